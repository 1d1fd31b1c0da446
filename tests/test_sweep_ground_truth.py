"""Charts of sweeps are what closed forms, single runs and other laws say they are."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sweeps import rows_of, tiny

from solver.cli import main
from solver.study.exponent import exponent_of
from solver.study.sweep import Plan
from solver.study.sweep.growth import growth
from solver.study.sweep.point import Row

STIFFNESS, PRESSURE = 210e9 * 3.14e-6, 5000.0


def end_of(plan: Plan, number: int) -> float:
    """Displacement of the end of a bar under a monotone pull."""
    at = plan.point(number)
    return at["peak"] ** 2 / (2.0 * STIFFNESS * at["friction"] * PRESSURE)


def test_the_design_chart_of_the_end_displacement_is_the_closed_form_to_second_order() -> None:
    sizes, errors = (15, 30, 60), []
    for elements in sizes:
        vary = ["friction=0.23,0.31,0.4", "peak=370:1010:5"]
        plan = tiny(vary, ["end_displacement"], load="ramp", elements=elements, instants=2)
        rows = rows_of(plan)
        assert all(row.holds for row in rows)
        exact = [end_of(plan, row.number) for row in rows]
        found = [row.values[0] for row in rows]
        errors.append(np.abs(np.array(found) / exact - 1.0).mean())
        assert errors[-1] < 2.0 / elements**2
    law = exponent_of(sizes, errors)
    assert law is not None
    assert -2.6 < law.value < -1.6


def test_the_energy_of_a_cycle_over_the_peak_is_the_closed_form() -> None:
    plan = tiny(["peak=500:1100:4"], ["dissipation@1"], load="cycle", elements=100)
    for row in rows_of(plan):
        peak = plan.point(row.number)["peak"]
        exact = 2.0 * peak**3 / (3.0 * STIFFNESS * 0.3 * PRESSURE)
        assert row.values[0] == pytest.approx(exact, rel=2e-4)


def test_iterations_over_k_are_those_of_single_runs(capsys: pytest.CaptureFixture[str]) -> None:
    plan = tiny(["k_scale=0.1:10:3:log", "finish=none,at-once"], ["iterations"])
    for row in rows_of(plan):
        own = [f"{name}={value}" for name, value in plan.settings_at(row.number).changed().items()]
        main(["run", "bar", "--json", *(part for one in own for part in ("--set", one))])
        assert json.loads(capsys.readouterr().out)["iterations"] == row.values[0]


@pytest.mark.parametrize("power", [-2.0, 0.5, 1.0])
def test_an_exponent_is_found_with_a_margin_that_holds_it(power: float) -> None:
    sizes = np.geomspace(50.0, 3200.0, 7)
    noise = np.random.default_rng(1)
    held = 0
    for _ in range(400):
        law = exponent_of(sizes, 3.0 * sizes**power * np.exp(0.1 * noise.standard_normal(7)))
        assert law is not None
        held += abs(law.value - power) <= law.margin
    assert 0.92 < held / 400 < 0.98


def test_growth_is_told_of_a_setting_over_decades_for_every_name() -> None:
    plan = tiny(["elements=10:40:3:log", "method=fast,paper"], ["iterations"])
    rows = [
        Row(n, "converged", "", (float(plan.point(n)["elements"] ** (1 + n % 2)),))
        for n in range(6)
    ]
    assert growth(plan, rows) == [
        "iterations, method=fast: elements^(1.00 ± 0.00), of 3 runs",
        "iterations, method=paper: elements^(2.00 ± 0.00), of 3 runs",
    ]
    assert growth(tiny(["elements=10,20,40"], ["iterations"]), rows[:3]) == []
