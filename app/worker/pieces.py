"""The structure in pieces, with the force on each side of the joints.

A joint is where two substructures meet, or one and its support: a cut, or a part of an
interface with friction. In LATIN each of its sides has displacements and forces of its
own, which fit those of the other side only in the solution.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from app.frame import LINEAR, LOCAL, Floats
from app.messages import Needs
from app.worker.cells import NONE, floats, lower_corner, thinned
from app.worker.outlines import Outline, outlines_in_the_plane, outlines_of_rods
from app.worker.piece_joints import PieceJoints, pairs_of
from solver.arrays import Array, Flags, Indices
from solver.discrete import Problem
from solver.latin import Iterate
from solver.settings.scene import Settings

MOST_RODS = 6
"""Largest number of rods whose pieces are shown."""
MOST_MOMENTS = 101
"""Largest number of instants that are shown."""


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


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of a structure, and sides of the joints between the pieces."""

    corners: Floats
    """Corners of the outlines, (n_corners, 2), m, NaN behind each outline."""
    parts: Indices
    """Piece of each corner, from 0, (n_corners,)."""
    substructures: Indices
    """Index of the substructure of each piece, (n_pieces,)."""
    joints: Indices
    """Joint of each side, from 0, ascending, (n_sides,)."""
    names: Sequence[str]
    """Interface with friction of each joint; empty for cuts."""
    is_above: Indices
    """1 for the side of the piece above or to the right, else 0, (n_sides,)."""
    owners: Indices
    """Piece of each side, (n_sides,)."""
    quarters: Floats
    """Quarter points of each side, (n_sides, 2, 2), m; of a curved one on its chord."""
    is_straight: Flags
    """Whether each side is a straight line, (n_sides,)."""
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


class Cutter:
    """A structure in pieces, iterate by iterate."""

    def __init__(self, problem: Problem, settings: Settings, columns: Indices) -> None:
        self._problem = problem
        self._kind = settings.kind
        self._columns = columns
        self._structure = settings.structure()
        self._bodies = self._structure.description().bodies
        if self._kind == "helices":
            self._bodies = len(problem.contacts)
        self._made: tuple[str, _Apart] | None = None

    def pieces(self, iterate: Iterate, needs: Needs) -> Pieces:
        """Pieces of an iterate, and forces on the pieces, in both stages.

        Of many rods those beside the selected interface are shown.
        """
        name = needs.interface
        if self._made is None or self._made[0] != name:
            self._made = name, self._apart(name)
        return self._made[1].of(iterate)

    def _apart(self, name: str) -> _Apart:
        problem = self._problem
        names = list(problem.contacts)
        numbers = np.arange(len(problem.substructures))
        if self._kind == "plane":
            positions = problem.positions[problem.row_dofs]
            assert problem.inside is not None
            positions = positions - lower_corner(problem.inside)
            outlines = outlines_in_the_plane(problem, self._structure)
        else:
            count = min(self._bodies, MOST_RODS)
            if self._kind == "helices":
                count = 1
            first = names.index(name) - (count - 1) // 2
            first = min(max(first, 0), self._bodies - count)
            per_rod = len(numbers) // self._bodies
            numbers = numbers[first * per_rod : (first + count) * per_rod]
            rods = np.arange(len(numbers)) // per_rod
            outlines, positions = outlines_of_rods(problem, numbers, rods)
        joints = PieceJoints(problem, numbers, positions, name)
        return _Apart(problem, numbers, outlines, joints, self._columns)


class _Apart:
    """Some pieces and their joints, with maps from the fields of an iterate."""

    def __init__(
        self,
        problem: Problem,
        numbers: Indices,
        outlines: list[Outline],
        joints: PieceJoints,
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
            is_straight=joints.is_straight,
            points=floats(joints.points),
            sides=joints.sides,
            left_out=joints.left_out,
            columns=shown,
            stages={},
        )
        pairs = pairs_of(problem)
        is_cut = (pairs.numbers == NONE) & np.isin(pairs.above, rows)
        # A gap is a length: beams that meet at an angle leave none.
        is_cut &= ~problem.is_turn[problem.row_dofs[pairs.above]]
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

    def _stacked(self, outlines: list[Outline]) -> Array:
        """Prescribed displacement of all corners, (2 n_corners, n_instants), scaled."""
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
