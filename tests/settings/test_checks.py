"""Kinds of values: a message on a refused one names value and remedy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.checks import (
    COUNT,
    FLAG,
    FUNCTION,
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    ROWS,
    AnyOf,
    Choice,
    Count,
    InstanceOf,
    Kind,
    MappingOf,
    Number,
    Numbers,
    SequenceOf,
    check,
    check_value,
)
from solver.refusal import RefusedError

INF = float("inf")
NAN = float("nan")


@dataclass
class Rope:
    length: float = 1.0
    turns: int | None = None


KINDS: dict[str, tuple[Kind, list[Any], list[Any]]] = {
    "number": (
        Number(0.0, 2.0),
        [0, 0.0, 2.0, np.float64(1.0)],
        [-1e-300, 2.1, NAN, INF, True, "1", None, 1j],
    ),
    "above": (POSITIVE, [1e-300, 1e300, 3], [0.0, -0.0, INF, NAN, -1]),
    "endless": (Number(0.0, 2.0, endless=True), [2.0, INF], [3.0, -INF, NAN]),
    "count": (Count(1, 3), [1, np.int64(3)], [0, 4, 1.0, True, "1"]),
    "numbers": (
        Numbers(((2, None), (3,)), low=0.0, high=1.0),
        [np.zeros((2, 5)), np.ones(3), np.zeros((2, 0)), np.array([0, 1, 1])],
        [
            np.zeros((3, 2)),
            np.zeros(2),
            [0.0, 1.0, 1.0],
            np.array([0.0, 0.5, 1.1]),
            np.array([0.0, NAN, 1.0]),
            np.array(["a", "b", "c"]),
            np.array([True, False, True]),
        ],
    ),
    "numbers above": (
        Numbers(((None,),), low=0.0, above=True),
        [np.array([1e-300])],
        [np.array([1.0, 0.0]), np.array([1.0, INF])],
    ),
    "rows": (
        ROWS,
        [np.array([0, 4]), np.zeros(0, dtype=int)],
        [np.array([0.0]), np.array([-1]), np.array([[1]])],
    ),
    "instants": (
        INSTANTS,
        [np.array([3.0]), np.array([-1.0, 0.0, 5.0])],
        [np.zeros(0), np.array([0.0, 0.0]), np.array([0.0, 2.0, 1.0]), [0.0, 1.0]],
    ),
    "part": (InstanceOf(Rope, type(None)), [Rope(), None], [Rope, "Rope", 1]),
    "choice": (Choice(("a", "b")), ["a", "b"], ["c", "", None, 1, ["a"]]),
    "flag": (FLAG, [True, np.bool_(False)], [0, 1, "True", None]),
    "function": (FUNCTION, [len, Rope], [1, None, "len"]),
    "either": (AnyOf(COUNT, Choice(("all",))), [4, "all"], [0, "none", 1.5]),
    "each": (SequenceOf(COUNT), [(1,), [1, 2]], [(), (1, 0), "12", 3, {1: 2}]),
    "each of two": (SequenceOf(COUNT, 2), [(1, 2)], [(1,), (1, 2, 3)]),
    "named": (
        MappingOf(COUNT, ("a", "b")),
        [{}, {"a": 1}, {"a": 1, "b": 2}],
        [{"c": 1}, {"a": 0}, {1: 1}, [("a", 1)], None],
    ),
}
ALLOWED: list[tuple[Kind, Any]] = []
REFUSED: list[tuple[Kind, Any]] = []
for one_kind, fine, wrong in KINDS.values():
    ALLOWED += [(one_kind, value) for value in fine]
    REFUSED += [(one_kind, value) for value in wrong]


@pytest.mark.parametrize(("kind", "value"), ALLOWED)
def test_allowed_values_have_no_flaw(kind: Kind, value: Any) -> None:
    assert kind.flaw(value) is None
    check_value("Rope.length", value, kind)


@pytest.mark.parametrize(("kind", "value"), REFUSED)
def test_other_values_are_refused_in_a_line_with_name_and_allowed_values(
    kind: Kind, value: Any
) -> None:
    with pytest.raises(RefusedError) as caught:
        check_value("Rope.length", value, kind)
    text = str(caught.value)
    assert text.startswith("Rope.length = ")
    assert f"; allowed: {kind.allowed}; " in text
    assert "\n" not in text
    flaw = kind.flaw(value)
    assert flaw is not None
    assert text.endswith(flaw.remedy)


@given(
    st.floats(-10.0, 10.0),
    st.floats(-10.0, 10.0),
    st.booleans(),
    st.floats(-12.0, 12.0),
)
def test_a_range_of_one_number_is_that_of_an_array_of_it(
    low: float, high: float, above: bool, value: float
) -> None:
    alone = Number(low, high, above=above).flaw(value)
    among = Numbers(((None,),), low, high, above=above).flaw(np.array([value, value]))
    assert (alone is None) == (among is None)
    if above:
        is_in = low < value <= high
    else:
        is_in = low <= value <= high
    assert (alone is None) == is_in


def test_of_an_array_the_first_number_that_is_refused_is_named() -> None:
    values = np.ones((3, 4))
    values[1, 2] = 7.0
    values[2, 3] = NAN
    flaw = Numbers(((3, None),), high=5.0).flaw(values)
    assert flaw is not None
    assert flaw.shown == 7.0
    assert "[1, 2]" in flaw.remedy
    flaw = Numbers(((3, None),)).flaw(values)
    assert flaw is not None
    assert "[2, 3] is no finite number" in flaw.remedy


def test_of_a_sequence_and_a_mapping_the_place_of_the_flaw_is_named() -> None:
    flaw = SequenceOf(COUNT).flaw((1, 2, 0))
    assert flaw is not None
    assert flaw.remedy.startswith("number 2: ")
    flaw = MappingOf(COUNT).flaw({"a": 1, "b": 0})
    assert flaw is not None
    assert flaw.remedy.startswith('"b": ')


def test_of_either_a_number_or_an_array_a_number_is_told_its_own_flaw() -> None:
    either = AnyOf(NON_NEGATIVE, Numbers(((2,),), low=0.0))
    flaw = either.flaw(-1.0)
    assert flaw is not None
    assert flaw.remedy == "give a number in this range"
    flaw = either.flaw(np.array([0.0, -1.0]))
    assert flaw is not None
    assert flaw.remedy == "entry [1] is below zero, raise it"


def test_none_is_allowed_only_as_a_default() -> None:
    check(Rope(), length=POSITIVE, turns=COUNT)
    check(Rope(2.0, 3), length=POSITIVE, turns=COUNT)
    with pytest.raises(RefusedError, match=r"^Rope\.turns = 0"):
        check(Rope(turns=0), turns=COUNT)
    nothing: Any = None
    with pytest.raises(RefusedError, match=r"^Rope\.length = None"):
        check(Rope(nothing), length=POSITIVE)


def test_the_first_flaw_of_a_part_is_told() -> None:
    with pytest.raises(RefusedError) as caught:
        check(Rope(-1.0, 0), length=POSITIVE, turns=COUNT)
    assert caught.value.name == "Rope.length"
    assert caught.value.value == -1.0
