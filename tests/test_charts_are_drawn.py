"""Every kind of chart is drawn of plain data, fills in place, and stands in pages by itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bokeh.models import ColorBar, ColumnDataSource, ContinuousColorMapper, HoverTool
from browser import Chrome
from sweeps import tiny

from app.charts.draw import draw
from app.charts.filling import Filling, fill, form
from app.charts.keys import legend
from app.charts.layers import levels
from app.charts.page import render
from solver.study.chart import Chart, Map, Panel, PanelAxis, PanelCurve
from solver.study.page import GROUP, NO_CHARTS, PlotSection, renderer, write_page
from solver.study.sweep import Plan, Row
from solver.study.sweep.chart import chart_of, charts

X = np.array([1.0, 2.0, 3.0])
PANEL = Panel(
    "Curves",
    PanelAxis("Place", "m"),
    PanelAxis("Force", "N", logarithmic=True),
    (PanelCurve("one", X, X, 1), PanelCurve("two", X, np.array([1.0, 0.0, 2.0]), 2, "points")),
)
LINES = tiny(["k_scale=0.1:10:3:log", "acceleration=none,anderson"], ["iterations"])
AREA = tiny(["friction=0.1:0.7:7", "peak=300:1500:9"], ["peak_displacement"])


def rows_of_map(count: int = 63) -> list[Row]:
    """Give rows in no order of their numbers; the last but one has not converged."""
    order = np.random.default_rng(1).permutation(AREA.size)[:count]
    rows = [Row(int(n), "converged", "", (1.0 + n % 9 * (n // 9 + 1.0),)) for n in order]
    return [replace(row, ending="exhausted") if i == 1 else row for i, row in enumerate(rows)]


ENDS = [
    Row(4, "converged", "", (3.0,)),
    Row(0, "exhausted", "Raise max_iterations.", (12.0,)),
    Row(2, "converged", "", (np.inf,)),
    Row(1, "converged", "", (5.0,)),
]


def columns(figure: Any, name: str) -> dict[str, Any]:
    source = figure.select_one({"name": name})
    assert isinstance(source, ColumnDataSource), name
    return source.data


def everything(figure: Any) -> dict[str, Any]:
    return {
        source.name: {name: np.asarray(list(map(str, data))) for name, data in source.data.items()}
        for source in figure.select({"type": ColumnDataSource})
    }


def test_curves_are_drawn_with_their_values_but_what_a_scale_cannot_hold() -> None:
    figure = draw(PANEL)
    assert columns(figure, "curve-0")["y"].tolist() == [1.0, 2.0, 3.0]
    assert np.isnan(columns(figure, "curve-1")["y"]).tolist() == [False, True, False]
    assert len(columns(figure, "curve-1-points")["x"]) == 3
    assert (figure.title.text, figure.yaxis.axis_label) == ("Curves", "Force (N)")


def test_answers_what_has_not_converged_and_what_has_no_value_stand_apart() -> None:
    chart = chart_of(LINES, ENDS)
    figure = draw(chart, None, (1.0, 5.0))
    assert columns(figure, "answer")["number"].tolist() == [4, 1]
    assert columns(figure, "hollow")["number"].tolist() == [0]
    assert columns(figure, "nothing")["number"].tolist() == [2]
    (low, high) = figure.y_range.start, figure.y_range.end
    assert low < columns(figure, "nothing")["y"][0] < high
    assert columns(figure, "ring")["y"].tolist() == [5.0]
    assert len(columns(figure, "ghost")["xs"]) == 0
    assert any(isinstance(tool, HoverTool) for tool in figure.tools)
    assert ">Acceleration none<" in legend([chart])
    kinds = {one.data_source.name: one.glyph for one in figure.renderers}
    for name in ("answer", "hollow", "nothing"):
        assert kinds[name].line_color.field == "color", name


def test_a_map_has_cells_contours_their_values_and_a_scale_of_colours() -> None:
    chart = chart_of(AREA, rows_of_map())
    figure = draw(chart, chart, None)
    assert len(columns(figure, "answer")["left"]) == 62
    assert len(columns(figure, "hollow")["left"]) == 1
    assert len(columns(figure, "contour")["xs"]) == len(columns(figure, "ghost")["xs"]) > 3
    assert "20" in columns(figure, "label")["text"]
    assert len(figure.select({"type": ColorBar})) == 1


def test_what_lies_between_few_runs_is_drawn_and_the_runs_upon_it() -> None:
    corners = [0, 8, 54, 62, 30]
    (chart,) = charts(AREA, [Row(n, "converged", "", (float(n + 1),)) for n in corners])
    figure = draw(chart)
    assert len(columns(figure, "between")["left"]) == AREA.size
    assert len(columns(figure, "answer")["x"]) == 5


@pytest.mark.parametrize(
    ("plan", "rows"), [(LINES, ENDS), (AREA, rows_of_map())], ids=["curves", "map"]
)
def test_a_chart_that_fills_comes_to_what_is_drawn_at_once(plan: Plan, rows: list[Row]) -> None:
    whole = chart_of(plan, rows)
    started = len(rows) - 2
    assert form(chart_of(plan, rows[:started])) == form(whole)
    figure = draw(chart_of(plan, rows[:started]))
    kept = {name: figure.select_one({"name": name}) for name in ("answer", "hollow")}
    fill(figure, whole, None, None)
    at_once = draw(whole)
    found, wanted = everything(figure), everything(at_once)
    assert found.keys() == wanted.keys()
    for name, own in wanted.items():
        for column, values in own.items():
            assert found[name][column].tolist() == values.tolist(), (name, column)
    assert all(figure.select_one({"name": name}) is one for name, one in kept.items())
    colours = [one.select({"type": ContinuousColorMapper}) for one in (figure, at_once)]
    assert {(one.low, one.high) for one in colours[0]} == {
        (one.low, one.high) for one in colours[1]
    }
    for axis in ("x_range", "y_range"):
        ends = [(getattr(one, axis).start, getattr(one, axis).end) for one in (figure, at_once)]
        assert ends[0] == ends[1]


def test_of_a_map_that_fills_only_new_runs_are_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    rows, sent = rows_of_map(), list[int]()
    figure = draw(chart_of(AREA, rows[:40]))
    stream = ColumnDataSource.stream
    monkeypatch.setattr(
        ColumnDataSource,
        "stream",
        lambda self, new: sent.append(len(new["left"])) or stream(self, new),
    )
    fill(figure, chart_of(AREA, rows[:45]), None, None)
    fill(figure, chart_of(AREA, rows), None, None)
    assert sent == [5, 18]


def test_a_figure_on_a_page_is_touched_in_turns_of_the_page_alone() -> None:
    rows, acts = rows_of_map(), list[Callable[[], object]]()
    filling = Filling(acts.append, lambda: None)
    filling.show(chart_of(AREA, rows[:30]), None, None)
    assert filling._drawing is not None
    filling._drawing.result()
    filling.catch_up()
    filling.go_on(filling.figure.id)
    before = everything(filling.figure)
    filling.show(chart_of(AREA, rows), None, None)
    # What a browser does may be heard while Bokeh has the document for itself.
    np.testing.assert_equal(everything(filling.figure), before)
    for act in acts:
        act()
    assert len(columns(filling.figure, "answer")["x"]) == len(rows) - 1


def test_the_chart_before_is_between_the_ends_of_the_axis_too() -> None:
    low = [Row(n, "converged", "", (2.0 + n,)) for n in range(6)]
    high = [Row(n, "converged", "", (30.0 + n,)) for n in range(6)]
    before, chart = chart_of(LINES, high), chart_of(LINES, low)
    figure = draw(chart)
    assert figure.y_range.end < 30.0
    fill(figure, chart, before, None)
    assert figure.y_range.start < 2.0
    assert figure.y_range.end > 35.0
    assert len(columns(figure, "ghost")["xs"]) == 2


def test_what_is_zoomed_stays_while_a_chart_fills() -> None:
    figure = draw(chart_of(AREA, rows_of_map(40)))
    figure.x_range.update(start=0.2, end=0.3)
    fill(figure, chart_of(AREA, rows_of_map()), None, None)
    assert (figure.x_range.start, figure.x_range.end) == (0.2, 0.3)


@pytest.mark.parametrize(("low", "high", "log"), [(0.0, 9.3, False), (-5e-5, 2e-4, False)])
def test_contours_are_at_values_that_are_easily_read(low: float, high: float, log: bool) -> None:
    found = levels(low, high, logarithmic=log)
    assert 3 <= len(found) <= 9
    assert ((found > low) & (found < high)).all()
    assert all(float(f"{value:.2g}") == pytest.approx(value) for value in found)
    decades = levels(3e-6, 0.2, logarithmic=True)
    assert decades.tolist() == pytest.approx([1e-5, 1e-4, 1e-3, 1e-2, 0.1])


def kinds() -> list[Chart]:
    (sampled,) = charts(AREA, [Row(n, "converged", "", (n + 1.0,)) for n in (0, 8, 54, 62, 30)])
    assert isinstance(sampled, Map)
    assert sampled.is_sampled
    return [PANEL, chart_of(LINES, ENDS), chart_of(AREA, rows_of_map()), sampled]


def test_a_page_draws_every_kind_without_network_and_has_bokeh_once(
    tmp_path: Path, chrome: Chrome
) -> None:
    file, asked, complaints = tmp_path / "page.html", list[str](), list[str]()
    report = ["<p>Words.</p>", PlotSection("Two", kinds()[:2]), PlotSection("Maps", kinds()[2:])]
    assert write_page(file, "A page", report) == ""
    assert file.stat().st_size < 2_000_000
    page = chrome.new_page(900, 700)
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text))
    page.goto(file.as_uri())
    page.wait_for_function(
        """() => {
          const drawn = window.Bokeh?.documents.flatMap((one) => one.roots()) ?? []
          return drawn.length === 4 && drawn.every((one) => Bokeh.index.find_one(one)?.is_idle)
        }"""
    )
    assert page.get_by_role("figure").count() == 2
    complaints = [one for one in complaints if not one.startswith("[bokeh")]
    chrome.leave(page)
    assert [one for one in asked if not one.startswith(("file:", "data:", "blob:"))] == []
    assert complaints == []


def test_the_engine_finds_who_draws_by_an_entry_point() -> None:
    assert renderer() is render


@pytest.mark.parametrize("value", [None, "no_such_module:render"])
def test_without_anybody_who_draws_a_page_has_words_and_says_so_in_a_line(
    value: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = [EntryPoint("any", value, GROUP)] if value else []
    monkeypatch.setattr("solver.study.page.entry_points", lambda group: EntryPoints(there))
    file = tmp_path / "page.html"
    note = write_page(file, "A page", ["<p>Words.</p>", PlotSection("One", [PANEL])])
    assert note == NO_CHARTS
    assert "\n" not in note
    text = file.read_text(encoding="utf-8")
    assert "<p>Words.</p>" in text
    assert NO_CHARTS in text
    assert "<script" not in text
    assert write_page(file, "A page", ["<p>Words alone.</p>"]) == ""
