"""Probes: mean displacements, reactions and axial forces of a structure over time.

A probe of displacements inside condensed substructures is brought onto the degrees of
freedom of the problem once, by the transpose of their recovery; then its evaluation
costs no more than its few weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices, without_residue
from solver.discrete.contacts import ContactFields
from solver.discrete.inside import Inside
from solver.discrete.problem import Problem

AXES = {
    "left": 0,
    "right": 0,
    "bottom": 1,
    "top": 1,
}
"""Axis normal to each side: 0 is x, 1 is y."""
SAME_PLACE = 1e-9
"""Distance of two places that are the same, over the size of all bodies."""


class LoopFields(Protocol):
    """Fields of an iterate or a reference, SI, shape (n, n_instants)."""

    @property
    def displacement(self) -> Array:
        """Displacement of all degrees of freedom, (n_dofs, n_instants), m."""

    def contact(self, name: str) -> ContactFields:
        """Fields of one interface with friction."""


@dataclass(frozen=True, eq=False)
class Probe:
    """A weighted sum of displacements, plus a known constant.

    Attributes
    ----------
    dofs, weights
        Degrees of freedom of the problem, and their weights, shape (n,) both; weights
        in the probe's unit over m.
    constant
        Part of the sum that does not depend on displacements, shape (n_instants,) or
        0, in the probe's unit.
    """

    dofs: Indices
    weights: Array
    constant: Array | float = 0.0

    def __call__(self, displacement: Array) -> Array:
        """Value over time, (n_instants,), for displacements (n_dofs, n_instants), m."""
        return without_residue(*self.sum_of(displacement))

    def sum_of(self, displacement: Array) -> tuple[Array, Array]:
        """Sum of the terms, and sum of their absolute values, (n_instants,) both."""
        moved = displacement[self.dofs]
        sizes = np.abs(self.weights) @ np.abs(moved) + np.abs(self.constant)
        return np.asarray(self.weights @ moved + self.constant), np.asarray(sizes)

    def times(self, factor: float) -> Probe:
        """The probe times a factor."""
        return Probe(self.dofs, factor * self.weights, factor * self.constant)

    def of(self, fields: LoopFields) -> Array:
        """Value for an iterate or a reference, shape (n_instants,)."""
        return self(fields.displacement)


def constant(values: Array) -> Probe:
    """Probe of known values, shape (n_instants,), in any unit."""
    return Probe(np.zeros(0, dtype=np.intp), np.zeros(0), values)


def side_mean(problem: Problem, side: str, component: int) -> Probe:
    """Mean displacement along a whole outer side of bodies in the plane, m.

    The side is "left", "right", "bottom" or "top"; the component 0 along x, 1 along y.
    """
    inside = _inside(problem)
    ends, _ = _edges(inside, side)
    whole = np.linalg.norm(np.subtract(*inside.nodes[ends]), axis=1).sum()
    return _integral(problem, ends, component, np.full(ends.shape, 1.0 / whole))


def mean_held(problem: Problem, name: str, axis: int) -> Probe:
    """Mean displacement along an axis of nodes that an interface prescribes.

    In m along x (0) and y (1), in rad of a turn (2).
    """
    dofs = problem.held_dofs[name]
    along = _inside(problem).directions[dofs, axis]
    return Probe(dofs, along / len(dofs))


def node_sum(problem: Problem, weights: Array) -> Probe:
    """Sum of the displacements of all nodes times weights, (n_nodes, 2), m."""
    kept, constant = _inside(problem).adjoint(weights)
    dofs = np.flatnonzero(kept)
    return Probe(dofs, kept[dofs], constant)


def end_rotation(problem: Problem) -> Probe:
    """Mean counter-clockwise rotation of the right ends of the longest bodies, rad.

    A moment that the ends share as linear tractions works on this rotation: -12 / t^3
    times the integral of (y - y_middle) u_x over an end of height t.
    """
    inside = _inside(problem)
    ends, bodies = _edges(inside, "right")
    _, bodies = np.unique(bodies, return_inverse=True)
    y = inside.nodes[ends, 1]
    count = int(bodies.max()) + 1
    low = np.full(count, np.inf)
    high = np.full(count, -np.inf)
    np.minimum.at(low, bodies, y.min(axis=0))
    np.maximum.at(high, bodies, y.max(axis=0))
    lever = y - (0.5 * (low + high))[bodies]
    density = -12.0 / count / ((high - low) ** 3)[bodies] * lever
    return _integral(problem, ends, 0, density)


@dataclass(frozen=True, eq=False)
class Reaction:
    """A weighted sum of the reactions at degrees of freedom of known displacement.

    The holding forces are the forces of the elements there, less loads and the contact
    forces of the same nodes (MATHEMATICS.md, 6).

    Attributes
    ----------
    elements
        Forces of the elements less the loads, N.
    contacts
        Weights of the normal and the tangential contact forces, by interface,
        (n_points,) each; None where the interface has no normal forces.
    """

    elements: Probe
    contacts: Mapping[str, tuple[Array | None, Array]]

    def of(self, fields: LoopFields) -> Array:
        """Value for an iterate or a reference, (n_instants,), N or N m."""
        values, sizes = self.elements.sum_of(fields.displacement)
        for name, weights in self.contacts.items():
            contact = fields.contact(name)
            carried = contact.normal_force, contact.tangential_force
            for weight, force in zip(weights, carried, strict=True):
                if weight is not None and force is not None:
                    values = values - weight @ force
                    sizes = sizes + np.abs(weight) @ np.abs(force)
        return without_residue(values, sizes)

    def times(self, factor: float) -> Reaction:
        """The reaction times a factor."""
        contacts = dict[str, tuple[Array | None, Array]]()
        for name, (normal, tangential) in self.contacts.items():
            if normal is not None:
                normal = factor * normal
            contacts[name] = (normal, factor * tangential)
        return Reaction(self.elements.times(factor), contacts)


def reaction(problem: Problem, name: str, component: int | None = None) -> Reaction:
    """Sum of the reactions at an interface of prescribed displacements, N.

    In the plane those of one component are counted, 0 along x, 1 along y and 2 the
    moments, N m; along rods there is one.
    """
    held = np.zeros(problem.n_dofs)
    held[problem.held_dofs[name]] = 1.0
    if component is not None:
        held *= _inside(problem).directions[:, component]
    return _weighted_reaction(problem, held)


def reaction_moment(problem: Problem, name: str) -> Reaction:
    """Moment of the reactions at an interface in the plane about the origin, N m.

    Counter-clockwise, for a metre of thickness.
    """
    x, y = problem.positions.T
    along_x, along_y, turn = _inside(problem).directions.T
    held = np.zeros(problem.n_dofs)
    dofs = problem.held_dofs[name]
    held[dofs] = (x * along_y - y * along_x + turn)[dofs]
    return _weighted_reaction(problem, held)


def _weighted_reaction(problem: Problem, held: Array) -> Reaction:
    """Sum of the reactions times the weights `held` of the dofs, (n_dofs,)."""
    weights = np.zeros(problem.n_dofs)
    loads = np.zeros(problem.n_instants)
    for part in problem.substructures:
        of_part = held[part.dofs]
        if of_part.any():
            np.add.at(weights, part.dofs, part.elasticity.stiffness @ of_part)
            if part.body_force is not None:
                loads += of_part @ part.body_force
    for given in problem.prescribed_forces:
        loads += held[problem.row_dofs[given.rows]] @ given.values
    scales = problem.scales
    dofs = np.flatnonzero(weights)
    # The weights of a force by displacements are a stiffness.
    elastic = weights[dofs] * scales.force / scales.displacement
    elements = Probe(dofs, elastic, -loads * scales.force)
    return Reaction(elements, _contacts_at(problem, held))


def _contacts_at(
    problem: Problem, held: Array
) -> dict[str, tuple[Array | None, Array]]:
    """Weights of contact forces, by interface, from those of degrees of freedom.

    `held` has shape (n_dofs,), weights of normal forces, or None, and of tangential
    forces have (n_points,).
    """
    found: dict[str, tuple[Array | None, Array]] = {}
    names = problem.contacts.names
    for law, numbers, _, _ in problem.contacts.stacks:
        # All pairs of a point are at one node, so one of them tells its weight.
        _, pairs = np.unique(law.points, return_index=True)
        weights = []
        for component in law.components:
            weight = held[problem.row_dofs[component.above[pairs]]]
            if component.below is not None:
                weight = weight - held[problem.row_dofs[component.below[pairs]]]
            weights.append(weight)
        for number, (points, _) in zip(numbers, law.ranges, strict=True):
            normal = weights[0][points]
            tangential = weights[-1][points]
            if normal.any() or tangential.any():
                found[names[number]] = (normal if law.opens else None, tangential)
    return {name: found[name] for name in names if name in found}


class AxialForce:
    """Axial force in the elements of rods, from displacements at some instants.

    Attributes
    ----------
    positions
        Middles of the elements, (n_elements,), m.
    wires
        Index of the rod of each element, from 0, (n_elements,).
    """

    def __init__(
        self, problem: Problem, instants: slice | Indices = slice(None)
    ) -> None:
        parts = problem.substructures
        places = problem.positions
        self._first = np.concatenate([part.dofs[:-1] for part in parts])
        self._second = np.concatenate([part.dofs[1:] for part in parts])
        scale = problem.scales.force / problem.scales.displacement
        matrices = [sparse.csr_array(part.elasticity.stiffness) for part in parts]
        springs = [-matrix.diagonal(1) for matrix in matrices]
        self._stiffness = scale * np.concatenate(springs)
        free = [part.free_force for part in parts if part.free_force is not None]
        self._free: Array | float = 0.0
        if free:
            self._free = problem.scales.force * np.concatenate(free)[:, instants]
        self.positions: Array = 0.5 * (places[self._first] + places[self._second])
        # A rod begins where its first substructure stands at the first position.
        begins = [places[part.dofs[0]] == places[0] for part in parts]
        sizes = [len(part.dofs) - 1 for part in parts]
        self.wires: Indices = np.repeat(np.cumsum(begins) - 1, sizes)

    def __call__(self, displacement: Array) -> Array:
        """Forces, (n_elements, n), N, for displacements (n_dofs, n), m."""
        elongation = displacement[self._second] - displacement[self._first]
        return np.asarray(self._stiffness[:, None] * elongation - self._free)


def _inside(problem: Problem) -> Inside:
    """Interior of a problem of bodies in the plane, which always has one."""
    assert problem.inside is not None
    return problem.inside


def _edges(inside: Inside, side: str) -> tuple[Indices, Indices]:
    """Nodes at both ends, (2, n), and bodies, (n,), of edges on an outer side."""
    places = inside.nodes[:, AXES[side]]
    if side in ("left", "bottom"):
        outermost = places.min()
    else:
        outermost = places.max()
    ends = np.stack([inside.elements, np.roll(inside.elements, -1, axis=1)])
    # Nodes of different bodies may be off by rounding.
    near = SAME_PLACE * np.ptp(places)
    along = np.all(np.abs(places[ends] - outermost) <= near, axis=0)
    return ends[:, along], inside.bodies[np.nonzero(along)[0]]


def _integral(problem: Problem, ends: Indices, component: int, density: Array) -> Probe:
    """Integral over edges of a displacement component times a density linear on each.

    `ends` are the nodes at both ends of n edges, `density` the values there, (2, n).
    """
    inside = _inside(problem)
    length = np.linalg.norm(np.subtract(*inside.nodes[ends]), axis=1)
    # Simpson's rule, exact for the product of two linear functions.
    shares = length / 6.0 * (density + density.sum(axis=0))
    weights = np.zeros_like(inside.nodes)
    np.add.at(weights[:, component], ends, shares)
    return node_sum(problem, weights)
