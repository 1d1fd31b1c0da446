"""Three meshes, or numbers of instants, tell how far a quantity is from its limit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.commands.cli import main
from solver.scenes import CATALOGUE
from solver.study.mesh import (
    LARGEST_ORDER,
    LEAST_ORDER,
    Refinement,
    answer,
    three_of,
    undivided,
)

CYCLE = 2.0 * 900.0**3 / (3.0 * 210e9 * 3.14e-6 * 1500.0)
"""Energy of a full cycle of the bar, J."""


def power(order: float, limit: float, share: float) -> Refinement:
    coarse, middle, fine = (
        limit * (1.0 + share * size**order) for size in (1.0, 0.5, 0.25)
    )
    return Refinement((coarse, middle, fine), 1)


@given(
    order=st.floats(LEAST_ORDER + 0.01, 4.0),
    limit=st.floats(1e-6, 1e9),
    share=st.floats(0.01, 1.0) | st.floats(-0.5, -0.01),
)
def test_a_power_of_the_size_is_found_with_what_it_tends_to(
    order: float, limit: float, share: float
) -> None:
    found = power(order, limit, share)
    assert found.order == pytest.approx(order, rel=1e-6)
    assert abs(found.limit - limit) <= found.margin
    if order <= LARGEST_ORDER:
        assert found.limit == pytest.approx(limit, rel=1e-6)
    assert abs(found.values[1] / found.limit - 1.0) <= found.deviation


@given(values=st.tuples(*3 * [st.floats(-1e6, 1e6)]))
def test_the_finest_value_is_always_inside_the_margin(
    values: tuple[float, float, float],
) -> None:
    found = Refinement(values, 1)
    slack = 1e-5 * max(map(abs, values))
    assert abs(found.values[2] - found.limit) <= found.margin + slack
    assert answer(found, "N")


def test_a_singular_corner_shows_no_limit_and_a_jump_no_power() -> None:
    assert "shows no limit" in answer(power(-0.3, 1.0, 0.5), "Pa")
    assert "no power" in answer(Refinement((1.0, 1.0, 0.9), 1), "m")
    # Rounding in a step is no change: a rope's energy had the power -36.9.
    rounded = Refinement((1.0, 1.0 - 1e-15, 0.9999), 1)
    assert "no power" in answer(rounded, "J")
    # It was said to change hardly any more, with a margin of two thirds.
    told = answer(Refinement((12.78, 8.716, 7.938), 1), "J")
    assert "It changed by 4.06 J, then by 0.778 J, which falls faster" in told
    assert "7.938 ± 5.1 J, by the first change" in told
    assert Refinement((1.0, 1.1, 1.1 + 1e-12), 1).margin > 0.1
    assert "All three are equal" in answer(Refinement((2.0, 2.0, 2.0), 1), "m")
    assert "no answer" in answer(Refinement((1.0, math.nan, 1.0), 1), "m")


def test_the_energy_of_a_cycle_is_what_the_closed_form_says(
    capsys: pytest.CaptureFixture[str],
) -> None:
    small = ["--set", "load=cycle", "--set", "instants=21"]
    assert main(["mesh", "bar", "--of", "dissipation@1", *small]) == 0
    lines = capsys.readouterr().out.splitlines()
    values = [float(line.split()[4]) for line in lines[:3]]
    found = Refinement((values[0], values[1], values[2]), 1)
    assert abs(found.limit - CYCLE) <= found.margin < 0.01 * CYCLE
    assert lines[5].startswith(
        f"Elements: Its error goes with the power {found.order:.2f}"
    )
    assert lines[7].startswith("Refine elements first")


@pytest.mark.parametrize(
    ("scene", "asked", "refined"),
    [
        ("bar elements=40 instants=11 load=ramp", "first_slip_time@0.45", "instants"),
        ("bar elements=10 instants=41 load=cycle", "dissipation@1", "elements"),
    ],
)
def test_a_sentence_says_whether_to_refine_elements_or_instants(
    scene: str, asked: str, refined: str, capsys: pytest.CaptureFixture[str]
) -> None:
    name, *changes = scene.split()
    settings = [f"--set={change}" for change in changes]
    assert main(["mesh", name, "--of", asked, *settings]) == 0
    assert f"Refine {refined} first" in capsys.readouterr().out


@pytest.mark.parametrize(
    "changes",
    [
        {"instants": 1},
        {"instants": 3, "load": [[0, 0], [0.1, 500], [0.2, -900], [0.5, 900], [1, 0]]},
        {"instants": 11},
        {"instants": 12},
    ],
)
def test_steps_are_halved_also_where_points_of_the_load_make_them(
    changes: dict[str, Any],
) -> None:
    """Runs of one instant stayed so, and no time step was said to change a thing."""
    settings = CATALOGUE["bar"].checked({"elements": 10, **changes})
    three, own = three_of(settings, ["instants"])
    assert three[own] is settings
    longest = [np.diff(each.times(), prepend=0.0).max() for each in three]
    assert longest[1] <= 0.5 * longest[0] * (1.0 + 1e-9)
    assert longest[2] <= 0.5 * longest[1] * (1.0 + 1e-9)


def test_steps_of_a_narrow_peak_are_said_to_stay() -> None:
    peak = [[0.5, 0.0], [0.501, 900.0], [0.502, 0.0]]
    settings = CATALOGUE["bar"].checked({"instants": 11, "load": peak})
    assert "up to 0.001 s" in undivided(settings)
    assert undivided(CATALOGUE["bar"].checked({"instants": 11})) == ""


def test_of_a_user_mesh_only_instants_are_refined(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["mesh", "mesh", "--of", "dissipation", "--set=instants=5"]) == 0
    said = capsys.readouterr().out
    assert "Elements: They are those of the mesh" in said
    assert "Instants: " in said
    assert "elements, " not in said


@pytest.mark.parametrize("asked", ["seconds", "peak_pressure", "nonsense"])
def test_quantities_that_do_not_depend_on_the_mesh_are_refused(
    asked: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mesh", "bar", "--of", asked]) == 2
    assert asked in capsys.readouterr().err
