"""Boxes of legends, whose entries follow each other in a line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bokeh.models import Legend
from bokeh.plotting import figure

from app.views.type_size import TEXT

OVER_AXIS = {"margin-left": "-52px", "top": "-1px"}
"""Style of a legend that begins at the left end of the figure, above its axis."""
CLOSE = """
.bk-grid { gap: 6px 5px !important; }
.bk-item { gap: 4px !important; }
.bk-item .bk-label { min-width: 0 !important; }
"""
"""Style sheet by which a legend of seven entries stands in one line; the theme keeps
entries farther apart."""
FLOWING = """
.bk-grid {
  display: flex !important;
  flex-wrap: wrap;
  width: auto !important;
  gap: 0 5px !important;
}
:host(.column) .bk-grid { flex-direction: column; gap: 6px !important; }
"""
"""Style sheet by which the entries of a legend follow each other, and take a second
line where the first has no room; or stand below each other."""
WIDE = ":host { width: calc(100% - 8px); }"
WIDER = ":host { width: calc(100% + 52px); }"
"""Style sheets of a legend beside a plot, without and with an axis at the left. It is
as wide whatever its entries are: a figure is painted once more when the size of its
legend changes."""


def legend(plot: figure, items: Sequence[Any], place: str = "above") -> Legend:
    """A legend in one line: above the plot, below it, or inside."""
    styles = {"font-size": TEXT}
    sheets = [CLOSE, FLOWING]
    if place != "center":
        sheets.append(WIDE)
        if any(axis.visible for axis in plot.yaxis):
            styles |= OVER_AXIS
            sheets.append(WIDER)
    box = Legend(
        items=items,
        orientation="horizontal",
        location="top_left",
        padding=0,
        margin=2,
        label_height=12,
        glyph_height=12,
        glyph_width=12,
        background_fill_alpha=0.0,
        # The page's theme has none, but not that of a page that is saved.
        border_line_color=None,
        styles=styles,
        stylesheets=sheets,
    )
    plot.add_layout(box, place)
    return box
