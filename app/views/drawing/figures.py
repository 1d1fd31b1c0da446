"""The figures of views, made once: what pictures set of them has a name by which it is found."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bokeh.models import (
    Axis,
    BasicTicker,
    ColumnDataSource,
    CustomJS,
    CustomJSTickFormatter,
    FixedTicker,
    Grid,
    HoverTool,
    Image,
    LinearAxis,
    LinearColorMapper,
    LinearScale,
    LogAxis,
    LogScale,
    MultiLine,
    NoOverlap,
    Plot,
    Range1d,
    Scatter,
    Text,
)
from bokeh.models.annotations.legends import ColorBar
from bokeh.models.glyphs import Patches
from bokeh.models.widgets import Div

from app.languages.language import Language
from app.picture.glossary import ENGLISH
from app.picture.units import TICKS
from app.views.drawing.colors import GREY, shaded
from app.views.drawing.drawing import View
from app.views.drawing.legend import card_title

FIT = """
const [left, right, low, high, ...rooms] = box.data.edge
if (figure.properties.inner_width.is_unset) { return }
const wide = figure.inner_width, tall = figure.inner_height
if (!(wide > 1 && tall > 1 && right > left)) { return }
// Words have the size of type; of the rest, what is beside the bodies takes what these leave.
const line = words ? LINE * parseFloat(words.text_font_size.value) / 13 : 0
const [, , under = 0, over = 0, lines_under = 0, lines_over = 0, flattest = 0, filled] = rooms
const aside = under + over, inner = tall - line * (lines_under + lines_over)
const wanted = flattest ? filled * inner : (high - low) * wide / (right - left)
const unit = Math.max(Math.min((inner - wanted) / (aside || 1), wide / 400, 1.6), 0.35)
const [before, after, below, above] = [0, 0, lines_under, lines_over].map((count, side) =>
  unit * rooms[side] + line * count)
const fits = (size, whole, room) => size / Math.max(whole - room, 0.2 * whole)
let across = fits(right - left, wide, before + after), up = fits(high - low, tall, below + above)
if (flattest) { up = Math.max(up, flattest / unit) }
else { across = up = Math.max(across, up) }
const put = (range, low, high, scale, whole, first, last) => {
  const start = low - scale * (first + 0.5 * (whole - first - last - (high - low) / scale))
  const values = {start, end: start + scale * whole}
  if (range.held) { range.held = values } else { range.setv(values, {sync: false}) }
}
put(figure.x_range, left, right, across, wide, before, after)
put(figure.y_range, low, high, up, tall, below, above)
Object.assign(box, {unit, per: [unit * across, unit * up]})
for (const one of shifted) { one.properties.data.change.emit() }
"""
"""Makes both axes of one scale, however large the plot is; not while one has zoomed in."""
LINE = 17
"""Height of a line of words, px, in type of 13."""
SHIFT = """
if (!box.per) { return }
const {dx, dy, ...data} = given.data, [x, y] = "xs" in data ? ["xs", "ys"] : ["x", "y"]
const moved = (own, by, per) =>
  own.map((at, i) => at + per * (by.length === 1 ? by[0] : by[i]))
const put = (own, by, per) => x === "x" ? moved(own, by, per)
  : own.map((one, i) => moved(one, by[i], per))
// Bands are as thick as there is room for.
const width = data.width?.map((one) => one < THINNEST ? one : Math.max(one * box.unit, 1.5))
const places = {[x]: put(data[x], dx, box.per[0]), [y]: put(data[y], dy, box.per[1])}
drawn.setv({data: {...data, ...width && {width}, ...places}}, {sync: false})
"""
"""Puts what a picture gives beside its place to where it is drawn, in the scale that there is."""
THINNEST = 3
"""Width from which a line is a band."""
SHADES = 180
FONT = "Roboto, sans-serif"
"""The colours of words follow the theme: the style sheet has them."""


def make_figure(view: View, say: Language = ENGLISH) -> Plot:
    """Make the figure of a view; among its tags is a model with what stands above it."""
    plot, slug = view.plot, view.slug
    made = _axes(view, say)
    if plot.palette:
        _add_colors(made, view, say)
    drawn = {"curves": _add_curves(made, view)}
    words = _words() if plot.words else None
    if words is not None:
        drawn["words"] = _empty(f"{slug}.words.drawn", "x", "y", "text", "across", "up")
        made.add_glyph(drawn["words"], words)
    if plot.is_touched:
        contacts = _empty(f"{slug}.contacts", "xs", "ys", "name")
        made.tags = [*made.tags, contacts, _empty(f"{slug}.along", "x")]
    if plot.is_touched and plot.words:
        names = "xs", "ys", "setting", "value", "rate", "is_metric"
        drawn["handles"] = _empty(f"{slug}.handles.drawn", *names)
        made.tags = [*made.tags, drawn["handles"]]
    if plot.equal:
        _fit(made, view, words, drawn if plot.words else {})
    return made


def _fit(made: Plot, view: View, words: Text | None, drawn: Mapping[str, ColumnDataSource]) -> None:
    """Have what is to be seen fill the figure, and what is drawn beside its place keep its size."""
    box = ColumnDataSource({"edge": []}, name=f"{view.slug}.box")
    shifted = []
    for name, source in drawn.items():
        given = _empty(f"{view.slug}.{name}", *map(str, source.data), "dx", "dy")
        args = {"given": given, "drawn": source, "box": box}
        given.js_on_change(
            "data", CustomJS(args=args, code=SHIFT.replace("THINNEST", str(THINNEST)))
        )
        shifted.append(given)
    known: dict[str, Any] = {"figure": made, "box": box, "words": words, "shifted": shifted}
    fit = CustomJS(args=known, code=FIT.replace("LINE", str(LINE)))
    box.js_on_change("data", fit)
    for name in ("inner_width", "inner_height"):
        made.js_on_change(name, fit)
    if words is not None:
        words.js_on_change("text_font_size", fit)


def _axes(view: View, say: Language) -> Plot:
    """Make empty axes; `bokeh.plotting.figure` makes twice as many models, none of them needed."""
    look, slug = view.plot, view.slug
    made = Plot(
        height=230,
        min_height=60 if look.words else 100,
        sizing_mode="stretch_both",
        title=None,
        toolbar_location=None,
        x_scale=LogScale() if "x" in look.logarithmic else LinearScale(),
        y_scale=LogScale() if "y" in look.logarithmic else LinearScale(),
        x_range=Range1d(start=1, end=2, name=f"{slug}.x"),
        y_range=Range1d(start=1, end=2, name=f"{slug}.y"),
        min_border_right=16,
        min_border_top=6,
        # The card is seen instead.
        background_fill_color=None,
        border_fill_color=None,
        outline_line_color=None,
        tags=[Div(text=card_title(view.name, (), say=say), name=f"{slug}.title")],
    )
    if look.names:
        made.add_tools(HoverTool(tooltips=[(say(look.names), "@name")]))
    if not look.x_label:
        return made
    made.add_layout(_axis("x", say(look.x_label), view), "below")
    axis = _axis("y", say(look.y_label), view)
    made.add_layout(axis, "left")
    if not look.chooses:
        made.add_layout(Grid(dimension=1, axis=axis, grid_line_color=GREY, grid_line_alpha=0.25))
    return made


def _axis(name: str, label: str, view: View) -> Axis:
    look, named = view.plot, f"{view.slug}.{name}-axis"
    style: dict[str, Any] = {
        "name": named,
        "axis_label": label,
        "axis_label_standoff": 4,
        "axis_label_text_font": FONT,
        "axis_label_text_font_size": "14px",
        "axis_label_text_font_style": "normal",
        "major_label_text_font": FONT,
        "major_label_text_font_size": "13px",
        "axis_line_color": None,
        "major_tick_line_color": None,
        "minor_tick_line_color": None,
    }
    if name in look.logarithmic:
        style["ticker"] = FixedTicker(ticks=[], name=f"{view.slug}.{name}-ticks")
        return LogAxis(major_label_policy=NoOverlap(), **style)
    # Labels are half of what a browser paints.
    least = 1 if name in look.whole else 0
    # Along x, and where a height chooses what one looks at, numbers have few digits.
    if name == "y" and look.chooses in ("", "time"):
        style["formatter"] = CustomJSTickFormatter(code=TICKS)
    return LinearAxis(ticker=BasicTicker(desired_num_ticks=4, min_interval=least), **style)


def _add_curves(made: Plot, view: View) -> ColumnDataSource:
    """Add one glyph for all curves, whose source is given, and one for each kind of marks."""
    slug = view.slug
    names = ("xs", "ys", "color", "width", "alpha", "dash", "name")
    lines = MultiLine(line_color="color", line_width="width", line_alpha="alpha", line_dash="dash")
    drawn = _empty(f"{slug}.curves.drawn" if view.plot.words else f"{slug}.curves", *names)
    made.add_glyph(drawn, lines)
    for marks in view.plot.marks:
        is_ring = marks.kind == "ring"
        glyph = Scatter(
            marker="x" if marks.kind == "cross" else "circle",
            size=9 if marks.kind == "cross" else 11,
            fill_color=None if is_ring else marks.color,
            line_color=marks.color,
            line_width=2,
        )
        made.add_glyph(_empty(f"{slug}.{marks.kind}", "x", "y"), glyph)
    return drawn


def _words() -> Text:
    return Text(
        text_align="across",
        text_baseline="up",
        text_font={"value": FONT},
        text_font_size="13px",
        text_font_style="bold",
        text_line_height=1.25,
        background_fill_alpha=0.75,
    )


def _add_colors(made: Plot, view: View, say: Language) -> None:
    """Add an image, or bodies, and the scale of their colours."""
    plot, slug = view.plot, view.slug
    palette = list(plot.palette) if not plot.scale else shaded(SHADES, plot.palette)
    high = len(palette) - 1 if not plot.scale else 1
    mapper = LinearColorMapper(palette=palette, low=0, high=high, name=f"{slug}.colors")
    if plot.equal:
        color: Any = {"field": "value", "transform": mapper}
        source = _empty(f"{slug}.bodies", "xs", "ys", "value")
        alpha = 0.6 if plot.words else 1.0
        shown = {"fill_color": color, "fill_alpha": alpha, "line_color": color, "line_width": 0.5}
        made.add_glyph(source, Patches(**shown, name=f"{slug}.patches"))
    elif not plot.names:
        source = _empty(f"{slug}.image", "image", "x", "y", "dw", "dh")
        made.add_glyph(source, Image(dw="dw", dh="dh", color_mapper=mapper))
    if plot.scale:
        bar = ColorBar(
            ticker=BasicTicker(desired_num_ticks=4, min_interval=0 if plot.equal else 1),
            major_label_policy=NoOverlap(),
            color_mapper=mapper,
            title=say(plot.scale),
            title_text_font=FONT,
            title_text_font_size="13px",
            title_text_font_style="normal",
            major_label_text_font=FONT,
            major_label_text_font_size="13px",
            major_tick_line_color=None,
            bar_line_color=None,
            background_fill_color=None,
            width=10,
            padding=4,
            name=f"{slug}.color-bar",
        )
        made.add_layout(bar, "right")


def _empty(name: str, *columns: str) -> ColumnDataSource:
    return ColumnDataSource({column: [] for column in columns}, name=name)
