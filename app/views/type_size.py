"""Type size of the words in a figure, which is larger on a projector."""

from __future__ import annotations

from bokeh import models
from bokeh.core.properties import value
from bokeh.models import ColorBar, CustomJS, Title
from bokeh.plotting import figure

TEXT = "12px"
WORDS = "14px"
"""Type sizes of plots, and of words at arrows, as CSS has them."""
LETTER = 0.56
ROW = 1.3
"""Width of a letter and height of a line of words over their type size, about."""
FONT = value("Roboto, sans-serif")
"""The page's font, for texts that are drawn in plots."""
KEEP = "if (cb_obj.tags.length) { cb_obj.setv(cb_obj.tags[0]) }"
"""Script that keeps sizes that are not the theme's: the browser sets those of the theme
as it draws a figure."""


def magnify(plot: figure, size: str, words: str) -> None:
    """Set the type size of a figure, and that of words in it, as CSS has them."""
    keep = CustomJS(code=KEEP)
    # Each by itself: an em is 13 pixels to axes, whatever the style.
    for model in (plot, *plot.legend):
        model.styles = {**model.styles, "font-size": size}
    # Marks of legends are as large as their words: on a projector colours are seen.
    pixels = round(float(size.removesuffix("px")))
    marks = dict.fromkeys(("glyph_width", "glyph_height", "label_height"), pixels)
    for box in plot.legend:
        box.update(tags=[marks], **marks)
        if not box.js_property_callbacks:
            box.js_on_change("glyph_width", keep)
    # Bokeh's own search would go through the figure for each kind.
    parts = plot.references()
    for part in parts:
        if isinstance(part, models.Text):
            part.text_font_size = words
    titled = [part for part in parts if isinstance(part, Title | ColorBar)]
    for model in (*plot.axis, *titled):
        names = [name for name in model.properties() if name.endswith("text_font_size")]
        sizes = dict.fromkeys(names, size)
        tags = []
        if size != TEXT:
            tags = [sizes]
        model.update(tags=tags, **sizes)
        if f"change:{names[0]}" not in model.js_property_callbacks:
            model.js_on_change(names[0], keep)
