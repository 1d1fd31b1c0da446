"""What the browser does around plots by itself: values, zoom, one of them on the whole page."""

from __future__ import annotations

from typing import ClassVar

from app.components.innards import Plain
from app.components.panes import script

STYLE = """
div { position: fixed; z-index: 1310; display: flex; align-items: center; gap: 6px; }
div[hidden] { display: none; }
output, button { font: 500 14px/1.3 var(--bokeh-base-font, sans-serif); border-radius: 4px;
  color: var(--mui-palette-text-primary); background: var(--mui-palette-background-paper); }
output { padding: 0 4px; font-variant-numeric: tabular-nums; }
output:empty { display: none; }
button { width: 26px; height: 24px; padding: 0; cursor: pointer;
  border: 1px solid color-mix(in srgb, currentColor 40%, transparent); }
"""


class Lens(Plain):
    """Shows the values under the pointer, and a button on the card that one looks at."""

    _esm = script("say.js", "within.js", "picture/powers.js", "lens.js")
    _stylesheets: ClassVar[list[str]] = [STYLE]
