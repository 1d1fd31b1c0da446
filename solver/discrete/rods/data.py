"""Elastic rods that rub, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from solver.arrays import Array
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

COARSEST = 6
"""Elements below which a mesh is not coarsened: a front needs a few to be seen at all."""


@dataclass(frozen=True, eq=False)
class RodsData:
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
        """Give the same uncut rods on half the elements, or None where no front would be seen.

        They must be whole: a break stands at a node.
        """
        elements = self.elements // 2
        if elements < COARSEST:
            return None
        nodes = np.linspace(0.0, self.length, elements + 1)
        body_force = self.body_force
        if body_force is not None and body_force.ndim == 2:
            body_force = self._at(nodes, body_force)
        return replace(
            self,
            elements=elements,
            substructures=1,
            bound=self._at(nodes, self.bound),
            body_force=body_force,
            section=self._section_between(nodes),
        )

    def _at(self, nodes: Array, field: Array) -> Array:
        """Give a field at other nodes, linear between its own."""
        return np.apply_along_axis(lambda own: np.interp(nodes, self.nodes, own), 0, field)

    def _section_between(self, nodes: Array) -> Array | None:
        """Give the stiffness between other nodes, in series what the elements have there."""
        if self.section is None:
            return None
        compliance = np.concatenate([[0.0], np.cumsum(1.0 / self.section)])
        own = np.diff(np.interp(nodes, self.nodes, compliance))
        return np.asarray(np.mean(own) / own)


def neighbours(wire: int, wires: int) -> int:
    """Give how many neighbours a rod of several has, numbered from 1."""
    return (wire > 1) + (wire < wires)
