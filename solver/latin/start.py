"""Start from the solution on a coarser mesh, where a solution is cheap."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.checks import FUNCTION, check
from solver.discrete.problem import Problem
from solver.latin.end.certified import balance_of_rows, known_forces
from solver.latin.iterate import Checkpoint
from solver.laws import Contact
from solver.reference.assembly import Interrupted, NoReferenceError
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.refusal import RefusedError, Words


@dataclass(frozen=True)
class Nested:
    """Start from the solution of the same structure on a coarser mesh.

    The incremental solver finds that solution. LATIN's own iterate on that mesh serves
    less: on 400 elements and instants of the bar 1 % of the friction force takes 16
    iterations instead of 70, on 1600 elements 11 instead of never, and on strands of 10
    and 20 wires 51 and 148 instead of 71 and more than 400, at a third to two thirds of
    the time (measured). From a mesh four times as coarse strands take twice as many.

    Attributes
    ----------
    coarser
        Function that makes the problems on coarser meshes, uncut, the finest first,
        when a run begins; of rods, as the problem itself.
    """

    coarser: Callable[[], Iterable[Problem]]

    def __post_init__(self) -> None:
        check(self, coarser=FUNCTION)

    def of(
        self, problem: Problem, k: Array, seconds: float = math.inf
    ) -> Checkpoint | None:
        """Start of a problem, from the finest coarser mesh that has a solution.

        None if there is no such mesh, or its solution takes longer than `seconds`. `k`
        is the search direction of the rows, shape (n_rows,), scaled.
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
                return Checkpoint(0, 0.0, prolong(solution, problem, k))
        return None


def prolong(solution: Reference, fine: Problem, k: Array) -> Array:
    """W + F/k of a solution on a coarser mesh, carried to a finer one.

    Displacement and friction force per length are linear between the coarse nodes of a
    body; the forces on cuts and ends are those that the displacement needs inside each
    substructure.

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
        If bodies lie in the plane, or the meshes are not of one structure.
    """
    coarse = solution.problem
    _check_meshes(coarse, fine)
    displacement = solution.displacement / coarse.scales.displacement
    inside = _interpolated(_apart(fine), _apart(coarse), displacement)
    force, is_open = _carried(solution, fine)
    # Cuts and ends carry the rest of the force that a substructure needs.
    balance, needed = balance_of_rows(fine, inside)
    rest = balance.T @ (needed - balance @ force)
    force[is_open] = rest[is_open]
    return np.asfortranarray(inside[fine.row_dofs] + force / k[:, None])


def _check_meshes(coarse: Problem, fine: Problem) -> None:
    """Refuse problems in the plane, and two that are not of one structure."""
    remedy = "start without one"
    for problem in (coarse, fine):
        if problem.positions.ndim > 1:
            shown = Words("a problem of bodies in the plane")
            raise RefusedError("Nested.coarser", shown, "problems of rods", remedy)
    for kind, are_alike in (
        ("interfaces", list(coarse.rubbing) == list(fine.rubbing)),
        ("bodies", _bodies(coarse)[-1] == _bodies(fine)[-1]),
        ("instants", np.array_equal(coarse.instants, fine.instants)),
    ):
        if not are_alike:
            raise RefusedError(
                "Nested.coarser",
                Words(f"a problem of other {kind}"),
                "the same structure and instants on another mesh",
                remedy,
            )


def _carried(solution: Reference, fine: Problem) -> tuple[Array, Flags]:
    """Friction of a solution, carried to the rows of a finer mesh.

    Returns
    -------
    F of the rows, shape (n_rows, n_instants), scaled, zero where they do not rub; and
    whether they do not rub, shape (n_rows,).
    """
    coarse = solution.problem
    known, _ = known_forces(coarse, solution.contact_force / coarse.scales.force)
    force = np.zeros((fine.n_rows, known.shape[1]))
    is_open = np.ones(fine.n_rows, dtype=bool)
    for name, target in fine.rubbing.items():
        law = coarse.rubbing[name]
        friction = law.by_point(known[law.tangent.above])
        # Per length, as nodal forces depend on the mesh.
        density = friction / law.by_point(law.weights)[:, None]
        spread = _interpolated(
            _points_apart(fine, target), _points_apart(coarse, law), density
        )
        shared = spread[target.points] * target.weights[:, None]
        for rows, sign in zip(target.tangent.sides, (1.0, -1.0), strict=False):
            force[rows] = sign * shared
            is_open[rows] = False
    return force, is_open


def _bodies(problem: Problem) -> Indices:
    """Number of the body of every degree of freedom, from 0 on, shape (n_dofs,).

    Positions ascend along each body.
    """
    return np.cumsum(np.diff(problem.positions, prepend=-1.0) <= 0.0)


def _apart(problem: Problem) -> Array:
    """Positions of the degrees of freedom, with bodies laid end to end and apart.

    Shape (n_dofs,), m; no body touches the next.
    """
    return np.asarray(
        problem.positions + 2.0 * problem.scales.displacement * _bodies(problem)
    )


def _points_apart(problem: Problem, law: Contact) -> Array:
    """Positions of an interface's points, those of different bodies apart.

    Shape (n_points,), m.
    """
    numbers = np.zeros(len(law.positions), dtype=np.intp)
    bodies = _bodies(problem)
    numbers[law.points] = sum(
        bodies[problem.row_dofs[rows]] for rows in law.tangent.sides
    )
    return law.positions + 2.0 * problem.scales.displacement * numbers


def _interpolated(fine: Array, coarse: Array, values: Array) -> Array:
    """Interpolate values in space, linear between the coarse positions.

    `fine` and `coarse` are positions, shapes (n_fine,) and (n_coarse,), m, `values`
    have shape (n_coarse, n_instants); the result has shape (n_fine, n_instants).
    """
    # Beyond the coarse ends the value at the end holds.
    right = np.clip(np.searchsorted(coarse, fine), 1, len(coarse) - 1)
    share = (fine - coarse[right - 1]) / (coarse[right] - coarse[right - 1])
    share = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray(values[right - 1] * (1.0 - share) + values[right] * share)
