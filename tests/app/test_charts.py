"""Charts drawn of plain data, in units that are read, in pages of their own."""

from __future__ import annotations

from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path
from tomllib import loads
from typing import Any

import holoviews as hv
import numpy as np
import pytest
from bokeh.models import (
    BasicTicker,
    BasicTickFormatter,
    ColorBar,
    ColumnDataSource,
    FixedTicker,
    HoverTool,
    LogTicker,
    LogTickFormatter,
)
from sweeps import tiny

from app.charts import SIZES, contours, in_units, keys, overlay, render
from solver.study import page
from solver.study.page import (
    Chart,
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    write_page,
)
from solver.study.sweep.charts import chart_of
from solver.study.sweep.plan import Row

X = np.array([1.0, 2.0, 3.0])
PANEL = Panel(
    "Curves",
    PanelAxis("Place", "m"),
    PanelAxis("Force", "N", logarithmic=True),
    (
        PanelCurve("one", X, 1e3 * X, 1),
        PanelCurve("two", X, np.array([1e3, 0.0, 2e3]), 2),
    ),
)
LINES = tiny(["k_scale=0.1:10:3:log", "acceleration=none,anderson"], ["iterations"])
AREA = tiny(["friction=0.1:0.7:7", "peak=300:1500:9"], ["peak_displacement"])
CELLS = [
    Row(n, "converged", "", (1e-3 * (1.0 + n % 9 * (n // 9 + 1.0)),))
    for n in range(AREA.size)
]
ENDS = [
    Row(4, "converged", "", (3.0,)),
    Row(0, "exhausted", "Raise max_iterations.", (12.0,)),
    Row(2, "converged", "", (np.inf,)),
    Row(1, "converged", "", (5.0,)),
]


def draw(chart: Chart) -> Any:
    """Figure of a chart."""
    return hv.renderer("bokeh").get_plot(overlay(in_units(chart))).state


def data_of(figure: Any, column: str) -> list[dict[str, Any]]:
    """Data of all sources that have a column."""
    sources = figure.select({"type": ColumnDataSource})
    return [source.data for source in sources if column in source.data]


def test_values_are_drawn_in_units_that_are_read_but_what_a_scale_cannot_hold() -> None:
    figure = draw(PANEL)
    ys = [
        list(map(str, data["y"]))
        for data in data_of(figure, "y")
        if len(data["y"]) == 3
    ]
    assert sorted(ys) == [["1.0", "2.0", "3.0"], ["1.0", "nan", "2.0"]]
    assert (figure.title.text, figure.yaxis.axis_label) == ("Curves", "Force (kN)")
    assert "> one<" in keys([PANEL])


def test_a_short_logarithmic_axis_has_its_ticks_at_1_2_5() -> None:
    across = PanelAxis("Deflection", "m", logarithmic=True, limits=(0.9e-3, 11e-3))
    up = PanelAxis("Force", "N", logarithmic=True)
    x = np.array([1e-3, 3e-3, 1e-2])
    curve = PanelCurve("one", x, np.array([1.0, 500.0, 1e4]), 1)
    figure = draw(Panel("Curves", across, up, (curve,)))
    assert list(figure.xaxis.ticker.ticks) == [1.0, 2.0, 5.0, 10.0]
    # In the browser texts of single ticks would stay as the ticks change.
    assert not figure.xaxis.major_label_overrides
    assert isinstance(figure.xaxis.formatter, BasicTickFormatter)
    # On a long one powers of ten have room alone.
    assert isinstance(figure.yaxis.ticker, LogTicker)
    assert isinstance(figure.yaxis.formatter, LogTickFormatter)


def test_the_ticks_of_a_chart_that_fills_go_as_far_as_its_axis() -> None:
    across = PanelAxis("Factor", "", logarithmic=True, limits=(0.8, 120.0))
    up = PanelAxis("Iterations", "", logarithmic=True, limits=(0.8, 60.0))
    begun = np.array([1.0, 2.0])
    figure = draw(Panel("Curves", across, up, (PanelCurve("one", begun, begun, 1),)))
    assert max(figure.xaxis.ticker.ticks) == 100.0
    # Over names there are runs alone, without curves.
    named = tiny(["acceleration=none,anderson"], ["iterations"])
    rows = [Row(0, "converged", "", (40.0,)), Row(1, "converged", "", (5.0,))]
    figure = draw(chart_of(named, rows, logarithmic=True))
    assert list(figure.yaxis.ticker.ticks) == [5.0, 10.0, 20.0]


def test_a_setting_of_whole_numbers_has_ticks_at_these_alone() -> None:
    plan = tiny(["cycles=1:3:3"], ["iterations"])
    rows = [Row(number, "converged", "", (5.0,)) for number in range(3)]
    assert list(draw(chart_of(plan, rows)).xaxis.ticker.ticks) == [1, 2, 3]


@pytest.mark.parametrize("height", [280.0, 240.0])
def test_a_point_at_zero_is_seen_whole(height: float) -> None:
    plan = tiny(["friction=0:0.7:8"], ["peak_displacement"])
    rows = [Row(n, "converged", "", (1e-3 * n,)) for n in range(plan.size)]
    figure = draw(chart_of(plan, rows))
    # A point has 7 px across.
    for ends in (figure.x_range, figure.y_range):
        assert -ends.start / (ends.end - ends.start) * height > 3.5
        assert ends.start > -0.05 * ends.end


def test_the_type_of_a_chart_that_fills_keeps_its_size() -> None:
    renderer = hv.renderer("bokeh").instance(theme="light_minimal")
    pipe = hv.streams.Pipe(data=PANEL)
    filling = hv.DynamicMap(lambda data: overlay(data), streams=[pipe])
    plot = renderer.get_plot(filling)
    for unit in ("N", "kN"):
        pipe.send(replace(PANEL, y=replace(PANEL.y, unit=unit)))
        assert plot.state.title.text_font_size == SIZES["title"]
        for axis in plot.state.axis:
            assert axis.axis_label_text_font_size == SIZES["labels"]
            assert axis.major_label_text_font_size == SIZES["ticks"]


def test_a_run_that_did_not_converge_is_hollow_and_says_why() -> None:
    figure = draw(chart_of(LINES, ENDS))
    (runs,) = data_of(figure, "said")
    # With a look of its own for a point that is pointed at, others change markers.
    dots = [part for part in figure.renderers if "said" in part.data_source.data]
    assert [part.hover_glyph for part in dots] == [None]
    # Why a run failed would leave the window in one line.
    (hover,) = figure.select({"type": HoverTool})
    assert "white-space: normal" in hover.tooltips
    looks = dict(
        zip(
            runs["said"],
            zip(runs["fill_alpha"], runs["marker"], strict=True),
            strict=True,
        )
    )
    (hollow,) = (said for said, look in looks.items() if look == (0.0, "circle"))
    (cross,) = (said for said, (_, marker) in looks.items() if marker == "x")
    assert "Raise max_iterations." in hollow
    assert "never" in cross
    assert list(looks.values()).count((1.0, "circle")) == 2


def test_a_map_has_a_cell_for_each_run_contours_their_values_and_a_scale() -> None:
    rows = [
        replace(row, ending="exhausted") if row.number == 5 else row for row in CELLS
    ]
    figure = draw(chart_of(AREA, rows))
    values, runs = sorted(data_of(figure, "left"), key=lambda data: len(data["left"]))
    assert len(values["left"]) == AREA.size - 1
    assert [place for place, hatch in enumerate(runs["hatch"]) if hatch.strip()] == [5]
    assert "20" in data_of(figure, "text")[0]["text"]
    assert "(mm)" in figure.title.text
    assert len(figure.select({"type": ColorBar})) == 1


def test_a_chart_that_fills_shows_what_is_new_in_the_same_figure() -> None:
    first, whole = (in_units(chart_of(LINES, rows)) for rows in (ENDS[:1], ENDS))
    pipe = hv.streams.Pipe(data=first)
    filling = hv.DynamicMap(lambda data: overlay(data), streams=[pipe])
    figure = hv.renderer("bokeh").get_plot(filling).state
    pipe.send(whole)
    assert sum(len(data["said"]) for data in data_of(figure, "said")) == 4
    assert (figure.y_range.start, figure.y_range.end) == whole.y.limits
    other = replace(whole, y=replace(whole.y, unit="k"))
    pipe.send(other)
    assert figure.yaxis.axis_label == other.y.label


@pytest.mark.parametrize(
    ("look", "few", "many"),
    [
        ({"logarithmic": True}, [0.01, 0.02, 0.5], [0.01, 0.1, 4.0]),
        ({"logarithmic": True}, [0.01, 0.02, 0.5], [3.1, 3.3, 3.9]),
        ({"whole": True}, [1.0, 2.0, 3.0], [*range(20, 40)]),
    ],
)
def test_an_axis_of_a_chart_that_fills_has_ticks_for_what_it_shows(
    look: dict[str, Any], few: list[float], many: list[float]
) -> None:
    across = PanelAxis("Deflection", "m")

    def panel(values: list[float]) -> Panel:
        up = PanelAxis("Energy", "J", **look)
        x = np.arange(len(values)) * 1.0
        return Panel("Curves", across, up, (PanelCurve("", x, np.array(values), 1),))

    pipe = hv.streams.Pipe(data=panel(few))
    filling = hv.DynamicMap(lambda data: overlay(data), streams=[pipe])
    figure = hv.renderer("bokeh").get_plot(filling).state
    assert isinstance(figure.yaxis.ticker, FixedTicker)
    pipe.send(panel(many))
    # Tickers of these kinds follow the limits of their axis.
    assert isinstance(figure.yaxis.ticker, LogTicker | BasicTicker)
    assert figure.ygrid[0].ticker == figure.yaxis.ticker
    assert not figure.yaxis.major_label_overrides


@pytest.mark.parametrize("is_logarithmic", [False, True])
def test_lines_of_equal_value_are_of_round_numbers_and_lie_where_these_are(
    is_logarithmic: bool,
) -> None:
    chart = chart_of(AREA, CELLS, logarithmic=is_logarithmic)
    x, y = np.meshgrid(chart.x_values, chart.y_values)
    chart = replace(chart, z=x * y)
    assert not contours(replace(chart, z=np.nan * chart.z))
    lines = contours(chart)
    assert len(lines) > 4
    for line in lines:
        assert float(f"{line['z']:.2g}") == line["z"]
        assert line["x"] * line["y"] == pytest.approx(line["z"], rel=0.05)


def test_what_many_runs_have_in_common_has_no_line() -> None:
    chart = chart_of(AREA, CELLS, logarithmic=False)
    x, y = np.meshgrid(chart.x_values, chart.y_values)
    flat = replace(chart, z=np.maximum(x - np.median(x), 0.0) * y)
    lines = contours(flat)
    assert lines
    assert all(line["z"] > 0.0 for line in lines)


def test_a_page_of_a_command_loads_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page, "renderer", lambda: render)
    plots = [PlotSection("Both", [PANEL])]
    write_page(tmp_path / "page.html", "page.html", plots, title="Two")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<script src" not in text
    assert 'aria-label="Both"' in text


def test_the_engine_finds_who_draws() -> None:
    root = Path(__file__).resolve().parents[2]
    project = loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    ((name, value),) = project["entry-points"][page.GROUP].items()
    assert EntryPoint(name, value, page.GROUP).load() is render


def test_braces_in_a_title_are_braces() -> None:
    named = replace(PANEL, title="{0} {label}.csv")
    assert draw(named).title.text == "{0} {label}.csv"
