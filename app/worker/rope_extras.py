"""What views of a strand need: a section, stress ranges, all wires, and the force in one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.frame import Bytes, Floats
from app.messages import Needs
from app.worker.geometry import floats, thinned
from solver.discrete.rope.forces import WireForces, cut_at, stress_ranges
from solver.discrete.rope.rope import Rope
from solver.latin import Iterate
from solver.scenes import structure_of
from solver.study.quantities.cycles import ends_of

if TYPE_CHECKING:
    from app.worker.sampling import Sampler

MOST_PLACES, MOST_WIRES = 200, 12
"""Places along a wire, and wires whose force is shown, at most."""


@dataclass(frozen=True, eq=False)
class Section:
    """All wires that one section of a strand cuts; the core wire is the first."""

    place: float
    """Along the strand, m."""
    wires: NDArray[np.intp]
    """The interface of each, -1 for the core, shape (n,)."""
    centres: Floats
    radii: Floats
    """Of its circle, shape (n, 2) and (n,), m; the outermost fibre is below."""
    stress: Floats
    slips: Bytes
    """Mean stress, Pa, and status, shape (n, n_instants)."""


@dataclass(frozen=True, eq=False)
class AllWires:
    """Status of all wires of a strand."""

    places: Floats
    """Along the strand, m, or polar angles, degrees, where it is bent alike all along."""
    is_clamped: bool
    """Whether it is bent beside a clamp; else each wire stands for its layer."""
    layers: NDArray[np.intp]
    """Of each wire, from 0, shape (n_wires,)."""
    status: Bytes
    """Shape (n_wires, n_places, n_instants)."""


@dataclass(frozen=True, eq=False)
class Ranges:
    """How far the stress of every wire swings in the last cycle, (n_wires,), Pa, by its layer."""

    layers: NDArray[np.intp]
    ranges: Floats


def section(sampler: Sampler, iterate: Iterate, needs: Needs) -> Section | None:
    """Cut all wires at the selected place, or at the clamp."""
    rope = structure_of(sampler.settings)
    if not isinstance(rope, Rope):
        return None
    columns = sampler.columns
    place = float(np.clip(needs.place or 0.0, 0.0, rope.seen_length))
    cut, forces = cut_at(rope, place), WireForces(rope)
    lengths = np.array([wire.length for wire in rope.wires])[cut.wire]
    node = np.round(cut.arc / lengths * rope.elements).astype(np.intp)
    points = cut.wire * (rope.elements - 1) + np.clip(node - 1, 0, rope.elements - 2)
    slips = iterate.status[np.ix_(points, columns)] * cut.side[:, None]
    core = rope.section.core
    stretched = core.young / rope.section.stiffness * rope.tension[columns]
    stress = forces.stress_at(cut, forces(iterate.displacement, columns))
    radii = [0.5 * rope.wires[number].diameter for number in cut.wire]
    return Section(
        place,
        np.append(-1, cut.wire),
        floats(np.concatenate([[[0.0, 0.0]], cut.centres * (1.0, -1.0)])),
        floats(np.array([0.5 * core.diameter, *radii])),
        floats(np.concatenate([stretched[None], stress])),
        np.concatenate([np.zeros((1, len(columns))), slips]).astype(np.int8),
    )


def all_wires(sampler: Sampler, iterate: Iterate, needs: Needs) -> AllWires | None:
    """Status of every wire, along it."""
    rope = structure_of(sampler.settings)
    if not isinstance(rope, Rope):
        return None
    points = rope.elements - 1
    kept = thinned(points, MOST_PLACES)
    status = iterate.status[:, sampler.columns].reshape(len(rope.wires), points, -1)
    length = rope.seen_length if rope.is_clamped else 180.0
    return AllWires(
        floats((kept + 1.0) / rope.elements * length),
        rope.is_clamped,
        np.array([wire.layer for wire in rope.wires]),
        np.ascontiguousarray(status[:, kept]),
    )


def wire_ranges(sampler: Sampler, iterate: Iterate, needs: Needs) -> Ranges | None:
    """How far stresses swing in the last cycle, or in all of the time where there is none."""
    rope = structure_of(sampler.settings)
    if not isinstance(rope, Rope):
        return None
    ends = ends_of(sampler.settings)
    last = slice(ends[-2], ends[-1] + 1) if len(ends) > 1 else slice(None)
    layers = np.array([wire.layer for wire in rope.wires])
    return Ranges(layers, floats(stress_ranges(rope, iterate.displacement, last)))


ROPE_EXTRAS: dict[str, Callable[[Sampler, Iterate, Needs], Any]] = {
    "section": section,
    "all_wires": all_wires,
    "wire_ranges": wire_ranges,
}
