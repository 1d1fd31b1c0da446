"""The cross-section of a strand: where wires are, their stress and slip; quantities of a run."""

from __future__ import annotations

import math

import numpy as np
import pytest
from ropes import exact_of, settings_of, solved

from solver.discrete.rope_section import stress_ranges, wires_at
from solver.scenes import CATALOGUE, structure_of
from solver.study.finished import FinishedRun, finished_run
from solver.study.quantities import QUANTITIES, reading
from solver.study.rope_measures import OF_ROPES

PLACES = (0.0, 0.013, 0.21)
CLAMPED = {"bending": "clamp", "layers": 2, "elements": 48, "instants": 31, "length": 0.3}


def taken(name: str, run: FinishedRun) -> float:
    return float(reading(name)(run))


@pytest.mark.parametrize("place", PLACES)
def test_under_a_uniform_curvature_the_wires_of_every_section_carry_the_moment(
    place: float,
) -> None:
    """Any section has about the moment that a wire has on average along it."""
    settings = settings_of(elements=160, layers=3)
    scene, found = solved(settings)
    instant = 30
    seen = wires_at(scene, found.displacement, instant, place)
    assert len(seen.stress) == settings.section.wires == 37
    areas = np.pi * seen.diameters**2 / 4.0
    lay = np.array([0.0, *(one.lay for one in settings.section.layers)])[seen.layer + 1]
    share = seen.stress * areas * np.cos(lay)
    moment = float(np.sum(share * seen.centres[:, 1]))
    own = settings.section.slipping_bending * scene.curvature[instant]
    whole = float(scene.moment()(found.displacement)[instant])
    assert moment + own == pytest.approx(whole, rel=0.02)
    assert float(np.sum(share)) == pytest.approx(settings.tension, rel=1e-6)
    assert float(np.sum(share * seen.centres[:, 0])) == pytest.approx(0.0, abs=0.02 * abs(whole))


def test_near_a_clamp_each_wire_is_seen_where_it_is() -> None:
    scene, found = solved(settings_of(**CLAMPED))
    seen = wires_at(scene, found.displacement, 20, 0.1)
    size = scene.elements + 1
    for place, wire in enumerate(scene.wires):
        angle = float(wire.helix.angle(np.array(0.1 / np.cos(wire.helix.lay))))
        radius = wire.helix.radius
        centre = radius * np.array([np.sin(angle), np.cos(angle)])
        np.testing.assert_allclose(seen.centres[1 + place], centre, atol=1e-12)
        own = found.displacement[place * size : (place + 1) * size, 20]
        at = np.interp(0.1, wire.along, own)
        assert seen.slip[1 + place] == pytest.approx(at, abs=1e-15)
    assert (seen.layer[0], seen.slip[0]) == (-1, 0.0)


def test_no_wires_of_a_section_overlap() -> None:
    scene, found = solved(settings_of(**CLAMPED))
    for place in (0.0, 0.07, 0.29):
        seen = wires_at(scene, found.displacement, 0, place)
        apart = np.linalg.norm(seen.centres[:, None] - seen.centres, axis=-1)
        needed = 0.5 * (seen.diameters[:, None] + seen.diameters)
        np.fill_diagonal(apart, np.inf)
        assert (apart / needed).min() > 0.97


def test_while_all_sticks_the_stress_range_is_that_of_a_bar() -> None:
    settings = settings_of(curvature=0.005, layers=1, instants=21)
    scene, found = solved(settings)
    helix, layer = settings.section.helix(0), settings.section.layers[0]
    stretch = helix.radius * np.cos(helix.lay) ** 2 + 0.5 * layer.diameter
    expected = 2.0 * 0.005 * layer.young * stretch
    ranges = stress_ranges(scene, found.displacement, slice(None))
    assert ranges == pytest.approx([expected], rel=2e-3)


def test_slip_relieves_the_stress() -> None:
    loose, tight = (settings_of(friction=mu, layers=1) for mu in (0.02, 1e3))
    smaller, larger = (
        stress_ranges(*(one[0], one[1].displacement), slice(None)).max()
        for one in (solved(loose), solved(tight))
    )
    assert smaller < 0.7 * larger


def test_energy_stiffness_and_slip_are_those_of_the_closed_form() -> None:
    settings = settings_of(curvature=0.1, instants=201, elements=80, layers=1, cycles=2)
    run, exact = finished_run(settings, errors=False), exact_of(settings)
    energy = exact.energy(0.1)
    assert reading("energy_per_metre@2")(run) == pytest.approx(energy, rel=0.01)
    secant = float(exact.moment(np.array(0.1))) / 0.1
    assert taken("bending_stiffness", run) == pytest.approx(secant, rel=0.005)
    assert taken("slipping_bending", run) < secant < taken("stuck_bending", run)
    # All slips, so that friction's bound times the slip of a point is what it takes of a metre.
    work, slip = taken("wire_work", run), taken("wire_slip", run)
    assert work == pytest.approx(2.0 * exact.layers[0].bound * slip, rel=1e-6)


def test_near_a_clamp_slip_and_friction_work_are_beside_it() -> None:
    settings = settings_of(**CLAMPED)
    run = finished_run(settings, errors=False)
    assert math.isnan(taken("energy_per_metre", run))
    for name in ("wire_slip", "wire_work", "stress_range", "bending_stiffness"):
        assert taken(name, run) > 0.0
    scene = structure_of(settings)
    swing = np.ptp(run.iterate.displacement, axis=1).reshape(-1, settings.elements + 1)
    most = int(swing.max(axis=0).argmax())
    assert run.problem.positions[most] < 0.25 * scene.described().length


def test_only_ropes_are_asked_for_what_ropes_have() -> None:
    bar = CATALOGUE["bar"].settings.checked({"elements": 10, "instants": 11, "substructures": 2})
    run = finished_run(bar, errors=False)
    for one in OF_ROPES:
        assert not one.applies(bar)
        assert math.isnan(taken(one.name, run))
        assert QUANTITIES[one.name] is one
