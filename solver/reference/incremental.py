"""The incremental reference: friction solved instant by instant, on the assembled structure.

Over one instant the displacement increment v minimises a strictly convex function (theory.md, 6),

    phi(v) = 1/2 v' K v - g' v + sum r |v|,

with K the stiffness, r the friction bounds, and g the load that the friction force of the previous
instant leaves unbalanced. Its minimum is known once every point's status s is: v = 0 where s = 0,
and K v = g - r s elsewhere. The pull g - K v is then minus the friction force.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import blas, solveh_banded

from solver.discrete.contact_fields import ContactFields, contact_fields
from solver.discrete.problem import Array, Problem
from solver.reference.assembly import assembled_stiffness, external_force

NEWTON_LIMIT = 8  # steps from one guess of the statuses before a better one is sought
COARSEST = 8  # degrees of freedom below which no coarser mesh is asked for a guess
ROUNDING = 32.0 * float(np.finfo(float).eps)


class Interrupted(Exception):  # noqa: N818  # asked for by the caller, so no error
    """The caller asked the solver to stop before the last instant."""


@dataclass(frozen=True, eq=False)
class Reference:
    """The solution of a problem on its own mesh and instants, exact up to rounding.

    Attributes
    ----------
    problem
        What it solves.
    displacement
        Shape (n_dofs, n_instants), m.
    contact_force
        Nodal forces on the bodies above, stacked as `Problem.sum_of_contact` says, shape
        (n_forces, n_instants), N.
    status
        Shape (n_points, n_instants), the points stacked interface by interface: -1 slip backward,
        0 stick, +1 slip forward, 2 open. The increment of a sticking point is zero.
    residual
        Relative KKT residual, the maximum over the instants. Of `incremental`: distance of 0 from
        the subdifferential K v - g + r d|v| of phi, in the maximum norm, divided by the sum of |g|;
        storing v in doubles costs as much.
    converged
        Whether the instants are solved, shape (n_instants,).
    ambiguous
        Instants whose solution is certainly one of several, same shape; others may be, too, where
        friction is large.
    steps
        Newton steps, which are linear systems of full size, in all.
    seconds
        Time taken.
    """

    problem: Problem
    displacement: Array
    contact_force: Array
    status: NDArray[np.int8]
    residual: float
    converged: NDArray[np.bool_]
    ambiguous: NDArray[np.bool_]
    steps: int
    seconds: float

    @property
    def friction_force(self) -> Array:
        """Nodal friction force on the body, (n_points, n_instants), N, where its bound is known."""
        return self.contact_force

    def contact(self, name: str) -> ContactFields:
        """Show one interface with friction."""
        problem = self.problem
        sizes = [len(law.positions) for law in problem.rubbing.values()]
        first = sum(sizes[: list(problem.rubbing).index(name)])
        status = self.status[first : first + len(problem.rubbing[name].positions)]
        rows = self.displacement[problem.row_dofs] / problem.scales.displacement
        return contact_fields(problem, name, self.contact_force, rows, status)


def incremental(problem: Problem, stop: Callable[[], bool] | None = None) -> Reference:
    """Solve instant by instant (theory.md, 6).

    A point whose displacement is prescribed may rub too. Where it moves, its friction force is
    -r sign(v). Where it stands still, only the sum of friction force and reaction is determinate:
    the friction force is taken as zero. LATIN shares the sum in a way that depends on k and on
    the decomposition (measured, once the whole bar slides), so compare no force there.

    Parameters
    ----------
    problem
        A structure with one frictional interface of known bound.
    stop
        Called once per instant.

    Raises
    ------
    Interrupted
        As soon as `stop` gives True.
    """
    start = time.perf_counter()
    structure = _Structure(problem)
    increments, pulls = np.zeros((2, problem.n_instants, problem.n_dofs))
    balance, status, residual = np.zeros(problem.n_dofs), np.zeros(problem.n_dofs), 0.0
    for load, moved, increment, pull in zip(
        structure.load_steps, structure.moves, increments, pulls, strict=True
    ):
        if stop is not None and stop():
            raise Interrupted
        found = structure.minimise(load + balance, moved, status)
        increment[:], pull[:] = found.increment, found.pull
        balance, status = found.pull, found.status
        residual = max(residual, found.residual)
    return Reference(
        problem=problem,
        displacement=np.cumsum(increments, axis=0).T * problem.scales.displacement,
        contact_force=0.0 - pulls.T[structure.point_dofs] * problem.scales.force,
        status=np.sign(increments.T[structure.point_dofs]).astype(np.int8),
        residual=residual,
        converged=np.ones(problem.n_instants, dtype=bool),
        ambiguous=np.zeros(problem.n_instants, dtype=bool),
        steps=structure.band.solutions,
        seconds=time.perf_counter() - start,
    )


@dataclass(frozen=True, eq=False)
class _Minimum:
    """Fields of shape (n_dofs,) at the minimum of phi, and its relative KKT residual."""

    increment: Array
    pull: Array
    status: Array
    residual: float


class _Structure:
    """The assembled structure, and the steps of its load and supports, one row an instant."""

    def __init__(self, problem: Problem) -> None:
        law = problem.friction
        rubbing = problem.row_dofs[law.rows]
        self.point_dofs = np.zeros(len(law.positions), dtype=np.intp)
        self.point_dofs[law.points] = rubbing
        self.band = _Band(assembled_stiffness(problem))
        self.load_steps = np.diff(external_force(problem).T, axis=0, prepend=0.0)
        self._fixed, prescribed = problem.prescribed
        self.moves = np.diff(prescribed.T, axis=0, prepend=0.0)
        self._movable, bound = np.ones(problem.n_dofs), np.zeros(problem.n_dofs)
        self._movable[self._fixed] = 0.0
        np.add.at(bound, rubbing, law.bound)
        self._support_bound = bound[self._fixed]
        self._search = _Search(self.band, bound * self._movable, self._movable)

    def minimise(self, force: Array, moved: Array, status: Array) -> _Minimum:
        """Minimise phi over one instant, from a guess of the statuses."""
        given = np.zeros(len(force))
        given[self._fixed] = moved
        found = self._search(self._movable * (force - self.band.product(given)), status)
        found.increment[self._fixed] = moved
        found.pull[self._fixed] = self._support_bound * np.sign(moved)
        return found


class _Search:
    """Minimise phi where some degrees of freedom are held at zero.

    Newton's method for the statuses takes a few steps from a good guess, but a front then advances
    by one point a step, and the method may cycle. So it gives up early, and starts again from the
    statuses of a mesh twice as coarse, found in the same way. Where that fails too, an active-set
    method ends in finitely many steps.
    """

    def __init__(self, band: _Band, bound: Array, movable: Array) -> None:
        self._band = band
        self._bound = bound
        self._movable = movable
        self._rubs = (bound > 0.0) * movable
        self._free = movable - self._rubs  # neither held nor rubbing
        self._limit = np.where(self._rubs > 0.0, bound, np.inf)

    def __call__(self, force: Array, status: Array) -> _Minimum:
        """Find the minimum from a guess of the statuses; no force where nothing moves."""
        status, done = self._statuses(force, status)
        status = status if done else self._descend(force, status)
        increment = self._slip(force, status)
        pull = force - self._band.product(increment)
        bound = self._bound
        held = np.where(status != 0.0, bound * status, np.minimum(np.maximum(pull, -bound), bound))
        violation = float((np.abs(pull - held) * self._movable).max())
        relative = violation / float(np.abs(force).sum()) if violation else 0.0
        return _Minimum(increment, held, status, relative)

    def _statuses(self, force: Array, status: Array) -> tuple[Array, bool]:
        """Seek the statuses, and tell whether they are right."""
        found, done = self._newton(force, status)
        if done or len(force) < COARSEST:
            return found, done
        coarse, _ = self._coarser._statuses(_pairs(force), np.sign(_pairs(status)))
        return self._newton(force, self._rubs * np.repeat(coarse, 2)[: len(force)])

    def _newton(self, force: Array, status: Array) -> tuple[Array, bool]:
        for _ in range(NEWTON_LIMIT):
            increment = self._slip(force, status)
            pull = force - self._band.product(increment)
            excess = np.abs(pull) - self._limit - self._rounding(force, increment)
            corrected = np.where(
                status != 0.0, status * (status * increment > 0.0), np.sign(pull) * (excess > 0.0)
            )
            if np.array_equal(corrected, status):
                return status, True
            status = corrected
        return status, False

    @cached_property
    def _coarser(self) -> _Search:
        """The same structure with each two successive degrees of freedom tied together."""
        movable = np.minimum(_pairs(self._movable), 1.0)
        band = self._band.tied_in_pairs(self._movable, movable)
        return _Search(band, _pairs(self._bound), movable)

    def _slip(self, force: Array, status: Array) -> Array:
        """Solve for the increment under given statuses; exactly zero where they are zero."""
        keep = self._free + np.abs(status)
        return self._band.solve_kept(keep, keep * (force - self._bound * status))

    def _rounding(self, force: Array, increment: Array) -> float:
        size = self._band.largest_row * np.abs(increment).max() + np.abs(force).max()
        return ROUNDING * float(size)

    def _descend(self, force: Array, status: Array) -> Array:
        """Minimise phi by an active-set method, every step of which lowers phi.

        A step ends where a first point stops, which then sticks; at a minimum over the slipping
        points, the point pulled most beyond its bound is released, and moves the way it is
        pulled. So no set of statuses has its minimum reached twice.
        """
        increment = self._slip(force, status)
        status = status * (status * increment > 0.0)
        increment *= self._free + np.abs(status)
        while True:
            target = self._slip(force, status)
            stops = np.flatnonzero(status * target < 0.0)
            if len(stops):
                share = increment[stops] / (increment[stops] - target[stops])
                first = stops[share.argmin()]
                if increment[first] == 0.0:  # released a moment ago, within rounding of its bound
                    status[first] = 0.0
                    return status
                increment += share.min() * (target - increment)
                increment[first] = 0.0
                status = status * (status * increment > 0.0)
                increment *= self._free + np.abs(status)
                continue
            increment = target
            pull = force - self._band.product(increment)
            excess = np.where(status == 0.0, np.abs(pull) - self._limit, -np.inf)
            most = int(excess.argmax())
            if excess[most] <= self._rounding(force, increment):
                return status
            status[most] = np.sign(pull[most])


class _Band:
    """A symmetric sparse matrix, solved as a band: upper diagonals by row (LAPACK's form)."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._matrix = matrix
        entries = sparse.triu(matrix).tocoo()
        rows, columns = entries.coords
        self._width = int((columns - rows).max())
        self._upper = np.zeros((self._width + 1, matrix.shape[0]), order="F")
        self._upper[self._width - (columns - rows), columns] = entries.data
        self.largest_row = float(np.abs(matrix).sum(axis=1).max())
        self.solutions = 0

    def product(self, field: Array) -> Array:
        """Give K v."""
        return np.asarray(blas.dsbmv(self._width, 1.0, self._upper, field))

    def solve_kept(self, keep: Array, force: Array) -> Array:
        """Solve on the degrees of freedom where `keep` is 1; where it is 0, the force must be 0."""
        self.solutions += 1
        matrix = self._upper.copy(order="F")
        for offset in range(1, self._width + 1):
            matrix[self._width - offset, offset:] *= keep[offset:] * keep[:-offset]
        return np.asarray(solveh_banded(matrix, force, overwrite_ab=True, check_finite=False))

    def tied_in_pairs(self, movable: Array, movable_pairs: Array) -> _Band:
        """Give the stiffness of successive pairs of movable degrees of freedom, tied together."""
        own = np.arange(len(movable))
        tie, held = sparse.csr_array((movable, (own, own // 2))), 1.0 - movable_pairs
        return _Band(sparse.csr_array(tie.T @ self._matrix @ tie + sparse.diags_array(held)))


def _pairs(field: Array) -> Array:
    """Sum over successive pairs; an odd last one stays alone."""
    return np.add.reduceat(field, np.arange(0, len(field), 2))
