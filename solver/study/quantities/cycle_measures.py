"""Quantities of cyclic loads, of ropes of helical wires, and of broken wires."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import RESIDUE, Array
from solver.discrete.probes import AxialForce
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import stress_ranges
from solver.laws import OPEN, FrictionLaw
from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import (
    driven_limit,
    largest_swing,
    shakedown_limit,
    slip_space,
)
from solver.settings.scene import Settings
from solver.study.quantities.body_measures import is_rope, secant
from solver.study.quantities.contact_measures import are_clamped, dissipation
from solver.study.quantities.cycles import (
    cycle_ends,
    instants_of_cycle,
    n_cycles_of,
    slips_of,
)
from solver.study.quantities.finished import FinishedRun, first_largest
from solver.study.quantities.quantity import CYCLE, quantity

NO_ENERGY = 1e-12
"""Share of the dissipated energy up to which the energy of a cycle is rounding."""
REGAINED = 0.9
"""Share of its tension up to which the recovery of a broken wire is measured.

The rest is extrapolated at the same rate: the element in which the tension is complete
again would blur the length."""


def has_cycles(settings: Settings) -> bool:
    """Check whether the load has a cycle."""
    return n_cycles_of(settings) > 0


def has_a_limit(settings: Settings) -> bool:
    """Check whether a shakedown limit is known: for rods, and for closed contacts.

    Contacts in the plane stay closed where surfaces without a gap rub by Coulomb's law.
    """
    law = settings.law
    if not has_cycles(settings) or law.slip_factor is not None:
        return False
    if settings.kind != "plane":
        return True
    if not settings.opens or settings.has("spring") or law != FrictionLaw():
        return False
    holds = settings.structure().description().holds
    # Open contacts make the set of slips that may stay another one.
    gaps = [hold.gap for hold in holds if hold.gap is not None]
    return settings.values()["friction"] != 0.0 and not np.any(gaps)


@quantity(
    "Energy of the last cycle over the second",
    applies=lambda settings: n_cycles_of(settings) > 1,
)
def cycle_energy_ratio(run: FinishedRun) -> float:
    """Energy of the last cycle over that of the second; NaN if the latter is zero."""
    energy = run.cycles.energy
    if energy[1] > NO_ENERGY * np.abs(run.dissipated).sum():
        return float(energy[-1] / energy[1])
    return math.nan


@quantity("Slip that the last cycle leaves", "m", applies=has_cycles)
def ratchet(run: FinishedRun) -> float:
    """Largest slip per cycle that remains at the end of the last cycle, m."""
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
    """Largest share of the contact that slips simultaneously in the last cycle.

    0 is stick, 1 gross slip, anything between partial slip (O. Vingsbo, S. Söderberg,
    On fretting maps, Wear 126, 1988). A point that a clamp holds never slips, and is
    left out.
    """
    length = _free_lengths(run)[:, None]
    status = run.iterate.status[run.problem.contacts.on_surfaces]
    # Points that are open carry nothing, and are no part of the contact then.
    status = status[:, instants_of_cycle(run.settings, n_cycles_of(run.settings))]
    touching = (length * (status != OPEN)).sum(axis=0)
    slipping = (length * (np.abs(status) == 1)).sum(axis=0)
    # At an instant without contact nothing slips.
    shares = slipping[touching > 0.0] / touching[touching > 0.0]
    return float(shares.max(initial=0.0))


def _free_lengths(run: FinishedRun) -> Array:
    """Tributary lengths of points of surfaces, (n_points,), m; 0 of clamped ones.

    That of a point is the length of all points for which it stands.
    """
    contacts = run.problem.contacts
    lengths = []
    for law in contacts.laws.values():
        is_free = ~are_clamped(run.problem, law)
        lengths.append(law.by_point(law.weights * is_free))
    represented = contacts.copies * contacts.of_points(lengths)
    return np.asarray(represented[contacts.on_surfaces])


@quantity("Shakedown factor on the swing of the load", applies=has_a_limit)
def shakedown_factor(run: FinishedRun) -> float:
    """Shakedown factor on the swing of the load about its mean in the last cycle.

    With that factor slip can still cease (MATHEMATICS.md, 15). NaN where no limit
    is known, or where not even the mean load keeps all contacts closed.
    """
    problem = run.problem
    last = _last(run)
    try:
        if problem.opens:
            swing, _ = largest_swing(slip_space(problem), last)
            return min(swing, driven_limit(problem, last))
        return shakedown_limit(problem, last)
    except NoReferenceError:
        return math.nan


def _rope(settings: Settings) -> Rope:
    """Structure of the settings of a rope."""
    rope = settings.structure()
    assert isinstance(rope, Rope)
    return rope


def _last(run: FinishedRun) -> slice:
    """Instants of the last cycle, including its first; all instants without a cycle."""
    ends = cycle_ends(run.settings)
    if len(ends) > 1:
        return slice(ends[-2], ends[-1] + 1)
    return slice(0, None)


def _sticks_rigidly(settings: Settings) -> bool:
    """Check whether the wires of a rope do not give way before they slip."""
    return is_rope(settings) and math.isinf(settings.law.stiffness)


@quantity("Bending stiffness while nothing slips", "N·m^2", applies=_sticks_rigidly)
def stuck_bending(run: FinishedRun) -> float:
    """Bending stiffness with all wires sticking, N m^2.

    Of a strand whose contacts give way before they slip it is smaller, and not known.
    """
    return _rope(run.settings).section.stuck_bending


@quantity("Bending stiffness once all slips", "N·m^2", applies=is_rope)
def slipping_bending(run: FinishedRun) -> float:
    """Bending stiffness with all wires slipping, N m^2."""
    return _rope(run.settings).section.slipping_bending


@quantity(
    "Moment over the largest curvature",
    "N·m^2",
    applies=is_rope,
    when=lambda run: first_largest(run.displacement),
)
def bending_stiffness(run: FinishedRun, instant: int) -> float:
    """Moment at the largest curvature over that curvature, N m^2."""
    return secant(run, instant)


@quantity(
    "Energy dissipated, a metre of strand",
    "J/m",
    parameter=CYCLE,
    applies=lambda settings: is_rope(settings) and not _rope(settings).is_clamped,
)
def energy_per_metre(run: FinishedRun, at: float | None) -> float:
    """Energy dissipated per metre of strand, J/m: in the whole run, or in one cycle.

    NaN near a clamp, and where the load has fewer cycles.
    """
    return dissipation.of(run, at) / _rope(run.settings).drawn_length


@quantity("Largest stress range of a wire in the last cycle", "Pa", applies=is_rope)
def stress_range(run: FinishedRun) -> float:
    """Largest stress range of any wire in the last cycle, Pa."""
    rope = _rope(run.settings)
    return float(stress_ranges(rope, run.iterate.displacement, _last(run)).max())


@quantity("Largest slip of a wire in the last cycle, to and fro", "m", applies=is_rope)
def wire_slip(run: FinishedRun) -> float:
    """Largest range of the slip of any point of a wire in the last cycle, m."""
    return float(np.ptp(run.iterate.displacement[:, _last(run)], axis=1).max())


@quantity(
    "Largest friction work in the last cycle, a metre of wire", "J/m", applies=is_rope
)
def wire_work(run: FinishedRun) -> float:
    """Largest friction work per metre of wire in the last cycle, J/m.

    Fretting is worst at that point, which near a clamp is beside the clamp.
    """
    last = instants_of_cycle(run.settings, n_cycles_of(run.settings) or None)
    largest = []
    for stacked, _, work in slips_of(run.iterate):
        law = stacked.law
        of_cycle = law.by_point(work[:, last].sum(axis=1))
        largest.append(float((of_cycle / law.by_point(law.weights)).max()))
    return max(largest)


@quantity(
    "Length over which a broken wire regains its force",
    "m",
    applies=lambda settings: settings.has("broken"),
    when=lambda run: first_largest(np.maximum(run.force, 0.0)),
)
def recovery_length(run: FinishedRun, instant: int) -> float:
    """Distance from the break at which a wire has regained its tension, m.

    The distance is taken at the largest tension. NaN without a broken wire, or without
    tension; infinite if the wire regains its tension on neither side.
    """
    description = run.settings.structure().description()
    if description.broken is None or run.force[instant] <= 0.0:
        return math.nan
    wire, position = description.broken
    axial = AxialForce(run.problem, slice(instant, instant + 1))
    forces = axial(run.iterate.displacement[:, instant : instant + 1])
    # The tension far from the break is that of the loop.
    share = forces[axial.wires == wire, 0] / run.force[instant]
    size = description.length / len(share)
    node = round(position / size)
    # Both sides of the break recover, and the shorter length is that of the wire.
    after = size * _elements_to(share[node:], REGAINED) / REGAINED
    before = size * _elements_to(share[:node][::-1], REGAINED) / REGAINED
    return min(after, before)


def _elements_to(share: Array, level: float) -> float:
    """Number of elements from a break to where the tension reaches a level.

    The tension is known in the middles of the elements, as a share of the full one,
    shape (n_elements,). It is zero at the break and linear between the middles.
    Infinite if the level is not reached.
    """
    distances = np.concatenate([[0.0], np.arange(len(share)) + 0.5])
    values = np.maximum.accumulate(np.concatenate([[0.0], share]))
    if values[-1] >= level:
        return float(np.interp(level, values, distances))
    return math.inf
