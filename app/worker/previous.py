"""The run before: its last iterate, and whether another run may start from that."""

from __future__ import annotations

import numpy as np

from app.worker.orders import Run
from solver.discrete import Problem, discretise
from solver.files import scene_settings
from solver.latin import Iterate
from solver.latin.warm import iterations_from


def last_iterate(order: Run) -> Iterate | None:
    """Give the last iterate of a run that was parked, if it had any."""
    if order.resume is None:
        return None
    settings = scene_settings(order.scene).checked(order.values)
    resume = order.resume
    return next(iterations_from(discretise(settings), settings, resume.start, resume.before))


def fits(previous: Iterate | None, problem: Problem) -> bool:
    """Tell whether a run may start from another's iterate.

    Row by row it always may; fields that have to be carried to another mesh must be those of wires
    that rub where these do.
    """
    if previous is None:
        return False
    old = previous.problem
    if np.array_equal(old.row_dofs, problem.row_dofs):
        return True
    wires = old.positions.ndim == problem.positions.ndim == 1
    return wires and set(problem.rubbing) <= set(old.rubbing)
