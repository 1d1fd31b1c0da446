"""A slider that the server and the user both move.

What the server shows and what the user wants are two parameters, one for each direction, so that
no late echo of a shown value is taken for a wish (Material sliders send such echoes when they are
updated many times a second).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param

from app.innards import Prompt

STYLE = """
label { display: block; font-size: 15px; line-height: 1.4; white-space: nowrap; }
output { font-weight: 600; }
input { display: block; width: 100%; margin: 4px 0; accent-color: #1976d2; cursor: pointer; }
button { float: right; padding: 0 6px; font: inherit; line-height: 1.3; color: inherit;
  background: transparent; border-radius: 4px; cursor: pointer;
  border: 1px solid color-mix(in srgb, currentColor 40%, transparent); }
"""


class Scrubber(Prompt):
    """A range from `start` to `end`.

    Attributes
    ----------
    shown
        Where it stands.
    wanted
        Where the user moved it last.
    plays
        What its button says that plays through it; without words there is none.
    playing
        Whether it does.
    pressed
        Counts how often that button was pressed.
    """

    label = param.String(default="")
    help = param.String(default="")
    text = param.String(default="", doc="What is written beside the label.")
    start = param.Integer(default=0)
    end = param.Integer(default=1)
    shown = param.Integer(default=0)
    wanted = param.Integer(default=-1)
    plays = param.String(default="")
    playing = param.Boolean(default=False)
    pressed = param.Integer(default=0)

    _esm = "scrubber.js"
    _stylesheets: ClassVar[list[str]] = [STYLE]


def scrubber(width: int, wish: Callable[[int], None], **options: Any) -> Scrubber:
    """Make one for a row, where its label needs this width, px; `wish` is told what is wanted."""
    made = Scrubber(
        margin=(0, 8),
        min_width=width,
        sizing_mode="stretch_width",
        styles={"flex": f"1 1 {width}px"},
        **options,
    )
    made.param.watch(lambda event: wish(event.new), "wanted")
    return made
