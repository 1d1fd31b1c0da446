"""Discrete problem of rectangular bodies, with the rest of one on its support."""

from __future__ import annotations

from functools import partial

import numpy as np

from solver.arrays import Array
from solver.discrete.inside import Inside
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.plane.bodies_problem import problem_of as problem_of_bodies
from solver.discrete.plane.rectangles.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.plane.rectangles.stack_bodies import bodies_of
from solver.discrete.plane.rectangles.stack_sides import is_moved
from solver.discrete.problem import Problem
from solver.discrete.scales import Scales
from solver.refusal import RefusedError, Words


def problem_of(stack: Stack) -> Problem:
    """Discrete problem of a stack: that of its bodies, which may start at rest.

    Raises
    ------
    RefusedError
        If bodies can move though all contacts are closed and stick.
    """
    try:
        return problem_of_bodies(bodies_of(stack), partial(_rest, stack))
    except LooseBodiesError as error:
        held = [name for name, side in stack.sides.items() if is_moved(side)]
        raise RefusedError(
            "Stack.sides",
            Words(f"with displacements of {' and '.join(held) or 'no side'}"),
            "sides and supports that leave no body free to move or to turn, where all "
            "contacts are closed and stick",
            "prescribe the displacement of one more side, or along both axes, or add a "
            "support",
        ) from error


def _rest(stack: Stack, inside: Inside, scales: Scales) -> Array | None:
    """Displacement of a body at rest on its support, (n_dofs, n_instants), scaled.

    None where the body has not to be brought onto its support.
    """
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    x, y = inside.positions.T
    along_x, along_y, _ = inside.directions.T
    modes = np.stack([along_y, x * along_y - y * along_x], axis=1)
    length = scales.displacement
    rest = np.asarray(modes @ (rigid / np.array([[length], [1.0]])))
    if stack.spring is not None:
        slide = rigid_slide(stack, stack.spring) / length
        rest += np.outer(along_x, slide)
    return rest
