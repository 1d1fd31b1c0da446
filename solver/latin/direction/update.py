"""Search direction of friction points, set once more when the contact status has settled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.direction.changing import ChangingDirection
from solver.latin.direction.rules import Auto, SearchDirection, automatic
from solver.latin.indicators import behaviour_of
from solver.latin.iterate import Checkpoint, UpdateProgress

SETTLED, CALM = 0.1, 25
"""The status has settled when no larger share of all points and instants than this changed between
stick, slip forward and slip backward, so many iterations on end. Sooner, 1 % is reached later; at
a smaller share some loads wait past iteration 100."""
SLIDING = 0.3
"""Factor on the automatic k of a point that always slips; at a point that sticks for a share of the
instants, this to the power of the other share. Measured with Anderson acceleration: of 0.03, 0.1,
0.3 and 0.4 the one with the fewest iterations to 1e-6 of friction force; 0.1 takes more than no
update at all, and so does a k that is larger where points slip."""
TRIAL = 20
"""Iterations after which the new k must have made the k-free indicator smaller, again and again."""


@dataclass(frozen=True)
class FromStatus:
    """A search direction that follows the contact status, once that has settled.

    Attributes
    ----------
    first
        The search direction until then.
    """

    first: SearchDirection = Auto()

    @property
    def scale(self) -> float:
        """Factor on k of all rows."""
        return self.first.scale

    def of(self, problem: Problem) -> Array:
        """Give k of every row at the start, shape (n_rows,), scaled, read-only."""
        return self.first.of(problem)

    def at_work(self, problem: Problem, start: Checkpoint | None) -> DirectionUpdate:
        """Give k of a problem to a run, on a course that a checkpoint may remember."""
        return DirectionUpdate(problem, self.of(problem), start.course if start else None)


class DirectionUpdate(ChangingDirection):
    """k(x, t) in separated form: a profile in x from the status, constant in t.

    A slipping point carries its bound whatever its place, so the small k that leaves its place
    free is the better one; at a point that never slips any k serves. The profile multiplies the
    automatic k, whatever k was before. It is constant in time, so each substructure keeps one
    operator for all instants.

    It never diverges where the constant k converges: at every `TRIAL` iterations the k-free
    indicator of W and F must be below that of the trial before, the update being the first.
    Otherwise the run goes back to W, F of that trial and to the old k, and stays there.

    Parameters
    ----------
    problem, k
        What is solved, and its search direction at the start.
    course
        From a checkpoint, if the run goes on from one.
    """

    def __init__(self, problem: Problem, k: Array, course: UpdateProgress | None) -> None:
        super().__init__(k, course)
        self._problem, self._first = problem, k
        self._gives_way = any(
            law.tangential.softness is not None for law in problem.rubbing.values()
        )

    @property
    def is_due(self) -> bool:
        """Whether the next iteration is to begin with `turn`."""
        wait = {"first": CALM, "updated": TRIAL}.get(self.course.phase)
        return wait is not None and self.course.count >= wait

    def see(self, local_displacement: Array, incoming: Array) -> None:
        """Take in a local stage: what sticks and slips there."""
        course = self.course
        if course.phase == "updated":
            self.course = replace(course, count=course.count + 1)
        if course.phase != "first":
            return
        # a point that gives way moves while it sticks: its force tells whether it slips
        reads = self._gives_way
        force = course.k[:, None] * (local_displacement - incoming) if reads else None
        laws = self._problem.rubbing.values()
        # creep counts as slip: what still changes has not settled
        status = np.concatenate([law.status(local_displacement, force) for law in laws])
        changed = 1.0 if course.status is None else float(np.mean(status != course.status))
        is_calm = changed <= SETTLED
        self.course = replace(course, status=status, count=course.count + 1 if is_calm else 0)

    def turn(self, displacement: Array, force: Array) -> tuple[Array, Array] | None:
        """Decide on k, as `ChangingDirection` says."""
        course = self.course
        violation = behaviour_of(self._problem, displacement, force)
        kept = (displacement, force)
        if course.status is not None:
            self.course = UpdateProgress(
                "updated", self._updated(course), kept=kept, violation=violation
            )
            return kept
        if violation < course.violation:
            self.course = replace(course, count=0, kept=kept, violation=violation)
            return None
        self.course = UpdateProgress("returned", self._first)
        return course.kept

    def _updated(self, course: UpdateProgress) -> Array:
        assert course.status is not None
        share = np.count_nonzero(course.status, axis=1) / course.status.shape[1]
        k, first = automatic(self._problem), 0
        for law in self._problem.rubbing.values():
            for rows in law.tangent.sides:
                k[rows] *= SLIDING ** share[first + law.points]
            first += len(law.positions)
        k.flags.writeable = False
        return k
