"""The general friction law, and mu by place (MATHEMATICS.md, 8 and 14)."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import assert_names, refusal
from small_scenes import KINDS, SMALL

from solver.files.amounts import unit_of
from solver.files.saved import settings_from_command
from solver.latin import solve
from solver.laws import FrictionLaw
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.definitions import properties_of
from solver.study.quantities.cycle_measures import has_a_limit

GENERAL = {"friction_law": "general"}
PLANE = ["block", "layers", "incline", "fault"]
PEAK = ((0.0, 1.0), (1e-5, 1.3), (1e-4, 0.5))


def chosen(scene, **values):
    return CATALOGUE[scene].checked(SMALL[scene] | values)


def run(scene, **values):
    settings = chosen(scene, **values)
    problem = discretise(settings)
    return solve(
        problem,
        method_of(settings),
        distance=distance_to(reference_of(problem), problem),
    )


@pytest.mark.parametrize("scene", list(SMALL))
def test_the_default_friction_law_is_coulombs(scene):
    assert chosen(scene, **GENERAL).law == FrictionLaw()


@pytest.mark.parametrize("scene", KINDS)
def test_a_stiffness_alone_is_the_compliant_law_of_the_same_stiffness(scene):
    compliant = chosen(scene, friction_law="compliant", contact_stiffness=30.0)
    absolute = 30.0 * compliant.contact_unit
    general = chosen(scene, **GENERAL, tangential_stiffness=absolute)
    forces = [
        solve(discretise(one), method_of(one), watch=False).iterate.friction_force
        for one in (compliant, general)
    ]
    np.testing.assert_allclose(*forces, atol=1e-9 * np.abs(forces[0]).max())


@pytest.mark.parametrize("scene", ["bar", "block", "layers", "fault"])
def test_two_points_of_strength_are_friction_that_changes_with_slip(scene):
    ratio = {"friction_ratio": 0.8, "slip_length": 2e-4}
    before, *after = (
        solve(discretise(one), method_of(one), watch=False).iterate.friction_force
        for one in (
            chosen(scene, friction_law="slip-dependent", **ratio),
            chosen(scene, **GENERAL, **ratio, strength="linear"),
            chosen(scene, **GENERAL, strength=[[0.0, 1.0], [2e-4, 0.8]]),
        )
    )
    for force in after:
        np.testing.assert_array_equal(force, before)


def test_cohesion_alone_holds_its_length_and_slips_beyond():
    given = {
        "gap": "flat",
        "friction": 0.0,
        "cohesion": 2e6,
        "poisson": 0.0,
        "plane": "stress",
        "top_normal_displacement": -1e-5,
        "top_tangential_displacement": 4e-5,
    }
    result = run("block", **GENERAL, **given, top_tangential_load="ramp")
    assert result.is_certified
    carried = -result.iterate.contact("support").tangential_force.sum(axis=0)
    assert carried[-1] == pytest.approx(2e6 * 0.1, rel=1e-9)


def test_a_block_is_refused_what_cohesion_and_cap_cannot_hold_and_only_that():
    pressed = {
        "gap": "flat",
        "top": "traction",
        "top_normal_traction": -1e6,
        "friction": 0.0,
        "top_tangential_traction": 2e5,
    }
    assert "no friction" not in refusal(lambda: chosen("block", **pressed))
    assert run("block", **pressed, **GENERAL, cohesion=2.1e5).is_certified
    for values in ({"cohesion": 1.9e5}, {"cohesion": 1e6, "friction_cap": 1.9e5}):
        text = refusal(
            lambda values=values: chosen("block", **pressed, **GENERAL, **values)
        )
        assert "friction cannot hold it" in text


def test_a_broken_wire_is_held_by_cohesion_too():
    pulled = {"peak": 2000.0, "friction": 0.0, **GENERAL}
    assert "tensions below 0 N" in refusal(lambda: chosen("strand", **pulled))
    assert run("strand", **pulled, cohesion=3000.0).is_certified
    text = refusal(
        lambda: chosen("strand", **pulled, cohesion=3000.0, friction_cap=1000.0)
    )
    assert "tensions below 1000 N" in text


@pytest.mark.parametrize("law", [{}, {"tangential_stiffness": 1e7}])
def test_cohesion_and_cap_of_a_bar_are_a_bound_as_known_as_that_of_its_pressure(law):
    given = GENERAL | law | {"peak": 600.0}
    laws = {"friction": 0.2}, {"friction": 0.12, "cohesion": 500.0, "friction_cap": 1e3}
    one, other = (run("bar", **given, **values) for values in laws)
    forces = [result.iterate.friction_force for result in (one, other)]
    np.testing.assert_allclose(*forces, atol=1e-9 * np.abs(forces[0]).max())
    settings = chosen("bar", **given, friction=0.0, cohesion=1000.0)
    assert settings.sentence().startswith("A steel bar lies on a rough table")
    problem = discretise(settings)
    loop = next(curve for curve in settings.exact(problem) if curve.of == "loop")
    moved = one.iterate.displacement[-1]
    np.testing.assert_allclose(loop.across, moved, atol=0.05 * np.abs(moved).max())


def test_no_point_of_a_bar_carries_more_than_the_cap():
    result = run("bar", **GENERAL, friction_cap=900.0)
    support = result.iterate.problem.friction
    carried = (
        np.abs(result.iterate.friction_force)
        / support.by_point(support.weights)[:, None]
    )
    assert result.is_certified
    assert carried.max() == pytest.approx(900.0, rel=1e-9)


@pytest.mark.parametrize(
    ("scene", "stiffness"), [("bar", 1e8), ("block", 1e12), ("layers", 1e12)]
)
@pytest.mark.parametrize("cohesion", [0.0, 1.0])
def test_softening_on_a_spring_is_certified(scene, stiffness, cohesion):
    size = cohesion * (300.0 if scene == "bar" else 3e5)
    if scene == "block":
        flat = {"gap": "flat"}
    else:
        flat = {}
    law = {"tangential_stiffness": stiffness, "strength": PEAK, "cohesion": size}
    result = run(scene, **GENERAL, **law, **flat)
    assert result.is_certified
    assert result.records[-1].error_force < 1e-8
    assert kkt_residual(result.iterate, result.iterate.problem) < 1e-8


def test_a_bonded_bar_softens_as_in_closed_form():
    """theory: a zone of length s softens, P = N_0 cos(beta s) + (tau / beta) sin(beta
    s).

    The strength is a factor over the slider's slip; over the bond's, the spring adds
    its own.
    """
    peak = 4000.0
    stiffness = 4e7
    slope = 4e6
    axial = 210e9 * 3.14e-6
    bond = {
        **{"friction": 0.0, "cohesion": peak, "tangential_stiffness": stiffness},
        "strength": [[0.0, 1.0], [peak / slope, 0.0]],
    }
    falls = slope / (1.0 - slope / stiffness)
    lag = np.sqrt(stiffness / axial)
    beta = np.sqrt(falls / axial)
    zone = 0.4
    first = peak / lag * np.tanh(lag * (1.0 - zone))
    pull = first * np.cos(beta * zone) + peak / beta * np.sin(beta * zone)
    moved = peak / stiffness + peak / falls * (1.0 - np.cos(beta * zone))
    moved += first * np.sin(beta * zone) / (axial * beta)
    given = {"elements": 200, "instants": 41, "load": "ramp", "peak": float(pull)}
    result = run("bar", **(GENERAL | bond | given))
    assert result.is_certified
    assert result.iterate.displacement[-1, -1] == pytest.approx(moved, rel=5e-3)


def test_soft_joints_under_steel_are_solved():
    joints = {"tangential_stiffness": 1e8, "normal_stiffness": 1e8}
    assert run("block", **GENERAL, **joints, gap="flat").is_certified
    assert chosen("block", **GENERAL, **joints).contact_unit == pytest.approx(2.1e12)


@pytest.mark.parametrize(
    ("table", "why"),
    [
        ([[0.0, 2.0], [1e-3, 1.0]], "the factor at slip 0 is 1"),
        ([[1e-3, 1.0], [2e-3, 0.5]], "the factor at slip 0 is 1"),
        ([[0.0, 1.0]], "at least two points"),
        ([[0.0, 1.0], [1e-3, -0.5]], "factors of at least 0"),
        ([[0.0, 1.0], [1e-300, 0.5]], "slips that grow"),
        ([[0.0, 1.0], [0.0, 0.5]], "must increase"),
    ],
)
def test_a_strength_that_does_not_begin_at_one_is_refused_in_words(table, why):
    text = refusal(lambda: chosen("bar", **GENERAL, strength=table))
    assert_names(text, "strength", "", "")
    assert why in text
    chosen(
        "bar", strength=[[0.0, 2.0], [1e-3, 1.0]]
    )  # where it does nothing nobody minds


def test_stiffnesses_without_digits_are_refused_with_what_is_possible():
    text = refusal(lambda: chosen("block", **GENERAL, tangential_stiffness=1e-12))
    assert_names(
        text, "tangential_stiffness", "1e-12", "0, or from 2100 N/m^3 to 2.1e21 N/m^3"
    )


@pytest.mark.parametrize("scene", list(SMALL))
def test_units_are_those_of_a_rod_or_of_an_area_and_what_does_nothing_does_not_show(
    scene,
):
    definitions = CATALOGUE[scene].definitions()
    is_plane = CATALOGUE[scene].kind == "plane"
    if is_plane:
        stiffness = "N/m^3"
        pressure = "Pa"
    else:
        stiffness = "N/m^2"
        pressure = "N/m"
    assert properties_of(definitions["tangential_stiffness"]).unit == stiffness
    assert {
        properties_of(definitions[name]).unit for name in ("cohesion", "friction_cap")
    } == {pressure}
    assert unit_of(definitions["cohesion"]).name == ("MPa" if is_plane else "kN/m")
    assert unit_of(definitions["tangential_stiffness"]).name == (
        "GN/m³" if is_plane else "MN/m²"
    )
    given = chosen(scene, **GENERAL)
    plain = chosen(scene)
    for name in ("tangential_stiffness", "cohesion", "friction_cap", "strength"):
        assert given.applies(name)
        assert not plain.applies(name)
        assert ("per length" in definitions[name].doc) is (
            name != "strength" and not is_plane
        )
    has_across = "normal_stiffness" in definitions and given.applies("normal_stiffness")
    assert has_across is given.opens
    assert not given.applies("friction_ratio")
    assert given.replace(strength="linear").applies("friction_ratio")


def test_a_strength_is_read_from_a_file(tmp_path):
    table = tmp_path / "bond.csv"
    table.write_text("slip [mm],factor\n0,1\n0.1,1.4\n1,0.3\n", encoding="utf-8")
    settings, _ = settings_from_command(
        "bar", ["friction_law=general", f"strength={table}"]
    )
    assert settings.strength == ((0.0, 1.0), (1e-4, 1.4), (1e-3, 0.3))


def test_closed_forms_of_coulombs_law_are_not_shown_for_other_laws():
    cycles = {"cycles": 3, "load": "cycle", "instants": 41}
    assert has_a_limit(chosen("bar", **GENERAL, cohesion=100.0, **cycles))
    assert not has_a_limit(chosen("bar", **GENERAL, strength="linear", **cycles))
    bent = {"cycles": 3, "instants": 41, "bend_load": "cycle"}
    assert has_a_limit(chosen("layers", **GENERAL, **bent))
    for law in (
        {"cohesion": 1e5},
        {"friction_cap": 1e5},
        {"tangential_stiffness": 1e12},
    ):
        assert not has_a_limit(chosen("layers", **GENERAL, **law, **bent))


def test_layers_on_soft_joints_are_not_called_as_stiff_as_one_beam():
    stuck = {"plane": "stress", "deflection": 1e-7, "pressure_load": [[0.0, 1e7]]}
    for law, known in (({}, True), ({"tangential_stiffness": 1e10}, False)):
        settings = chosen("layers", **GENERAL, **law, **stuck)
        problem = discretise(settings)
        reference = reference_of(problem)
        assert not reference.contact("contact 1-2").status.any()
        assert bool(list(settings.exact(problem, reference))) is known


@pytest.mark.parametrize("scene", PLANE)
@pytest.mark.parametrize("profile", ["rising", ((0.0, 1.0), (1e4, 1.0))])
def test_mu_by_place_is_certified_and_one_of_factors_1_changes_nothing(scene, profile):
    result = run(scene, friction_profile=profile)
    assert result.is_certified
    if profile == "rising":
        return
    plain = run(scene).iterate.friction_force
    np.testing.assert_allclose(
        result.iterate.friction_force, plain, atol=1e-9 * np.abs(plain).max()
    )


def test_a_sliding_block_carries_mu_of_each_place():
    given = {
        "gap": "flat",
        "poisson": 0.0,
        "plane": "stress",
        "friction_profile": "rising",
        "top_normal_displacement": -4e-6,
        "top_tangential_displacement": 1e-4,
    }
    contact = run("block", **given, top_tangential_load="ramp").iterate.contact(
        "support"
    )
    share = np.abs(contact.tangential_force[:, -1]) / contact.normal_force[:, -1]
    pressed = contact.normal_force[:, -1] > 0.0
    np.testing.assert_allclose(
        share[pressed], 0.3 * np.linspace(0.2, 1.8, 17)[pressed], rtol=1e-6
    )


def test_factors_on_mu_below_zero_are_refused():
    text = refusal(lambda: chosen("block", friction_profile=[[0.0, -1.0]]))
    assert_names(text, "friction_profile", "-1.0", "factors of at least 0")
