"""Many cycles, in slabs of time: each begins with the fields of the one before.

A load that repeats itself, exactly or nearly, makes the fields of a cycle those of the
cycle before or nearly so. Over the whole interval an iteration does not know that, and
corrects all cycles alike though the first is soon right. In slabs of a cycle the first
take as many iterations as one cycle does, the next few, and one or two once friction
has settled (solver/study/README.md, 9).
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array, read_only
from solver.discrete.problem import Problem
from solver.latin.direction.directions import SearchDirection
from solver.latin.direction.from_status import FromStatus
from solver.latin.end.status import Decision, Ending
from solver.latin.end.status_step import StatusStep
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.method import Latin
from solver.latin.solve import Solution, record, solve
from solver.latin.start import Nested
from solver.reference.distance import Distance
from solver.refusal import RefusedError

SHARE = 1e-3
"""Share of the accuracy at which the k-free indicator ends a slab too: what changes
foretell takes eleven iterations to know, and a field that goes on as before needs
one."""


@dataclass(frozen=True)
class Slab:
    """A slab of time, ready to be solved: its instants in the whole, what to solve, and from where.

    Slabs of one interval share the method, with its k.
    """

    instants: slice
    problem: Problem
    latin: Latin
    start: Checkpoint | None = None


@dataclass(frozen=True, kw_only=True)
class _OfWhole(SearchDirection):
    """The search direction of the whole interval, whatever acts in a slab of it."""

    k: Array

    def rule(self, problem: Problem) -> Array:
        return self.k


def first_slab(problem: Problem, latin: Latin, length: int) -> Slab:
    """The first slab of a problem.

    It has `length` instants, those of a cycle or of several, and one more, the state of
    rest at which time begins.

    Raises
    ------
    RefusedError
        If the problem or the method goes by more than fields and where sliders stand.
    """
    if length < 1:
        raise RefusedError(
            "slab", length, "instants, from 1 on", "give those of a cycle"
        )
    if isinstance(latin.direction, FromStatus):
        raise RefusedError(
            "k_update",
            "status",
            "a k that stays as it is in slabs of time",
            "set it to none",
        )
    for name, law in problem.own_laws.items():
        if law.remembers:
            raise RefusedError(
                f"the law of {name}",
                type(law).__name__,
                "laws that remember nothing but where sliders stand",
                "solve the whole interval at once",
            )
    instants = slice(0, min(1 + length, problem.n_instants))
    start = None
    nested = latin.start
    stop = latin.stop
    if nested is not None:
        start = Nested(
            lambda: (_during(coarser, instants) for coarser in nested.coarser())
        )
    if np.isfinite(stop.accuracy):
        stop = replace(stop, sufficient=min(SHARE * stop.accuracy, 1.0) ** 2)
    method = replace(
        latin,
        direction=_OfWhole(k=latin.direction.of(problem)),
        start=start,
        stop=stop,
    )
    return Slab(instants, _during(problem, instants), method)


def _during(
    problem: Problem, some: slice, start: Mapping[str, Array] | None = None
) -> Problem:
    """A problem at instants that follow each other.

    `start` is where the sliders of every interface with friction stand before the first
    of them, as of `Friction.slider`, (n_pairs,) each; None at zero.
    """

    def during(field: Array | None) -> Array | None:
        if field is None:
            return None
        return field[:, some]

    parts = tuple(
        replace(
            part, body_force=during(part.body_force), free_force=during(part.free_force)
        )
        for part in problem.substructures
    )
    interfaces = {name: law.during(some) for name, law in problem.interfaces.items()}
    for name, before in (start or {}).items():
        interfaces[name] = problem.rubbing[name].during(some).begun(before)
    return replace(
        problem,
        substructures=parts,
        interfaces=interfaces,
        instants=problem.instants[some],
        rest=during(problem.rest),
        carried=during(problem.carried),
        drives=tuple(drive.during(some) for drive in problem.drives),
    )


def next_slab(
    problem: Problem, slab: Slab, solved: Iterate, length: int
) -> Slab | None:
    """The slab that follows one, and its solution; None after the last."""
    first = slab.instants.stop
    if first == problem.n_instants:
        return None
    instants = slice(first, min(first + length, problem.n_instants))
    moved = solved.local_displacement
    force = solved.boundary_local_force
    ends = {
        # Pairs of one point that stand apart could never stick together again.
        name: law.mean_by_point(law.tangential.slider(moved, force)[:, -1])[law.points]
        for name, law in solved.problem.rubbing.items()
    }
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
    """Solution of the whole interval, slab after slab, each until the stop rule ends it.

    The first is certified where that can be, whatever the method says: its error would
    go on into all others. These end by estimate, as incremental solvers begin at rest.
    The status is the first that is not convergence; a limit on seconds is on all slabs
    together, and on those `spent` before. The last record has the distance to a
    reference of the whole interval, if any.
    """
    began = time.perf_counter()
    slab: Slab | None = first_slab(problem, latin, length)
    solutions: list[Solution] = []
    while slab is not None:
        method = replace(slab.latin, finish=None if solutions else StatusStep())
        billed = spent + time.perf_counter() - began
        solutions.append(
            solve(slab.problem, method, start=slab.start, watch=False, spent=billed)
        )
        slab = next_slab(problem, slab, solutions[-1].iterate, length)
    missed = (
        solution
        for solution in solutions
        if solution.status.ending is not Ending.CONVERGED
    )
    status = next(missed, solutions[-1]).status
    joined = _together(problem, [solution.iterate for solution in solutions])
    *records, last = (entry for solution in solutions for entry in solution.records)
    records = [
        replace(entry, iteration=number) for number, entry in enumerate(records, 1)
    ]
    of_whole = Decision(last.seconds, last.estimated_error, status)
    return Solution(joined, [*records, record(joined, of_whole, distance)], status)


def _together(problem: Problem, parts: Sequence[Iterate]) -> Iterate:
    """Iterates of all slabs one after the other; they have no common bases."""
    if len(parts) == 1:
        return parts[0]

    def joined(name: str) -> Array:
        return read_only(
            np.concatenate([getattr(part, name) for part in parts], axis=1)
        )

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
