"""Start from the solution on a coarser mesh, where it is cheap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from solver.arrays import Array, Flags, Indices
from solver.checks import FUNCTION, check
from solver.discrete.problem import Problem
from solver.latin.end.certified import balance_of_rows, known_forces
from solver.laws import Component, Contact
from solver.reference.assembly import (
    Interrupted,
    NoReferenceError,
    assembled_stiffness,
    external_force,
)
from solver.reference.glued_structure import factored
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.refusal import RefusedError, Words

WAVES = 2.0
"""Length of the longest waves that a start leaves wrong, over an element of the coarser
mesh. Of belts of 40, 120 and 500 elements, five each, 1 % of the contact force takes at
most 14, 6 and 3 iterations; 18, 8 and 4 with twice as much; 74, 168 and 225 with the k
of a search from zero (measured)."""


@dataclass(frozen=True)
class Nested:
    """Start from the solution of the same structure on a coarser mesh.

    The incremental solver finds that solution. LATIN's own iterate on that mesh serves
    less: from it 1 % of the friction force took 70 iterations on 400 elements and
    instants of the bar, and was never found on 1600, where 5 and 3 are enough from that
    solution (measured). From a mesh four times as coarse strands take twice as many.

    Attributes
    ----------
    coarser
        Function that makes the problems on coarser meshes, uncut, the finest first,
        when a run begins; of rods or lines of beams, as the problem itself.
    """

    coarser: Callable[[], Iterable[Problem]]

    def __post_init__(self) -> None:
        check(self, coarser=FUNCTION)

    def of(self, problem: Problem, seconds: float = math.inf) -> Reference | None:
        """Solution on the finest coarser mesh that can be solved, for `prolong`.

        None if there is no such mesh, or its solution takes longer than `seconds`.
        """
        deadline = time.perf_counter() + seconds
        for coarse in self.coarser():
            _check_meshes(coarse, problem)
            try:
                solution = reference_of(coarse, lambda: time.perf_counter() > deadline)
            except NoReferenceError:
                continue
            except Interrupted:
                return None
            if solution.converged.all():
                return solution
        return None


def wrong_waves(solution: Reference) -> float:
    """Largest wavelength that a solution on a coarser mesh does not resolve, m."""
    laws = solution.problem.contacts.laws.values()
    elements = [float(law.by_point(law.weights).max()) for law in laws]
    return WAVES * max(elements, default=math.inf)


def prolong(solution: Reference, fine: Problem, k: Array) -> Array:
    """W + F/k of a solution on a coarser mesh, interpolated to a finer one.

    Displacement and contact force per length are linear between the coarse points; the
    forces on cuts and ends are those that the displacement needs inside each
    substructure. In the plane displacements of contacts are carried in the directions
    along and across them, so that a line that slides along its curve stays on it, and
    all others are those of elastic equilibrium.

    Parameters
    ----------
    solution
        Solution on the coarser mesh.
    fine
        Problem of the same structure on the finer mesh.
    k
        Search direction of its rows, shape (n_rows,), scaled.

    Returns
    -------
    W + F/k of its rows, shape (n_rows, n_instants), scaled.

    Raises
    ------
    RefusedError
        If bodies are no lines, or the meshes are not of one structure.
    """
    coarse = solution.problem
    _check_meshes(coarse, fine)
    # Curves on both meshes may differ in size, and with it their scales.
    displacement = solution.displacement / fine.scales.displacement
    if fine.inside is None:
        inside = _interpolated(
            _positions_of_dofs(fine), _positions_of_dofs(coarse), displacement
        )
    else:
        inside, is_known = _moved_contacts(coarse, displacement, fine)
        _balance(fine, inside, is_known)
    force, is_open = _contact_forces(solution, fine)
    # Cuts and ends carry the rest of the force that a substructure needs.
    balance, needed = balance_of_rows(fine, inside)
    shares = np.maximum(balance @ is_open.astype(float), 1.0)
    rest = balance.T @ ((needed - balance @ force) / shares[:, None])
    force[is_open] = rest[is_open]
    return np.asfortranarray(inside[fine.row_dofs] + force / k[:, None])


def _check_meshes(coarse: Problem, fine: Problem) -> None:
    """Refuse bodies that are no lines, and meshes of different structures."""
    remedy = "start without one"
    for problem in (coarse, fine):
        if problem.inside is not None and not problem.inside.is_of_lines:
            shown = Words("a problem of bodies in the plane")
            allowed = "problems of rods or lines of beams"
            raise RefusedError("Nested.coarser", shown, allowed, remedy)
    for kind, are_alike in (
        ("elements", (coarse.inside is None) == (fine.inside is None)),
        ("interfaces", list(coarse.contacts) == list(fine.contacts)),
        ("bodies", _bodies(coarse).max() == _bodies(fine).max()),
        ("instants", np.array_equal(coarse.instants, fine.instants)),
    ):
        if not are_alike:
            raise RefusedError(
                "Nested.coarser",
                Words(f"a problem of other {kind}"),
                "the same structure and instants on another mesh",
                remedy,
            )


def _moved_contacts(
    coarse: Problem, displacement: Array, fine: Problem
) -> tuple[Array, Flags]:
    """Displacement of contacts, interpolated to degrees of freedom of a finer mesh.

    `displacement` is that of the coarser mesh, (n_coarse_dofs, n_instants), scaled.

    Returns
    -------
    Displacement, shape (n_dofs, n_instants), scaled, that of contacts and the
    prescribed one, and zero elsewhere; and where it is known, shape (n_dofs,).
    """
    moved = np.zeros((fine.n_dofs, fine.n_instants))
    is_known = np.zeros(fine.n_dofs, dtype=bool)
    for name, target in fine.contacts.items():
        law = coarse.contacts[name]
        places = _positions_of_points(fine, target), _positions_of_points(coarse, law)
        for component, carried in zip(law.components, target.components, strict=True):
            for rows, to_rows in zip(component.sides, carried.sides, strict=True):
                of_points = law.mean_by_point(displacement[coarse.row_dofs[rows]])
                dofs = fine.row_dofs[to_rows]
                moved[dofs] = _interpolated(*places, of_points)[target.points]
                is_known[dofs] = True
    dofs, values = fine.prescribed
    moved[dofs] = values
    is_known[dofs] = True
    return moved, is_known


def _balance(problem: Problem, displacement: Array, is_known: Flags) -> None:
    """Complete known displacements, in place, to elastic equilibrium.

    `displacement` has shape (n_dofs, n_instants), scaled, `is_known` (n_dofs,).
    """
    free = np.flatnonzero(~is_known)
    if not len(free):
        return
    stiffness = assembled_stiffness(problem)
    force = external_force(problem) - stiffness @ displacement
    own = sparse.csc_array(stiffness[free][:, free])
    displacement[free] = factored(own).solve(force[free])


def _contact_forces(solution: Reference, fine: Problem) -> tuple[Array, Flags]:
    """Contact forces of a solution, interpolated to the rows of a finer mesh.

    Returns
    -------
    F of the rows, shape (n_rows, n_instants), scaled, zero where they do not rub; and
    whether they do not rub, shape (n_rows,).
    """
    coarse = solution.problem
    known, _ = known_forces(coarse, solution.contact_force / fine.scales.force)
    force = np.zeros((fine.n_rows, known.shape[1]))
    is_open = np.ones(fine.n_rows, dtype=bool)
    for name in fine.contacts:
        for carried, shared in _shared_forces(coarse, known, fine, name):
            for rows, sign in zip(carried.sides, (1.0, -1.0), strict=False):
                force[rows] = sign * shared
                is_open[rows] = False
    return force, is_open


def _shared_forces(
    coarse: Problem, force: Array, fine: Problem, name: str
) -> Iterator[tuple[Component, Array]]:
    """Components of a finer mesh's interface, with interpolated forces.

    `force` is that of the rows of the coarser mesh, shape (n_coarse_rows, n_instants),
    scaled; those carried have shape (n_pairs, n_instants).
    """
    law = coarse.contacts[name]
    target = fine.contacts[name]
    places = _positions_of_points(fine, target), _positions_of_points(coarse, law)
    for component, carried in zip(law.components, target.components, strict=True):
        nodal = law.by_point(force[component.above])
        # Per length, as nodal forces depend on the mesh.
        density = nodal / law.by_point(law.weights)[:, None]
        spread = _interpolated(*places, density)
        yield carried, spread[target.points] * target.weights[:, None]


def _bodies(problem: Problem) -> Indices:
    """Index of the body of every degree of freedom, from 0 on, shape (n_dofs,).

    Positions ascend along each rod.
    """
    if problem.inside is not None:
        return problem.inside.body_of_dofs
    return np.cumsum(np.diff(problem.positions, prepend=-1.0) <= 0.0)


def _positions_of_dofs(problem: Problem) -> Array:
    """Positions of the degrees of freedom, with rods laid end to end with gaps.

    Shape (n_dofs,), m; no rod touches the next.
    """
    return np.asarray(
        problem.positions + 2.0 * problem.scales.displacement * _bodies(problem)
    )


def _positions_of_points(problem: Problem, law: Contact) -> Array:
    """Positions of an interface's points, with rods laid end to end with gaps.

    Shape (n_points,), m; in the plane as shares of the length of the interface, as a
    curve is a little longer on a finer mesh.
    """
    if problem.inside is not None:
        return law.positions / (law.positions[-1] or 1.0)
    numbers = np.zeros(len(law.positions), dtype=np.intp)
    bodies = _bodies(problem)
    numbers[law.points] = sum(
        bodies[problem.row_dofs[rows]] for rows in law.tangent.sides
    )
    return law.positions + 2.0 * problem.scales.displacement * numbers


def _interpolated(fine: Array, coarse: Array, values: Array) -> Array:
    """Interpolate values linearly between coarse positions.

    `fine` and `coarse` are positions, shapes (n_fine,) and (n_coarse,), m, `values`
    have shape (n_coarse, n_instants); the result has shape (n_fine, n_instants).
    """
    if len(coarse) == 1:
        return np.repeat(values, len(fine), axis=0)
    # Beyond the coarse ends the value at the end holds.
    right = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    share = (fine - coarse[right - 1]) / (coarse[right] - coarse[right - 1])
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(values[right - 1] * (1.0 - share) + values[right] * share)
