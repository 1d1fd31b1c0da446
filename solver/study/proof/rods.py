"""Cases of rods: the bar of the paper, a broken wire, a strand of helical wires that is bent."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.discrete.cross_section import mooring
from solver.discrete.rope import Rope
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.reference.closed_forms.masing import energy_of_cycle
from solver.reference.closed_forms.pulled_bar import (
    pulled_changing_bar,
    pulled_compliant_bar,
)
from solver.scenes import structure_of
from solver.study.proof.known_case import Answer, KnownCase, Number

OWN = "solver/README.md, 6: equilibrium of the part that slips"
PLAY = f"{OWN}; M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989"
JENKINS = "Jenkins' element on a bar: equilibrium of what slips and what stands on springs"
MASING = f"{JENKINS}; Masing's rule"
CHANGING = "Equilibrium of what slips, with a bound that is linear in the slip"
PAPAILIOU = (
    "K.-O. Papailiou, On the bending stiffness of transmission line conductors, IEEE Trans. Power "
    "Delivery 12, 1997, without growth of tension along the wire"
)
PEAK = 910.0
"""N; fronts then stop within elements, not at nodes, where they are exact."""
CYCLE = {
    "load": [[0.0, 0.0], [0.2, PEAK], [0.6, -PEAK], [1.0, PEAK]],
    "elements": 200,
    "instants": 101,
}
LOOSENED = {
    "load": [[0.0, 0.0], [0.5, 610.0], [1.0, 610.0]],
    "pressure_load": [[0.0, 5000.0], [0.5, 5000.0], [1.0, 2500.0]],
    "elements": 200,
    "instants": 41,
}
SOFT = {"friction_law": "compliant", "contact_stiffness": 100.0}
CHANGED = {"friction_law": "slip-dependent", "slip_length": 1e-3}
LAYERS, TENSION = 2, 120e3
"""Of the strand of helical wires, and N."""
STEPS = 60
"""Instants of a quarter of a cycle."""


def rod_cases() -> list[KnownCase]:
    """Cases, none of them solved yet."""
    springs, broken = {**_pull(1200.0), **SOFT}, {**_pull(610.0), "instants": 21}
    loosened, soft = "bar whose pressure halves while the load stands", "bar on contact that gives"
    hardens, softens = ({**_pull(PEAK), **CHANGED, "friction_ratio": ratio} for ratio in (1.5, 0.5))
    changing = "bar on friction that {} with slip"
    return [
        KnownCase("bar pulled", PLAY, 1e-4, "bar", _pull(PEAK), _pulled),
        KnownCase("bar pulled until all slides", PLAY, 1e-9, "bar", _pull(1800.0), _slid),
        KnownCase("bar pulled to and fro", PLAY, 2e-3, "bar", CYCLE, _cycled),
        KnownCase(loosened, PLAY, 1e-4, "bar", LOOSENED, _pulled),
        KnownCase(f"{soft} way before it slips", JENKINS, 1e-4, "bar", springs, _gave_way),
        KnownCase(
            f"{soft} way, pulled to and fro", MASING, 2e-3, "bar", {**CYCLE, **SOFT}, _sprung_cycle
        ),
        KnownCase(changing.format("hardens"), CHANGING, 1e-4, "bar", hardens, _changed),
        KnownCase(changing.format("softens"), CHANGING, 1e-4, "bar", softens, _changed),
        KnownCase("broken wire between two others", OWN, 2e-3, "strand", broken, _broke),
        *map(_bent, (1.2, 1.5, 6.0)),
    ]


def _pull(peak: float) -> dict[str, Any]:
    return {"load": [[0.0, 0.0], [1.0, peak]], "elements": 200, "instants": 41}


def _end(exact: float, answer: Answer) -> Number:
    return "end displacement", "m", exact, answer.fields.displacement[-1, -1]


def _pulled(answer: Answer) -> Iterator[Number]:
    settings, (stiffness, _) = answer.settings, answer.bar
    bound = settings.friction * settings.path("pressure_load")[-1]
    yield _end(settings.path("load")[-1] ** 2 / (2.0 * stiffness * bound), answer)


def _slid(answer: Answer) -> Iterator[Number]:
    stiffness, bound = answer.bar
    length, force = answer.settings.length, answer.settings.path("load")[-1]
    yield _end((force * length - 0.5 * bound * length**2) / stiffness, answer)


def _cycled(answer: Answer) -> Iterator[Number]:
    stiffness, bound = answer.bar
    most = PEAK**2 / (2.0 * stiffness * bound)
    back = most - PEAK**2 / (4.0 * stiffness * bound)
    return _loop(answer, back, 2.0 * PEAK**3 / (3.0 * stiffness * bound))


def _sprung_cycle(answer: Answer) -> Iterator[Number]:
    """By Masing's rule."""

    def grown(force: float) -> float:
        return pulled_compliant_bar(force, *_sprung(answer))[0]

    return _loop(answer, grown(PEAK) - 2.0 * grown(0.5 * PEAK), energy_of_cycle(PEAK, grown))


def _loop(answer: Answer, back: float, energy: float) -> Iterator[Number]:
    """Where the end is when first unloaded, and what a cycle takes from the peak on."""
    load, end = answer.settings.path("load"), answer.fields.displacement[-1]
    loaded = int(np.argmax(load))
    unloaded = loaded + int(np.argmin(np.abs(load[loaded : loaded + len(load) // 2])))
    yield "end displacement, unloaded", "m", back, end[unloaded]
    yield "energy of a cycle", "J", energy, np.trapezoid(load[loaded:], end[loaded:])


def _sprung(answer: Answer) -> tuple[float, float, float, float]:
    """Length, ES, bound and density of the springs, as the closed forms take them."""
    settings, (stiffness, bound) = answer.settings, answer.bar
    density = settings.contact_stiffness * stiffness / settings.length**2
    return settings.length, stiffness, bound, density


def _gave_way(answer: Answer) -> Iterator[Number]:
    force = float(answer.settings.path("load")[-1])
    yield _end(pulled_compliant_bar(force, *_sprung(answer))[0], answer)


def _changed(answer: Answer) -> Iterator[Number]:
    settings = answer.settings
    law = settings.friction_ratio, settings.slip_length
    yield _end(pulled_changing_bar(float(settings.path("load")[-1]), *answer.bar, *law), answer)


def _broke(answer: Answer) -> Iterator[Number]:
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


def _bent(share: float) -> KnownCase:
    """A strand bent to and fro, so many times as far as where its outer layer slips first."""
    strand = BentStrand(mooring(LAYERS), 0.3, TENSION)
    peak = share * strand.layers[-1].first_slip
    changes = {
        **{"bending": "uniform", "layers": LAYERS, "tension": TENSION, "curvature": peak},
        **{"elements": 40, "instants": 5 * STEPS + 1},
    }

    def numbers(answer: Answer) -> Iterator[Number]:
        rope = structure_of(answer.settings)
        assert isinstance(rope, Rope)
        moment = rope.moment()(answer.fields.displacement)
        yield "moment", "N m", float(strand.moment(np.array(peak))), moment[STEPS]
        taken = float(np.trapezoid(moment[STEPS:], rope.curvature[STEPS:]))
        yield "energy of a cycle, a metre", "J/m", strand.energy(peak), taken

    title = f"strand of helical wires bent to {share:g} kappa_0"
    return KnownCase(title, PAPAILIOU, 0.01, "rope", changes, numbers)
