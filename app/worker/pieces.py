"""The structure taken apart: its pieces, and the force on each side of its joints.

A joint is where two substructures meet, or one and its support: a cut, or a part of an
interface with friction. In LATIN each of its sides has displacements and forces of its
own, which fit those of the other side only in the solution.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import sparse

from app.frame import LINEAR, LOCAL, Floats
from app.messages import Needs
from app.worker.geometry import NONE, PITCH, THICKNESS, floats, ring_of, thinned
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.substructure import Substructure
from solver.latin import Iterate
from solver.settings.scene import Settings

MOST_JOINTS = 240
"""Largest number of joints whose forces are shown."""
MOST_DETAILED = 40
"""Number of joints up to which all have their micro forces, and not the selected
interface alone."""
MOST_RODS = 6
"""Largest number of rods whose pieces are shown."""
MOST_CORNERS = 600
MOST_MOMENTS = 101
"""Largest numbers of corners of outlines, about, and of instants that are shown."""
ABOVE = 0
BELOW = 1
"""Sides of a joint: of the piece above or to the right, and of the other one."""


@dataclass(frozen=True, eq=False)
class StageFields:
    """Displacements and forces of one stage of an iteration."""

    moved: Floats
    """Displacement of the corners with their own piece, (n_corners, 2, n_instants),
    m."""
    joined: Floats
    """Their displacement if both sides of all cuts moved by their mean, same shape."""
    gap: Floats
    """Largest jump at the cuts, (n_instants,), m."""
    forces: Floats
    """Macro force on each side: forces at its two quarter points that have the
    resultant and the moment of all, (n_sides, 2, 2, n_instants), N."""
    micro: Floats
    """Rest of the force at points, as what it would be if the whole side had it,
    (n_points, 2, n_instants), N."""

    @property
    def nbytes(self) -> int:
        """Memory of the arrays, bytes."""
        return sum(array.nbytes for array in vars(self).values())


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of a structure, and the sides of the joints between them."""

    corners: Floats
    """Corners of the outlines, (n_corners, 2), m, NaN behind each outline."""
    parts: Indices
    """Piece of each corner, from 0, (n_corners,)."""
    substructures: Indices
    """Number of the substructure of each piece, (n_pieces,)."""
    joints: Indices
    """Joint of each side, from 0, ascending, (n_sides,)."""
    names: Sequence[str]
    """Interface with friction of each joint; empty for cuts."""
    is_above: Indices
    """1 for the side of the piece above or to the right, else 0, (n_sides,)."""
    owners: Indices
    """Piece of each side, (n_sides,)."""
    quarters: Floats
    """Quarter points of each side, (n_sides, 2, 2), m."""
    points: Floats
    """Points with micro forces, (n_points, 2), m."""
    sides: Indices
    """Side of each point, (n_points,)."""
    left_out: int
    """Number of joints that are not shown."""
    columns: Indices
    """Indices of the instants among those of a frame, (n_instants,)."""
    stages: Mapping[str, StageFields]
    """Fields by stage, `LOCAL` and `LINEAR`."""

    @property
    def nbytes(self) -> int:
        """Memory of the fields, bytes."""
        return sum(stage.nbytes for stage in self.stages.values())


class Cutter:
    """A structure that is taken apart, iterate by iterate."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        self._problem = problem
        self._kind = settings.kind
        self._columns = columns
        self._bodies = settings.structure().description().bodies
        if self._kind == "helices":
            self._bodies = len(problem.rubbing)
        self._made: tuple[str, _Apart] | None = None

    def pieces(self, iterate: Iterate, needs: Needs) -> Pieces:
        """Pieces of an iterate, and the forces on them, in both stages.

        Of many rods those beside the selected interface are shown.
        """
        name = needs.interface
        if self._made is None or self._made[0] != name:
            self._made = name, self._apart(name)
        return self._made[1].of(iterate)

    def _apart(self, name: str) -> _Apart:
        problem = self._problem
        names = list(problem.rubbing)
        numbers = np.arange(len(problem.substructures))
        if self._kind == "plane":
            outlines = _outlines_of_bodies(problem)
            positions = problem.positions[problem.row_dofs]
        else:
            count = min(self._bodies, MOST_RODS)
            if self._kind == "helices":
                count = 1
            first = names.index(name) - (count - 1) // 2
            first = min(max(first, 0), self._bodies - count)
            per_rod = len(numbers) // self._bodies
            numbers = numbers[first * per_rod : (first + count) * per_rod]
            rods = np.arange(len(numbers)) // per_rod
            outlines, positions = _outlines_of_rods(problem, numbers, rods)
        joints = _Joints(problem, numbers, positions, name)
        return _Apart(problem, numbers, outlines, joints, self._columns)


@dataclass(frozen=True, eq=False)
class _Outline:
    """Outline of a piece: its corners, (n, 2), m, and how they move.

    `motion` is the map from the rows of the piece, (2 n, n_boundary), and `given` what
    is added, (2 n, n_instants), scaled, or None.
    """

    corners: Array
    motion: Array
    given: Array | None


def _mean_of_rows(part: Substructure) -> Array:
    """Mean over the rows of each degree of freedom of a piece, (n_dofs, n_boundary)."""
    trace = part.elasticity.trace
    mean = np.zeros((len(part.dofs), len(trace)))
    mean[trace, np.arange(len(trace))] = 1.0
    return np.asarray(mean / np.maximum(mean.sum(axis=1), 1.0)[:, None])


def _outlines_of_bodies(problem: Problem) -> list[_Outline]:
    """Outlines of the substructures of bodies in the plane."""
    inside = problem.inside
    assert inside is not None
    limit = int(np.clip(MOST_CORNERS / (4 * len(inside.grids)), 2, 9))
    outlines = []
    for number, grid in enumerate(inside.grids):
        numbers = np.arange(grid.size).reshape(grid.shape)
        up, across = [thinned(size, limit) for size in grid.shape]
        ring = ring_of(numbers[np.ix_(up, across)])
        matrix, given = inside.of_part(number, ring)
        motion = matrix @ _mean_of_rows(problem.substructures[number])
        corners = inside.nodes[grid.ravel()[ring]]
        outlines.append(_Outline(corners, motion, given))
    return outlines


def _outlines_of_rods(
    problem: Problem, numbers: Indices, rods: Indices
) -> tuple[list[_Outline], Array]:
    """Outlines of the pieces of some rods, and positions of all rows, (n_rows, 2), m.

    `numbers` are those of their substructures and `rods` those of their rods, from
    below, (n_pieces,).
    """
    parts = [problem.substructures[number] for number in numbers]
    length = max(float(np.ptp(problem.positions[part.dofs])) for part in parts)
    length = max(length, float(problem.positions.max()))
    thickness = THICKNESS * length
    positions = np.zeros((problem.n_rows, 2))
    positions[:, 0] = problem.positions[problem.row_dofs]
    outlines = []
    for part, rod in zip(parts, rods, strict=True):
        low = PITCH * length * rod
        # Cuts are in the middle of a rod, contacts at its foot or its top.
        positions[part.rows, 1] = low + 0.5 * thickness
        ends = [0, -1, -1, 0, 0]
        x = problem.positions[part.dofs[ends]]
        corners = np.stack([x, low + thickness * np.array([0, 0, 1, 1, 0])], axis=1)
        motion = np.zeros((10, len(part.rows)))
        motion[::2] = _mean_of_rows(part)[ends]
        given = None
        if problem.carried is not None:
            given = np.zeros((10, problem.n_instants))
            given[::2] = problem.carried[part.dofs[ends]]
        outlines.append(_Outline(corners, motion, given))
    for law in problem.rubbing.laws.values():
        positions[law.tangent.above, 1] -= 0.5 * thickness
        if law.tangent.below is not None:
            positions[law.tangent.below, 1] += 0.5 * thickness
    return outlines, positions


class _SidePairs(NamedTuple):
    """Rows that face each other, and the number of their interface, (n_pairs,) each.

    The number is `NONE` at cuts, and so is the row below on a support.
    """

    above: Indices
    below: Indices
    numbers: Indices

    def joints(self, owners: Indices) -> tuple[_SidePairs, Indices, Indices]:
        """Pairs at shown joints; what tells these apart, (n_joints, 3); joint of each.

        `owners` are the pieces of all rows, `NONE` where they are not shown, and `NONE`
        behind the last, (n_rows + 1,).
        """
        keys = np.stack([self.numbers, owners[self.above], owners[self.below]], axis=1)
        is_shown = (keys[:, 1] != NONE) & ((keys[:, 2] != NONE) | (self.below == NONE))
        keys, of_pairs = np.unique(keys[is_shown], axis=0, return_inverse=True)
        shown = _SidePairs(
            self.above[is_shown], self.below[is_shown], self.numbers[is_shown]
        )
        return shown, keys, of_pairs.ravel()


class _Joints:
    """Sides of the joints between some pieces, and forces on them.

    `joints`, `is_above`, `owners`, `quarters`, `points` and `sides` are as in `Pieces`.
    `macro`, (4 n_sides, n_rows), and `micro`, (2 n_points, n_rows), are maps from the
    forces on all rows, whose `positions` are (n_rows, 2), m. With many joints there are
    micro forces on the interface of a name alone.
    """

    def __init__(
        self, problem: Problem, numbers: Indices, positions: Array, name: str
    ) -> None:
        self._n_rows = problem.n_rows
        owners = np.full(problem.n_rows + 1, NONE)
        for piece, number in enumerate(numbers):
            owners[problem.substructures[number].rows] = piece
        pairs, keys, of_pairs = _pairs_of(problem).joints(owners)
        kept = thinned(len(keys), MOST_JOINTS)
        self.left_out = len(keys) - len(kept)
        names = [*problem.rubbing, ""]
        self.names = [names[number] for number in keys[kept, 0]]
        self._gather(pairs, of_pairs, kept)
        self.owners = owners[self._rows[np.unique(self._sides, return_index=True)[1]]]
        self._components = np.zeros(len(self._rows), dtype=np.intp)
        if problem.inside is not None:
            dofs = problem.row_dofs[self._rows]
            along = problem.inside.directions[dofs, :2]
            self._components = np.abs(along).argmax(axis=1)
        self._positions = positions[self._rows]
        self._measure()
        self.macro = self._macro()
        self.points, self.sides, self.micro = self._micro(name)

    def _gather(self, pairs: _SidePairs, of_pairs: Indices, kept: Indices) -> None:
        """Number the sides of the joints that are kept, and collect their rows.

        `of_pairs` are the joints of the pairs, (n_pairs,).
        """
        rows = np.concatenate([pairs.below, pairs.above])
        joints = np.tile(of_pairs, 2)
        is_above = np.repeat([0, 1], len(of_pairs))
        has_side = (rows != NONE) & np.isin(joints, kept)
        self._rows = rows[has_side]
        sides = 2 * np.searchsorted(kept, joints[has_side]) + is_above[has_side]
        each, self._sides = np.unique(sides, return_inverse=True)
        self.joints = each // 2
        self.is_above = each % 2

    def _measure(self) -> None:
        """Find quarter points, and the place of each row along its side, -1 to 1."""
        shape = len(self.joints), 2
        low = np.full(shape, np.inf)
        high = np.full(shape, -np.inf)
        np.minimum.at(low, self._sides, self._positions)
        np.maximum.at(high, self._sides, self._positions)
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low)
        steps = np.array([-0.5, 0.5])[None, :, None]
        self.quarters = middle[:, None] + steps * half[:, None]
        along = half.argmax(axis=1)[self._sides]
        each = np.arange(len(self._rows))
        away = (self._positions - middle[self._sides])[each, along]
        length = half[self._sides][each, along]
        self._along = np.divide(away, length, np.zeros_like(away), where=length > 0.0)

    def _macro(self) -> sparse.csr_array:
        """Map to macro forces at quarter points, (4 n_sides, n_rows), as of a lever."""
        shares = np.concatenate([0.5 - self._along, 0.5 + self._along])
        targets = 4 * self._sides + self._components
        places = np.concatenate([targets, targets + 2]), np.tile(self._rows, 2)
        shape = 4 * len(self.joints), self._n_rows
        return sparse.csr_array((shares, places), shape=shape)

    def _micro(self, name: str) -> tuple[Array, Indices, sparse.csr_array]:
        """Points with micro forces, (n_points, 2), m, their sides, and a map to these.

        The macro force is spread as a traction that is linear along the side.
        """
        groups = self._groups(name)
        members = np.concatenate([np.zeros(0, dtype=np.intp), *groups])
        places = np.round(self._along[members], 9)
        keys = np.stack([self._sides[members], places], axis=1)
        keys, first, of_members = np.unique(
            keys, axis=0, return_index=True, return_inverse=True
        )
        blocks = [sparse.coo_array((0, 0))]
        for group in groups:
            blocks.append(sparse.coo_array(_without_macro(self._along[group])))
        within = sparse.block_diag(blocks, format="coo")
        targets = 2 * of_members.ravel() + self._components[members]
        places = targets[within.coords[0]], self._rows[members][within.coords[1]]
        shape = 2 * len(keys), self._n_rows
        micro = sparse.csr_array((within.data, places), shape=shape)
        points = self._positions[members[first]]
        return points, keys[:, 0].astype(np.intp), micro

    def _groups(self, name: str) -> list[Indices]:
        """Rows of each side and component with micro forces, in order along it."""
        is_chosen = np.ones(len(self.names), dtype=bool)
        if len(self.names) > MOST_DETAILED:
            is_chosen = np.array(self.names) == name
        order = np.lexsort((self._along, self._components, self._sides))
        order = order[is_chosen[self.joints[self._sides[order]]]]
        numbers = 2 * self._sides[order] + self._components[order]
        ends = np.flatnonzero(np.diff(numbers)) + 1
        # Of two points the macro force is all.
        return [group for group in np.split(order, ends) if len(group) > 2]


def _pairs_of(problem: Problem) -> _SidePairs:
    """Rows of both sides of all cuts and interfaces with friction."""
    above = []
    below = []
    numbers = []
    for cut in problem.cuts:
        above.append(cut.second)
        below.append(cut.first)
        numbers.append(np.full(len(cut.first), NONE))
    for stacked in problem.rubbing.stacks:
        law = stacked.law
        support = np.full(len(law.points), NONE)
        for component in law.components:
            above.append(component.above)
            below.append(support if component.below is None else component.below)
            numbers.append(stacked.numbers[law.interface_of_pairs])
    return _SidePairs(
        np.concatenate(above), np.concatenate(below), np.concatenate(numbers)
    )


def _without_macro(along: Array) -> Array:
    """Map from nodal forces to the micro part of the traction, (n_points, n_points).

    Points are at ascending places along a side, from -1 to 1, (n_points,); the traction
    is given as the force of the whole side.
    """
    steps = 0.5 * np.diff(along)
    weights = np.append(steps, 0.0) + np.insert(steps, 0, 0.0)
    modes = np.stack([np.ones_like(along), along], axis=1)
    work = modes.T @ (weights[:, None] * modes)
    macro = weights[:, None] * modes @ np.linalg.solve(work, modes.T)
    share = weights / weights.sum()
    return np.asarray((np.eye(len(along)) - macro) / share[:, None])


class _Apart:
    """Some pieces and their joints, with the maps from the fields of an iterate."""

    def __init__(
        self,
        problem: Problem,
        numbers: Indices,
        outlines: list[_Outline],
        joints: _Joints,
        columns: Indices,
    ) -> None:
        self._scales = problem.scales
        self._joints = joints
        shown = thinned(len(columns), MOST_MOMENTS)
        self._columns = columns[shown]
        self._mean = problem.mean_of_rows
        self._dofs = problem.row_dofs
        sizes = [len(outline.corners) for outline in outlines]
        parts = [problem.substructures[number] for number in numbers]
        rows = np.concatenate([part.rows for part in parts])
        blocks = [sparse.coo_array(outline.motion) for outline in outlines]
        motions = sparse.block_diag(blocks, format="coo")
        places = motions.coords[0], rows[motions.coords[1]]
        shape = motions.shape[0], problem.n_rows
        self._motion = sparse.csr_array((motions.data, places), shape=shape)
        self._given = self._stacked(outlines)
        # NaN behind each outline.
        self._ends = np.cumsum(sizes)
        corners = np.concatenate([outline.corners for outline in outlines])
        self._pieces = Pieces(
            corners=floats(self._gapped(corners)),
            parts=np.repeat(np.arange(len(sizes)), np.add(sizes, 1)),
            substructures=numbers,
            joints=joints.joints,
            names=joints.names,
            is_above=joints.is_above,
            owners=joints.owners,
            quarters=floats(joints.quarters),
            points=floats(joints.points),
            sides=joints.sides,
            left_out=joints.left_out,
            columns=shown,
            stages={},
        )
        pairs = _pairs_of(problem)
        is_cut = (pairs.numbers == NONE) & np.isin(pairs.above, rows)
        self._cuts = pairs.above[is_cut], pairs.below[is_cut]

    def of(self, iterate: Iterate) -> Pieces:
        """The pieces with the fields of both stages of an iterate."""
        columns = self._columns
        local = self._stage(
            iterate.local_displacement[:, columns],
            iterate.boundary_local_force[:, columns],
        )
        linear = self._stage(
            iterate.boundary_displacement[:, columns],
            iterate.boundary_force[:, columns],
        )
        return replace(self._pieces, stages={LOCAL: local, LINEAR: linear})

    def _stage(self, displacement: Array, force: Array) -> StageFields:
        """Fields of a stage from W and F of all rows, (n_rows, n_instants), scaled."""
        joined = (self._mean @ displacement)[self._dofs]
        above, below = self._cuts
        jump = np.abs(displacement[above] - displacement[below])
        count = len(self._columns)
        macro = self._joints.macro @ force * self._scales.force
        micro = self._joints.micro @ force * self._scales.force
        return StageFields(
            moved=self._moved(displacement),
            joined=self._moved(joined),
            gap=floats(jump.max(axis=0, initial=0.0) * self._scales.displacement),
            forces=floats(macro.reshape(-1, 2, 2, count)),
            micro=floats(micro.reshape(-1, 2, count)),
        )

    def _moved(self, displacement: Array) -> Floats:
        """Displacement of the corners, (n_corners, 2, n_instants), m."""
        moved = self._motion @ displacement + self._given
        moved = moved.reshape(-1, 2, moved.shape[1]) * self._scales.displacement
        return floats(self._gapped(moved))

    def _stacked(self, outlines: list[_Outline]) -> Array:
        """Given displacement of all corners, (2 n_corners, n_instants), scaled."""
        stacked = []
        for outline in outlines:
            if outline.given is None:
                shape = 2 * len(outline.corners), len(self._columns)
                stacked.append(np.zeros(shape))
            else:
                stacked.append(outline.given[:, self._columns])
        return np.concatenate(stacked)

    def _gapped(self, corners: Array) -> Array:
        """Values at corners, (n, ...), with NaN behind each outline."""
        return np.insert(corners, self._ends, np.nan, axis=0)
