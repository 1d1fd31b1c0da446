"""From a strand that is bent to what a screen shows of all its wires."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.picture.shown import Bytes, Floats, floats, thinned
from solver.arrays import Array
from solver.discrete.rope.forces import CutWires, WireForces, cut_at, stress_ranges
from solver.discrete.rope.rope import Rope
from solver.latin import Iterate
from solver.scenes import structure_of
from solver.settings import Settings
from solver.study.quantities.cycles import ends_of

MOST_PLACES = 200
"""Places along the strand at which wires are shown."""


class Stiffness(NamedTuple):
    """Bending stiffness of a strand while nothing slips, and once all does, N m^2."""

    stuck: float
    slipping: float


@dataclass(frozen=True, eq=False)
class Strand:
    """What the wires of a strand are, whatever they do.

    Attributes
    ----------
    layers
        Of each interface, from 0, shape (n_wires,).
    is_clamped
        Whether it is bent beside a clamp.
    places
        At which the wires' status is shown: along the strand, m, or, of one that is bent alike all
        along, polar angles, degrees.
    length
        To which these go.
    bending
        Stiffness at both ends.
    lengths
        Of every wire along the strand, shape (n_wires,), m.
    middles
        Of elements, as shares of these.
    usual
        The interface that is looked at unless one is chosen: outermost, where slip begins.
    """

    layers: NDArray[np.intp]
    is_clamped: bool
    places: Floats
    length: float
    bending: Stiffness
    lengths: Floats
    middles: Floats
    usual: str


@dataclass(frozen=True, eq=False)
class StrandField:
    """All wires at one instant, and those that one section cuts.

    Attributes
    ----------
    status
        Of all wires at the strand's places, shape (n_wires, n_places).
    place
        Of the section, m.
    wires, layers
        The interface of each wire that is cut, and its layer, shape (n_cut,).
    centres, radii
        Of its circle, shape (n_cut, 2) and (n_cut,), m; the outermost fibre is below.
    stress
        Mean over its section, shape (n_cut,), Pa.
    slips
        Status there, shape (n_cut,).
    core
        Stress of the core wire, Pa, and its radius, m.
    force, stuck_force
        In the chosen wire at the strand's middles, and what it would be if nothing slipped, N.
    ends
        Finds the lowest and the highest stress of all instants where it is cut, (2, n_cut), Pa.
    ranges
        Finds how far the stress of every wire swings in the last cycle, where it swings most,
        shape (n_wires,), Pa.
    """

    status: Bytes
    place: float
    wires: NDArray[np.intp]
    layers: NDArray[np.intp]
    centres: Floats
    radii: Floats
    stress: Floats
    slips: Bytes
    core: tuple[float, float]
    force: Floats
    stuck_force: Floats
    ends: Callable[[], Floats]
    ranges: Callable[[], Floats]


def shown_strand(settings: Settings) -> ShownStrand | None:
    """Give what is shown of a strand that is bent, where the settings describe one."""
    rope = structure_of(settings)
    if not isinstance(rope, Rope):
        return None
    ends = ends_of(settings)
    return ShownStrand(rope, slice(ends[-2], ends[-1] + 1) if len(ends) > 1 else slice(None))


class ShownStrand:
    """A strand that is bent, thinned.

    Parameters
    ----------
    rope
        The strand.
    last
        Instants of the last cycle, or all where there is none.

    Attributes
    ----------
    base
        What holds of every iterate.
    """

    def __init__(self, rope: Rope, last: slice) -> None:
        self._rope, self._forces = rope, WireForces(rope)
        self._points = rope.elements - 1
        # Both are the same at every instant that one looks at.
        self._ends: tuple[Iterate, float, Floats] | None = None
        self._ranges: tuple[Iterate, Floats] | None = None
        self._last = last
        self._names = [wire.name for wire in rope.wires]
        self._elements = thinned(rope.elements, MOST_PLACES)
        self._nodes = thinned(self._points, MOST_PLACES)
        share = (self._nodes + 1.0) / rope.elements
        length = rope.seen_length if rope.is_clamped else 180.0
        self.base = Strand(
            layers=np.array([wire.layer for wire in rope.wires]),
            is_clamped=rope.is_clamped,
            places=floats(share * length),
            length=length,
            bending=Stiffness(rope.section.stuck_bending, rope.section.slipping_bending),
            lengths=floats(np.array([wire.along[-1] for wire in rope.wires])),
            middles=floats((self._elements + 0.5) / rope.elements),
            usual=max(rope.wires, key=lambda wire: wire.layer).name,
        )

    def at(self, iterate: Iterate, column: int, place: float, interface: str) -> StrandField:
        """Show an iterate at one instant, cut at a place along the strand, m."""
        cut = cut_at(self._rope, place)
        status = iterate.status[:, column].reshape(-1, self._points)
        wires = [self._rope.wires[number] for number in cut.wire]
        force = self._forces(iterate.displacement, slice(column, column + 1))
        number = list(self._names).index(interface)
        return StrandField(
            status=status[:, self._nodes],
            place=place,
            wires=cut.wire,
            layers=cut.layer,
            centres=floats(cut.centres * (1.0, -1.0)),
            radii=floats(np.array([0.5 * wire.diameter for wire in wires])),
            stress=floats(self._forces.stress_at(cut, force)[:, 0]),
            slips=self._slips(cut, status),
            core=self._core(column),
            force=floats(force[number, self._elements, 0]),
            stuck_force=floats(self._stuck(number, column)[self._elements]),
            ends=partial(self._ends_of, iterate, place),
            ranges=partial(self._ranges_of, iterate),
        )

    def _ends_of(self, iterate: Iterate, place: float) -> Floats:
        known = self._ends
        if known is None or known[0] is not iterate or known[1] != place:
            force = self._forces(iterate.displacement, slice(None))
            stress = self._forces.stress_at(cut_at(self._rope, place), force)
            both = floats(np.stack([stress.min(axis=1), stress.max(axis=1)]))
            self._ends = known = iterate, place, both
        return known[2]

    def _ranges_of(self, iterate: Iterate) -> Floats:
        known = self._ranges
        if known is None or known[0] is not iterate:
            found = floats(stress_ranges(self._rope, iterate.displacement, self._last))
            self._ranges = known = iterate, found
        return known[1]

    def _core(self, column: int) -> tuple[float, float]:
        """Give stress and radius of the core wire, which is stretched as the strand is."""
        section = self._rope.section
        strain = float(self._rope.tension[column]) / section.stiffness
        return section.core.young * strain, 0.5 * section.core.diameter

    def _stuck(self, number: int, column: int) -> Array:
        """Give the force in a wire if nothing slipped, in its elements, N."""
        wire = self._rope.wires[number]
        nodes = wire.helix.stuck_force(wire.arc, wire.curvature[:, [column]])[:, 0]
        return np.asarray(wire.tension[column] + 0.5 * (nodes[1:] + nodes[:-1]))

    def _slips(self, cut: CutWires, status: Bytes) -> Bytes:
        lengths = np.array([wire.length for wire in self._rope.wires])[cut.wire]
        node = np.round(cut.arc / lengths * self._rope.elements).astype(np.intp)
        points = np.clip(node - 1, 0, self._points - 1)
        return np.asarray(status[cut.wire, points] * cut.side, dtype=np.int8)
