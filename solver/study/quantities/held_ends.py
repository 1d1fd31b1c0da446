"""Lengths of interfaces at held ends, where bodies have no points that rub."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.rods.rods import Rods
from solver.discrete.rope.rope import Rope
from solver.study.quantities.finished import FinishedRun


def held_lengths(run: FinishedRun, name: str) -> Array:
    """Lengths of held ends without points, beside the points of an interface, m.

    Shape (n_points,): zero but at the first and the last point.
    """
    contacts = run.problem.contacts
    lengths = np.zeros(contacts.sizes[contacts.number_of[name]])
    structure = run.settings.structure()
    if isinstance(structure, Rope):
        wire = structure.wires[contacts.number_of[name]]
        lengths[[0, -1]] += 0.5 * wire.length / structure.elements
    elif isinstance(structure, Rods) and structure.wires > 1:
        half = 0.5 * structure.length / structure.elements
        ends = {0: structure.left, -1: structure.right}
        for point, end in ends.items():
            if end.is_prescribed:
                lengths[point] += half
    elif isinstance(structure, Stack) and structure.is_pile:
        law = contacts[name]
        lengths += _at_held_sides(structure, law.by_point(law.weights))
    return lengths


def _at_held_sides(stack: Stack, lengths: Array) -> Array:
    """Lengths of sides that are held across a joint of bodies that lie on each other.

    From the tributary lengths of the points of the joint; shape (n_points,) both, m.
    Over a gap ends need not touch where the points beside them do.
    """
    if stack.support is not None and np.any(stack.support.gap):
        return np.zeros_like(lengths)
    size = stack.length / stack.elements[0]
    held = np.zeros_like(lengths)
    for point, side in ((0, "left"), (-1, "right")):
        # A point at the end of a joint has half an element, one beside it a whole.
        is_beside = lengths[point] > 0.75 * size
        if is_beside and stack.sides[side].y.prescribed:
            held[point] += 0.5 * size
    return held
