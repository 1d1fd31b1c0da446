"""Forces and stresses in the wires of a strand that is bent, and what one of its sections cuts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.rope.rope import Rope


@dataclass(frozen=True, eq=False)
class CutWires:
    """All wires of the layers at one section, inside out and around, shape (n_cut,) each.

    A wire is cut at its centre, sideways and towards the outermost fibre, (n_cut, 2),
    m. The one that stands for it has this place in `Rope.wires`, and is there at this
    arc length, m; the side is -1 where a wire slips the other way, on the other side of
    the plane of bending, else 1.
    """

    wire: Indices
    centres: Array
    arc: Array
    side: Array


def cut_at(rope: Rope, place: float) -> CutWires:
    """Cut all wires at a place along the strand, m.

    Under a uniform curvature the one wire of a layer passes half a turn, from the
    outermost fibre to the innermost; the other half is its mirror image in the plane of
    bending.
    """
    cuts = []
    for number, wire in enumerate(rope.wires):
        lay = wire.made.lay
        starts = wire.start + 2.0 * np.pi * np.arange(wire.stands_for) / wire.stands_for
        arc = place / np.cos(lay)
        if rope.is_clamped:
            arc = min(arc, wire.length)
        angles = starts + arc * np.sin(lay) / wire.radius
        arcs = np.full(len(angles), arc)
        sides = np.ones(len(angles))
        if not rope.is_clamped:
            turned = np.sign(lay) * angles
            sides = np.where(np.sin(turned) < 0.0, -1.0, 1.0)
            arcs = np.arccos(np.cos(turned)) / np.pi * wire.length
        cuts.append((np.full(len(angles), number), angles, arcs, sides))
    which, angle, arc, side = (np.concatenate(one) for one in zip(*cuts, strict=True))
    radius = np.array([wire.radius for wire in rope.wires])[which]
    centres = radius[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    return CutWires(which, centres, arc, side)


def wire_forces(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Forces in the elements of all wires: their tension and what bending adds.

    Shape (n_wires, n_elements, n_columns), N, from the displacement of the problem's
    degrees of freedom, (n_dofs, n_instants), m, at some of the instants.
    """
    slips = np.split(displacement[:, columns], len(rope.wires))
    forces = []
    for wire, slip in zip(rope.wires, slips, strict=True):
        spring = wire.made.stiffness / np.diff(wire.arc)
        change = spring[:, None] * np.diff(slip, axis=0) + wire.stuck_force(columns)
        forces.append(wire.tension[columns] + change)
    return np.stack(forces)


def wire_stresses(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Mean stresses over the sections of all wires in their elements, as `wire_forces`, Pa."""
    areas = np.array([wire.made.area for wire in rope.wires])
    return np.asarray(wire_forces(rope, displacement, columns) / areas[:, None, None])


def stress_at(rope: Rope, cut: CutWires, stress: Array) -> Array:
    """Mean stress of every wire that is cut, from `wire_stresses`.

    Shape (n_cut, n_columns), Pa; linear between the middles of elements, and beyond the
    first and the last of them.
    """
    sizes = np.array([wire.length / rope.elements for wire in rope.wires])
    at = cut.arc / sizes[cut.wire] - 0.5
    first = np.clip(np.floor(at).astype(np.intp), 0, max(rope.elements - 2, 0))
    share = (at - first)[:, None]
    low = stress[cut.wire, first]
    high = stress[cut.wire, np.minimum(first + 1, rope.elements - 1)]
    return np.asarray((1.0 - share) * low + share * high)


def stress_ranges(rope: Rope, displacement: Array, some: slice) -> Array:
    """How far the stress of every wire swings where it swings most, shape (n_wires,), Pa.

    At the fibre of the wire where its bending about its own axis adds to it; over some
    instants.
    """
    axial = wire_stresses(rope, displacement, some)
    curvature = np.stack([wire.curvature[:, some] for wire in rope.wires])
    outer = np.array(
        [0.5 * wire.made.young * wire.made.diameter for wire in rope.wires]
    )
    bent = outer[:, None, None] * 0.5 * (curvature[:, 1:] + curvature[:, :-1])
    swings = [np.ptp(axial + way * bent, axis=2).max(axis=1) for way in (-1.0, 1.0)]
    return np.asarray(np.maximum(*swings))
