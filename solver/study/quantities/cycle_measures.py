"""Quantities of a load that repeats itself, and of strands: of helical wires, or a broken one."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import RESIDUE, Array
from solver.discrete.probes import AxialForce
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import stress_ranges
from solver.laws import OPEN, FrictionLaw
from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import largest_swing, shakedown_limit, slip_space
from solver.settings.scene import Settings
from solver.study.quantities.cycles import cycles_in, ends_of, instants_of, slips_of
from solver.study.quantities.finished import FinishedRun, first_largest
from solver.study.quantities.quantity import CYCLE, quantity

NO_ENERGY = 1e-12
"""Share of all energy that rounding makes."""
REGAINED = 0.9
"""Share of its tension up to which a broken wire is watched; it regains the rest at
that rate. The element in which the rest is regained would blur the place."""


def has_cycles(settings: Settings) -> bool:
    """Whether a load has a cycle."""
    return cycles_in(settings) > 0


def has_a_limit(settings: Settings) -> bool:
    """Whether slip that stays is known: of rods, and in the plane of closed contacts.

    Contacts stay closed where surfaces without a gap rub by Coulomb's law.
    """
    law = settings.law
    if not has_cycles(settings) or law.strength is not None:
        return False
    if settings.kind != "plane":
        return True
    if not settings.opens or settings.has("spring") or law != FrictionLaw():
        return False
    gaps = [
        hold.gap
        for hold in settings.structure().described().holds
        if hold.gap is not None
    ]
    return settings.values()["friction"] != 0.0 and not np.any(gaps)


@quantity(
    "Energy of the last cycle over the second",
    applies=lambda settings: cycles_in(settings) > 1,
)
def cycle_energy_ratio(run: FinishedRun) -> float:
    """Energy of the last cycle over that of the second; NaN where that took none."""
    energy = run.cycles.energy
    is_any = energy[1] > NO_ENERGY * np.abs(run.dissipated).sum()
    if is_any:
        return float(energy[-1] / energy[1])
    return math.nan


@quantity("Slip that the last cycle leaves", "m", applies=has_cycles)
def ratchet(run: FinishedRun) -> float:
    """Slip that the last cycle leaves, at the point where it leaves most, m."""
    left = np.abs(run.cycles.net[:, -1]).max()
    if left > RESIDUE * run.cycles.slip.max():
        return float(left)
    return 0.0


@quantity(
    "Share of the contact that slips at once in the last cycle",
    is_share=True,
    applies=has_cycles,
)
def sliding_share(run: FinishedRun) -> float:
    """Largest share of the contact that slips at once in the last cycle, by length.

    0 is stick, 1 gross slip, anything between partial slip (O. Vingsbo, S. Söderberg,
    On fretting maps, Wear 126, 1988). A point that a clamp holds never slips, and is
    left out.
    """
    held = run.problem.is_held
    lengths = [
        law.by_point(
            law.weights * ~np.all([held[rows] for rows in law.tangent.sides], axis=0)
        )
        for law in run.problem.surfaces.values()
    ]
    length = np.concatenate(lengths)[:, None]
    status = run.iterate.status[run.problem.on_surfaces]
    status = status[:, instants_of(run.settings, cycles_in(run.settings))]
    touching = (length * (status != OPEN)).sum(axis=0)
    slipping = (length * (np.abs(status) == 1)).sum(axis=0)
    shares = slipping[touching > 0.0] / touching[touching > 0.0]
    return float(shares.max(initial=0.0))


@quantity("Shakedown factor on the swing of the load", applies=has_a_limit)
def shakedown_factor(run: FinishedRun) -> float:
    """Largest factor on the swing about the mean of the last cycle under which slip can cease.

    `solver/README.md`, 15; NaN where none is known, or not even the mean keeps all
    contacts closed.
    """
    try:
        if run.problem.opens:
            return largest_swing(slip_space(run.problem), _last(run))[0]
        return shakedown_limit(run.problem, _last(run))
    except NoReferenceError:
        return math.nan


def is_rope(settings: Settings) -> bool:
    """Whether there are wires around a core."""
    return settings.kind == "helices"


def _rope(settings: Settings) -> Rope:
    rope = settings.structure()
    assert isinstance(rope, Rope)
    return rope


def _last(run: FinishedRun) -> slice:
    """Instants of the last cycle, its beginning among them; or all without one."""
    ends = ends_of(run.settings)
    if len(ends) > 1:
        return slice(ends[-2], ends[-1] + 1)
    return slice(0, None)


@quantity("Bending stiffness while nothing slips", "N·m^2", applies=is_rope)
def stuck_bending(run: FinishedRun) -> float:
    """Bending stiffness while nothing slips, N m^2."""
    return _rope(run.settings).section.stuck_bending


@quantity("Bending stiffness once all slips", "N·m^2", applies=is_rope)
def slipping_bending(run: FinishedRun) -> float:
    """Bending stiffness of wires that all slip, N m^2."""
    return _rope(run.settings).section.slipping_bending


@quantity(
    "Moment over the largest curvature",
    "N·m^2",
    applies=is_rope,
    when=lambda run: first_largest(run.displacement),
)
def bending_stiffness(run: FinishedRun, instant: int) -> float:
    """Moment at the largest curvature over that, N m^2."""
    curvature = float(run.displacement[instant])
    if curvature:
        return float(run.force[instant]) / curvature
    return math.nan


@quantity(
    "Energy dissipated, a metre of strand",
    "J/m",
    parameter=CYCLE,
    applies=lambda settings: is_rope(settings) and not _rope(settings).is_clamped,
)
def energy_per_metre(run: FinishedRun, at: float | None) -> float:
    """Energy that friction takes in a metre of strand, J/m: of the whole run, or of a cycle.

    NaN near a clamp, and with fewer cycles.
    """
    some = instants_of(run.settings, at)
    if some is None:
        return math.nan
    return float(run.dissipated[some].sum()) / _rope(run.settings).seen_length


@quantity("Largest stress range of a wire in the last cycle", "Pa", applies=is_rope)
def stress_range(run: FinishedRun) -> float:
    """How far the stress of a wire swings in the last cycle, the wire where it is most, Pa."""
    rope = _rope(run.settings)
    return float(stress_ranges(rope, run.iterate.displacement, _last(run)).max())


@quantity("Largest slip of a wire in the last cycle, to and fro", "m", applies=is_rope)
def wire_slip(run: FinishedRun) -> float:
    """How far a wire slips to and fro in the last cycle, at the point that slips most, m."""
    return float(np.ptp(run.iterate.displacement[:, _last(run)], axis=1).max())


@quantity(
    "Largest friction work in the last cycle, a metre of wire", "J/m", applies=is_rope
)
def wire_work(run: FinishedRun) -> float:
    """What friction takes of a metre of wire in the last cycle, where it is most, J/m.

    There fretting is worst; near a clamp it is beside it.
    """
    last = instants_of(run.settings, cycles_in(run.settings) or None)
    return max(
        float(
            (law.by_point(work[:, last].sum(axis=1)) / law.by_point(law.weights)).max()
        )
        for law, _, work in slips_of(run.iterate)
    )


@quantity(
    "Length over which a broken wire regains its force",
    "m",
    applies=lambda settings: settings.has("broken"),
    when=lambda run: first_largest(np.maximum(run.force, 0.0)),
)
def recovery_length(run: FinishedRun, instant: int) -> float:
    """How far from its break a wire carries its tension again, at the largest tension, m.

    NaN without a broken wire, or without tension; infinite if it does so on neither
    side.
    """
    described = run.settings.structure().described()
    if described.broken is None or run.force[instant] <= 0.0:
        return math.nan
    wire, place = described.broken
    axial = AxialForce(run.problem, slice(instant, instant + 1))
    force = axial(run.iterate.displacement[:, instant : instant + 1])[
        axial.wires == wire, 0
    ]
    share = force / run.force[instant]
    size = described.length / len(share)
    node = round(place / size)
    sides = share[node:], share[:node][::-1]
    return min(size * _reached(side, REGAINED) / REGAINED for side in sides)


def _reached(share: Array, level: float) -> float:
    """Elements from a break to where the tension, known in their middles, reaches a share of it.

    Linear between the middles, and nothing at the break; infinite if it is not reached.
    """
    places = np.concatenate([[0.0], np.arange(len(share)) + 0.5])
    values = np.maximum.accumulate(np.concatenate([[0.0], share]))
    if values[-1] >= level:
        return float(np.interp(level, values, places))
    return math.inf
