"""Elastic rods that rub on a support, or on each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from solver.arrays import Array
from solver.checks import (
    COUNT,
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    Count,
    Each,
    Either,
    Number,
    Numbers,
    Part,
    check,
    check_value,
)
from solver.discrete.probes import Probe, Reaction, constant, reaction
from solver.discrete.problem import Problem
from solver.discrete.rods.cut_rods import SIDES, CutRods
from solver.discrete.structure import (
    OUTWARD,
    Act,
    Axes,
    Description,
    Hold,
    Loop,
    on_side,
)
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

SHOWN = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Where a body force that changes along the rods is shown, and the pressure where
anything rubs."""
SEVERAL = 8
"""Wires up to which the load of each is shown."""
Side = Literal["left", "right"]


@dataclass(frozen=True, eq=False)
class End:
    """How an end of every rod is pulled, or held; with nothing given it is free.

    Attributes
    ----------
    force
        Axial force on it, positive to the right, shape (n_instants,), N; None where it
        is held.
    displacement
        Of what holds it, shape (n_instants,), m; None where nothing does.
    spring
        Stiffness of the spring by which that holds it, N/m; infinite where it does so
        itself.

    Raises
    ------
    RefusedError
        For a force and a displacement, a spring that is not stiffer than zero, or no
        numbers.
    """

    force: Array | None = None
    displacement: Array | None = None
    spring: float = np.inf

    def __post_init__(self) -> None:
        over_time = Numbers(((None,),))
        spring = Number(0.0, above=True, endless=True)
        check(self, spring=spring, force=over_time, displacement=over_time)
        if self.force is not None and self.displacement is not None:
            raise RefusedError(
                "End.force",
                "given, with a displacement",
                "either of them",
                "leave out the other",
            )

    @property
    def is_prescribed(self) -> bool:
        """Whether its displacement is given."""
        return self.displacement is not None and bool(np.isinf(self.spring))

    @property
    def is_on_spring(self) -> bool:
        """Whether a spring holds it."""
        return self.displacement is not None and not np.isinf(self.spring)


@dataclass(frozen=True, eq=False)
class Rods:
    """One rod on a rigid rough support, or equal parallel rods that rub on each other.

    All have the same ends and friction law; absent parts are None.

    Attributes
    ----------
    length, stiffness
        Length L, m, and axial stiffness ES of one rod, N; where that varies, of the
        uniform rod that the same force at both ends stretches by as much.
    elements, substructures
        Of one rod: numbers of equal linear elements, and of parts that they are dealt
        to.
    bound
        Friction bound mu p at the nodes of an interface, N/m, shape (n_nodes,), or
        where it changes with time (n_nodes, n_instants).
    factors
        On the bound of each interface between several rods, shape (wires - 1,), or of
        all.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    wires
        Number of the rods, from 1: a single one rubs on its support, several on their
        neighbours.
    broken
        Number of the broken rod and of the node where it is broken, of several rods.
    body_force
        Axial force per length, N/m: uniform along the rods, shape (n_instants,), or at
        the nodes of each, (n_nodes, n_instants).
    strain
        Strain e_0 that the rods would have without any force, as by heat, shape
        (n_elements, n_instants), 1.
    settlement
        Displacement s of the support itself, at the nodes of a single rod, shape
        (n_nodes, n_instants), m. Ends are not on it.
    section
        Stiffness of every element over `stiffness`, shape (n_elements,), where it
        varies; the mean of the inverse is 1.
    pressure
        p behind the bound over time, shape (n_instants,), N/m, for whoever draws it,
        where one number says it at every instant.

    Raises
    ------
    RefusedError
        For a number that is not above zero or none, a field of another shape, instants
        that do not increase, a bound below zero, a settlement under several rods, or a
        break of a single one.
    """

    length: float
    stiffness: float
    elements: int
    substructures: int
    bound: Array
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
            left=Part(End),
            right=Part(End),
            friction_law=Part(FrictionLaw),
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
        """Refuse what does not fit the numbers of elements, rods and instants."""
        nodes = self.elements + 1
        instants = len(self.instants)
        over_time = Numbers(((instants,),))
        contacts = max(self.wires - 1, 1)
        check(
            self,
            substructures=Count(1, self.elements),
            bound=Numbers(((nodes,), (nodes, instants)), low=0.0),
            body_force=Numbers(((instants,), (nodes, instants))),
            strain=Numbers(((self.elements, instants),)),
            settlement=Numbers(((nodes, instants),)),
            factors=Either(NON_NEGATIVE, Numbers(((contacts,),), low=0.0)),
            section=Numbers(((self.elements,),), low=0.0, above=True),
            pressure=over_time,
            broken=Each(COUNT, 2),
        )
        for side, end in self.ends.items():
            for what, values in (
                ("force", end.force),
                ("displacement", end.displacement),
            ):
                if values is not None:
                    check_value(f"Rods.{side}.{what}", values, over_time)
        if self.broken is not None:
            check_value("Rods.wires", self.wires, Count(2))
            check_value("Rods.broken[0]", self.broken[0], Count(1, self.wires))
            check_value("Rods.broken[1]", self.broken[1], Count(1, self.elements - 1))

    @property
    def nodes(self) -> Array:
        """Positions of the nodes of a rod, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def bounds(self) -> Array:
        """The bound, shape (n_nodes, n_instants), or (n_nodes, 1) where it stays the same, N/m."""
        if self.bound.ndim == 2:
            return self.bound
        return self.bound[:, None]

    @property
    def ends(self) -> dict[Side, End]:
        """Both, by their side."""
        return {"right": self.right, "left": self.left}

    @property
    def load(self) -> Array:
        """Force on the right end of a rod that rubs nowhere, shape (n_instants,), N."""
        if self.right.is_prescribed:
            assert self.right.displacement is not None
            return self.right.displacement * (self.stiffness / self.length)
        if self.right.force is None:
            return np.zeros(len(self.instants))
        return self.right.force

    @property
    def is_only_pulled(self) -> bool:
        """Whether nothing but a force at the right ends moves the rods, and the left ones rest."""
        held = self.left.is_prescribed and not np.any(self.left.displacement)
        moved = self.body_force, self.strain, self.settlement
        return (
            held
            and self.right.force is not None
            and all(each is None for each in moved)
        )

    @property
    def rubbing_sides(self) -> int:
        """Neighbours of the broken rod."""
        if self.broken is None:
            return 0
        return 1 + (1 < self.broken[0] < self.wires)

    def discretise(self) -> Problem:
        """Make the discrete problem.

        On the support the interface is "friction"; "contact 1-2" lies between rods 1
        and 2, the second being the body above. Its points run along the rods; at the
        break of either there are two, one for each of the parts that have come apart.

        Between rods held ends do not rub: nothing slips there, and friction could not
        be told from the reactions.
        """
        names = ["friction"]
        rub_at_ends = (True, True)
        if self.wires > 1:
            names = [
                f"contact {number}-{number + 1}" for number in range(1, self.wires)
            ]
            rub_at_ends = not self.left.is_prescribed, not self.right.is_prescribed
        rods = [self] * self.wires
        places = [self.nodes] * self.wires
        return CutRods(rods, places, names, rub_at_ends).problem()

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        drive = self._drive
        if self.driven_end is None and drive is not None:
            title, unit, _ = drive
            is_held = self.ends["right"].displacement is not None
            return (title, unit), ("Force", "N") if is_held else (
                "End displacement",
                "m",
            )
        if self.wires == 1:
            return ("End displacement", "m"), ("Force", "N")
        return ("Mean end displacement", "m"), ("Tension", "N")

    def loop(self, problem: Problem) -> Loop:
        """Mean force on the ends that are driven over their mean displacement.

        Where no end is: what a right end does, or the force that holds it, over what
        drives.
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

    def end_force(self, problem: Problem, side: Side) -> Probe | Reaction:
        """Mean axial force at the ends of a side, N, positive to the right."""
        end = self.ends[side]
        if end.displacement is None:
            return constant(
                np.zeros(len(self.instants)) if end.force is None else end.force
            )
        if end.is_prescribed:
            return reaction(problem, SIDES[side]).times(1.0 / self.wires)
        moved = self._moved(problem, side).times(-end.spring)
        spring = end.spring
        return replace(moved, constant=moved.constant + spring * end.displacement)

    def _moved(self, problem: Problem, side: Side) -> Probe:
        """Mean displacement of the ends of a side, which stand on no support, m."""
        rows = problem.interfaces[SIDES[side]].rows
        node = 0 if side == "left" else -1
        if self.settlement is None:
            settled = 0.0
        else:
            settled = self.settlement[node]
        return Probe(
            problem.row_dofs[rows], np.full(len(rows), 1.0 / len(rows)), settled
        )

    @property
    def driven_end(self) -> Side | None:
        """The end that is pulled or moved, the right one before the left one, or None."""
        for side, end in self.ends.items():
            if (
                np.any(end.force)
                if end.displacement is None
                else np.any(end.displacement)
            ):
                return side
        return None

    @property
    def _drive(self) -> tuple[str, str, Array] | None:
        """What drives rods whose ends are left alone: title, unit, and values over time."""
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

    def described(self) -> Description:
        """The rods in words, for whoever draws them."""
        broken = self.broken and (self.broken[0] - 1, float(self.nodes[self.broken[1]]))
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
        right = OUTWARD["right"]
        pulled = self.wires if self.wires <= SEVERAL else 1
        heights = (np.arange(pulled) + 0.5) / pulled
        for side, end in self.ends.items():
            if end.displacement is not None:
                places = on_side(side, heights[:1] if side == "left" else heights)
                yield Act(f"{side} x", "u", places, right, end.displacement, "m")
            elif end.force is not None:
                yield Act(
                    f"{side} x", "F", on_side(side, heights), right, end.force, "N"
                )
        shown = np.rint(SHOWN * self.elements).astype(np.intp)
        if self.body_force is not None:
            is_uniform = self.body_force.ndim == 1
            if is_uniform:
                values = self.body_force
            else:
                values = self.body_force[shown]
            places = on_side("body", [0.5] if is_uniform else SHOWN)
            yield Act("body", "b", places, right, values, "N/m")
        if self.strain is not None:
            values = self.strain[np.abs(self.strain).max(axis=1).argmax()]
            yield Act("body strain", "ε₀", on_side("body", []), right, values, "")
        if self.settlement is not None:
            places = on_side("bottom", SHOWN)
            yield Act("bottom x", "s", places, right, self.settlement[shown], "m")
        rubs = SHOWN[
            np.interp(SHOWN, self.nodes / self.length, self.bounds.max(axis=1)) > 0.0
        ]
        if self.pressure is not None and len(rubs):
            places = on_side("top", rubs)
            yield Act("top y", "p", places, OUTWARD["bottom"], self.pressure, "N/m")

    def _holds(self) -> Iterator[Hold]:
        for side, end in self.ends.items():
            if end.is_on_spring:
                yield Hold("spring", side, moved=end.displacement)
            elif end.is_prescribed and (side == "left" or not np.any(end.displacement)):
                yield Hold("clamp", side, moved=end.displacement)
        if self.wires > 1:
            return
        rubs = np.flatnonzero(self.bounds.any(axis=1))
        for run in np.split(rubs, np.flatnonzero(np.diff(rubs) > 1) + 1):
            if len(run) > 1:
                first, last = run[[0, -1]] / self.elements
                yield Hold("support", "bottom", (float(first), float(last)))
