"""What a strand of helical wires shows in its cross-section: its wires, their stress and slip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.rope_data import RopeData, RopeWire


@dataclass(frozen=True, eq=False)
class SectionWires:
    """The wires of a cross-section at one instant, the core first; shape (n_wires,) each.

    Attributes
    ----------
    layer, number
        From 0 on; -1 and 0 of the core.
    centres
        Sideways and towards the outermost fibre, shape (n_wires, 2), m.
    diameters
        m.
    stress
        Mean axial stress, Pa.
    bending
        What bending about its own axis adds at a wire's outermost fibre, Pa.
    slip
        On what it lies on, along the wire, m.
    """

    layer: Indices
    number: Indices
    centres: Array
    diameters: Array
    stress: Array
    bending: Array
    slip: Array


def wires_at(rope: RopeData, displacement: Array, instant: int, place: float) -> SectionWires:
    """Look at a cross-section.

    Parameters
    ----------
    rope
        The strand.
    displacement
        Slip of all nodes, shape (n_dofs, n_instants), m.
    instant
        Its number.
    place
        Distance along the strand, m. Bent alike all along, wires beyond half a turn are those that
        were turned round there: their stress is the same, their slip the opposite.
    """
    found = [_core(rope, instant, place)]
    for wire, slip in zip(rope.wires, slips_of(rope, displacement), strict=True):
        nodes = _at_nodes(wire.helix.force(wire.arc, slip, wire.curvature)[:, instant])
        area = wire.area
        for number in range(wire.stands_for):
            arc = place / np.cos(wire.helix.lay)
            turned = 2.0 * np.pi * number / wire.stands_for
            angle = float(wire.helix.angle(np.array(arc))) + turned
            way = 1.0
            if not rope.is_clamped:
                arc, way = _in_half_a_turn(wire, angle)
            force, slipped, bent = (
                float(np.interp(arc, wire.arc, one))
                for one in (nodes, slip[:, instant], wire.curvature[:, instant])
            )
            found.append(
                (
                    wire.layer,
                    wire.number + number,
                    wire.helix.radius * np.sin(angle),
                    wire.helix.radius * np.cos(angle),
                    wire.diameter,
                    (wire.tension[instant] + force) / area,
                    0.5 * wire.young * wire.diameter * bent,
                    way * slipped,
                )
            )
    columns = np.array(found, dtype=float).T
    return SectionWires(
        columns[0].astype(np.intp),
        columns[1].astype(np.intp),
        np.ascontiguousarray(columns[2:4].T),
        *columns[4:],
    )


def slips_of(rope: RopeData, displacement: Array) -> list[Array]:
    """Give the slip of every wire at its nodes, shape (n_nodes, n_instants) each, m."""
    return np.split(displacement, len(rope.wires))


def stress_ranges(rope: RopeData, displacement: Array, some: slice) -> Array:
    """Give how far the stress of every wire swings where it swings most, shape (n_wires,), Pa.

    At the fibre of the wire where its bending about its own axis adds to it; over some instants.
    """
    found = []
    for wire, slip in zip(rope.wires, slips_of(rope, displacement), strict=True):
        axial = (wire.tension + wire.helix.force(wire.arc, slip, wire.curvature)) / wire.area
        middle = 0.5 * (wire.curvature[1:] + wire.curvature[:-1])
        bent = 0.5 * wire.young * wire.diameter * middle
        swings = [np.ptp((axial + way * bent)[:, some], axis=1).max() for way in (-1.0, 1.0)]
        found.append(float(max(swings)))
    return np.array(found)


def _core(rope: RopeData, instant: int, place: float) -> tuple[float, ...]:
    core = rope.section.core
    strain = rope.tension[instant] / rope.section.stiffness
    wire = rope.wires[0]
    bent = np.interp(place, wire.along, wire.curvature[:, instant])
    bending = 0.5 * core.young * core.diameter * bent
    return -1.0, 0.0, 0.0, 0.0, core.diameter, core.young * strain, float(bending), 0.0


def _at_nodes(elements: Array) -> Array:
    """Give at the nodes what is known in elements: the mean of both, or that of the last."""
    return 0.5 * (np.append(elements[:1], elements) + np.append(elements, elements[-1:]))


def _in_half_a_turn(wire: RopeWire, angle: float) -> tuple[float, float]:
    """Give where the wire that is there stands at this angle, and the sign of its slip."""
    around = angle % (2.0 * np.pi)
    way = 1.0 if around <= np.pi else -1.0
    around = min(around, 2.0 * np.pi - around)
    return float(around / np.pi * wire.length), way
