"""The cross-section of a strand: where wires are, their stress and slip; quantities of a run."""

from __future__ import annotations

import numpy as np
import pytest
from ropes import exact_of, settings_of, solved

from solver.arrays import Array
from solver.discrete.rope.forces import CutWires, WireForces, cut_at, stress_ranges
from solver.discrete.rope.rope import Rope
from solver.study.quantities.finished import FinishedRun, finished_run
from solver.study.quantities.quantities import reading

CLAMPED = {"bending": "clamp", "layers": 2, "elements": 48, "instants": 31, "length": 0.3}


def taken(name: str, run: FinishedRun) -> float:
    return float(reading(name)(run))


def section_of(
    scene: Rope, displacement: Array, instant: int, place: float
) -> tuple[CutWires, Array]:
    cut, forces = cut_at(scene, place), WireForces(scene)
    return cut, forces.stress_at(cut, forces(displacement, slice(instant, instant + 1)))[:, 0]


def test_under_a_uniform_curvature_the_wires_of_a_section_carry_the_moment() -> None:
    """Any section has about the moment that a wire has on average along it."""
    settings = settings_of(elements=160, layers=3)
    scene, found = solved(settings)
    instant = 30
    cut, stress = section_of(scene, found.displacement, instant, 0.013)
    section = settings.section
    assert len(stress) == section.wires - 1 == 36
    areas, lay = (
        np.array([getattr(one, name) for one in section.layers])[cut.layer]
        for name in ("area", "lay")
    )
    share = stress * areas * np.cos(lay)
    moment = float(np.sum(share * cut.centres[:, 1]))
    own = section.slipping_bending * scene.curvature[instant]
    whole = float(scene.moment()(found.displacement)[instant])
    assert moment + own == pytest.approx(whole, rel=0.02)
    core = settings.tension * section.core.stiffness / section.stiffness
    assert float(np.sum(share)) + core == pytest.approx(settings.tension, rel=1e-6)
    assert float(np.sum(share * cut.centres[:, 0])) == pytest.approx(0.0, abs=0.02 * abs(whole))


def test_near_a_clamp_each_wire_is_seen_where_it_is() -> None:
    scene, found = solved(settings_of(**CLAMPED))
    element = 16
    place = (element + 0.5) * scene.wires[0].along[1]
    cut, stress = section_of(scene, found.displacement, 20, place)
    assert cut.wire.tolist() == list(range(len(scene.wires)))
    forces = WireForces(scene)(found.displacement, slice(20, 21))
    for wire, centre, arc, force, own in zip(
        scene.wires, cut.centres, cut.arc, forces, stress, strict=True
    ):
        assert arc == pytest.approx(place / np.cos(wire.helix.lay))
        angle = float(wire.helix.angle(np.array(arc)))
        expected = wire.helix.radius * np.array([np.sin(angle), np.cos(angle)])
        np.testing.assert_allclose(centre, expected, atol=1e-12)
        assert own == pytest.approx(float(force[element, 0]) / wire.area)


def test_while_all_sticks_the_stress_range_is_that_of_a_bar() -> None:
    settings = settings_of(curvature=0.005, layers=1, instants=21)
    scene, found = solved(settings)
    helix, layer = settings.section.helix(0), settings.section.layers[0]
    stretch = helix.radius * np.cos(helix.lay) ** 2 + 0.5 * layer.diameter
    expected = 2.0 * 0.005 * layer.young * stretch
    ranges = stress_ranges(scene, found.displacement, slice(None))
    assert ranges == pytest.approx([expected], rel=2e-3)


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
