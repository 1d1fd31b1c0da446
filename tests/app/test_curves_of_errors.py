"""Curves of errors over iterations: their axis, names and goal, and taps on them."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest
from pictures import meet
from views import (
    frames_of,
    shown,
    view_of,
)

from app.frame import Frame, Selection
from app.views.errors import CURVES, HEIGHT, LEAST, WIDTH, Convergence

RUNS = count(1000)
"""Numbers of runs that no view has shown."""


@pytest.fixture(scope="module")
def plot() -> Convergence:
    """A plot that shows one run after the other: a figure takes longer to make."""
    return view_of(Convergence, frames_of("bar")[1])


def show_anew(plot: Convergence, frame: Frame, size: str = "12px") -> None:
    """Show a frame as that of a new run, in type of a size."""
    plot.magnify(size)
    shown(plot, replace(frame, run=replace(frame.run, number=next(RUNS))))


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
def test_an_error_of_rounding_or_zero_is_drawn_at_the_foot_with_a_whole_name(
    value: float,
) -> None:
    last = frames_of("bar")[1]
    errors = last.history["error_force"].copy()
    errors[-1] = value
    history = {**last.history, "error_force": errors}
    view = view_of(Convergence, replace(last, history=history))
    drawn = view.sources["error_force"].data
    assert len(drawn["x"]) == len(errors)
    axis = view.figure.y_range
    assert axis.start < drawn["y"][-1] <= 1.001 * LEAST
    names = view.sources["names"].data
    lowest = np.log10(min(names["y"]) / axis.start) / np.log10(axis.end / axis.start)
    assert lowest * HEIGHT > 0.5 * view.type_size


def test_curves_of_errors_are_named_at_their_ends_and_names_stay_apart() -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    names = view.sources["names"].data
    assert {"force", "displ.", "exact"} <= set(names["text"])
    axis = view.figure.y_range
    heights = np.sort(np.log10(names["y"])) / np.log10(axis.end / axis.start)
    assert np.diff(heights).min() > 0.05
    assert all(axis.start < y < axis.end for y in names["y"])
    assert max(names["x"]) < 0.9 * view.figure.x_range.end


def test_names_lie_on_no_ring_of_the_answer(plot: Convergence) -> None:
    """The name of an indicator that ends low stood half below it."""
    glyphs = {each.name: each.glyph for each in plot.figure.renderers}
    ring = glyphs["answer"]
    outside = 0.5 * (ring.size + ring.line_width)
    assert glyphs["names"].x_offset > outside + 2.0


@pytest.mark.parametrize("end", [0.1, 0.02, 0.0101, 0.0099, 0.003, 1e-4])
@pytest.mark.parametrize("size", ["12px", "19px"])
def test_names_of_curves_lie_on_no_line_of_the_goal(
    plot: Convergence, end: float, size: str
) -> None:
    last = frames_of("bar")[1]
    length = len(last.history["iteration"])
    history = {
        name: np.geomspace(1.0, end * (1.0 + 0.1 * number), length)
        for number, name in enumerate(CURVES)
    }
    history["iteration"] = last.history["iteration"]
    show_anew(plot, replace(last, history=history), size)
    names = plot.sources["names"].data
    assert len(names["y"]) == len(CURVES)
    heights = on_plot(plot, names["x"], names["y"])[:, 1]
    ((_, goal),) = on_plot(plot, [0.0], plot.sources["goal"].data["y"])
    assert np.abs(heights - goal).min() > 0.55 * plot.type_size
    assert np.diff(np.sort(heights)).min() > plot.type_size
    assert heights.min() > 0.0
    assert heights.max() < HEIGHT


def on_plot(view: Convergence, x: Any, y: Any) -> np.ndarray:
    """Points of a plot of errors, px, (n, 2)."""
    axis = view.figure.y_range
    heights = np.log10(np.divide(y, axis.start)) / np.log10(axis.end / axis.start)
    shares = np.divide(x, view.figure.x_range.end)
    return np.stack([shares, heights], axis=1) * [WIDTH, HEIGHT]


@pytest.mark.parametrize("length", [4, 30, 75, 100])
@pytest.mark.parametrize("decades", [1.0, 3.0, 6.0])
def test_the_name_of_the_goal_is_at_its_line_and_on_no_curve(
    plot: Convergence, length: int, decades: float
) -> None:
    last = frames_of("bar")[1]
    # Curves fall through the line of the goal, some at the beginning, some at the end.
    shares = np.arange(1.0, length + 1.0) / length
    history = dict.fromkeys(last.history, 10.0 ** (-2.0 * shares))
    history |= {"iteration": length * shares, "indicator": 10.0 ** (-decades * shares)}
    history["behaviour"] = 10.0 ** (1.0 - decades * shares**2)
    show_anew(plot, replace(last, iteration=length, history=history))
    goal = plot.sources["goal name"].data
    assert goal["text"] == ["goal 1 %"]
    (at,) = on_plot(plot, goal["x"], goal["y"])
    half = np.array([0.0, 0.4 * plot.type_size])
    width = np.array([0.5 * plot.type_size * len("goal 1 %"), 0.0])
    if goal["text_align"] == ["right"]:
        at -= width
    box = np.array([at - half, at + half + width])
    assert 0.0 <= box[0, 0] < box[1, 0] <= WIDTH
    (line,) = on_plot(plot, [0.0], plot.sources["goal"].data["y"])
    assert abs(line[1] - at[1]) < plot.type_size
    for name in CURVES:
        data = plot.sources[name].data
        x = np.linspace(data["x"][0], data["x"][-1], 2000)
        y = 10.0 ** np.interp(x, data["x"], np.log10(data["y"]))
        points = on_plot(plot, x, y)
        assert not meet(box, points, points), name


@pytest.mark.parametrize("width", [230.0, 380.0, 700.0])
@pytest.mark.parametrize("size", ["12px", "19px"])
def test_names_at_the_ends_of_curves_are_whole_in_a_narrow_plot(
    width: float, size: str
) -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    view.magnify(size)
    view.lay_out(width, HEIGHT)
    shown(view, answer)
    names = view.sources["names"].data
    assert names["text"]
    for x, text in zip(names["x"], names["text"], strict=True):
        begin = x / view.figure.x_range.reset_end * width
        assert begin + 0.5 * float(size.removesuffix("px")) * len(text) <= width


def test_an_answer_of_few_iterations_is_no_line_at_the_left_edge_of_its_axis() -> None:
    first, _, answer = frames_of("bar")
    view = view_of(Convergence, first)
    # A search has room to go on.
    assert view.figure.x_range.end >= 20.0
    history = {name: values[:2] for name, values in answer.history.items()}
    shown(view, replace(answer, iteration=2, history=history))
    assert view.figure.x_range.end <= 10.0


def test_each_curve_of_errors_is_hidden_by_the_legend_while_its_name_stays() -> None:
    answer = frames_of("bar")[2]
    view = view_of(Convergence, answer)
    (legend,) = view.figure.legend
    assert legend.click_policy == "hide"
    names = [item.label.value for item in legend.items if item.visible]
    assert names == ["force", "displ.", "estimate", "k-free", "η"]
    curves = {item.renderers[0].name for item in legend.items}
    assert set(CURVES) <= curves
    assert set(names) <= set(view.sources["names"].data["text"])


def test_a_tap_on_the_errors_goes_back_to_that_iteration() -> None:
    first, last, answer = frames_of("bar")
    view = view_of(Convergence, answer)
    state = view.state
    for frame in (first, last, answer):
        state.history.add(frame)
    view._go_back(type("Tap", (), {"x": last.iteration + 0.3}))
    assert state.frame is last
    assert state.iteration == last.iteration
