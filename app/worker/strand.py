"""A bent strand: wires seen from the side, and extras of its views.

The view is across the plane of bending onto the cylinder of the outer layer. Each wire
has a strip of the cylinder, and half of the wires are hidden behind it at any position;
the outermost fibre is below.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import binary_dilation

from app.frame import Bytes, DeformedGeometry, Floats, Geometry
from app.messages import Needs
from app.worker.cells import floats, mesh_of, thinned
from app.worker.geometry import MOST_POINTS, Extras, StressField
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import (
    cut_at,
    stress_at,
    wire_forces,
    wire_stresses,
)
from solver.latin import Iterate
from solver.settings.scene import Settings

A_TURN = 20
FEWEST_STEPS = 40
MOST_STEPS = 100
"""Steps along the strand for each turn of an outer wire; least and largest number of
steps."""
SHOWN_SHARE = 0.12 * np.pi
"""Angle from the edges of the visible half within which a wire has no line of contact,
rad."""


class OuterWires(NamedTuple):
    """Drawn wires of the outer layer of a strand.

    Their number, lay angle, rad, radius of their helix, radius of the strand, and its
    length, all in m, with a number of steps along it.
    """

    count: int
    lay: float
    helix: float
    radius: float
    length: float
    n_steps: int

    @property
    def z(self) -> Array:
        """Ends of the steps, shape (n_steps + 1,), m."""
        return np.linspace(0.0, self.length, self.n_steps + 1)

    def angle(self, wire: Array, position: Array) -> Array:
        """Polar angle of wires, rad, at positions along the strand, m.

        Indices of the wires and positions have the shape of the result, or are scalars.
        """
        turned = position * np.tan(self.lay) / self.helix
        return np.asarray(2.0 * np.pi * wire / self.count + turned)

    def height(self, angle: Array) -> Array:
        """Height of wires above the foot, m, at polar angles, rad, same shape."""
        return np.asarray(self.radius * (1.0 - np.cos(angle)))

    def strips(self) -> Iterator[tuple[int, Indices, Array]]:
        """Visible stretches of wires: index, steps, (n,), and nodes, (2, n, 2), m."""
        half = np.pi / self.count
        for number in range(self.count):
            middle = self.angle(number, self.z)
            for turn in np.unique(np.floor((middle + half) / (2.0 * np.pi))):
                edges = middle - 2.0 * np.pi * turn + np.array([[-half], [half]])
                edges = np.clip(edges, 0.0, np.pi)
                # The strip begins and ends a step behind its visible part.
                steps = np.flatnonzero(binary_dilation(np.ptp(edges, axis=0) > 1e-9))
                if len(steps):
                    z = np.broadcast_to(self.z[steps], (2, len(steps)))
                    heights = self.height(edges[:, steps])
                    yield number, steps, np.stack([z, heights], axis=-1)


# Moves of a slider seldom change the wires: making their mesh took 6 % of each run.
@lru_cache(maxsize=4)
def strips_of(wires: OuterWires) -> tuple[dict[str, Any], Array, Indices]:
    """Mesh of the strips of wires, with two rows of nodes for each strip.

    Then the positions of the middles of cells, (n_cells,), m, and the step of each
    node, (n_nodes,).
    """
    numbers, steps, grids = zip(*wires.strips(), strict=True)
    z = wires.z
    middles = [0.5 * (z[strip[1:]] + z[strip[:-1]]) for strip in steps]
    rows = np.concatenate([np.tile(strip, 2) for strip in steps])
    return mesh_of(grids, numbers), np.concatenate(middles), rows


class DrawnRope:
    """Strips of the wires in front, and a line of contact along each.

    Under a uniform curvature one wire represents a layer, and passes half a turn from
    the outermost fibre to the innermost; the other half is its mirror image.
    """

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        rope = settings.structure()
        assert isinstance(rope, Rope)
        self._rope = rope
        self._columns = columns
        # Only the outer layer is seen.
        description = rope.description()
        outer = max(wire.layer for wire in rope.wires)
        wires = [wire for wire in rope.wires if wire.layer == outer]
        self._first = len(rope.wires) - len(wires)
        lay = wires[0].layer_data.lay
        helix = wires[0].radius
        self._radius = 0.5 * description.height
        turns = description.length * np.tan(abs(lay)) / (2 * np.pi * helix)
        n_steps = int(np.clip(A_TURN * turns, FEWEST_STEPS, MOST_STEPS))
        self._wires = OuterWires(
            count=sum(wire.stands_for for wire in wires),
            lay=lay,
            helix=helix,
            radius=self._radius,
            length=description.length,
            n_steps=n_steps,
        )
        self._z = self._wires.z
        mesh = self._mesh()
        rows, heights, chains, self._points, self._sides = self._lines()
        self._points_moved = self._moved(rows, np.nan_to_num(heights))
        points = floats(np.stack([self._z[rows], heights], axis=1))
        self.geometry = Geometry(
            description=description, points=points, chains=chains, **mesh
        )
        self.extras: Extras = {
            "stress": self._stress,
            "axial force": self._axial_force,
            "section": self._section,
        }

    def deformed(self, iterate: Iterate) -> DeformedGeometry:
        """The prescribed bending of the strand, and the status of its wires."""
        slips = iterate.status[np.ix_(self._points, self._columns)]
        status = (slips * self._sides[:, None]).astype(np.int8)
        return DeformedGeometry(self._nodes_moved, self._points_moved, status)

    def _mesh(self) -> dict[str, Any]:
        """Make the mesh of strips; set wires and points of cells, and bent nodes."""
        mesh, middles, rows = strips_of(self._wires)
        nearest = self._nearest(mesh["parts"], middles)
        self._quad_wires, _, self._quad_elements, _ = nearest
        self._nodes_moved = self._moved(rows, mesh["nodes"][:, 1])
        return mesh

    def _stress(self, iterate: Iterate, needs: Needs) -> StressField:
        """Mean stress over the section of every wire, (n_cells, n_instants), Pa."""
        stress = wire_stresses(self._rope, iterate.displacement, self._columns)
        shown = stress[self._quad_wires, self._quad_elements]
        return "wire stress", "Pa", floats(shown)

    def _nearest(
        self, numbers: Array, positions: Array
    ) -> tuple[Indices, Indices, Indices, Bytes]:
        """Wire, contact point, element and sign of slip at positions on outer wires.

        Numbers of wires and positions along the strand, m, have shape (n,), as all
        results.
        """
        wires = self._first + numbers
        sides = np.ones(len(positions), dtype=np.int8)
        share = positions / self._z[-1]
        if not self._rope.is_clamped:
            # One wire represents the layer: on its way back it slips the other way.
            turned = np.sign(self._wires.lay) * self._wires.angle(numbers, positions)
            wires = np.full(len(positions), self._first)
            share = np.arccos(np.cos(turned)) / np.pi
            sides = np.where(np.sin(turned) < 0.0, -1, 1).astype(np.int8)
        return wires, *self._points_at(wires, share), sides

    def _points_at(self, wires: Indices, share: Array) -> tuple[Indices, Indices]:
        """Nearest contact points, and elements, (n,), at shares of the length, (n,)."""
        count = self._rope.elements
        nearest = np.round(share * count).astype(np.intp)
        node = np.clip(nearest, 1, max(count - 1, 1))
        element = np.clip((share * count).astype(np.intp), 0, count - 1)
        return wires * (count - 1) + node - 1, element

    def _lines(self) -> tuple[Indices, Array, Indices, Indices, Bytes]:
        """Contact points along the wires in front: steps, heights with NaN, and wires.

        The last two are the number of the point whose status each shows, and the sign
        of its slip. All have shape (n,).
        """
        numbers = np.repeat(np.arange(self._wires.count), len(self._z))
        rows = np.tile(np.arange(len(self._z)), self._wires.count)
        angle = np.remainder(self._wires.angle(numbers, self._z[rows]), 2.0 * np.pi)
        is_seen = (angle >= SHOWN_SHARE) & (angle <= np.pi - SHOWN_SHARE)
        heights = np.where(is_seen, self._wires.height(angle), np.nan)
        # The point behind each stretch stays: its NaN ends the line.
        kept = is_seen | np.append(False, is_seen[:-1])
        wires, points, _, sides = self._nearest(numbers[kept], self._z[rows[kept]])
        return rows[kept], heights[kept], wires, points, sides

    def _moved(self, rows: Indices, heights: Array) -> Floats:
        """Displacement of points at heights, (n,), m: (n, 2, n_instants), m.

        Sections stay plane.
        """
        up, slope = self._bent
        along = slope[rows] * (self._radius - heights)[:, None]
        return floats(np.stack([along, up[rows]], axis=1))

    @cached_property
    def _bent(self) -> tuple[Array, Array]:
        """Height, m, and slope of the axis, (n_steps, n_instants) each."""
        rope = self._rope
        z = self._z
        if rope.is_clamped:
            wire = rope.wires[self._first]
            columns = wire.curvature[:, self._columns].T
            curvature = np.stack(
                [np.interp(z, wire.along, values) for values in columns], axis=1
            )
        else:
            curvature = np.tile(rope.curvature[self._columns], (len(z), 1))
        slope = cumulative_trapezoid(curvature, dx=z[1], axis=0, initial=0.0)
        up = cumulative_trapezoid(slope, dx=z[1], axis=0, initial=0.0)
        if not rope.is_clamped:
            # A strand that nothing holds is drawn level in its middle.
            middle = len(z) // 2
            up = up - up[middle] - slope[middle] * (z - z[middle])[:, None]
            slope = slope - slope[middle]
        return up, slope

    def _axial_force(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """Axial force in the selected wire, and in a sticking wire."""
        rope = self._rope
        columns = self._columns
        names = [wire.name for wire in rope.wires]
        number = names.index(needs.interface)
        wire = rope.wires[number]
        places = thinned(rope.elements, MOST_POINTS)
        stuck = wire.tension[columns] + wire.stuck_force(columns)
        force = wire_forces(rope, iterate.displacement, columns)[number]
        middles = 0.5 * (wire.along[1:] + wire.along[:-1])
        return {
            "x": floats(np.asarray(middles)[places]),
            "force": floats(force[None, places]),
            "names": names[number : number + 1],
            "stuck": floats(stuck[places]),
        }

    def _section(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """All wires in a section at the selected position or the clamp; core first.

        "position" along the strand, m; "wires", the interface of each, -1 for the core,
        (n,); "centres", (n, 2), and "radii", (n,), m, the outermost fibre below; mean
        "stress", Pa, and "slips", its status, (n, n_instants).
        """
        rope = self._rope
        columns = self._columns
        position = float(np.clip(needs.position or 0.0, 0.0, rope.drawn_length))
        cut = cut_at(rope, position)
        lengths = np.array([wire.length for wire in rope.wires])[cut.wire]
        points, _ = self._points_at(cut.wire, cut.arc / lengths)
        slips = iterate.status[np.ix_(points, columns)] * cut.side[:, None]
        # The core is only stretched, and does not slip.
        core = rope.section.core
        stretched = core.young / rope.section.stiffness * rope.tension[columns]
        stress = stress_at(
            rope, cut, wire_stresses(rope, iterate.displacement, columns)
        )
        radii = [0.5 * rope.wires[number].layer_data.diameter for number in cut.wire]
        return {
            "position": position,
            "wires": np.append(-1, cut.wire),
            "centres": floats(
                np.concatenate([[[0.0, 0.0]], cut.centres * (1.0, -1.0)])
            ),
            "radii": floats(np.array([0.5 * core.diameter, *radii])),
            "stress": floats(np.concatenate([stretched[None], stress])),
            "slips": np.concatenate([np.zeros((1, len(columns))), slips]).astype(
                np.int8
            ),
        }
