"""Search direction of bodies that turn out to stick on each other wherever they touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.direction.changing import ChangingDirection
from solver.latin.iterate import UpdateProgress

LOOK = 3
"""The iteration that tells. In the second one what will stick may still slip, at a tenth of all
points and instants; in the third none does where none does in the end, and of 33 stacks all that
slip at more than half a hundredth of points and instants showed it (measured)."""


class UntilNothingSlips(ChangingDirection):
    """A k for what slips, and for bodies that are one as soon as they turn out to be.

    Small k is for what slips: there friction is known, and the place is sought. What has never
    slipped has its place from the start, so it loses nothing by a large k; it is the force that is
    sought. Where a point sticks after it has slipped, a large k would make force of all that its
    place is wrong by: stacks of which 13 % slip take more than 80 iterations to 1 % of the contact
    force with it, 72 without (measured). So k changes only if nothing slips at all.

    The run then begins anew. From its fields at that time, which the small k left apart from point
    to point, 22 to more than 120 iterations to 1 % follow, and 9 to 15 from zero (measured).

    Parameters
    ----------
    problem, k
        What is solved, and its search direction while bodies may slip.
    stuck
        The search direction where none does; shape (n_rows,), scaled, read-only, as k.
    course
        From a checkpoint, if the run goes on from one.
    """

    def __init__(
        self, problem: Problem, k: Array, stuck: Array, course: UpdateProgress | None
    ) -> None:
        super().__init__(k, course)
        self._laws = [law for law in problem.rubbing.values() if not law.is_on_support]
        self._stuck = stuck

    @property
    def is_due(self) -> bool:
        """Whether the next iteration is to begin with `turn`."""
        return self.course.phase == "first" and self.course.count == LOOK

    def see(self, local_displacement: Array, incoming: Array) -> None:
        """Take in a local stage: whether anything slips there."""
        course = self.course
        if course.phase != "first":
            return
        self.course = replace(course, count=course.count + 1)
        if self.is_due and self._slips(local_displacement, incoming):
            self.course = UpdateProgress("returned", course.k)

    def turn(self, displacement: Array, force: Array) -> tuple[Array, Array]:
        """Change k, and begin anew: W and F, shape (n_rows, n_instants), scaled."""
        self.course = UpdateProgress("updated", self._stuck)
        return np.zeros_like(displacement), np.zeros_like(force)

    def _slips(self, displacement: Array, incoming: Array) -> bool:
        force = self.k[:, None] * (displacement - incoming)
        return any(bool((np.abs(law.status(displacement, force)) == 1).any()) for law in self._laws)
