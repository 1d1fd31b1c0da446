"""What a chart is drawn of: layers, each a table of columns and its looks, the lowest first.

The columns are those of the data sources that a figure has, so that a chart fills by these alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from app.views.drawing.colors import FORCE, GREY, shaded
from solver.arrays import Array, Flags, Indices
from solver.study.chart import HUES, Chart, Map, Panel, PanelCurve, Runs

COLORS = (GREY, *HUES)
"""Of curves by their hue; grey is of references."""
COLOURS = 64
"""Of a map."""
MOST_LEVELS = 8
"""Lines of equal value on a map."""
BY_HUE = {"color": "hue", "cmap": list(COLORS), "clim": (-0.5, len(COLORS) - 0.5)}
SAYS: dict[str, Any] = {"tools": ["hover"], "hover_tooltips": "@said"}
FEWEST = 4
"""Points of a line that has room for its value."""
PAPER = {"background_fill_color": "#fff", "background_fill_alpha": 0.7}
HIT = 2.0
"""Times its size that a point is hit from."""
Here = tuple[float, float]
NOWHERE = np.zeros(0)
Mark = Literal["Curve", "Contours", "Points", "Rectangles", "Labels"]


@dataclass(frozen=True, eq=False)
class Layer:
    """Marks of one kind.

    Attributes
    ----------
    name
        Of its data source.
    columns
        Of this, n entries each.
    looks
        Options of HoloViews.
    """

    name: str
    mark: Mark
    columns: dict[str, Any]
    looks: dict[str, Any] = field(default_factory=dict)


def layers(chart: Chart, before: Chart | None = None, here: Here | None = None) -> list[Layer]:
    """Say of what a chart is drawn.

    Parameters
    ----------
    chart
        Whatever there is of it.
    before
        One of the same axes, of which a ghost is left.
    here
        A place on the axes that is marked.
    """
    make = _of_map if isinstance(chart, Map) else _of_panel
    return list(make(chart, before, here or (np.nan, np.nan)))  # type: ignore[arg-type]


def edges(values: Array, *, logarithmic: bool) -> Array:
    """Give where cells about ascending values end, shape (n + 1,)."""
    v = np.log(values) if logarithmic else values
    steps = np.diff(v) if len(v) > 1 else np.ones(1)
    inner = (v[:-1] + v[1:]) / 2.0
    found: Array = np.concatenate([[v[0] - steps[0] / 2.0], inner, [v[-1] + steps[-1] / 2.0]])
    return np.exp(found) if logarithmic else found


def limits(chart: Chart, before: Chart | None) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Give the ends of both axes, between which the chart before is too; None for whatever fits."""
    if isinstance(chart, Panel):
        up, old = chart.y.limits, before.y.limits if before else None
        if up and old and (old[0] > 0.0 or not chart.y.logarithmic):
            up = min(up[0], old[0]), max(up[1], old[1])
        return chart.x.limits or (None, None), up or (None, None)
    x = edges(chart.x_values, logarithmic=chart.x.logarithmic)
    y = edges(chart.y_values, logarithmic=chart.y.logarithmic)
    return (float(x[0]), float(x[-1])), (float(y[0]), float(y[-1]))


def span(chart: Map) -> tuple[float, float]:
    """Give the ends of the scale of colours."""
    known = chart.z[np.isfinite(chart.z)]
    if not known.size:
        return (1.0, 10.0)
    low, high = float(known.min()), float(known.max())
    by = 0.1 * abs(low) or 1.0
    return (low, high) if low < high else (low - by, high + by)


def levels(low: float, high: float, *, logarithmic: bool) -> Array:
    """Give values that are easily read between two others."""
    if logarithmic:
        powers = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)))
        found = np.outer(powers, [1.0, 2.0, 5.0] if len(powers) <= 4 else [1.0]).ravel()
    else:
        rough = (high - low) / MOST_LEVELS
        power = 10.0 ** np.floor(np.log10(rough))
        step = power * next(one for one in (1.0, 2.0, 5.0, 10.0) if one * power >= rough)
        found = step * np.arange(np.ceil(low / step), high / step)
    return np.asarray(found[(found > low) & (found < high)])


def _of_panel(panel: Panel, before: Panel | None, here: Here) -> Iterator[Layer]:
    old = before.curves if before else ()
    lines = [curve for curve in old if curve.line != "faint" and len(curve.x)]
    looks = {**BY_HUE, "line_dash": "dashed", "line_width": 2.0, "alpha": 0.4}
    if panel.runs is not None:
        yield Layer("ghost", "Contours", _paths(lines), looks)
    for place, curve in enumerate(panel.curves):
        yield from _of_curve(panel, curve, place)
    if panel.runs is not None:
        yield from _of_runs(panel, before, panel.runs, here)


def _of_curve(panel: Panel, curve: PanelCurve, place: int) -> Iterator[Layer]:
    y = np.where(curve.y > 0.0, curve.y, np.nan) if panel.y.logarithmic else curve.y
    columns, color = {"x": curve.x, "y": y}, COLORS[curve.hue]
    has_points, is_faint = curve.line == "points", curve.line == "faint"
    name, plain = f"curve-{place}", has_points or is_faint
    looks = {
        "color": color,
        "line_dash": "solid" if plain else curve.line,
        "line_width": 1.0 if plain else 2.2,
        "alpha": 0.35 if is_faint else 1.0,
    }
    if panel.runs is None:
        told = [("", curve.label), (panel.x.label, "@x"), (panel.y.label, "@y")]
        looks |= {"tools": ["hover"], "hover_tooltips": told}
    yield Layer(name, "Curve", columns, looks)
    if has_points:
        yield Layer(f"{name}-points", "Points", columns, {"color": color, "size": 6})


def _of_runs(panel: Panel, before: Panel | None, runs: Runs, here: Here) -> Iterator[Layer]:
    (_, (low, high)), (x, y), axis = limits(panel, before), here, panel.y
    known = np.isfinite(runs.y)
    # What has no value stands at the upper edge.
    top = high * (low / high) ** 0.03 if axis.logarithmic else high - 0.03 * (high - low)
    dots = {**BY_HUE, **SAYS, "size": 7, "hit_dilation": HIT, "line_width": 1.6}
    dotted = {"color": FORCE, "line_dash": "dotted", "line_width": 1.5}
    yield Layer("here", "Curve", {"x": np.full(2, x), "y": np.array([low, high])}, dotted)
    yield Layer("hollow", "Points", _told(runs, known & ~runs.holds), {**dots, "fill_alpha": 0.0})
    yield Layer("answer", "Points", _told(runs, known & runs.holds), dots)
    never = {**_told(runs, ~known), "y": np.full((~known).sum(), top)}
    yield Layer("nothing", "Points", never, {**dots, "marker": "x", "line_width": 2.0})
    yield _ring(x, y)


def _of_map(chart: Map, before: Map | None, here: Here) -> Iterator[Layer]:
    runs, answers = chart.runs, chart.runs.holds
    line = {"tools": [], "line_width": 1.2}
    by_value = {
        **{"color": "value", "cmap": shaded(COLOURS), "clim": span(chart), "line_alpha": 0.0},
        **{"logz": chart.scale.logarithmic, "colorbar": True, "clabel": chart.scale.unit},
    }
    hatched = {
        "fill_alpha": 0.0,
        "line_alpha": 0.0,
        "backend_opts": {
            "glyph.hatch_pattern": {"value": "right_diagonal_line"},
            "glyph.hatch_color": {"value": GREY},
        },
    }
    if chart.is_sampled:
        yield Layer("between", "Rectangles", _between(chart), by_value)
    else:
        yield Layer("answer", "Rectangles", _cells(chart, answers), {**by_value, **SAYS})
        yield Layer("hollow", "Rectangles", _cells(chart, ~answers), {**hatched, **SAYS})
    paths, _ = _contours(before) if before else (_paths([]), None)
    yield Layer("ghost", "Contours", paths, {**line, "color": "#fff", "line_dash": "dashed"})
    paths, labels = _contours(chart)
    labels = labels if chart.level is None else _values(chart)
    yield Layer("contour", "Contours", paths, {**line, "color": "#000", "alpha": 0.75})
    halo = {"text_color": "#000", "text_font_size": "11px", **PAPER}
    yield Layer("label", "Labels", labels, halo)
    if chart.is_sampled:
        dots = {"color": "#fff", "line_color": "#444", "size": 4, **SAYS}
        yield Layer("answer", "Points", _told(runs, answers), dots)
    yield _ring(*here)


def _ring(x: float, y: float) -> Layer:
    """Mark where the present settings stand."""
    there = np.isfinite([x, y]).all()
    columns = {"x": np.array([x] if there else []), "y": np.array([y] if there else [])}
    looks = {"color": FORCE, "fill_alpha": 0.0, "size": 16, "line_width": 2.5}
    return Layer("ring", "Points", columns, looks)


def _told(runs: Runs, which: Flags) -> dict[str, Any]:
    return {
        "x": runs.x[which],
        "y": runs.y[which],
        "hue": runs.hues[which].astype(float),  # whole ones HoloViews takes for a colour
        "number": runs.numbers[which],
        "said": [runs.said[int(place)] for place in np.flatnonzero(which)],
    }


def _cells(chart: Map, which: Flags) -> dict[str, Any]:
    """Give a cell for each run."""
    told, runs = _told(chart.runs, which), chart.runs
    columns, rows = (
        np.searchsorted(values, told[name])
        for name, values in (("x", chart.x_values), ("y", chart.y_values))
    )
    return {**_sides(chart, columns, rows), "value": runs.values[which], **told}


def _between(chart: Map) -> dict[str, Any]:
    """Give a cell for each value, whether a run has given it or not."""
    rows, columns = np.nonzero(np.isfinite(chart.z))
    return {**_sides(chart, columns, rows), "value": chart.z[rows, columns]}


def _values(chart: Map) -> dict[str, Any]:
    """Write into each cell what it is."""
    rows, columns = np.nonzero(np.isfinite(chart.z))
    text = [f"{value:.2g}" for value in chart.z[rows, columns]]
    return {"x": chart.x_values[columns], "y": chart.y_values[rows], "text": text}


def _sides(chart: Map, columns: Indices, rows: Indices) -> dict[str, Array]:
    x = edges(chart.x_values, logarithmic=chart.x.logarithmic)
    y = edges(chart.y_values, logarithmic=chart.y.logarithmic)
    return {"left": x[columns], "bottom": y[rows], "right": x[columns + 1], "top": y[rows + 1]}


def _paths(curves: list[PanelCurve]) -> dict[str, Any]:
    return {
        "xs": [curve.x for curve in curves],
        "ys": [curve.y for curve in curves],
        "hue": [float(curve.hue) for curve in curves],
    }


def _contours(chart: Map) -> tuple[dict[str, Any], dict[str, Any]]:
    """Give the lines of equal value, straight between runs on the page, and what stands on them."""
    # Slow to import, as is all that draws: by then HoloViews has done it.
    from bokeh.plotting.contour import contour_data

    paths, labels = list[tuple[Array, Array]](), list[tuple[float, float, str]]()
    several = levels(*span(chart), logarithmic=chart.scale.logarithmic)
    at = several if chart.level is None else np.array([chart.level])
    if min(chart.z.shape) > 1 and at.size:
        axes = (chart.x, chart.y)
        there = [np.log if axis.logarithmic else np.asarray for axis in axes]
        back = [np.exp if axis.logarithmic else np.asarray for axis in axes]
        x, y = (to(v) for to, v in zip(there, (chart.x_values, chart.y_values), strict=True))
        of = np.log if chart.scale.logarithmic else np.asarray
        lines: Any = contour_data(x, y, of(chart.z), of(at), want_fill=False).line_data
        for level, across, up in zip(at, lines.xs, lines.ys, strict=True):
            found = _parts(back[0](across), back[1](up))
            paths += found
            along, high = max(found, key=lambda path: len(path[0]), default=(NOWHERE, NOWHERE))
            if len(along) >= FEWEST:
                middle = len(along) // 2
                labels.append((along[middle], high[middle], f"{level:.4g}"))
    xs, ys = [x for x, _ in paths], [y for _, y in paths]
    words = {name: [label[i] for label in labels] for i, name in enumerate(("x", "y", "text"))}
    return {"xs": xs, "ys": ys, "hue": [0.0] * len(paths)}, words


def _parts(x: Array, y: Array) -> list[tuple[Array, Array]]:
    """Give the parts of a line that is interrupted by NaNs."""
    known = np.isfinite(x)
    ends = np.flatnonzero(~known)
    parts = zip(*(np.split(v[known], ends - np.arange(len(ends))) for v in (x, y)), strict=True)
    return [part for part in parts if len(part[0])]
