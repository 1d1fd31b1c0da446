"""What the engine cannot do it refuses in words, and what differs it does not take for alike."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.definitions import SettingError
from solver.latin import coarse, iterations, response
from solver.latin.direction import search_direction
from solver.latin.linear import FullGroup
from solver.scenes import discretise
from solver.scenes.bar import BarSettings

SMALL = {"elements": 20, "instants": 11, "substructures": 4, "search_direction": "paper"}


def singular(*arguments: Any, **options: Any) -> Any:
    raise RuntimeError("Factor is exactly singular")


@pytest.mark.parametrize("module", [response, coarse], ids=["substructure", "coarse problem"])
def test_a_sparse_factor_that_fails_is_refused_as_a_dense_one_is(
    module: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = BarSettings.checked(SMALL)
    monkeypatch.setattr(module, "splu", singular)
    with pytest.raises(SettingError, match="k_scale"):
        next(iterations(discretise(settings), settings))


def test_a_rule_for_the_search_direction_that_is_none_of_both_is_refused() -> None:
    settings = BarSettings.checked(SMALL)
    other: Any = SimpleNamespace(**{**settings.values(), "search_direction": "third"})
    with pytest.raises(SettingError, match=r"third.*paper, auto"):
        search_direction(discretise(settings), other)


@pytest.mark.parametrize("without", [0, 2, 3])
def test_a_body_force_in_some_of_alike_substructures_stays_theirs(without: int) -> None:
    problem = discretise(BarSettings.checked({**SMALL, "body_force": 100.0}))
    parts = list(problem.substructures)
    force = parts[without].body_force
    assert force is not None
    parts[without] = replace(parts[without], body_force=None)
    missing = FullGroup(problem, parts, problem.direction)
    parts[without] = replace(parts[without], body_force=np.zeros_like(force))
    zero = FullGroup(problem, parts, problem.direction)
    assert missing.body is not None
    assert np.array_equal(missing.body, zero.body)
    assert [bool(missing.body[:, place].any()) for place in range(4)] == [
        place != without for place in range(4)
    ]
