"""The map of a study: both solvers on multiples of the present size, and where they are equal."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from solver.reference.condensation import NoReferenceError
from solver.scenes import CATALOGUE
from solver.study.speed import crossover as measuring
from solver.study.speed.crossover import (
    FACTORS,
    LARGE,
    Comparison,
    Crossover,
    crossover,
    equal_at,
    notes,
    ratio_table,
)

TINY: dict[str, dict[str, Any]] = {
    "bar": {"elements": 12, "instants": 11, "substructures": 3},
    "strand": {"elements": 6, "instants": 5, "substructures": 2, "wires": 4},
    "layers": {"elements": 8, "instants": 5, "layers": 4, "substructures": 1},
}
MADE = Crossover(
    "layers",
    "Layers",
    (),
    (
        *(Comparison(size, 41, latin, 1.0) for size, latin in ((4, 4.0), (16, 1.0), (64, 0.25))),
        *(Comparison(size, 81, latin, 1.0) for size, latin in ((4, 2.0), (16, 0.5))),
        Comparison(64, 81, math.nan, math.nan, "left out: it would take about 2 h and 3 GB"),
    ),
)


@pytest.mark.parametrize("scene", list(TINY))
def test_the_present_size_and_its_multiples_are_measured(scene: str) -> None:
    settings = CATALOGUE[scene].settings.checked(TINY[scene])
    found = crossover(settings)
    name = CATALOGUE[scene].grows[0]
    assert found.setting == name
    assert found.sizes == [round(factor * getattr(settings, name)) for factor in FACTORS]
    last = settings.instants - 1
    assert found.instants == [round(factor * last) + 1 for factor in FACTORS]
    assert (found.ratios > 0.0).all()


def test_all_that_makes_a_body_larger_grows_together(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def refuse(form: Any) -> None:
        seen.append(form)
        raise NoReferenceError("too large")

    monkeypatch.setattr(measuring, "incremental", refuse)
    settings = CATALOGUE["block"].settings.checked({})
    found = crossover(settings, large=True)
    assert found.sizes == [round(factor * settings.elements) for factor in LARGE]
    assert {(one.elements / one.elements_up, one.elements / one.substructures) for one in seen} == {
        (2.0, 12.0)
    }
    assert np.isnan(found.ratios).all()
    assert {one.message for one in found.comparisons} == {"too large"}


def test_what_would_take_too_long_or_is_no_size_is_left_out_and_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settings = CATALOGUE["strand"].settings.checked({**TINY["strand"], "wires": 2})
    monkeypatch.setattr(measuring, "LONGEST", 0.0)
    found = crossover(settings)
    assert found.sizes == [1, 2, 4]
    said = {one.size: one.message for one in found.comparisons}
    assert said[1] == "there is no such size"
    assert said[2].startswith("left out: it would take about")
    assert any("Wires 4" in line and "left out" in line for line in notes(found))


def test_a_run_that_has_not_converged_is_no_answer() -> None:
    comparison = Comparison(4, 41, 1.0, 2.0, "LATIN: exhausted")
    assert math.isnan(comparison.ratio)
    assert Comparison(4, 41, 1.0, 2.0).ratio == 0.5


def test_sizes_between_which_latin_comes_ahead_are_joined_by_powers() -> None:
    assert equal_at([4, 16, 64], [4.0, 2.0, 0.5]) == pytest.approx(32.0)
    assert equal_at([4, 16, 64], [4.0, math.nan, 0.25]) == pytest.approx(16.0)
    assert equal_at([4, 16], [0.5, 0.4]) is None
    assert equal_at([4, 16], [4.0, 2.0]) is None


def test_the_table_has_the_ratios_and_where_they_are_one() -> None:
    head, first, second = ratio_table(MADE)
    assert head[1:] == ["layers 4", "layers 16", "layers 64", "equal at"]
    assert first == ["41 instants", "4", "1", "0.25", "16"]
    assert second == ["81 instants", "2", "0.5", "-", "8"]
    assert "2 of 5 sizes" in notes(MADE)[0]
