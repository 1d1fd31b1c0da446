"""Layers may grow shorter, and a force may bend them:
leaf springs, held to closed forms.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refusal

from solver import solve
from solver.arrays import Array
from solver.discrete.plane.rectangles.stack import Stack
from solver.files.saved import settings_from_command
from solver.reference.closed_forms.elastic_bodies import (
    TwoLeaves,
    cantilever,
    leaf_spring,
)
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.layers import LayersSettings
from solver.scenes.method import method_of
from solver.settings.values import SettingError
from solver.study.quantities import reading
from solver.study.scene_run import finished_run

LENGTH = 0.5
HEIGHT = 0.01
YOUNG = 210e9
PRESSURE = 2e6
THIN = {
    "plane": "stress",
    "length": LENGTH,
    "thickness": 0.005,
    "young": YOUNG,
    "instants": 3,
}
LOOSE = {
    **THIN,
    "friction": 0.0,
    "pressure": 0.0,
    "bend_load": "ramp",
    "bending": "force",
}
LEAVES = {**LOOSE, "layer_lengths": "graduated"}


def settings_of(**values: Any) -> Any:
    return CATALOGUE["layers"].checked(values)


@pytest.mark.parametrize("elements", [5, 20])
def test_layers_touch_and_hold_each_other_up_to_their_clamp(elements: int) -> None:
    """The half element beside the clamp was left out: 10 % of five elements."""
    settings = settings_of(
        layers=3,
        elements=elements,
        elements_up=2,
        instants=3,
        pressure=PRESSURE,
        deflection=0.0,
        pull=1e5,
    )
    run = finished_run(settings, errors=False)
    assert reading("contact_width")(run) == pytest.approx(2.0 * LENGTH, rel=1e-12)
    held = settings.friction * PRESSURE * LENGTH
    assert reading("holding_force")(run) == pytest.approx(held, rel=0.01)


def deflection(settings: Any) -> Array:
    """Deflection of the end over time, (n_instants,), m."""
    problem = discretise(settings)
    loop = settings.structure().loop(problem)
    return np.asarray(loop.displacement(reference_of(problem).displacement))


def alone(height: float = 0.005) -> float:
    return cantilever(LENGTH, height, YOUNG, 0.3)


@pytest.mark.parametrize("layers", [2, 3, 4])
def test_a_graduated_spring_bends_as_beams_that_touch_at_their_ends(
    layers: int,
) -> None:
    settings = settings_of(**LEAVES, layers=layers, force=100.0)
    factor = leaf_spring(np.arange(layers, 0, -1) / layers)
    assert factor is not None
    found = deflection(settings)
    assert found[-1] == pytest.approx(100.0 / (factor * alone()), rel=3e-3)
    (exact,) = settings.exact(discretise(settings))
    np.testing.assert_allclose(found, exact.across, atol=3e-3 * found[-1])


def test_bent_the_other_way_the_longest_leaf_bends_alone() -> None:
    settings = settings_of(**LEAVES, layers=3, force=-100.0)
    assert deflection(settings)[-1] == pytest.approx(-100.0 / alone(), rel=3e-3)
    moment = settings_of(**{**LEAVES, "bending": "moment"}, layers=3, moment=-20.0)
    rotation = -20.0 * LENGTH / (YOUNG * 0.005**3 / 12.0)
    assert deflection(moment)[-1] == pytest.approx(rotation, rel=3e-3)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("instants", [17, 33])
def test_leaves_that_come_apart_are_unloaded_to_nothing(
    friction: float, instants: int
) -> None:
    there_and_back = {
        "bend_load": "sine",
        "friction": friction,
        "instants": instants,
        "elements": 24,
    }
    settings = settings_of(**(LEAVES | there_and_back), layers=3, force=100.0)
    found = reference_of(discretise(settings))
    assert found.converged.all()
    assert np.abs(found.contact_force).max() > 10.0
    assert np.abs(found.contact_force[:, -1]).max() < 1e-6
    assert np.abs(found.displacement[:, -1]).max() < 1e-9


def test_many_leaves_tend_to_a_spring_of_uniform_strength() -> None:
    """A triangle of n widths bends by F L^3 / (2 n E I), a leaf by F L^3 / (3 E I)."""
    off = []
    for count in (4, 16, 64):
        factor = leaf_spring(np.arange(count, 0, -1.0))
        assert factor is not None
        off.append(factor / (2.0 * count / 3.0) - 1.0)
    assert off[0] > 3.0 * off[1] > 9.0 * off[2] > 0.0
    assert off[2] < 0.01


def energy_lost(leaves: TwoLeaves, peak: float) -> float:
    """Energy that two leaves lose in a cycle of a force up to a peak, J."""
    stuck, apart = leaves.stiffnesses
    slips = peak - leaves.first_slip
    return 4.0 * leaves.first_slip * slips * (1.0 / apart - 1.0 / stuck)


@pytest.mark.parametrize("share", [1.5, 2.5])
def test_two_leaves_lose_the_energy_of_goodman_and_klumpp(share: float) -> None:
    leaves = TwoLeaves(LENGTH, HEIGHT, YOUNG, 0.0, 0.3 * PRESSURE)
    peak = share * leaves.first_slip
    there = [[0.0, 0.0], [0.25, 0.0], [0.4, peak], [0.7, -peak], [1.0, peak]]
    settings = settings_of(
        **{
            **THIN,
            "thickness": HEIGHT,
            "poisson": 0.0,
            "instants": 41,
            "layers": 2,
            "bending": "force",
            "bend_load": there,
            "pressure": PRESSURE,
            "elements": 32,
        }
    )
    problem = discretise(settings)
    solution = solve(problem, method_of(settings), watch=False)
    assert solution.is_certified
    loop = settings.structure().loop(problem)
    bent = loop.displacement.of(solution.iterate)
    force = loop.force(solution.iterate)
    cycle = settings.times() >= 0.4
    energy = abs(float(np.trapezoid(force[cycle], bent[cycle])))
    assert energy == pytest.approx(energy_lost(leaves, peak), rel=0.005)
    (exact,) = settings.exact(problem)
    np.testing.assert_allclose(bent, exact.across, atol=0.005 * bent.max())


def test_lengths_that_are_all_whole_are_the_stack_that_it_was() -> None:
    small = {"elements": 12, "instants": 5}
    table = settings_of(**small, layer_lengths=[[n, 1] for n in range(1, 5)])
    runs = [reference_of(discretise(one)) for one in (settings_of(**small), table)]
    np.testing.assert_array_equal(runs[0].displacement, runs[1].displacement)


def test_leaves_touch_as_far_as_the_shorter_one_goes_and_are_cut_where_it_ends() -> (
    None
):
    table = [[1, 0.5], [2, 1.0], [3, 0.3]]
    settings = settings_of(layers=3, elements=20, substructures=3, layer_lengths=table)
    problem = discretise(settings)
    ends = [
        problem.contacts[name].positions[-1] for name in ("contact 1-2", "contact 2-3")
    ]
    assert ends == pytest.approx([0.25, 0.15])
    assert len(problem.substructures) == 3 + 5 + 1
    assert problem.inside is not None
    assert len(problem.inside.nodes) == settings.n_nodes == (11 + 21 + 7) * 3
    stack = settings.structure()
    assert isinstance(stack, Stack)
    assert stack.longest == 1
    acts = {act.where: act.points for act in stack.description().acts}
    np.testing.assert_allclose(acts["top y"][:, 1], [1.0, 2 / 3, 2 / 3])
    np.testing.assert_allclose(acts["bottom y"][:, 1], [0.0, 0.0, 1 / 3])


def test_a_run_says_where_leaves_end_elsewhere_than_given() -> None:
    table = [[1, 1.0], [2, 0.5]]
    (remark,) = settings_of(layers=2, elements=5, layer_lengths=table).left_out()
    assert "up to 10 % of the length" in remark
    assert not list(settings_of(layers=2, elements=6, layer_lengths=table).left_out())


def test_pressure_on_all_that_lies_open_presses_leaves_and_bends_none() -> None:
    changes = {"friction": 0.0, "poisson": 0.0, "instants": 3, "pressure_load": "ramp"}
    settings = settings_of(
        layer_lengths="graduated", bending="force", force=0.0, **changes
    )
    problem = discretise(settings)
    found = reference_of(problem)
    for name, law in problem.contacts.items():
        pressed = found.contact(name).normal_force[:, -1] / law.by_point(law.weights)
        np.testing.assert_allclose(pressed[3:-3], PRESSURE, rtol=0.02)
    squeezed = PRESSURE / YOUNG * 0.01
    assert np.abs(found.displacement[1::2, -1]).max() < 5.0 * squeezed


def test_a_force_over_time_comes_from_a_file_in_its_unit(tmp_path: Path) -> None:
    path = tmp_path / "force.csv"
    path.write_text("time [s],force [kN/m]\n0,0\n1,2.5\n")
    changes = ["bending=force", f"bend_load={path}"]
    settings, messages = settings_from_command("layers", changes)
    assert settings.values()["bend_load"] == ((0.0, 0.0), (1.0, 2500.0))
    assert "force in kN/m" in messages["bend_load"]
    with pytest.raises(SettingError, match="names no displacement in m"):
        settings_from_command("layers", changes[1:])


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ([[1, 1.0], [2, 0.5]], "4 pairs, one for each layer; there are 2"),
        ([[1, 1.0], [2, 0.5], [3, 0.5], [5, 0.2]], "number each layer from 1 to 4"),
        ([[1, 0.9], [2, 0.5], [3, 0.5], [4, 0.2]], "the largest of them 1"),
        ([[1, 1.0], [2, 0.5], [3, 0.0], [4, 0.2]], "shares above 0"),
        ([[1, 100.0], [2, 50.0], [3, 20.0], [4, 10.0]], "over that of the longest"),
        ("falling", "equal, graduated, or pairs [[layer, share], ...]"),
    ],
)
def test_lengths_that_are_not_one_share_for_each_layer_are_refused(
    table: Any, words: str
) -> None:
    text = refusal(lambda: LayersSettings.checked({"layer_lengths": table}))
    assert "layer_lengths" in text
    assert words in text
