"""What sweeps ask of a strand of helical wires; its cycles are those of its load."""

from __future__ import annotations

import math

import numpy as np

from solver.discrete.rope import Rope
from solver.discrete.wire_forces import stress_ranges
from solver.scenes import kind_of, structure_of
from solver.settings import Settings
from solver.study.quantities.cycles import ends_of
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import CYCLE, Quantity
from solver.study.quantities.slips import slips_of


def is_rope(settings: Settings) -> bool:
    """Tell whether there are wires around a core."""
    return kind_of(settings) == "helices"


def is_bent_alike(settings: Settings) -> bool:
    """Tell whether a strand is bent alike all along, so that a metre of it has a meaning."""
    return is_rope(settings) and not _rope(settings).is_clamped


def _rope(settings: Settings) -> Rope:
    found = structure_of(settings)
    assert isinstance(found, Rope)
    return found


def _last(run: FinishedRun) -> slice:
    """Give the instants of the last cycle, its beginning among them; or all without one."""
    ends = ends_of(run.settings)
    return slice(ends[-2], ends[-1] + 1) if len(ends) > 1 else slice(None)


def stuck_bending(run: FinishedRun, at: float | None) -> float:
    """Give the bending stiffness while nothing slips, N m^2."""
    return _rope(run.settings).section.stuck_bending if is_rope(run.settings) else math.nan


def slipping_bending(run: FinishedRun, at: float | None) -> float:
    """Give the bending stiffness of wires that all slip, N m^2."""
    return _rope(run.settings).section.slipping_bending if is_rope(run.settings) else math.nan


def bending_stiffness(run: FinishedRun, at: float | None) -> float:
    """Give the moment at the largest curvature over that, N m^2."""
    if not is_rope(run.settings):
        return math.nan
    return bending_stiffness_at(run, int(np.argmax(np.abs(run.displacement))))


def bending_stiffness_at(run: FinishedRun, instant: int) -> float:
    """Give the moment over the curvature at an instant, N m^2."""
    curvature = float(run.displacement[instant])
    return float(run.force[instant]) / curvature if curvature else math.nan


def energy_per_metre(run: FinishedRun, at: float | None) -> float:
    """Give the energy that friction takes in a metre of strand, J/m: of the whole, or of a cycle.

    NaN near a clamp, and with fewer cycles.
    """
    if not is_bent_alike(run.settings):
        return math.nan
    ends, number = ends_of(run.settings), 0 if at is None else int(at)
    if number and len(ends) <= number:
        return math.nan
    some = slice(ends[number - 1] + 1, ends[number] + 1) if number else slice(None)
    rope = _rope(run.settings)
    works = (work[:, some].sum() for _, _, work in slips_of(run.iterate))
    shares = (wire.stands_for / wire.along[-1] for wire in rope.wires)
    return float(sum(share * work for share, work in zip(shares, works, strict=True)))


def stress_range(run: FinishedRun, at: float | None) -> float:
    """Give how far the stress of a wire swings in the last cycle, the wire where it is most, Pa."""
    if not is_rope(run.settings):
        return math.nan
    rope = _rope(run.settings)
    return float(stress_ranges(rope, run.iterate.displacement, _last(run)).max())


def wire_slip(run: FinishedRun, at: float | None) -> float:
    """Give how far a wire slips to and fro in the last cycle, at the point that slips most, m."""
    if not is_rope(run.settings):
        return math.nan
    return float(np.ptp(run.iterate.displacement[:, _last(run)], axis=1).max())


def wire_work(run: FinishedRun, at: float | None) -> float:
    """Give what friction takes of a metre of wire in the last cycle, where it is most, J/m.

    There fretting is worst; near a clamp it is beside it.
    """
    if not is_rope(run.settings):
        return math.nan
    some = _last(run)
    after = slice(0 if some.start is None else some.start + 1, some.stop)
    return max(
        float((law.by_point(work[:, after].sum(axis=1)) / law.by_point(law.weights)).max())
        for law, _, work in slips_of(run.iterate)
    )


OF_ROPES = (
    Quantity(
        "stuck_bending",
        "Bending stiffness while nothing slips",
        "N·m^2",
        stuck_bending,
        applies=is_rope,
    ),
    Quantity(
        "slipping_bending",
        "Bending stiffness once all slips",
        "N·m^2",
        slipping_bending,
        applies=is_rope,
    ),
    Quantity(
        "bending_stiffness",
        "Moment over the largest curvature",
        "N·m^2",
        bending_stiffness,
        applies=is_rope,
        at_instant=bending_stiffness_at,
    ),
    Quantity(
        "energy_per_metre",
        "Energy dissipated, a metre of strand",
        "J/m",
        energy_per_metre,
        CYCLE,
        applies=is_bent_alike,
    ),
    Quantity(
        "stress_range",
        "Largest stress range of a wire in the last cycle",
        "Pa",
        stress_range,
        applies=is_rope,
    ),
    Quantity(
        "wire_slip",
        "Largest slip of a wire in the last cycle, to and fro",
        "m",
        wire_slip,
        applies=is_rope,
    ),
    Quantity(
        "wire_work",
        "Largest friction work in the last cycle, a metre of wire",
        "J/m",
        wire_work,
        applies=is_rope,
    ),
)
"""Quantities of strands of helical wires."""
