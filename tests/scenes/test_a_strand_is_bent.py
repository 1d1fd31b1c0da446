"""A strand of helical wires is rods on supports of their own, as closed forms say."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from ropes import exact_of, moment_of, settings_of, solved

from solver import discrete, solve
from solver.arrays import Array
from solver.discrete.rope.cross_section import (
    CONSTRUCTIONS,
    CrossSection,
    WireLayer,
    seven_wire,
)
from solver.discrete.rope.rope import Rope
from solver.discrete.rope.wire_forces import (
    CutWires,
    cut_at,
    stress_at,
    stress_ranges,
    wire_stresses,
)
from solver.files.results import result_arrays
from solver.latin import Auto, Latin, Stop
from solver.reference.closed_forms.bent_strand import BentWire
from solver.reference.contact import IncrementalContact
from solver.reference.incremental import (
    IncrementalRod,
    incremental_solver,
    reference_of,
)
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.study.quantities import reading
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

CLAMPED: dict[str, Any] = {
    "bending": "clamp",
    "layers": 2,
    "elements": 24,
    "instants": 31,
}
CHANGING: dict[str, Any] = {**CLAMPED, "tension_load": "shaken"}


@pytest.mark.parametrize("construction", CONSTRUCTIONS)
def test_first_bending_meets_the_closed_form(construction: str) -> None:
    most = {"mooring": 0.3, "seven-wire": 0.1, "conductor": 0.2}[construction]
    settings = settings_of(construction=construction, load="ramp", curvature=most)
    scene, found = solved(settings)
    exact = exact_of(settings).moment(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * exact[-1]
    assert found.status.any()


@pytest.mark.parametrize("load", ["cycle", "random", "decaying"])
def test_a_strand_follows_masings_rule_along_any_path(load: str) -> None:
    settings = settings_of(load=load, curvature=0.12, instants=301, elements=80, seed=4)
    scene, found = solved(settings)
    exact = exact_of(settings).along(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * np.abs(exact).max()


def test_a_strand_that_sticks_is_stiff_as_one_body_and_slips_as_loose_wires() -> None:
    settings = settings_of(load="ramp", curvature=1.0, instants=401)
    scene, found = solved(settings)
    slopes = np.diff(moment_of(scene, found)) / np.diff(scene.curvature)
    section = settings.section
    assert slopes[0] == pytest.approx(section.stuck_bending, rel=2e-3)
    assert slopes[-1] == pytest.approx(section.slipping_bending, rel=1e-9)
    assert section.stuck_bending > 20.0 * section.slipping_bending


def test_a_strand_that_is_turned_by_a_wire_is_the_same_strand() -> None:
    scene = settings_of(**{**CLAMPED, "layers": 1}).structure()
    turn = 2.0 * np.pi / len(scene.wires)
    wires = [replace(wire, start=wire.start + turn) for wire in scene.wires]
    turned = replace(scene, wires=wires)
    moments = [
        moment_of(one, reference_of(discrete.discretise(one)))
        for one in (scene, turned)
    ]
    np.testing.assert_allclose(*moments, rtol=1e-9, atol=1e-9)


def test_outer_layers_press_on_what_is_below_them() -> None:
    """All wires press on the core, metre by metre of strand, and nothing on it."""
    section = CONSTRUCTIONS["mooring"](4)
    tension = np.array([2e5])
    below, above = section.line_pressures(tension)
    per_metre = np.array([one.wires / np.cos(one.lay) for one in section.layers])
    for inner, outer in pairwise(range(4)):
        assert per_metre[inner] * above[inner] == pytest.approx(
            per_metre[outer] * below[outer]
        )
    assert above[-1] == 0.0
    own = [
        per_metre[number]
        * section.wire_tension(number, tension)
        * np.sin(layer.lay) ** 2
        / section.radii[number]
        for number, layer in enumerate(section.layers)
    ]
    assert per_metre[0] * below[0] == pytest.approx(sum(own))


@pytest.mark.parametrize("construction", CONSTRUCTIONS)
def test_wires_carry_the_tension_and_lie_beside_each_other(construction: str) -> None:
    section = CONSTRUCTIONS[construction](5)
    tension = np.array([1e5])
    core = section.core.stiffness / section.stiffness * tension
    carried = core + sum(
        layer.wires * np.cos(layer.lay) * section.wire_tension(number, tension)
        for number, layer in enumerate(section.layers)
    )
    assert carried == pytest.approx(tension)
    for layer, radius in zip(section.layers, section.radii, strict=True):
        room = 2.0 * np.pi * radius * np.cos(layer.lay)
        assert layer.wires * layer.diameter <= 1.005 * room


@pytest.mark.parametrize("changes", [CLAMPED, CHANGING, {"load": "random"}])
def test_by_itself_latin_tends_to_the_reference(changes: dict[str, Any]) -> None:
    settings = settings_of(**changes)
    problem = discretise(settings)
    method = Latin(
        direction=Auto(), finish=None, stop=Stop(accuracy=1e-4, iterations=3000)
    )
    found = solve(problem, method, watch=False).iterate
    exact = reference_of(problem)
    scale = np.abs(exact.contact_force).max()
    assert np.abs(found.contact_force - exact.contact_force).max() < 0.02 * scale


def test_many_supports_of_known_bound_are_solved_as_rods_with_every_wire() -> None:
    settings = settings_of(**CLAMPED)
    problem = discretise(settings)
    assert isinstance(incremental_solver(problem), IncrementalRod)
    general = IncrementalContact(
        discretise(settings_of(**{**CLAMPED, "layers": 1}))
    ).march()
    special = reference_of(general.problem)
    np.testing.assert_array_equal(general.status, special.status)
    np.testing.assert_allclose(general.displacement, special.displacement, atol=1e-12)
    arrays = result_arrays(settings, solve(problem, method_of(settings), watch=False))
    shape = (settings.elements - 1, settings.instants)
    for wire in settings.structure().wires:
        assert arrays[f"interface/{wire.name}/slip"].shape == shape
    assert arrays["status"].shape == (len(problem.contacts) * shape[0], shape[1])


def test_bad_strands_are_refused() -> None:
    section = seven_wire()
    with pytest.raises(RefusedError, match="lay angle"):
        CrossSection(section.core, (WireLayer(6, 5e-3, 2e11),))
    with pytest.raises(RefusedError, match="row 1 is the core"):
        CrossSection(section.layers[0], section.layers)
    with pytest.raises(RefusedError, match="less than 90°"):
        CrossSection(section.core, (WireLayer(6, 5e-3, 2e11, 1.6),))
    with pytest.raises(RefusedError, match="one wire or more"):
        CrossSection(section.core, (WireLayer(0, 5e-3, 2e11, 0.3),))
    scene = settings_of(**CLAMPED).structure()
    short = replace(scene.wires[0], curvature=scene.wires[0].curvature[1:])
    with pytest.raises(RefusedError, match=r"curvature = of shape .* shape \[25, 31\]"):
        discrete.discretise(replace(scene, wires=[scene.wires[0], short]))
    with pytest.raises(RefusedError, match="strength = -1"):
        discrete.discretise(
            replace(scene, wires=[replace(scene.wires[0], strength=-1.0)])
        )


def taken(name: str, run: FinishedRun) -> float:
    return float(reading(name)(run))


def section_of(
    scene: Rope, displacement: Array, instant: int, place: float
) -> tuple[CutWires, Array]:
    cut = cut_at(scene, place)
    stress = wire_stresses(scene, displacement, slice(instant, instant + 1))
    return cut, stress_at(scene, cut, stress)[:, 0]


def test_under_a_uniform_curvature_the_wires_of_a_section_carry_the_moment() -> None:
    """Any section has about the moment that a wire has on average along it."""
    settings = settings_of(elements=160, layers=3)
    scene, found = solved(settings)
    cut, stress = section_of(scene, found.displacement, 30, 0.013)
    section = settings.section
    assert len(stress) == section.wires - 1 == 36
    layers = [scene.wires[number].layer_data for number in cut.wire]
    share = stress * [layer.area * np.cos(layer.lay) for layer in layers]
    across, moment = share @ cut.centres
    own = section.slipping_bending * scene.curvature[30]
    whole = float(scene.moment()(found.displacement)[30])
    assert moment + own == pytest.approx(whole, rel=0.02)
    of_wires = 1.0 - section.core.stiffness / section.stiffness
    assert share.sum() == pytest.approx(settings.tension * of_wires, rel=1e-6)
    assert across == pytest.approx(0.0, abs=0.02 * abs(whole))


def test_while_all_sticks_the_stress_range_is_that_of_a_bar() -> None:
    settings = settings_of(curvature=0.005, layers=1, instants=21)
    scene, found = solved(settings)
    layer = settings.section.layers[0]
    (radius,) = settings.section.radii
    stretch = radius * np.cos(layer.lay) ** 2 + 0.5 * layer.diameter
    expected = 2.0 * 0.005 * layer.young * stretch
    ranges = stress_ranges(scene, found.displacement, slice(None))
    assert ranges == pytest.approx([expected], rel=2e-3)


def test_energy_stiffness_and_slip_are_those_of_the_closed_form() -> None:
    settings = settings_of(curvature=0.1, instants=201, elements=80, layers=1, cycles=2)
    run = finished_run(settings, errors=False)
    exact = exact_of(settings)
    path = 0.1 * np.cos(np.linspace(0.0, 4.0 * np.pi, 801))
    energy = abs(float(np.trapezoid(exact.along(path)[400:], path[400:])))
    assert reading("energy_per_metre@2")(run) == pytest.approx(energy, rel=0.01)
    # One wire stands for all of its layer: what is taken is that of the strand that is
    # drawn.
    drawn = settings.structure().description().length
    assert reading("dissipation@2")(run) == pytest.approx(energy * drawn, rel=0.01)
    of_one = np.abs(run.iterate.contact("wire 1.1").tangential_force).sum(axis=0).max()
    assert taken("peak_friction", run) == pytest.approx(6.0 * 2.0 * of_one, rel=1e-9)
    secant = float(exact.moment(np.array(0.1))) / 0.1
    assert taken("bending_stiffness", run) == pytest.approx(secant, rel=0.005)
    assert taken("slipping_bending", run) < secant < taken("stuck_bending", run)
    # All slips, so that friction's bound times the slip of a point is what it takes of
    # a metre.
    work = taken("wire_work", run)
    slip = taken("wire_slip", run)
    assert work == pytest.approx(2.0 * exact.layers[0].strength * slip, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "is_told"),
    [
        ({}, True),
        ({"friction_law": "general", "cohesion": 1e3}, True),
        ({"friction_law": "compliant", "contact_stiffness": 1.0}, False),
        ({"friction_law": "general", "tangential_stiffness": 1e8}, False),
    ],
)
def test_the_stiffness_while_nothing_slips_is_told_of_rigid_contacts_alone(
    law: dict[str, Any], is_told: bool
) -> None:
    """A strand whose wires gave way was said to be eight times as stiff as it was."""
    settings = settings_of(curvature=1e-5, load="ramp", layers=2, instants=3, **law)
    run = finished_run(settings, errors=False)
    assert taken("dissipation", run) == 0.0
    stiffness = taken("stuck_bending", run)
    assert np.isfinite(stiffness) == is_told
    if is_told:
        assert taken("bending_stiffness", run) == pytest.approx(stiffness, rel=0.01)


def test_a_wire_that_stands_for_its_layer_counts_as_often_in_all_shares() -> None:
    """A metre of strand has 1 / cos(lay) of each wire; each layer was one wire."""
    settings = settings_of(
        construction="conductor", load="cycle", curvature=0.02, tension=3e4, instants=21
    )
    run = finished_run(settings, errors=False)
    section = settings.section
    lengths = np.array([layer.wires / np.cos(layer.lay) for layer in section.layers])
    lengths /= lengths.sum()
    statuses = [run.iterate.contact(name).status for name in run.problem.contacts]
    largest = int(np.argmax(np.abs(run.force)))
    stuck = [float(np.mean(status[:, largest] == 0)) for status in statuses]
    assert taken("stuck_share", run) == pytest.approx(lengths @ stuck, rel=1e-9)
    assert taken("stuck_share", run) != pytest.approx(np.mean(stuck), rel=0.05)
    # Half a turn of each wire has as many points: a metre of strand has more of those
    # of small wires with a short lay.
    turns = [wire.stands_for / wire.along[-1] for wire in settings.structure().wires]
    slipped = [float(np.any(np.abs(status) == 1, axis=1).mean()) for status in statuses]
    counted = np.average(slipped, weights=turns)
    assert taken("slipped_share", run) == pytest.approx(counted, rel=1e-9)


WIRE = WireLayer(6, diameter=3e-3, young=2e11, lay=np.radians(12.0))
BENT = BentWire(WIRE, radius=4e-3, strength=3000.0)


def test_a_strand_converges_with_order_two() -> None:
    off = []
    for elements in (20, 40, 80, 160):
        settings = settings_of(
            load="ramp", curvature=0.1, layers=1, elements=elements, instants=15
        )
        scene, found = solved(settings)
        exact = exact_of(settings).moment(scene.curvature)
        off.append(np.abs(moment_of(scene, found) - exact).max())
    orders = np.log2(np.array(off[:-1]) / np.array(off[1:]))
    assert np.mean(orders) == pytest.approx(2.0, abs=0.3)


def test_the_closed_form_has_its_landmarks() -> None:
    step = 1e-6 * BENT.first_slip
    stuck = WIRE.stiffness * BENT.radius**2 * np.cos(WIRE.lay) ** 3 / 2.0
    kappas = np.array([0.3, 0.9, 1.0, 1.0 + 1e-9, 0.5 * np.pi, 3.0]) * BENT.first_slip
    *elastic, first, after, full, beyond = BENT.moment(kappas)
    assert elastic == pytest.approx(kappas[:2] * stuck, rel=1e-12)
    assert after == pytest.approx(first, rel=1e-6)
    assert full == beyond == pytest.approx(4.0 / np.pi * first, rel=1e-9)
    slope = np.diff(
        BENT.moment(np.array([1.2 * BENT.first_slip, 1.2 * BENT.first_slip + step]))
    )
    assert 0.0 < slope[0] / step < stuck
