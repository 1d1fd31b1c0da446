"""Forces and stresses in the wires of a strand that is bent, and what one of its sections cuts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.rope import Rope


@dataclass(frozen=True, eq=False)
class CutWires:
    """All wires of the layers at one section, inside out and around, shape (n_cut,) each.

    Attributes
    ----------
    layer, wire
        The layer of each, and the place in `Rope.wires` of the one that stands for it.
    centres
        Sideways and towards the outermost fibre, shape (n_cut, 2), m.
    arc
        Where that is along the wire that stands for it, m.
    side
        1, or -1 where it slips the other way: on the other side of the plane of bending.
    """

    layer: Indices
    wire: Indices
    centres: Array
    arc: Array
    side: Array


def cut_at(rope: Rope, place: float) -> CutWires:
    """Cut all wires at a place along the strand, m.

    Under a uniform curvature the one wire of a layer passes half a turn, from the outermost fibre
    to the innermost; the other half is its mirror image in the plane of bending.
    """
    cuts = []
    for number, wire in enumerate(rope.wires):
        helix = wire.helix
        starts = helix.start + 2.0 * np.pi * np.arange(wire.stands_for) / wire.stands_for
        arc = place / np.cos(helix.lay)
        if rope.is_clamped:
            arc = min(arc, wire.length)
        angles = starts + arc * np.sin(helix.lay) / helix.radius
        arcs, sides = np.full(len(angles), arc), np.ones(len(angles))
        if not rope.is_clamped:
            turned = np.sign(helix.lay) * angles
            sides = np.where(np.sin(turned) < 0.0, -1.0, 1.0)
            arcs = np.arccos(np.cos(turned)) / np.pi * wire.length
        whole = np.full(len(angles), number)
        cuts.append((np.full(len(angles), wire.layer), whole, angles, arcs, sides))
    layer, which, angle, arc, side = (np.concatenate(one) for one in zip(*cuts, strict=True))
    radius = np.array([wire.helix.radius for wire in rope.wires])[which]
    centres = radius[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    return CutWires(layer, which, centres, arc, side)


class WireForces:
    """Forces in the wires of a strand, their tension and what bending adds.

    Parameters
    ----------
    rope
        The strand.
    """

    def __init__(self, rope: Rope) -> None:
        self._rope = rope
        helices = [wire.helix for wire in rope.wires]
        self._arc = np.stack([wire.arc for wire in rope.wires])
        stretch = [one.stiffness * one.radius * np.cos(one.lay) ** 2 for one in helices]
        angles = [one.angle(arc) for one, arc in zip(helices, self._arc, strict=True)]
        self._around = np.array(stretch)[:, None] * np.cos(angles)
        stiffness = np.array([one.stiffness for one in helices])
        self._spring = stiffness[:, None] / np.diff(self._arc, axis=1)
        self.areas: Array = np.array([wire.area for wire in rope.wires])

    def __call__(self, displacement: Array, columns: slice | Indices) -> Array:
        """Forces in the elements at some instants.

        Parameters
        ----------
        displacement
            Of the problem's degrees of freedom, shape (n_dofs, n_instants), m.
        columns
            Numbers of the instants.

        Returns
        -------
        Shape (n_wires, n_elements, n_columns), N.
        """
        wires = self._rope.wires
        slip = displacement[:, columns].reshape(*self._arc.shape, -1)
        curvature = np.stack([wire.curvature[:, columns] for wire in wires])
        stuck = self._around[:, :, None] * curvature
        change = self._spring[:, :, None] * np.diff(slip, axis=1)
        change += 0.5 * (stuck[:, 1:] + stuck[:, :-1])
        tension = np.stack([wire.tension[columns] for wire in wires])
        return np.asarray(tension[:, None, :] + change)

    def stress_at(self, cut: CutWires, force: Array) -> Array:
        """Mean stress of every wire that is cut, from forces as `__call__` gives them.

        It is linear between the middles of elements, and beyond the first and the last of them.

        Returns
        -------
        Shape (n_cut, n_columns), Pa.
        """
        if force.shape[1] == 1:
            return np.asarray(force[cut.wire, 0] / self.areas[cut.wire, None])
        size = self._arc[cut.wire, 1]
        at = cut.arc / size - 0.5
        first = np.clip(np.floor(at).astype(np.intp), 0, force.shape[1] - 2)
        share = (at - first)[:, None]
        low, high = force[cut.wire, first], force[cut.wire, first + 1]
        return np.asarray(((1.0 - share) * low + share * high) / self.areas[cut.wire, None])


def stress_ranges(rope: Rope, displacement: Array, some: slice) -> Array:
    """How far the stress of every wire swings where it swings most, shape (n_wires,), Pa.

    At the fibre of the wire where its bending about its own axis adds to it; over some instants.
    """
    forces = WireForces(rope)
    axial = forces(displacement, some) / forces.areas[:, None, None]
    curvature = np.stack([wire.curvature[:, some] for wire in rope.wires])
    outer = np.array([0.5 * wire.young * wire.diameter for wire in rope.wires])
    bent = outer[:, None, None] * 0.5 * (curvature[:, 1:] + curvature[:, :-1])
    swings = [np.ptp(axial + way * bent, axis=2).max(axis=1) for way in (-1.0, 1.0)]
    return np.asarray(np.maximum(*swings))
