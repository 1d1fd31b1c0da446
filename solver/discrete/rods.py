"""Elastic rods that rub on a support, or on each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from solver.arrays import Array
from solver.discrete.cut_rods import COARSEST, discretise_rods
from solver.discrete.probes import Probe, reaction
from solver.discrete.problem import Problem
from solver.discrete.structure import OUTWARD, Act, Description, Hold, Loop, LoopFields
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

SHOWN = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
"""Where a body force that changes along the rods is shown, and the pressure where anything rubs."""
SEVERAL = 8
"""Wires up to which the load of each is shown."""


@dataclass(frozen=True, eq=False)
class Rods:
    """One rod on a rigid rough support, or equal parallel rods that rub on each other.

    Their left ends are held; absent parts are None.

    Attributes
    ----------
    length, stiffness
        Length L, m, and axial stiffness ES of one rod, N; where that varies, of the uniform rod
        that the same force at both ends stretches by as much.
    elements, substructures
        Of one rod: numbers of equal linear elements, and of parts that they are dealt to.
    bound
        Friction bound mu p at the nodes of an interface, N/m, shape (n_nodes,), or where it changes
        with time (n_nodes, n_instants).
    load
        Force at the right end of every rod, or with a rigid grip that of a rod which carries
        nothing but its share, shape (n_instants,), N.
    instants, duration
        Instants, shape (n_instants,), and length of the interval, s.
    wires
        Number of the rods, from 1: a single one rubs on its support, several on their neighbours.
    broken
        Number of the broken rod and of the node where it is broken, of several rods.
    rigid_grip
        Whether the right ends are displaced by load times L / ES instead.
    support
        Displacement of the held ends, shape (n_instants,), m.
    body_force
        Axial force per length, N/m: uniform along the rods, shape (n_instants,), or at the nodes of
        each, (n_nodes, n_instants).
    friction_law
        Along the interfaces.
    section
        Stiffness of every element over `stiffness`, shape (n_elements,), where it varies; the mean
        of the inverse is 1.
    pressure
        p behind the bound over time, shape (n_instants,), N/m, for whoever draws it, where one
        number says it at every instant.

    Raises
    ------
    RefusedError
        For a bound or a body force of another shape, or a bound below zero.
    """

    length: float
    stiffness: float
    elements: int
    substructures: int
    bound: Array
    load: Array
    instants: Array
    duration: float
    wires: int = 1
    broken: tuple[int, int] | None = None
    rigid_grip: bool = False
    support: Array | None = None
    body_force: Array | None = None
    section: Array | None = None
    pressure: Array | None = None
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)

    def __post_init__(self) -> None:
        nodes, instants = self.elements + 1, len(self.instants)
        if self.bound.shape not in ((nodes,), (nodes, instants)):
            raise RefusedError(
                "Rods.bound",
                list(self.bound.shape),
                f"shape [{nodes}], or [{nodes}, {instants}] where it changes with time",
                "give a value for every node, at every instant where it changes",
            )
        if self.bound.min() < 0.0:
            raise RefusedError(
                "Rods.bound", float(self.bound.min()), "0 or more", "give no bound below zero"
            )
        if self.body_force is not None and self.body_force.shape not in (
            (instants,),
            (nodes, instants),
        ):
            raise RefusedError(
                "Rods.body_force",
                list(self.body_force.shape),
                f"shape [{instants}], or [{nodes}, {instants}] where it changes along the rods",
                "give a value for every instant, at every node where it changes along them",
            )

    @property
    def nodes(self) -> Array:
        """Positions of the nodes of a rod, shape (n_nodes,), m."""
        return np.linspace(0.0, self.length, self.elements + 1)

    @property
    def bounds(self) -> Array:
        """The bound, shape (n_nodes, n_instants), or (n_nodes, 1) where it stays the same, N/m."""
        return self.bound if self.bound.ndim == 2 else self.bound[:, None]

    @property
    def rubbing_sides(self) -> int:
        """Neighbours of the broken rod."""
        return 0 if self.broken is None else neighbours(self.broken[0], self.wires)

    def coarser(self) -> Self | None:
        """Return the same uncut rods on half the elements; None where no front would be seen.

        They must be whole: a break stands at a node.
        """
        elements = self.elements // 2
        if elements < COARSEST:
            return None
        nodes = np.linspace(0.0, self.length, elements + 1)
        body_force, section = self.body_force, self.section
        if body_force is not None and body_force.ndim == 2:
            body_force = self._at(nodes, body_force)
        if section is not None:  # in series what the elements have between the new nodes
            compliance = np.concatenate([[0.0], np.cumsum(1.0 / section)])
            soft = np.diff(np.interp(nodes, self.nodes, compliance))
            section = np.mean(soft) / soft
        return replace(
            self,
            elements=elements,
            substructures=1,
            bound=self._at(nodes, self.bound),
            body_force=body_force,
            section=section,
        )

    def _at(self, nodes: Array, values: Array) -> Array:
        """Values at other nodes, linear between those of the rod."""
        return np.apply_along_axis(lambda own: np.interp(nodes, self.nodes, own), 0, values)

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return discretise_rods(self)

    def loop(self, problem: Problem) -> Loop:
        """Mean force on the loaded ends over their mean displacement."""
        rows, given = problem.interfaces["load"].rows, problem.interfaces["load"].given_force
        weights = np.full(len(rows), 1.0 / len(rows))
        force: Array | Callable[[LoopFields], Array]
        if given is not None:
            force = weights @ given.values * problem.scales.force
        else:
            held = reaction(problem, "load")
            force = lambda fields: held(fields.displacement) / len(rows)  # noqa: E731
        across, up = ("End", "Force") if self.wires == 1 else ("Mean end", "Tension")
        ends = Probe(problem.row_dofs[rows], weights)
        return Loop((f"{across} displacement", "m"), (up, "N"), ends, force)

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
        start, pulled = np.array([[0.0, 0.5]]), self.wires if self.wires <= SEVERAL else 1
        heights = (np.arange(pulled) + 0.5) / pulled
        end = np.stack([np.ones(pulled), heights], axis=1)
        right = OUTWARD["right"]
        if self.rigid_grip:
            moved = self.load * self.length / self.stiffness
            yield Act("right x", "u", end, right, right, moved, "m")
        else:
            yield Act("right x", "F", end, right, right, self.load, "N")
        if self.support is not None:
            yield Act("left x", "u", start, right, OUTWARD["left"], self.support, "m")
        if self.body_force is not None:
            x = np.array([0.5]) if self.body_force.ndim == 1 else SHOWN
            middle = np.stack([x, np.full(len(x), 0.5)], axis=1)
            nearest = np.rint(x * self.elements).astype(np.intp)
            values = self.body_force if self.body_force.ndim == 1 else self.body_force[nearest]
            yield Act("body", "b", middle, right, right, values, "N/m")
        most = self.bounds.max(axis=1)
        x = SHOWN[np.interp(SHOWN, self.nodes / self.length, most) > 0.0]
        if self.pressure is not None and len(x):
            places = np.stack([x, np.ones_like(x)], axis=1)
            ways = OUTWARD["bottom"], OUTWARD["top"]
            yield Act("top y", "p", places, *ways, self.pressure, "N/m")

    def _holds(self) -> Iterator[Hold]:
        yield Hold("clamp", "left", moved=self.support)
        if self.wires > 1:
            return
        rubs = np.flatnonzero(self.bounds.any(axis=1))
        for run in np.split(rubs, np.flatnonzero(np.diff(rubs) > 1) + 1):
            if len(run) > 1:
                first, last = run[[0, -1]] / self.elements
                yield Hold("support", "bottom", (float(first), float(last)))


def neighbours(wire: int, wires: int) -> int:
    """Number of neighbours that a rod of several has, numbered from 1."""
    return (wire > 1) + (wire < wires)
