"""Joints between the pieces of a structure, and forces on their sides."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from app.worker.cells import NONE, thinned
from solver.arrays import Array, Flags, Indices
from solver.discrete import Problem

MOST_JOINTS = 240
"""Largest number of joints whose forces are shown."""
MOST_DETAILED = 40
"""Number of joints up to which all have their micro forces, and not the selected
interface alone."""
BENT = 0.05
"""Largest distance of a straight side from its chord, over half of that."""
ASIDE = 0.1
"""Angle between a chord and the direction that distinguishes components, rad; share by
which a side that is called tall is taller than wide."""


class SidePairs(NamedTuple):
    """Opposite rows, and index of their interface, (n_pairs,) each.

    The number is `NONE` at cuts, and so is the row below on a support.
    """

    above: Indices
    below: Indices
    numbers: Indices

    def joints(self, owners: Indices) -> tuple[SidePairs, Indices, Indices]:
        """Pairs at shown joints; keys of joints, (n_joints, 3); joint of each pair.

        `owners` are the pieces of all rows, `NONE` where they are not shown, and `NONE`
        behind the last, (n_rows + 1,).
        """
        keys = np.stack([self.numbers, owners[self.above], owners[self.below]], axis=1)
        is_shown = (keys[:, 1] != NONE) & ((keys[:, 2] != NONE) | (self.below == NONE))
        keys, of_pairs = np.unique(keys[is_shown], axis=0, return_inverse=True)
        shown = SidePairs(
            self.above[is_shown], self.below[is_shown], self.numbers[is_shown]
        )
        return shown, keys, of_pairs.ravel()


class PieceJoints:
    """Sides of the joints between some pieces, and forces on the sides.

    `joints`, `is_above`, `owners`, `quarters`, `is_straight`, `points` and `sides` are
    as in `Pieces`.
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
        pairs, keys, of_pairs = pairs_of(problem).joints(owners)
        kept = thinned(len(keys), MOST_JOINTS)
        self.left_out = len(keys) - len(kept)
        names = [*problem.contacts, ""]
        self.names = [names[number] for number in keys[kept, 0]]
        turns = problem.is_turn[problem.row_dofs]
        self._gather(pairs, of_pairs, kept, turns)
        self.owners = owners[self._rows[np.unique(self._sides, return_index=True)[1]]]
        self._directions = np.tile([1.0, 0.0], (len(self._rows), 1))
        if problem.inside is not None:
            dofs = problem.row_dofs[self._rows]
            self._directions = problem.inside.directions[dofs, :2]
        self._positions = positions[self._rows]
        self._measure()
        self.macro = self._macro()
        self.points, self.sides, self.micro = self._micro(name)

    def _gather(
        self, pairs: SidePairs, of_pairs: Indices, kept: Indices, turns: Flags
    ) -> None:
        """Number the sides of the kept joints, and collect their rows.

        `of_pairs` are the joints of the pairs, (n_pairs,). Rows of a turn, (n_rows,),
        have no force.
        """
        rows = np.concatenate([pairs.below, pairs.above])
        joints = np.tile(of_pairs, 2)
        is_above = np.repeat([0, 1], len(of_pairs))
        has_side = (rows != NONE) & np.isin(joints, kept) & ~turns[rows]
        self._rows = rows[has_side]
        sides = 2 * np.searchsorted(kept, joints[has_side]) + is_above[has_side]
        each, self._sides = np.unique(sides, return_inverse=True)
        self.joints = each // 2
        self.is_above = each % 2

    def _measure(self) -> None:
        """Find quarter points, and the position of each row along its side, -1 to 1.

        The place is the one on the chord from end to end of the side.
        """
        begin, end = self._ends()
        middle = 0.5 * (begin + end)
        half = 0.5 * (end - begin)
        steps = np.array([-0.5, 0.5])[None, :, None]
        self.quarters = middle[:, None] + steps * half[:, None]
        chords = half[self._sides]
        squares = (chords**2).sum(axis=1)
        beyond = self._positions - middle[self._sides]
        away = (beyond * chords).sum(axis=1)
        has_length = squares > 0.0
        self._along = np.divide(away, squares, np.zeros_like(away), where=has_length)
        beside = beyond - self._along[:, None] * chords
        is_off = (beside**2).sum(axis=1) > BENT**2 * squares
        self.is_straight = np.bincount(self._sides, weights=is_off) == 0.0
        self._components = self._components_along(chords)

    def _components_along(self, chords: Array) -> Indices:
        """Component of each row, (n_rows,): 0 along its chord, 1 across.

        Of both rows at a node one is of either. Chords have the shape (n_rows, 2), m.
        """
        # Turned a little: two directions that are askew by 45 degrees are
        # distinguished.
        cos = np.cos(ASIDE)
        sin = np.sin(ASIDE)
        turned = chords @ np.array([[cos, sin], [-sin, cos]])
        turned[~chords.any(axis=1)] = cos, sin
        across = turned[:, ::-1] * [-1.0, 1.0]
        of_chord = np.abs((self._directions * turned).sum(axis=1))
        of_normal = np.abs((self._directions * across).sum(axis=1))
        return (of_normal > of_chord).astype(np.intp)

    def _ends(self) -> tuple[Array, Array]:
        """Ends of each side along its longer direction, (n_sides, 2) both, m."""
        shape = len(self.joints), 2
        low = np.full(shape, np.inf)
        high = np.full(shape, -np.inf)
        np.minimum.at(low, self._sides, self._positions)
        np.maximum.at(high, self._sides, self._positions)
        # Where a side is as wide as tall, rounding must not order that of one piece by
        # x and that of the other by y.
        wide, tall = (high - low).T
        longer = (tall > (1.0 + ASIDE) * wide).astype(np.intp)[self._sides]
        place = self._positions[np.arange(len(self._rows)), longer]
        order = np.lexsort((place, self._sides))
        firsts = np.searchsorted(self._sides[order], np.arange(shape[0]))
        lasts = np.append(firsts[1:], len(order)) - 1
        return self._positions[order[firsts]], self._positions[order[lasts]]

    def _macro(self) -> sparse.csr_array:
        """Map to macro forces at quarter points, (4 n_sides, n_rows), by lever arms."""
        shares = np.stack([0.5 - self._along, 0.5 + self._along], axis=1)
        # Of every row to both quarter points, along x and y.
        values = shares[:, :, None] * self._directions[:, None]
        targets = 4 * self._sides[:, None] + np.arange(4)
        rows = np.repeat(self._rows, 4)
        shape = 4 * len(self.joints), self._n_rows
        macro = sparse.csr_array((values.ravel(), (targets.ravel(), rows)), shape=shape)
        macro.eliminate_zeros()
        return macro

    def _micro(self, name: str) -> tuple[Array, Indices, sparse.csr_array]:
        """Points with micro forces, (n_points, 2), m, their sides, and the map to them.

        The macro force is spread as a traction that is linear along the side.
        """
        groups = self._groups(name)
        members = np.concatenate([np.zeros(0, dtype=np.intp), *groups])
        keys = np.stack(
            [self._sides[members], np.round(self._along[members], 9)], axis=1
        )
        keys, first, of_members = np.unique(
            keys, axis=0, return_index=True, return_inverse=True
        )
        within = self._within(groups)
        at, by = within.coords
        values = within.data[:, None] * self._directions[members[at]]
        targets = 2 * of_members.ravel()[at, None] + np.arange(2)
        rows = np.repeat(self._rows[members][by], 2)
        shape = 2 * len(keys), self._n_rows
        micro = sparse.csr_array((values.ravel(), (targets.ravel(), rows)), shape=shape)
        micro.eliminate_zeros()
        points = self._positions[members[first]]
        return points, keys[:, 0].astype(np.intp), micro

    def _within(self, groups: list[Indices]) -> sparse.coo_array:
        """Map from forces of rows to micro forces, group by group."""
        blocks = [sparse.coo_array((0, 0))]
        for group in groups:
            blocks.append(sparse.coo_array(_without_macro(self._along[group])))
        return sparse.block_diag(blocks, format="coo")

    def _groups(self, name: str) -> list[Indices]:
        """Rows of each side and component with micro forces, ordered along the side."""
        is_chosen = np.ones(len(self.names), dtype=bool)
        if len(self.names) > MOST_DETAILED:
            is_chosen = np.array(self.names) == name
        order = np.lexsort((self._along, self._components, self._sides))
        order = order[is_chosen[self.joints[self._sides[order]]]]
        numbers = 2 * self._sides[order] + self._components[order]
        ends = np.flatnonzero(np.diff(numbers)) + 1
        # Of two points the macro force is all.
        return [group for group in np.split(order, ends) if len(group) > 2]


def pairs_of(problem: Problem) -> SidePairs:
    """Rows of both sides of all cuts and interfaces with friction."""
    above = []
    below = []
    numbers = []
    for cut in problem.cuts:
        above.append(cut.second)
        below.append(cut.first)
        numbers.append(np.full(len(cut.first), NONE))
    for stacked in problem.contacts.stacks:
        law = stacked.law
        support = np.full(len(law.points), NONE)
        for component in law.components:
            above.append(component.above)
            below.append(support if component.below is None else component.below)
            numbers.append(stacked.numbers[law.interface_of_pairs])
    return SidePairs(
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
    share = (weights / weights.sum())[:, None]
    micro = np.eye(len(along)) - macro
    # Points of a round side that stand at one place of its chord have no length there.
    return np.divide(micro, share, np.zeros_like(micro), where=share > 0.0)
