"""What the engine cannot do it refuses in words, and what differs it does not take for alike."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.latin import (
    PGD,
    Anderson,
    Auto,
    Latin,
    Paper,
    Stop,
    coarse,
    iterations,
    response,
)
from solver.latin.linear_stage import FullGroup
from solver.latin.response import Responses
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

SMALL = {"elements": 20, "instants": 11, "substructures": 4, "search_direction": "paper"}


def singular(*arguments: Any, **options: Any) -> Any:
    raise RuntimeError("Factor is exactly singular")


@pytest.mark.parametrize("module", [response, coarse], ids=["substructure", "coarse problem"])
def test_a_sparse_factor_that_fails_is_refused_as_a_dense_one_is(
    module: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = BarSettings.checked(SMALL)
    monkeypatch.setattr(module, "splu", singular)
    with pytest.raises(RefusedError, match="k_scale"):
        next(iterations(discretise(settings), method_of(settings)))


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Auto(scale=0.0), "Auto.scale"),
        (lambda: Paper(along=-1.0), "Paper.along"),
        (lambda: PGD(modes=0), "PGD.modes"),
        (lambda: PGD(tolerance=math.nan), "PGD.tolerance"),
        (lambda: Anderson(memory=0), "Anderson.memory"),
        (lambda: Stop(accuracy=0.0), "Stop.accuracy"),
        (lambda: Stop(tolerance=-1.0), "Stop.tolerance"),
        (lambda: Stop(iterations=0), "Stop.iterations"),
        (lambda: Latin(relaxation=1.5), "Latin.relaxation"),
        (lambda: Latin(threads=0), "Latin.threads"),
    ],
)
def test_a_part_refuses_its_own_numbers(make: Callable[[], object], name: str) -> None:
    with pytest.raises(RefusedError, match=rf"^{name} = .* is refused; allowed: a number"):
        make()


@pytest.mark.parametrize("without", [0, 2, 3])
def test_a_body_force_in_some_of_alike_substructures_stays_theirs(without: int) -> None:
    problem = discretise(BarSettings.checked({**SMALL, "body_force": 100.0}))
    parts = list(problem.substructures)
    force = parts[without].body_force
    assert force is not None
    parts[without] = replace(parts[without], body_force=None)
    missing = FullGroup(problem, parts, problem.direction, Responses())
    parts[without] = replace(parts[without], body_force=np.zeros_like(force))
    zero = FullGroup(problem, parts, problem.direction, Responses())
    assert missing.body is not None
    assert np.array_equal(missing.body, zero.body)
    assert [bool(missing.body[:, place].any()) for place in range(4)] == [
        place != without for place in range(4)
    ]
