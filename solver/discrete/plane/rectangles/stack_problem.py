"""Problem of rectangular bodies: that of their lattices, which may start at rest."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import cache, partial

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.inside import Inside
from solver.discrete.loose_bodies import LooseBodiesError
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.bodies_problem import problem_of as problem_of_bodies
from solver.discrete.plane.body import Body, NodeSpring
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.rectangles.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.plane.rectangles.stack_joints import StackJoints
from solver.discrete.plane.rectangles.stack_sides import StackSides
from solver.discrete.problem import Problem
from solver.discrete.substructure import Scales, substructure_sizes
from solver.refusal import RefusedError, Words


def bodies_of(stack: Stack) -> Bodies:
    """Bodies, joints, holds and loads of a stack."""
    shapes = _shapes_of(stack)
    of_size = cache(partial(_ends_of, stack))
    ends = [of_size(brick.columns, brick.rows) for brick in stack.rectangles]
    joints = StackJoints.of(stack, shapes)
    sides = StackSides(stack, shapes, joints.lines, ends)
    springs = []
    if stack.spring is not None:
        foot = int(shapes[0].grid[0, -1])
        length = 0.5 * shapes[0].height
        spring = stack.spring
        springs.append(
            NodeSpring("spring", 0, foot, spring.slack, spring.stiffness, length)
        )
    return Bodies(
        bodies=_bodies_of(stack, shapes, ends),
        joints=joints.all(),
        held=sides.held(),
        loads=sides.loads(),
        instants=stack.instants,
        duration=stack.duration,
        state=stack.state,
        friction_law=stack.friction_law,
        macro_degree=stack.macro_degree,
        springs=springs,
        groups=stack.groups,
    )


def _shapes_of(stack: Stack) -> list[Lattice]:
    """Lattice of every body; equal bodies have the very same one."""
    width = stack.length / stack.elements[0]
    height = stack.height / stack.elements[1]
    known = dict[tuple[int, int], Lattice]()
    shapes = []
    for brick in stack.rectangles:
        size = brick.columns, brick.rows
        if size not in known:
            known[size] = Lattice(*size, width, height)
        shapes.append(known[size])
    return shapes


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Ends of substructures along a pile, in elements, (n_ends,), ascending.

    0 is left out. Substructures end at the cuts of the longest body, and where any body
    ends.
    """
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


def _ends_of(stack: Stack, columns: int, rows: int) -> tuple[list[int], list[int]]:
    """Ends of the parts of a body along and up, in elements from its corner."""
    spans = [columns]
    if stack.is_pile:
        spans = [each.columns for each in stack.rectangles]
    along = ends_along(max(spans), stack.substructures[0], spans)
    up = np.cumsum(substructure_sizes(rows, stack.substructures[1]))
    return [0, *along[along <= columns].tolist()], [0, *up.tolist()]


def _labels_of(ends: tuple[list[int], list[int]]) -> Indices:
    """Index of the part of each element, (n_elements,), row by row of parts."""
    along, up = [np.diff(of_axis) for of_axis in ends]
    columns = np.repeat(np.arange(len(along)), along)
    rows = np.repeat(np.arange(len(up)), up)
    return np.asarray(np.add.outer(len(along) * rows, columns).ravel())


def _bodies_of(
    stack: Stack,
    shapes: Sequence[Lattice],
    ends: Sequence[tuple[list[int], list[int]]],
) -> list[Body]:
    """Bodies; those that are alike are made together."""
    origins = _origins_of(stack)
    labels = dict[Lattice, Indices]()
    alike = dict[Hashable, list[int]]()
    for number, shape in enumerate(shapes):
        key = id(shape), stack.modulus(number), number < stack.strips
        alike.setdefault(key, []).append(number)
    found = dict[int, Body]()
    for numbers in alike.values():
        first = numbers[0]
        shape = shapes[first]
        if shape not in labels:
            labels[shape] = _labels_of(ends[first])
        weight = None
        if first >= stack.strips:
            weight = stack.body_force
        body = Body(
            name="body",
            shape=shape,
            young=stack.modulus(first) * stack.young,
            poisson=stack.poisson,
            weight=weight,
            substructures=int(labels[shape].max()) + 1,
            parts=labels[shape],
        )
        names = [f"body {number + 1}" for number in numbers]
        made = body.placed(names, origins[numbers], np.zeros(len(numbers)))
        found.update(zip(numbers, made, strict=True))
    return [found[number] for number in range(len(shapes))]


def _origins_of(stack: Stack) -> Array:
    """Lower left corner of every body, (n_bodies, 2), m."""
    corners = np.array([(brick.x, brick.y) for brick in stack.rectangles])
    size = np.array([stack.length, stack.height]) / np.array(stack.elements)
    return np.asarray(corners * size)


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
        held = [name for name, side in stack.sides.items() if side.is_moved]
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
