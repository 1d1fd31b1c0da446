"""Elastic rods that rub on a support, or on each other, as plain data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from solver.arrays import Array
from solver.checks import (
    COUNT,
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    AnyOf,
    Count,
    InstanceOf,
    Numbers,
    SequenceOf,
    check,
    check_value,
)
from solver.discrete.probes import Probe, Reaction, constant, reaction
from solver.discrete.problem import Problem
from solver.discrete.rods.end import SIDES, End, EndName
from solver.discrete.rods.rods_drawn import (
    act_of_body_force,
    act_of_settlement,
    act_of_strain,
    acts_at_ends,
    acts_of_pressure,
    holds_of_ends,
    holds_of_support,
)
from solver.discrete.structure import Act, Axes, Description, Hold, Loop
from solver.laws import FrictionLaw
from solver.refusal import RefusedError


@dataclass(frozen=True, eq=False)
class Rods:
    """A rod on a rigid rough support, or equal parallel rods that rub on each other.

    All have the same ends and friction law; absent parts are None.

    Attributes
    ----------
    length, stiffness
        Length L, m, and axial stiffness ES of one rod, N; where ES varies, that of the
        uniform rod that the same force at both ends stretches by as much.
    elements, substructures
        Numbers of equal linear elements of one rod, and of its substructures.
    strength
        Friction strength mu p at the nodes of an interface, N/m, shape (n_nodes,), or
        where it changes with time (n_nodes, n_instants).
    factors
        Factors on the strength of each interface between several rods, shape (wires -
        1,), or one factor for all.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    wires
        Number of the rods, from 1: a single rod rubs on its support, several rods on
        their neighbours.
    broken
        Number of the broken rod, from 1, and of the node where it is broken; for
        several rods only.
    body_force
        Axial force per length, N/m: uniform along the rods, shape (n_instants,), or at
        the nodes of each, (n_nodes, n_instants).
    strain
        Strain e_0 that the rods would have without any force, as by heat, shape
        (n_elements, n_instants), 1.
    settlement
        Displacement s of the support itself, at the nodes of a single rod, shape
        (n_nodes, n_instants), m. What holds the ends does not move with it.
    section
        Stiffness of every element over `stiffness`, shape (n_elements,), where it
        varies; the mean of the inverse is 1.
    pressure
        Pressure p behind the strength over time, shape (n_instants,), N/m, for
        drawings, where it is uniform along the rods.

    Raises
    ------
    RefusedError
        For a number that is not above zero or not finite, a field of another shape,
        instants that do not increase, a strength below zero, a settlement under several
        rods, or a break of a single rod.
    """

    length: float
    stiffness: float
    elements: int
    substructures: int
    strength: Array
    left: End
    right: End
    instants: Array
    duration: float
    wires: int = 1
    broken: tuple[int, int] | None = None
    body_force: Array | None = None
    strain: Array | None = None
    settlement: Array | None = None
    factors: Array | float = 1.0
    section: Array | None = None
    pressure: Array | None = None
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)

    def __post_init__(self) -> None:
        check(
            self,
            length=POSITIVE,
            stiffness=POSITIVE,
            elements=COUNT,
            wires=COUNT,
            instants=INSTANTS,
            duration=POSITIVE,
            left=InstanceOf(End),
            right=InstanceOf(End),
            friction_law=InstanceOf(FrictionLaw),
        )
        self._check_fields()
        if self.wires > 1 and self.settlement is not None:
            raise RefusedError(
                "Rods.settlement",
                self.wires,
                "a single rod",
                "several rods rub on each other",
            )

    def _check_fields(self) -> None:
        """Refuse fields that do not fit the numbers of elements, rods and instants."""
        nodes = self.elements + 1
        instants = len(self.instants)
        over_time = Numbers(((instants,),))
        contacts = max(self.wires - 1, 1)
        check(
            self,
            substructures=Count(1, self.elements),
            strength=Numbers(((nodes,), (nodes, instants)), low=0.0),
            body_force=Numbers(((instants,), (nodes, instants))),
            strain=Numbers(((self.elements, instants),)),
            settlement=Numbers(((nodes, instants),)),
            factors=AnyOf(NON_NEGATIVE, Numbers(((contacts,),), low=0.0)),
            section=Numbers(((self.elements,),), low=0.0, above=True),
            pressure=over_time,
            broken=SequenceOf(COUNT, 2),
        )
        for side, end in self.ends.items():
            if end.force is not None:
                check_value(f"Rods.{side}.force", end.force, over_time)
            if end.displacement is not None:
                check_value(f"Rods.{side}.displacement", end.displacement, over_time)
        if self.broken is not None:
            check_value("Rods.wires", self.wires, Count(2))
            check_value("Rods.broken[0]", self.broken[0], Count(1, self.wires))
            check_value("Rods.broken[1]", self.broken[1], Count(1, self.elements - 1))

    @property
    def nodes(self) -> Array:
        """Positions of the nodes of a rod, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def strengths(self) -> Array:
        """Friction strength, N/m, (n_nodes, n_instants), or (n_nodes, 1) if steady."""
        if self.strength.ndim == 2:
            return self.strength
        return self.strength[:, None]

    @property
    def ends(self) -> dict[EndName, End]:
        """Both ends by their side, the right one first."""
        return {"right": self.right, "left": self.left}

    @property
    def load(self) -> Array:
        """Force on the right end if there were no friction, shape (n_instants,), N."""
        if self.right.is_prescribed:
            assert self.right.displacement is not None
            return self.right.displacement * (self.stiffness / self.length)
        if self.right.force is None:
            return np.zeros(len(self.instants))
        return self.right.force

    @property
    def is_only_pulled(self) -> bool:
        """Check whether only a force at the right ends moves the rods.

        The left ends are clamped then, and nothing acts between both ends.
        """
        is_clamped = self.left.is_prescribed and not np.any(self.left.displacement)
        is_pulled = self.right.force is not None
        between = (self.body_force, self.strain, self.settlement)
        return is_clamped and is_pulled and all(each is None for each in between)

    @property
    def rubbing_sides(self) -> int:
        """Number of neighbours of the broken rod; 0 without one."""
        if self.broken is None:
            return 0
        return 1 + (1 < self.broken[0] < self.wires)

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        drive = self._drive
        if self.driven_end is None and drive is not None:
            title, unit, _ = drive
            if self.right.displacement is not None:
                return (title, unit), ("Force", "N")
            return (title, unit), ("End displacement", "m")
        if self.wires == 1:
            return ("End displacement", "m"), ("Force", "N")
        return ("Mean end displacement", "m"), ("Tension", "N")

    def loop(self, problem: Problem) -> Loop:
        """Mean force on the ends that are driven over their mean displacement.

        Where no end is driven: displacement of the right end, or the force that holds
        it, over the strain, settlement or body force that drives.
        """
        side = self.driven_end or "right"
        drive = self._drive
        moved = self._moved(problem, side)
        force = self.end_force(problem, side).of
        if self.driven_end is None and drive is not None:
            _, _, values = drive
            if self.ends[side].displacement is None:
                force = moved.of
            return Loop(*self.axes, constant(values), force)
        return Loop(*self.axes, moved, force)

    def end_force(self, problem: Problem, side: EndName) -> Probe | Reaction:
        """Mean axial force at the ends of a side, N, positive to the right."""
        end = self.ends[side]
        if end.displacement is None:
            force = end.force
            if force is None:
                force = np.zeros(len(self.instants))
            return constant(force)
        if end.is_prescribed:
            return reaction(problem, SIDES[side]).times(1.0 / self.wires)
        moved = self._moved(problem, side).times(-end.spring)
        spring = end.spring
        return replace(moved, constant=moved.constant + spring * end.displacement)

    def _moved(self, problem: Problem, side: EndName) -> Probe:
        """Absolute mean displacement of the ends of a side, m."""
        rows = problem.interfaces[SIDES[side]].rows
        node = 0 if side == "left" else -1
        if self.settlement is None:
            settled = 0.0
        else:
            settled = self.settlement[node]
        weights = np.full(len(rows), 1.0 / len(rows))
        return Probe(problem.row_dofs[rows], weights, settled)

    @property
    def driven_end(self) -> EndName | None:
        """Side of the end that is pulled or moved, the right one first, or None."""
        for side, end in self.ends.items():
            values = end.displacement
            if values is None:
                values = end.force
            if np.any(values):
                return side
        return None

    @property
    def _drive(self) -> tuple[str, str, Array] | None:
        """Title, unit and values of a distributed load along the rods, or None.

        Values, (n_instants,), are those at the place where they are largest.
        """
        drives = (
            ("Strain without force", "", self.strain),
            ("Settlement", "m", self.settlement),
            ("Body force", "N/m", self.body_force),
        )
        for title, unit, values in drives:
            if values is not None and values.any():
                along = np.atleast_2d(values)
                return title, unit, along[np.abs(along).max(axis=1).argmax()]
        return None

    def description(self) -> Description:
        """Description of the rods for drawings."""
        broken = None
        if self.broken is not None:
            number, node = self.broken
            broken = (number - 1, float(self.nodes[node]))
        return Description(
            bodies=self.wires,
            length=self.length,
            height=None,
            instants=self.instants,
            acts=tuple(self._acts()),
            holds=tuple(self._holds()),
            broken=broken,
        )

    def _acts(self) -> Iterator[Act]:
        """Arrows of loads and motions of the ends, of loads along rods, of pressure."""
        yield from acts_at_ends(self.ends, self.wires)
        if self.body_force is not None:
            yield act_of_body_force(self.body_force)
        if self.strain is not None:
            yield act_of_strain(self.strain)
        if self.settlement is not None:
            yield act_of_settlement(self.settlement)
        if self.pressure is not None:
            places = self.nodes / self.length
            yield from acts_of_pressure(self.pressure, self.strengths, places)

    def _holds(self) -> Iterator[Hold]:
        """Springs and clamps of the ends, and the support of a single rod."""
        yield from holds_of_ends(self.ends)
        if self.wires == 1:
            yield from holds_of_support(self.strengths)
