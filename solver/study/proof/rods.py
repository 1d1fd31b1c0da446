"""Numbers that are known of rods, beside those of an answer: functions of `cases.toml`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.discrete.rope import Rope
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.reference.closed_forms.masing import energy_of_cycle
from solver.reference.closed_forms.pulled_bar import (
    pulled_changing_bar,
    pulled_compliant_bar,
)
from solver.study.proof.known_case import Answer, Number


def _end(exact: float, answer: Answer) -> Number:
    return "end displacement", "m", exact, answer.fields.displacement[-1, -1]


def pulled(answer: Answer) -> Iterator[Number]:
    """Clamped bar under a pull that stands, while the pressure falls or stands."""
    settings, (stiffness, _) = answer.settings, answer.bar
    bound = settings.friction * settings.path("pressure_load")[-1]
    yield _end(settings.path("load")[-1] ** 2 / (2.0 * stiffness * bound), answer)


def slid_out(answer: Answer) -> Iterator[Number]:
    """Clamped bar that slides all along."""
    stiffness, bound = answer.bar
    length, force = answer.settings.length, answer.settings.path("load")[-1]
    yield _end((force * length - 0.5 * bound * length**2) / stiffness, answer)


def cycled(answer: Answer) -> Iterator[Number]:
    """Where the end is when first unloaded, and what a cycle takes from the peak on."""
    (stiffness, bound), load = answer.bar, answer.settings.path("load")
    peak, end = float(load.max()), answer.fields.displacement[-1]
    back, energy = peak**2 / (4.0 * stiffness * bound), 2.0 * peak**3 / (3.0 * stiffness * bound)
    if answer.settings.friction_law == "compliant":
        # By Masing's rule.
        def grown(force: float) -> float:
            return pulled_compliant_bar(force, *_sprung(answer))[0]

        back = grown(peak) - 2.0 * grown(0.5 * peak)
        energy = energy_of_cycle(peak, grown)
    loaded = int(np.argmax(load))
    unloaded = loaded + int(np.argmin(np.abs(load[loaded : loaded + len(load) // 2])))
    yield "end displacement, unloaded", "m", back, end[unloaded]
    yield "energy of a cycle", "J", energy, np.trapezoid(load[loaded:], end[loaded:])


def _sprung(answer: Answer) -> tuple[float, float, float, float]:
    """Length, ES, bound and density of the springs, as the closed forms take them."""
    settings, (stiffness, bound) = answer.settings, answer.bar
    density = settings.contact_stiffness * stiffness / settings.length**2
    return settings.length, stiffness, bound, density


def gave_way(answer: Answer) -> Iterator[Number]:
    """Clamped bar on friction that gives way before it slips."""
    force = float(answer.settings.path("load")[-1])
    yield _end(pulled_compliant_bar(force, *_sprung(answer))[0], answer)


def changing_friction(answer: Answer) -> Iterator[Number]:
    """Clamped bar on friction that changes with slip."""
    law = answer.settings.friction_ratio, answer.settings.slip_length
    force = float(answer.settings.path("load")[-1])
    yield _end(pulled_changing_bar(force, *answer.bar, *law), answer)


def broken_wire(answer: Answer) -> Iterator[Number]:
    """Opening of a break, and half of what the wire regains on its way."""
    settings, (stiffness, bound) = answer.settings, answer.bar
    moved = answer.fields.displacement[:, -1]
    sides, tension = 2, float(settings.path("load")[-1])
    slip = tension**2 * (sides + 1) / (2.0 * stiffness * sides**2 * bound)
    first = (settings.broken - 1) * (settings.elements + 1)
    before = first + round(settings.break_position * settings.elements)
    yield "opening of the break", "m", 2.0 * slip, moved[before + 1] - moved[before]
    # Half of what is regained on the way: as strain of the element there.
    reached = round(0.5 * tension / (sides * bound) / settings.length * settings.elements)
    size = settings.length / settings.elements
    strain = (moved[before - reached] - moved[before - reached - 1]) / size
    exact = sides * bound * (reached + 0.5) * size
    yield "force of the broken wire", "N", exact, stiffness * strain


def bent_strand(answer: Answer) -> Iterator[Number]:
    """Moment at the peak of the curvature, and what a cycle takes."""
    settings, rope = answer.settings, answer.settings.structure()
    assert isinstance(rope, Rope)
    strand, peak = (
        BentStrand(settings.section, settings.friction, settings.tension),
        settings.curvature,
    )
    moment, quarter = rope.moment()(answer.fields.displacement), (settings.instants - 1) // 5
    yield "moment", "N m", float(strand.moment(np.array(peak))), moment[quarter]
    taken = float(np.trapezoid(moment[quarter:], rope.curvature[quarter:]))
    yield "energy of a cycle, a metre", "J/m", strand.energy(peak), taken
