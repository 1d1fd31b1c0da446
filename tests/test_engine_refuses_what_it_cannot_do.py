"""What the engine cannot do it refuses in words, and what differs it does not take for alike."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from solver.latin import (
    PGD,
    Accuracy,
    Anderson,
    Auto,
    Indicator,
    Iterations,
    Latin,
    Paper,
    iterations,
)
from solver.latin.linear import coarse, response
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
        (lambda: Accuracy(0.0), "Accuracy.share"),
        (lambda: Indicator(-1.0), "Indicator.eta"),
        (lambda: Iterations(0), "Iterations.most"),
        (lambda: Latin(relaxation=1.5), "Latin.relaxation"),
        (lambda: Latin(threads=0), "Latin.threads"),
    ],
)
def test_a_part_refuses_its_own_numbers(make: Callable[[], object], name: str) -> None:
    with pytest.raises(RefusedError, match=rf"^{name} = .* is refused; allowed: a number"):
        make()
