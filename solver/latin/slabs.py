"""Long histories in slabs of time: each begins with the last fields of the previous.

A load that repeats itself, exactly or nearly, makes the fields of a cycle those of the
cycle before or nearly so. Over the whole interval the iteration does not use that, and
corrects all cycles alike though the first is soon right. In slabs of a cycle the first
takes as many iterations as one cycle does, the next slabs take few, and once friction
has settled they take one or two (solver/study/README.md, 9).
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array, read_only
from solver.discrete.problem import Problem
from solver.latin.direction.directions import SearchDirection
from solver.latin.end.status import Decision, Ending, Status
from solver.latin.end.status_step import StatusStep
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.method import Latin
from solver.latin.solve import Record, Solution, record, solve
from solver.latin.start import Nested
from solver.reference.distance import Distance
from solver.refusal import RefusedError

SHARE = 1e-3
"""Share of the accuracy at which the k-free indicator ends a slab too: an estimate from
changes needs eleven iterations, and a field that continues as before needs one. Thirty
cycles of a block take 69 iterations, and without it 1189, in three times the time; ten
of a wall 48 and 111 (measured)."""


@dataclass(frozen=True)
class Slab:
    """Slab of time, ready to be solved.

    Attributes
    ----------
    instants
        Instants of the slab in the whole interval.
    problem
        The problem at these instants.
    latin
        Method, with its k, which all slabs of an interval share.
    start
        State from which the run continues; None for the first slab.
    """

    instants: slice
    problem: Problem
    latin: Latin
    start: Checkpoint | None = None


@dataclass(frozen=True, kw_only=True)
class _OfWhole(SearchDirection):
    """Search direction of the whole interval, `k` of shape (n_rows,), for a slab."""

    k: Array

    def rule(self, problem: Problem) -> Array:
        """Search direction k of the rows, shape (n_rows,), scaled."""
        return self.k


def first_slab(problem: Problem, latin: Latin, length: int) -> Slab:
    """First slab of a problem.

    The slab has `length` instants, those of a cycle or of several, and one more, the
    state of rest at which time begins.

    Raises
    ------
    RefusedError
        If the problem or the method remembers more than fields and sliders.
    """
    _check_slabs(problem, length)
    instants = slice(0, min(1 + length, problem.n_instants))
    stop = latin.stop
    if np.isfinite(stop.accuracy):
        stop = replace(stop, sufficient=min(SHARE * stop.accuracy, 1.0) ** 2)
    start = None
    nested = latin.start
    if nested is not None:
        start = Nested(
            lambda: (_during(coarser, instants) for coarser in nested.coarser())
        )
    k = latin.direction.begin(problem, None, multiscale=latin.multiscale).k
    method = replace(
        latin,
        direction=_OfWhole(k=k),
        start=start,
        stop=stop,
    )
    return Slab(instants, _during(problem, instants), method)


def _check_slabs(problem: Problem, length: int) -> None:
    """Refuse a problem that cannot be solved in slabs of `length` instants."""
    if length < 1:
        raise RefusedError(
            "slab", length, "instants, from 1 on", "give those of a cycle"
        )
    for name, law in problem.user_laws.items():
        if law.remembers:
            raise RefusedError(
                f"the law of {name}",
                type(law).__name__,
                "laws that remember nothing but where sliders stand",
                "solve the whole interval at once",
            )


def _during(
    problem: Problem, some: slice, start: Mapping[str, Array] | None = None
) -> Problem:
    """Problem restricted to some successive instants.

    Parameters
    ----------
    problem
        Problem of the whole interval.
    some
        The instants.
    start
        Positions of the sliders of interfaces with friction before the first of them,
        as of `Friction.slider`, shape (n_pairs,) each, scaled; None: all zero.
    """

    def during(field: Array | None) -> Array | None:
        """Values of a field of shape (n, n_instants), if there is one."""
        if field is None:
            return None
        return field[:, some]

    parts = []
    for part in problem.substructures:
        body_force = during(part.body_force)
        free_force = during(part.free_force)
        parts.append(replace(part, body_force=body_force, free_force=free_force))
    interfaces = {name: law.during(some) for name, law in problem.interfaces.items()}
    if start is not None:
        for name, slider in start.items():
            interfaces[name] = (
                problem.contacts.laws[name].during(some).with_start(slider)
            )
    return replace(
        problem,
        substructures=tuple(parts),
        interfaces=interfaces,
        instants=problem.instants[some],
        rest=during(problem.rest),
        carried=during(problem.carried),
        drives=tuple(drive.during(some) for drive in problem.drives),
    )


def next_slab(
    problem: Problem, slab: Slab, solved: Iterate, length: int
) -> Slab | None:
    """Slab of `length` instants after a solved one; None after the last."""
    first = slab.instants.stop
    if first == problem.n_instants:
        return None
    instants = slice(first, min(first + length, problem.n_instants))
    moved = solved.local_displacement
    force = solved.boundary_local_force
    ends = {}
    for name, law in solved.problem.contacts.laws.items():
        # Pairs of one point that stand apart could never stick together again.
        slider = law.tangential.slider(moved, force)[:, -1]
        ends[name] = law.mean_by_point(slider)[law.points]
    # The fields of the last cycle are the guess for the next.
    again = solved.outgoing[:, solved.problem.n_instants - length :]
    again = np.asfortranarray(again[:, : instants.stop - instants.start])
    return Slab(
        instants,
        _during(problem, instants, ends),
        slab.latin,
        Checkpoint(0, 0.0, read_only(again)),
    )


def solve_in_slabs(
    problem: Problem,
    latin: Latin,
    length: int,
    *,
    distance: Distance | None = None,
    spent: float = 0.0,
) -> Solution:
    """Solve the whole interval slab by slab, each to its stop rule.

    The first slab is certified if it can be, whatever the method says, as its error
    would continue into all others. These end by estimate, as incremental solvers begin
    at rest. The status is the first that is not convergence.

    Parameters
    ----------
    problem, latin
        The problem to be solved, and the method.
    length
        Number of instants of a slab.
    distance
        Distance to a reference of the whole interval, for the last record.
    spent
        Time that the run took before, s; a limit on seconds is on all slabs together,
        and on this time.
    """
    began = time.perf_counter()
    slab: Slab | None = first_slab(problem, latin, length)
    solutions: list[Solution] = []
    while slab is not None:
        finish = None
        if not solutions:
            finish = StatusStep()
        method = replace(slab.latin, finish=finish)
        # The limit on time is one for all slabs.
        billed = spent + time.perf_counter() - began
        solutions.append(
            solve(slab.problem, method, start=slab.start, watch=False, spent=billed)
        )
        slab = next_slab(problem, slab, solutions[-1].iterate, length)
    status = _first_failure(solutions)
    joined = _together(problem, [solution.iterate for solution in solutions])
    records: list[Record] = []
    for solution in solutions:
        records += solution.records
    # The last record is replaced by that of the whole interval.
    last = records.pop()
    records = [
        replace(entry, iteration=number) for number, entry in enumerate(records, 1)
    ]
    of_whole = Decision(last.seconds, last.estimated_error, status)
    return Solution(joined, [*records, record(joined, of_whole, distance)], status)


def _first_failure(solutions: Sequence[Solution]) -> Status:
    """Status of the first slab that has not converged, or of the last slab."""
    for solution in solutions:
        if solution.status.ending is not Ending.CONVERGED:
            return solution.status
    return solutions[-1].status


def _together(problem: Problem, parts: Sequence[Iterate]) -> Iterate:
    """Iterate of the whole interval, without bases, joined from those of all slabs."""
    if len(parts) == 1:
        return parts[0]

    def joined(name: str) -> Array:
        """Field of a name, shape (n_rows, n_instants), scaled, read-only."""
        fields = [getattr(part, name) for part in parts]
        return read_only(np.concatenate(fields, axis=1))

    return Iterate(
        number=sum(part.number for part in parts),
        seconds=sum(part.seconds for part in parts),
        problem=problem,
        k=parts[0].k,
        outgoing=joined("outgoing"),
        incoming=joined("incoming"),
        local_displacement=joined("local_displacement"),
        local_incoming=joined("local_incoming"),
    )
