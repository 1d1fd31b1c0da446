"""Cases of rods: the bar of the paper, a broken wire, a strand of helical wires that is bent."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from solver.discrete.cross_section import mooring
from solver.discrete.rope import Rope
from solver.reference.closed_forms.bent_strand import BentStrand
from solver.reference.closed_forms.pulled_bar import (
    cycled_compliant_bar,
    pulled_changing_bar,
    pulled_compliant_bar,
)
from solver.scenes import structure_of
from solver.study.proof.case import Answer, KnownCase, KnownNumber

OWN = "solver/README.md, 6: equilibrium of the part that slips"
PLAY = f"{OWN}; M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989"
JENKINS = "Jenkins' element on a bar: equilibrium of what slips and what stands on springs"
CHANGING = "Equilibrium of what slips, with a bound that is linear in the slip"
PAPAILIOU = (
    "K.-O. Papailiou, On the bending stiffness of transmission line conductors, IEEE Trans. Power "
    "Delivery 12, 1997, without growth of tension along the wire"
)
PEAK = 910.0
"""N; fronts then stop within elements, not at nodes, where they are exact."""
CYCLE = [[0.0, 0.0], [0.2, PEAK], [0.6, -PEAK], [1.0, PEAK]]
LAYERS, TENSION = 2, 120e3
"""Of the strand of helical wires, and N."""
STEPS = 60
"""Instants of a quarter of a cycle."""


def _bar(settings: Any) -> tuple[float, float]:
    """ES and mu p of a uniform bar."""
    return settings.young * settings.section, settings.friction * settings.pressure


def _end(exact: float, answer: Answer) -> KnownNumber:
    return KnownNumber("end displacement", "m", exact, float(answer.fields.displacement[-1, -1]))


def _pulled(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, bound = _bar(settings)
    yield _end(settings.path("load")[-1] ** 2 / (2.0 * stiffness * bound), answer)


def _slid(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, bound = _bar(settings)
    length, force = settings.length, settings.path("load")[-1]
    yield _end((force * length - 0.5 * bound * length**2) / stiffness, answer)


def _cycled(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, bound = _bar(settings)
    most = PEAK**2 / (2.0 * stiffness * bound)
    back = most - PEAK**2 / (4.0 * stiffness * bound)
    return _loop(settings, answer, back, 2.0 * PEAK**3 / (3.0 * stiffness * bound))


def _sprung_cycle(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    return _loop(settings, answer, *cycled_compliant_bar(PEAK, *_sprung(settings)))


def _loop(settings: Any, answer: Answer, back: float, energy: float) -> Iterator[KnownNumber]:
    """Compare where the end is when first unloaded, and what a cycle takes from the peak on."""
    load, end = settings.path("load"), answer.fields.displacement[-1]
    loaded = int(np.argmax(load))
    unloaded = loaded + int(np.argmin(np.abs(load[loaded : loaded + len(load) // 2])))
    yield KnownNumber("end displacement, unloaded", "m", back, float(end[unloaded]))
    taken = float(np.trapezoid(load[loaded:], end[loaded:]))
    yield KnownNumber("energy of a cycle", "J", energy, taken)


def _loosened(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, _ = _bar(settings)
    bound = settings.friction * settings.path("pressure_load")[-1]
    yield _end(settings.path("load")[-1] ** 2 / (2.0 * stiffness * bound), answer)


def _sprung(settings: Any) -> tuple[float, float, float, float]:
    """Length, ES, bound and density of the springs, as the closed forms take them."""
    stiffness, bound = _bar(settings)
    density = settings.contact_stiffness * stiffness / settings.length**2
    return settings.length, stiffness, bound, density


def _gave_way(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    force = float(settings.path("load")[-1])
    yield _end(pulled_compliant_bar(force, *_sprung(settings))[0], answer)


def _changed(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, bound = _bar(settings)
    law = settings.friction_ratio, settings.slip_length
    yield _end(
        pulled_changing_bar(float(settings.path("load")[-1]), stiffness, bound, *law), answer
    )


def _broke(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
    stiffness, bound = _bar(settings)
    sides, tension = 2, float(settings.path("load")[-1])
    slip = tension**2 * (sides + 1) / (2.0 * stiffness * sides**2 * bound)
    first = (settings.broken - 1) * (settings.elements + 1)
    before = first + round(settings.break_position * settings.elements)
    opening = np.diff(answer.fields.displacement[[before, before + 1], -1])[0]
    yield KnownNumber("opening of the break", "m", 2.0 * slip, float(opening))
    # Half of what is regained on the way: as strain of the element there.
    reached = round(0.5 * tension / (sides * bound) / settings.length * settings.elements)
    size = settings.length / settings.elements
    nodes = before - reached - 1 + np.arange(2)
    strain = np.diff(answer.fields.displacement[nodes, -1])[0] / size
    exact = sides * bound * (reached + 0.5) * size
    yield KnownNumber("force of the broken wire", "N", exact, float(stiffness * strain))


def _bent(share: float) -> KnownCase:
    """Bend a strand to and fro, so many times as far as where its outer layer slips first."""
    strand = BentStrand(mooring(LAYERS), 0.3, TENSION)
    peak = share * strand.layers[-1].first_slip
    changes = {
        "bending": "uniform",
        "layers": LAYERS,
        "tension": TENSION,
        "curvature": peak,
        "elements": 40,
        "instants": 5 * STEPS + 1,
    }

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        rope = structure_of(settings)
        assert isinstance(rope, Rope)
        moment = rope.moment()(answer.fields.displacement)
        yield KnownNumber(
            "moment", "N m", float(strand.moment(np.array(peak))), float(moment[STEPS])
        )
        taken = float(np.trapezoid(moment[STEPS:], rope.curvature[STEPS:]))
        yield KnownNumber("energy of a cycle, a metre", "J/m", strand.energy(peak), taken)

    title = f"strand of helical wires bent to {share:g} kappa_0"
    return KnownCase(title, PAPAILIOU, 0.01, "rope", changes, numbers)


def _pull(peak: float) -> dict[str, Any]:
    return {"load": [[0.0, 0.0], [1.0, peak]], "elements": 200, "instants": 41}


def rod_cases() -> Iterator[KnownCase]:
    """Cases, none of them solved yet."""
    yield KnownCase("bar pulled", PLAY, 1e-4, "bar", _pull(PEAK), _pulled)
    yield KnownCase("bar pulled until all slides", PLAY, 1e-9, "bar", _pull(1800.0), _slid)
    cycle = {"load": CYCLE, "elements": 200, "instants": 101}
    yield KnownCase("bar pulled to and fro", PLAY, 2e-3, "bar", cycle, _cycled)
    loosened = {
        "load": [[0.0, 0.0], [0.5, 610.0], [1.0, 610.0]],
        "pressure_load": [[0.0, 5000.0], [0.5, 5000.0], [1.0, 2500.0]],
        "elements": 200,
        "instants": 41,
    }
    yield KnownCase(
        "bar whose pressure halves while the load stands", PLAY, 1e-4, "bar", loosened, _loosened
    )
    soft = {**_pull(1200.0), "friction_law": "compliant", "contact_stiffness": 100.0}
    yield KnownCase(
        "bar on contact that gives way before it slips", JENKINS, 1e-4, "bar", soft, _gave_way
    )
    yield KnownCase(
        "bar on contact that gives way, pulled to and fro",
        f"{JENKINS}; Masing's rule",
        2e-3,
        "bar",
        {**soft, **cycle},
        _sprung_cycle,
    )
    for word, ratio in (("hardens", 1.5), ("softens", 0.5)):
        law = {"friction_law": "slip-dependent", "friction_ratio": ratio, "slip_length": 1e-3}
        yield KnownCase(
            f"bar on friction that {word} with slip",
            CHANGING,
            1e-4,
            "bar",
            {**_pull(PEAK), **law},
            _changed,
        )
    broken = {"load": [[0.0, 0.0], [1.0, 610.0]], "elements": 200, "instants": 21}
    yield KnownCase("broken wire between two others", OWN, 2e-3, "strand", broken, _broke)
    for share in (1.2, 1.5, 6.0):
        yield _bent(share)
