"""The slips of an interface with two points, as a picture sees them: each is a coordinate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import Floats, floats
from solver.arrays import Array
from solver.discrete import Problem
from solver.latin import Iterate
from solver.reference.condensation import NoReferenceError
from solver.reference.shakedown.slip_space import SlipSpace, room_of_two, slip_space
from solver.settings import Settings
from solver.study.quantities.cycles import ends_of
from solver.study.quantities.slips import slips_of

POINTS = 2


@dataclass(frozen=True)
class SlipPlane:
    """Where two points have slipped, and between which lines they stick.

    Attributes
    ----------
    slip
        Of both, shape (2, n_instants), m.
    matrix, limit
        Lines A w = b of an instant, shape (4, 2), N/m, and (4, n_instants), N; the first and the
        third are those at which the left point slips.
    room
        Corners of where both may stay at all instants of the last cycle, (n_corners, 2), m; none
        without a cycle, or where nothing is left.
    """

    slip: Floats
    matrix: Array
    limit: Array
    room: Array


def space_of(problem: Problem) -> SlipSpace | None:
    """Give the lines of the only interface of a problem, if it has two points and there are any.

    Where contact alone holds a body there is no field: its slip as a whole costs nothing.
    """
    points = [len(law.positions) for law in problem.rubbing.values()]
    if points != [POINTS] or problem.motions is not None:
        return None
    try:
        found = slip_space(problem)
    except NoReferenceError:
        return None
    return found if found.matrix.shape[1] == POINTS else None


def slip_plane(
    settings: Settings, iterate: Iterate, space: SlipSpace, columns: NDArray[np.intp]
) -> SlipPlane:
    """Show an iterate in the plane of its slips, at some instants."""
    ((law, slip, _),) = slips_of(iterate)
    ends = ends_of(settings)
    last = slice(ends[-2], ends[-1] + 1) if len(ends) > 1 else slice(0, 0)
    room = room_of_two(space, last) if len(ends) > 1 else np.zeros((0, POINTS))
    moved = np.cumsum(law.mean_by_point(slip), axis=1)
    return SlipPlane(floats(moved[:, columns]), space.matrix, space.limit[:, columns], room)
