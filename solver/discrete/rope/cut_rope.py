"""Discrete problem of a strand: each wire is a rod on a separate support."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Problem
from solver.discrete.rods.cut_rods import CutRods
from solver.discrete.rods.end import End
from solver.discrete.rods.rods import Rods
from solver.discrete.rope.rope import Rope, RopeWire


def problem_of(rope: Rope) -> Problem:
    """Make the discrete problem: all wires as rods with the same cuts.

    Positions are those along the strand. Where a wire represents its layer, over half a
    turn, so does its interface, over the strand that is drawn.
    """
    return CutRods(
        [_rod(rope, wire) for wire in rope.wires],
        [wire.along for wire in rope.wires],
        [wire.name for wire in rope.wires],
        rub_at_ends=(False, False),
        copies=[_copies(rope, wire) for wire in rope.wires],
    ).problem()


def _copies(rope: Rope, wire: RopeWire) -> float:
    """Number of equal interfaces that a wire's interface represents."""
    if rope.is_clamped:
        return 1.0
    # The drawn strand has several half turns of each wire, which all count.
    return wire.stands_for * rope.drawn_length / float(wire.along[-1])


def _rod(rope: Rope, wire: RopeWire) -> Rods:
    """A wire as a rod that is held at both ends."""
    held = End(displacement=np.zeros(len(rope.instants)))
    return Rods(
        length=wire.length,
        stiffness=wire.layer_data.stiffness,
        elements=rope.elements,
        substructures=rope.substructures,
        strength=np.multiply.outer(np.ones(rope.elements + 1), wire.strength),
        left=held,
        right=held,
        instants=rope.instants,
        duration=rope.duration,
        body_force=wire.body_force(),
        friction_law=rope.friction_law,
    )
