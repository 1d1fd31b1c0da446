"""Public QP solvers on the incremental problem of a bar (the extra `peers`).

Over one instant the displacement increment w minimises

    1/2 w' K w    subject to    |g - K w| <= r,

the dual of the problem that `solver.reference.incremental` solves: h = g - K w is minus
the friction force, and w = K^-1 (g - h) its work. K is sparse on both sides, and from
one instant to the next the bounds g - r and g + r alone change, so that each solver is
set up once. The load g is what the displacement so far leaves unbalanced. Degrees of
freedom that do not rub have r = 0 and are equalities. Forces are in units of the
largest bound (of the load, without friction): an absolute tolerance then means the same
for every bar.

Tolerances: the friction force is K times what an interior point or splitting method
computes, and so less precise; with the usual 1e-8 its error may be 1e-3. Each such
method runs at several tolerances, down to one that is tight enough. PIQP and Clarabel
test the duality gap too; a solver that does not (the default of ProxQP) may stop early
with a wrong force.
"""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from solver.arrays import Array, space_time
from solver.discrete.problem import Problem
from solver.reference.assembly import assembled_stiffness, external_force, points_dofs

Solve = Callable[[Array, Array], Array]
"""From the bounds of K w, each of shape (n,), to w, shape (n,)."""
MOST_ITERATIONS = 200_000
TIME_LIMIT = 60.0
"""Seconds after which a solver is stopped between two instants."""


class PeerError(RuntimeError):
    """A solver gave up, or took too long; the message says at which instant."""


@dataclass(frozen=True)
class Public:
    """A public solver.

    Attributes
    ----------
    name, module
        What it is called, and what is imported.
    tolerances
        Those at which it runs; one alone for a method that ends exactly, in finitely
        many steps.
    prepare
        Sets it up, from K of shape (n, n), the rows that are equalities, and a
        tolerance.
    """

    name: str
    module: str
    tolerances: tuple[float, ...]
    prepare: Callable[[sparse.csc_array, NDArray[np.bool_], float], Solve]

    @property
    def installed(self) -> bool:
        """Check whether the package can be imported."""
        return importlib.util.find_spec(self.module) is not None

    @property
    def version(self) -> str:
        """Installed version of the package."""
        return version(self.module)


@dataclass(frozen=True, eq=False)
class PublicFields:
    """Fields that a solver found, SI.

    Attributes
    ----------
    displacement
        Shape (n_dofs, n_instants), m.
    contact_force
        Nodal friction force on the body, shape (n_points, n_instants), N.
    """

    displacement: Array
    contact_force: Array


def solve_by(public: Public, problem: Problem, tolerance: float) -> PublicFields:
    """Solve instant by instant, set-up included.

    Raises
    ------
    PeerError
        Where the solver gives up, or takes longer than `TIME_LIMIT`.
    """
    bound = _bound_of(problem)
    fixed, _ = problem.prescribed
    stiffness = assembled_stiffness(problem)
    force = external_force(problem)
    displacement = _marched(public, problem, stiffness, force, bound, tolerance)
    pull = force - stiffness @ displacement
    # At held points the support hides from the balance what rubs there.
    slip = np.diff(displacement[fixed], axis=1, prepend=0.0)
    pull[fixed] = bound[fixed] * np.sign(slip)
    return PublicFields(
        displacement * problem.scales.displacement,
        -pull[points_dofs(problem)] * problem.scales.force,
    )


def _marched(
    public: Public,
    problem: Problem,
    stiffness: sparse.csr_array,
    force: Array,
    bound: Array,
    tolerance: float,
) -> Array:
    """Displacement, (n_dofs, n_instants), scaled, instant by instant.

    `force` and `bound` are the load and the friction bound of all degrees of freedom,
    (n_dofs, n_instants), scaled.
    """
    start = time.perf_counter()
    fixed, prescribed = problem.prescribed
    free = np.setdiff1d(np.arange(problem.n_dofs), fixed)
    unit = float(bound[free].max(initial=0.0)) or float(np.abs(force).max()) or 1.0
    largest = bound[free] / unit
    solve = public.prepare(
        sparse.csc_array(stiffness[free][:, free]),
        np.asarray(~largest.any(axis=1)),
        tolerance,
    )
    displacement = space_time(problem.n_dofs, problem.n_instants)
    before = np.zeros(problem.n_dofs)
    for instant, after in enumerate(displacement.T):
        after[free] = before[free]
        after[fixed] = prescribed[:, instant]
        left = (force[:, instant] - stiffness @ after)[free] / unit
        try:
            friction = largest[:, instant]
            after[free] += solve(left - friction, left + friction) * unit
        except PeerError as trouble:
            raise PeerError(f"gave up at instant {instant + 1}: {trouble}") from None
        before = after
        if time.perf_counter() - start > TIME_LIMIT:
            raise PeerError(f"stopped after {TIME_LIMIT:g} s, at instant {instant + 1}")
    return displacement


def _bound_of(problem: Problem) -> Array:
    """Largest friction of all degrees of freedom, (n_dofs, n_instants), scaled."""
    bound = np.zeros((problem.n_dofs, problem.n_instants))
    for law in problem.contacts.values():
        np.add.at(bound, problem.row_dofs[law.tangent.above], law.tangential.bound)
    return bound


def _piqp(
    stiffness: sparse.csc_array, equal: NDArray[np.bool_], tolerance: float
) -> Solve:
    import piqp

    solver = piqp.SparseSolver()
    settings = solver.settings
    settings.eps_abs = settings.eps_duality_gap_abs = tolerance
    settings.eps_rel = settings.eps_duality_gap_rel = 0.1 * tolerance
    settings.check_duality_gap = True
    settings.preconditioner_reuse_on_update = True
    matrix = sparse.csc_matrix(stiffness)
    rows = sparse.csr_matrix(stiffness)
    ones = np.ones(int((~equal).sum()))
    some = bool(equal.any())
    solver.setup(
        matrix,
        np.zeros(len(equal)),
        sparse.csc_matrix(rows[equal]) if some else None,
        np.zeros(int(equal.sum())) if some else None,
        sparse.csc_matrix(rows[~equal]),
        -ones,
        ones,
    )

    def solve(lower: Array, upper: Array) -> Array:
        given: dict[str, Any]
        if some:
            given = {"b": lower[equal]}
        else:
            given = {}
        solver.update(h_l=lower[~equal], h_u=upper[~equal], **given)
        status = solver.solve()
        if status != piqp.PIQP_SOLVED:
            raise PeerError(str(status))
        return np.array(solver.result.x)

    return solve


def _osqp(
    stiffness: sparse.csc_array, equal: NDArray[np.bool_], tolerance: float
) -> Solve:
    import osqp

    solver = osqp.OSQP()
    ones = np.ones(len(equal))
    solver.setup(
        sparse.csc_matrix(sparse.triu(stiffness)),
        np.zeros(len(equal)),
        sparse.csc_matrix(stiffness),
        -ones * ~equal,
        ones * ~equal,
        eps_abs=tolerance,
        eps_rel=tolerance,
        max_iter=MOST_ITERATIONS,
        verbose=False,
    )

    def solve(lower: Array, upper: Array) -> Array:
        solver.update(l=lower, u=upper)
        found = solver.solve(raise_error=False)
        if found.info.status_val != osqp.SolverStatus.OSQP_SOLVED:
            raise PeerError(found.info.status)
        return np.array(found.x)

    return solve


def _daqp(
    stiffness: sparse.csc_array, equal: NDArray[np.bool_], tolerance: float
) -> Solve:
    import daqp

    solver = daqp.Model()
    ones = np.ones(len(equal))
    dense = np.ascontiguousarray(stiffness.toarray())
    sense = np.where(equal, 5, 0).astype(np.int32)
    solver.setup(dense, 0.0 * ones, dense, ones * ~equal, -ones * ~equal, sense)
    solver.settings = {"primal_tol": tolerance, "iter_limit": MOST_ITERATIONS}

    def solve(lower: Array, upper: Array) -> Array:
        solver.update(bupper=upper, blower=lower)
        found, _, status, _ = solver.solve()
        if status < 1:
            raise PeerError(f"exit flag {status}")
        return np.array(found)

    return solve


def _clarabel(
    stiffness: sparse.csc_array, equal: NDArray[np.bool_], tolerance: float
) -> Solve:
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_feas = settings.tol_gap_abs = settings.tol_gap_rel = tolerance
    settings.presolve_enable = False  # as updates of the bounds ask
    rows = sparse.csr_matrix(stiffness)
    matrix = sparse.csc_matrix(
        sparse.vstack([rows[equal], rows[~equal], -rows[~equal]])
    )
    n_equal = int(equal.sum())
    n_rest = int((~equal).sum())
    if n_equal:
        cones = [clarabel.ZeroConeT(n_equal)]
    else:
        cones = []
    if n_rest:
        cones.append(clarabel.NonnegativeConeT(2 * n_rest))
    start = np.concatenate([np.zeros(n_equal), np.ones(2 * n_rest)])
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(sparse.triu(stiffness)),
        np.zeros(len(equal)),
        matrix,
        start,
        cones,
        settings,
    )

    def solve(lower: Array, upper: Array) -> Array:
        solver.update(b=np.concatenate([lower[equal], upper[~equal], -lower[~equal]]))
        found = solver.solve()
        # Almost solved: a tolerance below what rounding allows; the error is measured
        # anyway.
        if str(found.status) not in ("Solved", "AlmostSolved"):
            raise PeerError(str(found.status))
        return np.array(found.x)

    return solve


PUBLIC = (
    Public("PIQP", "piqp", (1e-2, 1e-5, 1e-8, 1e-13), _piqp),
    Public("OSQP", "osqp", (1e-3, 1e-5, 1e-7, 1e-9), _osqp),
    Public("DAQP", "daqp", (1e-10,), _daqp),
    Public("Clarabel", "clarabel", (1e-2, 1e-5, 1e-8, 1e-12), _clarabel),
)
