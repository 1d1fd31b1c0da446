"""From separated bases to what a screen shows of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from app.picture.shown import (
    MOST_MODES,
    MOST_SIZES,
    MOST_VALUES,
    Counts,
    Floats,
    ShownModes,
    floats,
    thinned,
)
from solver.arrays import Array
from solver.latin import Checkpoint, Iterate, Record
from solver.reduction.basis import Modes, Reduction

BORN = 0.5
"""Share of a mode's energy outside the modes before, from which it counts as born."""
LOBE = 0.5
"""Share of a mode's largest entry, from which an entry may fix the sign."""


@dataclass(frozen=True, eq=False)
class Bases:
    """The separated bases of one iterate.

    Attributes
    ----------
    iterate, before
        It, and the one before.
    found
        Its bases.
    substructure
        The chosen one, counted from 0.
    """

    iterate: Iterate
    before: Checkpoint | None
    found: Reduction
    substructure: int

    @property
    def largest(self) -> int:
        """Modes of the largest basis."""
        return max(modes.n_modes for modes in self.found.modes)

    @property
    def is_left(self) -> bool:
        """Whether they are those of the search, and the iterate the solution that goes beyond."""
        return self.iterate.residual is not None

    @cached_property
    def modes(self) -> ShownModes:
        """The modes of the chosen substructure."""
        problem, place, before = self.iterate.problem, self.substructure, self.before
        modes, record = self.found.modes[place], self.found.records[place]
        past = before.reduction.modes[place] if before and before.reduction else None
        rows = problem.substructures[place].rows
        # Rows of two interfaces that meet at a point move together.
        dofs, first = np.unique(problem.row_dofs[rows], return_index=True)
        positions = problem.positions[dofs]
        places = positions if positions.ndim == 1 else positions[:, 0]
        order = np.argsort(places, kind="stable")
        points = order[thinned(len(order))]
        space = modes.displacement_modes[first[points], :MOST_MODES].T
        size = _signed_size(space)
        instants = thinned(problem.n_instants)
        time = modes.time_functions[:MOST_MODES, instants] * problem.scales.displacement
        return ShownModes(
            positions=floats(places[points]),
            space_modes=floats(space / size[:, None]),
            time_functions=floats(time * size[:, None]),
            born=_outside(modes, past)[:MOST_MODES] > BORN,
            record=record,
            lost=max((past.n_modes if past else 0) + record.added - record.modes, 0),
        )

    @cached_property
    def values(self) -> tuple[Floats, Floats]:
        """How large the modes of the chosen substructure are, beside the field that they hold.

        Norms of the time functions, shape (n_modes,), relative to the largest entry of both; and
        singular values, at most `MOST_VALUES`, of what the local stage asks for, W^ + F^/k, in the
        same inner product.
        """
        iterate, modes = self.iterate, self.found.modes[self.substructure]
        problem = iterate.problem
        rows, weights = problem.substructures[self.substructure].rows, problem.time_weights
        wanted = 2.0 * iterate.local_displacement[rows] - iterate.local_incoming[rows]
        weighted = np.sqrt(modes.k)[:, None] * wanted * np.sqrt(weights)
        values = np.linalg.svd(weighted, compute_uv=False)[:MOST_VALUES]
        own = np.sqrt(modes.time_functions**2 @ weights)
        largest = max(float(values.max()), float(own.max(initial=0.0))) or 1.0
        return floats(own / largest), floats(values / largest)


def bases_of(iterate: Iterate, before: Checkpoint | None, substructure: int | None) -> Bases | None:
    """Give the bases of an iterate, if it has any; None chooses the last substructure."""
    found = iterate.reduction
    if found is None:
        return None
    last = len(found.modes) - 1
    place = last if substructure is None else min(max(substructure, 0), last)
    return Bases(iterate, before, found, place)


def sizes(entry: Record) -> Counts | None:
    """Give the numbers of modes in a record, shape (n_shown,); None without any."""
    if not entry.reduction:
        return None
    shown = thinned(len(entry.reduction), MOST_SIZES)
    return np.array([entry.reduction[place].modes for place in shown], dtype=np.int16)


def _signed_size(space: Array) -> Array:
    """Give the largest entry of every mode, with the sign of its last large lobe.

    The sign of the largest entry itself would flip whenever two lobes change places.
    """
    found = np.ones(len(space))
    for number, mode in enumerate(space):
        largest = float(np.abs(mode).max())
        if largest > 0.0:
            last = np.flatnonzero(np.abs(mode) >= LOBE * largest)[-1]
            found[number] = np.copysign(largest, mode[last])
    return found


def _outside(modes: Modes, past: Modes | None) -> Array:
    """Give the share of every mode's energy outside the modes before, shape (n_modes,)."""
    if past is None:
        return np.ones(modes.n_modes)
    inside = (modes.k[:, None] * past.outgoing).T @ modes.outgoing
    return np.asarray(1.0 - np.sum(inside**2, axis=0))
