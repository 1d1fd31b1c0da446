"""A strand of helical wires is rods on supports of their own, held to the closed form."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from ropes import exact_of, moment_of, settings_of, solved

from solver import Rods, solve
from solver.definitions import SettingError
from solver.discrete.rope.cross_section import CrossSection, WireLayer
from solver.discrete.rope.rope import Rope
from solver.files import result_arrays
from solver.latin import Auto, Latin, Stop
from solver.reference.choice import incremental_solver, reference_of
from solver.reference.contact import IncrementalContact
from solver.reference.incremental import IncrementalRod, incremental
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.constructions import CONSTRUCTIONS, seven_wire
from solver.scenes.method import method_of
from solver.scenes.rope import rope

CLAMPED: dict[str, Any] = {"bending": "clamp", "layers": 2, "elements": 24, "instants": 31}
CHANGING: dict[str, Any] = {**CLAMPED, "tension_load": "shaken"}


@pytest.mark.parametrize("construction", CONSTRUCTIONS)
def test_first_bending_meets_the_closed_form(construction: str) -> None:
    most = {"mooring": 0.3, "seven-wire": 0.1, "conductor": 0.2}[construction]
    settings = settings_of(construction=construction, load="ramp", curvature=most)
    scene, found = solved(settings)
    exact = exact_of(settings).moment(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * exact[-1]
    assert found.status.any()


@pytest.mark.parametrize("curvature", [0.02, 0.1, 0.25])
def test_a_cycle_loses_the_energy_of_masings_rule(curvature: float) -> None:
    settings = settings_of(curvature=curvature, instants=301)
    scene, found = solved(settings)
    moment, last = moment_of(scene, found), slice(60, None)
    loop = abs(float(np.trapezoid(moment[last], scene.curvature[last])))
    assert loop == pytest.approx(exact_of(settings).energy(curvature), rel=0.01)


@pytest.mark.parametrize("load", ["cycle", "random", "decaying"])
def test_along_any_path_it_follows_masings_rule_with_memory(load: str) -> None:
    settings = settings_of(load=load, curvature=0.12, instants=301, elements=80, seed=4)
    scene, found = solved(settings)
    exact = exact_of(settings).along(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * np.abs(exact).max()


def test_while_all_sticks_it_is_as_stiff_as_one_body_and_once_all_slips_as_loose_wires() -> None:
    settings = settings_of(load="ramp", curvature=1.0, instants=401)
    scene, found = solved(settings)
    slopes = np.diff(moment_of(scene, found)) / np.diff(scene.curvature)
    section = settings.section
    assert slopes[0] == pytest.approx(section.stuck_bending, rel=2e-3)
    assert slopes[-1] == pytest.approx(section.slipping_bending, rel=1e-9)
    assert section.stuck_bending > 20.0 * section.slipping_bending


def test_the_order_of_the_wires_means_nothing() -> None:
    scene = rope(settings_of(**CHANGING))
    order = np.random.default_rng(3).permutation(len(scene.wires))
    other = replace(scene, wires=[scene.wires[place] for place in order])
    one, two = (incremental(each.discretise()) for each in (scene, other))
    np.testing.assert_allclose(moment_of(scene, one), moment_of(other, two), rtol=1e-12, atol=1e-9)
    for name in one.problem.rubbing:
        mine, theirs = one.contact(name), two.contact(name)
        np.testing.assert_array_equal(mine.status, theirs.status)
        np.testing.assert_allclose(mine.slip, theirs.slip, atol=1e-15)
        np.testing.assert_allclose(mine.tangential_force, theirs.tangential_force, atol=1e-6)


def test_a_strand_that_is_turned_by_a_wire_is_the_same_strand() -> None:
    scene = rope(settings_of(**{**CLAMPED, "layers": 1}))
    turn = 2.0 * np.pi / len(scene.wires)
    wires = [
        replace(wire, helix=replace(wire.helix, start=wire.helix.start + turn))
        for wire in scene.wires
    ]
    turned = replace(scene, wires=wires)
    moments = [moment_of(one, incremental(one.discretise())) for one in (scene, turned)]
    np.testing.assert_allclose(*moments, rtol=1e-9, atol=1e-9)


def test_layers_may_be_laid_either_way_round() -> None:
    scene = rope(settings_of(**CLAMPED))
    wires = [replace(wire, helix=replace(wire.helix, lay=-wire.helix.lay)) for wire in scene.wires]
    mirrored = replace(scene, wires=wires)
    moments = [moment_of(one, incremental(one.discretise())) for one in (scene, mirrored)]
    np.testing.assert_allclose(*moments, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("changes", [CLAMPED, CHANGING])
def test_a_wire_of_it_is_a_bar_alone_under_its_body_force(changes: dict[str, Any]) -> None:
    scene = rope(settings_of(**changes))
    found = incremental(scene.discretise())
    size = scene.elements + 1
    for place in (0, 5, 13):
        wire = scene.wires[place]
        bound = np.broadcast_to(np.atleast_1d(wire.bound), (size, len(wire.bound)))
        bar = Rods(
            length=wire.length,
            stiffness=wire.helix.stiffness,
            elements=scene.elements,
            substructures=1,
            bound=bound[:, 0] if bound.shape[1] == 1 else bound,
            load=np.zeros(len(scene.instants)),
            instants=scene.instants,
            duration=scene.duration,
            rigid_grip=True,
            body_force=wire.helix.body_force(wire.arc, wire.curvature),
        )
        alone = incremental(bar.discretise())
        own = found.displacement[place * size : (place + 1) * size]
        largest = np.abs(alone.displacement).max()
        np.testing.assert_allclose(own, alone.displacement, atol=1e-9 * largest)
        np.testing.assert_array_equal(found.contact(wire.name).status, alone.status[1:-1])


def test_a_wire_is_in_equilibrium() -> None:
    """What its force changes by from end to end, friction has taken up."""
    scene = rope(settings_of(**CHANGING))
    found = incremental(scene.discretise())
    size = scene.elements + 1
    for place, wire in enumerate(scene.wires):
        slip = found.displacement[place * size : (place + 1) * size]
        force = wire.helix.force(wire.arc, slip, wire.curvature)
        friction = found.contact(wire.name).tangential_force
        np.testing.assert_allclose(np.diff(force, axis=0), -friction, atol=1e-7 * np.ptp(force))


def test_all_forces_grow_with_tension_and_curvature() -> None:
    one, other = (
        settings_of(**CLAMPED, fall_off=0.2, tension=1e5 * c, curvature=0.05 * c)
        for c in (1.0, 3.0)
    )
    (scene, small), (_, large) = solved(one), solved(other)
    np.testing.assert_array_equal(small.status, large.status)
    np.testing.assert_allclose(3.0 * small.displacement, large.displacement, atol=1e-14)
    np.testing.assert_allclose(3.0 * small.contact_force, large.contact_force, rtol=1e-7, atol=1e-5)
    assert small.status.any()
    assert len(small.displacement) == len(scene.wires) * (scene.elements + 1)


def test_outer_layers_press_on_what_is_below_them() -> None:
    """All that is laid presses on the core, metre by metre of strand, and nothing on it."""
    section, tension = CONSTRUCTIONS["mooring"](4), np.array([2e5])
    below, above = section.line_pressures(tension)
    per_metre = np.array([one.wires / np.cos(one.lay) for one in section.layers])
    for inner, outer in pairwise(range(4)):
        assert per_metre[inner] * above[inner] == pytest.approx(per_metre[outer] * below[outer])
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


def test_a_strand_of_prestressing_steel_has_the_area_of_its_standard() -> None:
    section = seven_wire()
    area = section.core.area + 6 * section.layers[0].area
    assert area == pytest.approx(150e-6, rel=0.01)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"bending": "uniform"},
        {"substructures": 4},
        {"tension_load": "loosening"},
        {"construction": "conductor", "tension": 28e3},
        {"cycles": 3},
        {"linear_stage": "pgd", "bending": "uniform", "substructures": 4},
    ],
)
def test_latin_certifies_it(changes: dict[str, Any]) -> None:
    settings = settings_of(**{**CLAMPED, **changes})
    solution = solve(discretise(settings), method_of(settings))
    assert solution.is_certified
    assert solution.iterate.residual < 1e-9


@pytest.mark.parametrize("changes", [CLAMPED, CHANGING, {"load": "random"}])
def test_by_itself_latin_tends_to_the_reference(changes: dict[str, Any]) -> None:
    settings = settings_of(**changes)
    problem = discretise(settings)
    method = Latin(direction=Auto(), finish=None, stop=Stop(accuracy=1e-4, iterations=3000))
    found, exact = solve(problem, method).iterate, incremental(problem)
    scale = np.abs(exact.contact_force).max()
    assert np.abs(found.contact_force - exact.contact_force).max() < 0.02 * scale


@pytest.mark.parametrize(
    "law",
    [
        {"friction_law": "compliant"},
        {"friction_law": "slip-dependent", "slip_length": 1e-5},
        {"friction_law": "slip-dependent", "friction_ratio": 0.7, "slip_length": 1e-4},
    ],
)
def test_it_takes_every_law_of_friction(law: dict[str, Any]) -> None:
    settings = settings_of(**{**CLAMPED, "layers": 1}, **law)
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    exact = reference_of(problem)
    assert exact.converged.all()
    scale = np.abs(exact.contact_force).max()
    assert np.abs(solution.iterate.contact_force - exact.contact_force).max() < 0.03 * scale


def test_many_supports_of_known_bound_are_solved_as_rods_and_their_result_has_every_wire() -> None:
    settings = settings_of(**CLAMPED)
    problem = discretise(settings)
    assert isinstance(incremental_solver(problem), IncrementalRod)
    general = IncrementalContact(discretise(settings_of(**{**CLAMPED, "layers": 1}))).march()
    special = incremental(general.problem)
    np.testing.assert_array_equal(general.status, special.status)
    np.testing.assert_allclose(general.displacement, special.displacement, atol=1e-12)
    arrays = result_arrays(settings, solve(problem, method_of(settings)))
    shape = (settings.elements - 1, settings.instants)
    for wire in rope(settings).wires:
        assert arrays[f"interface/{wire.name}/slip"].shape == shape
    assert arrays["status"].shape == (len(problem.rubbing) * shape[0], shape[1])


@pytest.mark.parametrize(("construction", "kinds"), [("mooring", 1), ("conductor", 3)])
def test_wires_that_are_alike_share_their_operator(construction: str, kinds: int) -> None:
    """The wires of a mooring strand are alike in all layers, those of a conductor in none."""
    settings = settings_of(**{**CLAMPED, "substructures": 3, "construction": construction})
    problem = discretise(settings)
    operators = {id(part.elasticity) for part in problem.substructures}
    assert len(problem.substructures) == 3 * settings.n_wires
    assert len(operators) == 3 * kinds


def test_without_friction_only_the_wires_themselves_are_bent() -> None:
    settings = settings_of(friction=0.0, curvature=0.2)
    scene, found = solved(settings)
    own = settings.section.slipping_bending * scene.curvature
    np.testing.assert_allclose(moment_of(scene, found), own, atol=1e-6 * own.max())


def test_what_is_no_strand_is_refused() -> None:
    section = seven_wire()
    with pytest.raises(RefusedError, match="lay angle"):
        CrossSection(section.core, (WireLayer(6, 5e-3, 2e11),))
    with pytest.raises(RefusedError, match="one straight wire"):
        CrossSection(section.layers[0], section.layers)
    with pytest.raises(RefusedError, match="pi / 2"):
        WireLayer(6, 5e-3, 2e11, 1.6)
    with pytest.raises(RefusedError, match="at least one wire"):
        WireLayer(0, 5e-3, 2e11, 0.3)
    scene = rope(settings_of(**CLAMPED))
    short = replace(scene.wires[0], curvature=scene.wires[0].curvature[1:])
    with pytest.raises(RefusedError, match="same number of nodes"):
        replace(scene, wires=[short, *scene.wires[1:]])
    with pytest.raises(RefusedError, match="below zero"):
        replace(scene, wires=[replace(scene.wires[0], bound=np.array([-1.0]))])


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"tension_load": [[0.0, 1e5], [1.0, -1e5]]}, "tension_load"),
        ({"bending": "clamp", "tension": 0.0}, "fall_off"),
    ],
)
def test_settings_that_cannot_be_are_refused(changes: dict[str, Any], name: str) -> None:
    with pytest.raises(SettingError, match=name):
        settings_of(**changes)


def test_a_coarser_strand_is_bent_alike() -> None:
    scene = rope(settings_of(**CLAMPED))
    coarse = scene.coarser()
    assert isinstance(coarse, Rope)
    for one, other in zip(scene.wires, coarse.wires, strict=True):
        np.testing.assert_allclose(one.curvature[::2], other.curvature, rtol=1e-12)
    assert coarse.coarser() is None or coarse.elements >= 12


def test_the_sentence_says_how_many_wires_there_are() -> None:
    said = CATALOGUE["rope"].words
    assert "37 wires" in said(settings_of(layers=3))
    assert "seven wires" in said(settings_of(construction="seven-wire"))
    assert "clamp" in said(settings_of(**CLAMPED))
