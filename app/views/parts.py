"""Parts of figures: bare figures, colour bars, tips, lines, and looks of glyphs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import panel as pn
from bokeh.models import (
    ColorBar,
    CustomJS,
    Glyph,
    GlyphRenderer,
    HoverTool,
    LayoutDOM,
    LinearColorMapper,
    Pane,
    Range1d,
    Spacer,
)
from bokeh.plotting import figure
from numpy.typing import ArrayLike

from solver.arrays import Array

LEAST = 60.0
"""Least width and height for which a figure is laid out, px: one that is out of sight
has a size of zero."""
KEEP_SHEETS = """
const {set, ...rest} = Object.getOwnPropertyDescriptor(Node.prototype, "textContent")
Object.defineProperty(HTMLStyleElement.prototype, "textContent", {
  ...rest,
  set(text) { if (text !== this.textContent) { set.call(this, text) } },
})
"""
"""Script that has the browser read a style sheet anew only where its text is another.
Bokeh sets those of all parts of a figure for each picture, and asks for styles in
between (https://github.com/bokeh/bokeh/issues/15286): a fifth of the browser's time."""
LAY_OUT = "Bokeh.index.find_one(plot)?.invalidate_layout()"
"""Script that lays a figure out anew."""


def bare(
    min_height: int,
    across: tuple[float, float],
    up: tuple[float, float],
    **more: Any,
) -> figure:
    """A figure without tools, frame and grid, with a minimum height, px, and limits."""
    plot = figure(
        sizing_mode="stretch_both",
        min_height=min_height,
        tools="",
        toolbar_location=None,
        title=None,
        x_range=Range1d(*across),
        y_range=Range1d(*up),
        # Of the first row and column of its pixels Bokeh clears but a half: what is
        # painted there would stay as dots.
        min_border=1,
        y_axis_type=None,
        **more,
    )
    plot.center = []
    plot.outline_line_color = None
    plot.background_fill_alpha = 0.0
    plot.border_fill_alpha = 0.0
    return plot


def color_bar(plot: figure, colors: LinearColorMapper, **look: Any) -> ColorBar:
    """A colour bar at the right of a figure, hidden until there are values.

    The bar keeps its mapper: where a figure that the browser knows comes to another
    card, Bokeh sets what is new in it before that is complete
    (https://github.com/bokeh/bokeh/pull/13710).
    """
    bar = ColorBar(
        color_mapper=colors,
        visible=False,
        width=9,
        # Half of a letter: values at its ends are read in full.
        padding=7,
        margin=0,
        title_standoff=4,
        title_text_font_style="normal",
        background_fill_alpha=0.0,
        **look,
    )
    plot.add_layout(bar, "right")
    # Bokeh keeps its width: with other limits its values would be cut, and with another
    # title that would lie on the plot.
    script = CustomJS(args={"plot": plot}, code=LAY_OUT)
    bar.js_on_change("title", script)
    colors.js_on_change("low", script)
    colors.js_on_change("high", script)
    return bar


def hover(
    plot: figure, renderers: list[GlyphRenderer], tips: Mapping[str, str]
) -> None:
    """Show values at the pointer: titles, and columns of the renderers' sources."""
    plot.add_tools(HoverTool(renderers=renderers, tooltips=list(tips.items())))


def visuals(kind: type[Glyph], look: Mapping[str, Any]) -> dict[str, Any]:
    """Properties of a kind of glyph; `color`, `width` etc. are of its line and fill."""
    names = kind.properties()
    properties = {}
    for trait, given in look.items():
        if trait in names:
            properties[trait] = given
            continue
        for name in (f"line_{trait}", f"fill_{trait}"):
            if name in names:
                properties[name] = given
    return properties


def laid_out_alone(plot: LayoutDOM) -> pn.pane.Bokeh:
    """A pane with a figure that is laid out separately, and fills its container.

    Bokeh lays out all that has a common root whenever one part asks for it, as each
    widget does that is new, and each figure whose labels become longer. A `Pane` ends
    this: what is in it is a root of its own, which follows its own size alone. And
    Panel, which takes the callbacks of the model of a pane that leaves the page, leaves
    those of the figure.
    """
    own_root = Pane(elements=[plot], styles={"width": "100%", "height": "100%"})
    room = Spacer(
        elements=[own_root], sizing_mode="stretch_both", min_height=plot.min_height
    )
    return pn.pane.Bokeh(room, margin=0)


@contextmanager
def come_last(panes: Sequence[pn.pane.Bokeh], document: Any) -> Iterator[None]:
    """Add separately laid out figures to a page after other changes.

    All goes in one message. Panel goes through all models of what is new several times,
    and most of these are the figures'.
    """
    rooms = [pane.object for pane in panes]
    figures = [room.elements for room in rooms]
    with pn.io.hold(document), document.models.freeze():
        for room in rooms:
            room.elements = []
        yield
        for room, elements in zip(rooms, figures, strict=True):
            room.elements = elements


def gapped(lines: Array) -> Array:
    """Join lines, shape (n, k, 2), with NaN after each, shape (n (k + 1), 2)."""
    gaps = np.full((len(lines), 1, 2), np.nan)
    return np.concatenate([lines, gaps], axis=1).reshape(-1, 2)


def heads_of(tips: Array, along: Array, lengths: Array) -> Array:
    """Corners of the heads of arrows, (n, 3, 2), px.

    From their tips, (n, 2), unit vectors along them, (n, 2), and lengths, (n, 1).
    """
    ends = tips - lengths * along
    half = 0.5 * lengths * along[:, ::-1] * [-1.0, 1.0]
    return np.stack([tips, ends + half, ends - half], axis=1)


def joined(curves: Iterable[ArrayLike]) -> Array:
    """Join curves, shape (2, n) each, with NaN in between, shape (2, n_all)."""
    gap = np.full((2, 1), np.nan)
    pieces: list[Array] = []
    for curve in curves:
        if pieces:
            pieces.append(gap)
        pieces.append(np.asarray(curve))
    if not pieces:
        return gap[:, :0]
    return np.concatenate(pieces, axis=1)
