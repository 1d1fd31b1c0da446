"""Curves of errors over iterations: their axis, names, and taps on them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from views import (
    frames_of,
    shown,
    view_of,
)

from app.frame import Selection
from app.views.errors import APART, CURVES, LEAST, Convergence, spread


def test_the_answer_is_a_ring_and_no_iteration_of_the_curve() -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    assert list(view.sources["answer"].data["x"]) == [answer.iteration]
    assert (
        len(view.sources["error_force"].data["x"])
        == len(answer.history["iteration"]) - 1
    )


def test_an_iterate_that_is_gone_back_to_is_marked_on_the_whole_curve() -> None:
    first, last, _ = frames_of("bar")
    view = view_of(Convergence, last)
    view.update(first, Selection(), None)
    assert list(view.sources["shown"].data["x"]) == [first.iteration]
    # A local stage lies between two whole iterates.
    view.update(last, Selection(stage="local"), None)
    assert list(view.sources["shown"].data["x"]) == [last.iteration - 0.5]
    assert len(view.sources["indicator"].data["x"]) == len(last.history["iteration"])


@pytest.mark.parametrize(("value", "ends"), [(2e-9, (1e-9, 10.0)), (1e5, (1e-3, 10.0))])
def test_an_indicator_widens_the_axis_of_errors_downwards_alone(
    value: float, ends: tuple[float, float]
) -> None:
    last = frames_of("bar")[1]
    small_values = np.full_like(last.history["indicator"], value)
    history = {**last.history, "indicator": small_values}
    view = view_of(Convergence, replace(last, history=history))
    shown_ends = view.figure.y_range.start, view.figure.y_range.end
    assert shown_ends == pytest.approx(ends)
    errors = view.sources["error_force"].data["y"]
    assert ends[0] < errors[-1] < ends[1]


@pytest.mark.parametrize("value", [0.0, 1e-16])
def test_an_error_of_rounding_or_zero_is_drawn_at_the_foot(value: float) -> None:
    last = frames_of("bar")[1]
    errors = last.history["error_force"].copy()
    errors[-1] = value
    history = {**last.history, "error_force": errors}
    view = view_of(Convergence, replace(last, history=history))
    drawn = view.sources["error_force"].data
    assert len(drawn["x"]) == len(errors)
    assert view.figure.y_range.start <= drawn["y"][-1] <= 1.001 * LEAST


def test_an_answer_of_few_iterations_is_no_line_at_the_left_edge_of_its_axis() -> None:
    first, _, answer = frames_of("bar")
    view = view_of(Convergence, first)
    # A search has room to go on.
    assert view.figure.x_range.end >= 20.0
    history = {name: values[:2] for name, values in answer.history.items()}
    shown(view, replace(answer, iteration=2, history=history))
    assert view.figure.x_range.end <= 10.0


def test_the_legend_names_all_curves_of_errors_and_the_goal_and_hides_them() -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    (legend,) = view.figure.legend
    assert legend.click_policy == "hide"
    names = [item.label.value for item in legend.items if item.visible]
    assert names == [
        "force",
        "displ.",
        "estimate",
        "k-free",
        "η",
        "goal 1 %",
    ]
    curves = {item.renderers[0].name for item in legend.items}
    assert set(CURVES) <= curves


def test_names_stand_at_the_ends_of_curves_and_the_answer_apart() -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    names = view.sources["names"].data
    titles = [title for title, *_ in CURVES.values()]
    assert sorted(names["text"]) == sorted([*titles, "exact"])
    assert np.all(np.diff(view._heights(names["y"])) >= APART - 1e-9)
    for column, (title, *_) in CURVES.items():
        end = view.sources[column].data["x"][-1]
        assert names["x"][names["text"].index(title)] == end
    # To the right of them there is room.
    assert max(names["x"]) <= view.figure.x_range.end / 1.25


@given(st.lists(st.floats(0.05, 0.9), max_size=7))
def test_heights_that_are_spread_are_apart_and_within_the_axis(
    heights: list[float],
) -> None:
    found = spread(sorted(heights), 0.1)
    assert np.all(np.diff(found) > 0.1 - 1e-9)
    assert all(0.05 <= height <= 1.0 for height in found)
    if np.all(np.diff(sorted(heights)) > 0.1):
        assert found == pytest.approx(sorted(heights))


def test_a_tap_on_the_errors_goes_back_to_that_iteration() -> None:
    first, last, answer = frames_of("bar")
    view = view_of(Convergence, answer)
    state = view.state
    for frame in (first, last, answer):
        state.history.add(frame)
    view._go_back(type("Tap", (), {"x": last.iteration + 0.3}))
    assert state.frame is last
    assert state.iteration == last.iteration
