"""Forces and stresses in the wires of a bent strand, and the wires cut by a section."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.rope.rope import Rope, RopeWire


@dataclass(frozen=True, eq=False)
class CutWires:
    """All wires of the layers at one section, inside out and around.

    Attributes
    ----------
    wire
        Number in `Rope.wires` of the wire that represents each, shape (n_cut,).
    centres
        Centre of each, sideways and towards the outermost fibre, shape (n_cut, 2), m.
    arc
        Arc length of the section along the wire that represents it, (n_cut,), m.
    side
        -1 where a wire slips the other way, on the other side of the plane of bending,
        else 1; (n_cut,).
    """

    wire: Indices
    centres: Array
    arc: Array
    side: Array


def cut_at(rope: Rope, position: float) -> CutWires:
    """Cut all wires at a position along the strand, m.

    Under a uniform curvature the one wire of a layer passes half a turn, from the
    outermost fibre to the innermost; the other half is its mirror image in the plane of
    bending.
    """
    cuts = []
    for number, wire in enumerate(rope.wires):
        angles, arcs, sides = _cut_wire(wire, position, is_clamped=rope.is_clamped)
        around = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        numbers = np.full(len(angles), number)
        cuts.append(CutWires(numbers, wire.radius * around, arcs, sides))
    return CutWires(
        wire=np.concatenate([cut.wire for cut in cuts]),
        centres=np.concatenate([cut.centres for cut in cuts]),
        arc=np.concatenate([cut.arc for cut in cuts]),
        side=np.concatenate([cut.side for cut in cuts]),
    )


def _cut_wire(
    wire: RopeWire, position: float, *, is_clamped: bool
) -> tuple[Array, Array, Array]:
    """Section of the wires that a wire represents, at a position along the strand, m.

    Returns
    -------
    Their polar angles, rad, arc lengths, m, and the side of each half turn, -1 or 1;
    shape (stands_for,) each.
    """
    lay = wire.layer_data.lay
    starts = wire.start + 2.0 * np.pi * np.arange(wire.stands_for) / wire.stands_for
    arc = position / np.cos(lay)
    if is_clamped:
        arc = min(arc, wire.length)
    angles = starts + arc * np.sin(lay) / wire.radius
    if is_clamped:
        return angles, np.full(len(angles), arc), np.ones(len(angles))
    # Half a turn of the wire represents both halves: angles are folded onto it.
    turned = np.sign(lay) * angles
    sides = np.where(np.sin(turned) < 0.0, -1.0, 1.0)
    arcs = np.arccos(np.cos(turned)) / np.pi * wire.length
    return angles, arcs, sides


def wire_forces(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Forces in the elements of all wires: of the tension and of bending.

    Shape (n_wires, n_elements, n_columns), N, from the displacement of the problem's
    degrees of freedom, (n_dofs, n_instants), m, at some of the instants.
    """
    slips = np.split(displacement[:, columns], len(rope.wires))
    forces = []
    for wire, slip in zip(rope.wires, slips, strict=True):
        spring = wire.layer_data.stiffness / np.diff(wire.arc)
        change = spring[:, None] * np.diff(slip, axis=0) + wire.stuck_force(columns)
        forces.append(wire.tension[columns] + change)
    return np.stack(forces)


def wire_stresses(rope: Rope, displacement: Array, columns: slice | Indices) -> Array:
    """Mean stresses over the sections of wires, Pa, of the shape of `wire_forces`."""
    areas = np.array([wire.layer_data.area for wire in rope.wires])
    return np.asarray(wire_forces(rope, displacement, columns) / areas[:, None, None])


def stress_at(rope: Rope, cut: CutWires, stress: Array) -> Array:
    """Mean stress of every cut wire, (n_cut, n_columns), from `wire_stresses`, Pa.

    The stress is linear between the middles of elements, and beyond the
    first and the last of them.
    """
    sizes = np.array([wire.length / rope.elements for wire in rope.wires])
    at = cut.arc / sizes[cut.wire] - 0.5
    first = np.clip(np.floor(at).astype(np.intp), 0, max(rope.elements - 2, 0))
    share = (at - first)[:, None]
    low = stress[cut.wire, first]
    high = stress[cut.wire, np.minimum(first + 1, rope.elements - 1)]
    return np.asarray((1.0 - share) * low + share * high)


def stress_ranges(rope: Rope, displacement: Array, instants: slice) -> Array:
    """Largest range of the stress of every wire over instants, (n_wires,), Pa.

    At the fibre of the wire where its bending about its own axis adds to the mean
    stress. `displacement` is that of the problem's dofs, (n_dofs, n_instants), m.
    """
    axial = wire_stresses(rope, displacement, instants)
    curvature = np.stack([wire.curvature[:, instants] for wire in rope.wires])
    outer = np.array(
        [0.5 * wire.layer_data.young * wire.layer_data.diameter for wire in rope.wires]
    )
    bent = outer[:, None, None] * 0.5 * (curvature[:, 1:] + curvature[:, :-1])
    swings = [np.ptp(axial + sign * bent, axis=2).max(axis=1) for sign in (-1.0, 1.0)]
    return np.asarray(np.maximum(*swings))
