"""The figures of views, made once: what pictures set of them has a name by which it is found."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bokeh.events import Pan, Tap
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    CustomJS,
    FixedTicker,
    LinearColorMapper,
    Range1d,
)
from bokeh.plotting import figure

from app.views.colors import shaded
from app.views.drawing import View

FIT = """
const [left, right, low, high] = box.data.edge
const wide = figure.inner_width, tall = figure.inner_height
if (!(wide > 1 && tall > 1 && right > left)) { return }
const scale = Math.max((right - left) / wide, (high - low) / tall)
const x = 0.5 * (left + right), y = 0.5 * (low + high)
figure.x_range.setv({start: x - 0.5 * scale * wide, end: x + 0.5 * scale * wide}, {sync: false})
figure.y_range.setv({start: y - 0.5 * scale * tall, end: y + 0.5 * scale * tall}, {sync: false})
"""
"""Makes both axes of one scale, however large the plot is."""
SHADES = 180


def make_figure(view: View, choose: Callable[[float], None]) -> Any:
    """Make the figure of a view; a tap or a drag chooses a height, where the view says so."""
    plot, slug = view.plot, view.slug
    made = _axes(view)
    if plot.palette:
        _add_colors(made, view)
    if plot.equal:
        box = ColumnDataSource({"edge": []}, name=f"{slug}.box")
        fit = CustomJS(args={"figure": made, "box": box}, code=FIT)
        box.js_on_change("data", fit)
        made.js_on_change("inner_width", fit)
        made.js_on_change("inner_height", fit)
    else:
        _add_curves(made, view)
    if plot.chooses:
        made.grid.visible = False
        made.on_event(Tap, lambda event: choose(event.y))
        made.on_event(Pan, lambda event: choose(event.y))
    return made


def _axes(view: View) -> Any:
    plot, slug = view.plot, view.slug
    made = figure(
        height=230,
        min_height=150,
        sizing_mode="stretch_both",
        toolbar_location=None,
        tools="hover" if plot.names else "",
        tooltips=[(plot.names, "@name")] if plot.names else None,
        x_axis_label=plot.x_label,
        y_axis_label=plot.y_label,
        x_axis_type="log" if "x" in plot.logarithmic else "linear",
        y_axis_type="log" if "y" in plot.logarithmic else "linear",
        x_range=Range1d(1, 2, name=f"{slug}.x"),
        y_range=Range1d(1, 2, name=f"{slug}.y"),
        min_border_right=12,
        min_border_top=6,
    )
    for name, axis in (("x", made.xaxis[0]), ("y", made.yaxis[0])):
        axis.name = f"{slug}.{name}-axis"
        if name in plot.logarithmic:
            axis.ticker = FixedTicker(ticks=[], name=f"{slug}.{name}-ticks")
        elif isinstance(axis.ticker, BasicTicker):
            # Labels are half of what a browser paints.
            axis.ticker.desired_num_ticks = 4
            if name in plot.whole:
                axis.ticker.min_interval = 1
    made.axis.axis_label_text_font_size = "14px"
    made.axis.major_label_text_font_size = "13px"
    made.axis.axis_label_standoff = 4
    made.axis.minor_tick_line_color = None
    made.xgrid.visible = False
    made.outline_line_color = None
    return made


def _add_curves(made: Any, view: View) -> None:
    """Add one glyph for all curves, and one for each kind of marks."""
    slug = view.slug
    names = ("xs", "ys", "color", "width", "alpha", "dash", "name")
    made.multi_line(
        "xs",
        "ys",
        source=_empty(f"{slug}.curves", *names),
        line_color="color",
        line_width="width",
        line_alpha="alpha",
        line_dash="dash",
    )
    for marks in view.plot.marks:
        is_ring = marks.kind == "ring"
        made.scatter(
            "x",
            "y",
            source=_empty(f"{slug}.{marks.kind}", "x", "y"),
            marker="x" if marks.kind == "cross" else "circle",
            size=9 if marks.kind == "cross" else 11,
            fill_color=None if is_ring else marks.color,
            line_color=marks.color,
            line_width=2,
        )


def _add_colors(made: Any, view: View) -> None:
    """Add an image, or bodies, and the scale of their colours."""
    plot, slug = view.plot, view.slug
    palette = list(plot.palette) if not plot.scale else shaded(SHADES, plot.palette)
    high = len(palette) - 1 if not plot.scale else 1
    mapper = LinearColorMapper(palette=palette, low=0, high=high, name=f"{slug}.colors")
    if plot.equal:
        color = {"field": "value", "transform": mapper}
        source = _empty(f"{slug}.bodies", "xs", "ys", "value")
        made.patches("xs", "ys", source=source, fill_color=color, line_color=color, line_width=0.5)
    elif not plot.names:
        source = _empty(f"{slug}.image", "image", "x", "y", "dw", "dh")
        made.image("image", "x", "y", "dw", "dh", source=source, color_mapper=mapper)
    if plot.scale:
        bar = ColorBar(
            ticker=FixedTicker(ticks=[], name=f"{slug}.scale"),
            color_mapper=mapper,
            title=plot.scale,
            width=10,
            padding=4,
            title_text_font_size="12px",
            major_label_text_font_size="12px",
            name=f"{slug}.bar",
        )
        made.add_layout(bar, "right")


def _empty(name: str, *columns: str) -> ColumnDataSource:
    return ColumnDataSource({column: [] for column in columns}, name=name)
