"""A slider that pictures and the user both move.

Where it stands is a parameter, and what the user wants a message, so that no late echo of a shown
value is taken for a wish (Material sliders send such echoes when they are updated many times a
second).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param

from app.components.innards import Plain
from app.components.panes import script

STYLE = """
label { display: block; font-size: 15px; line-height: 1.4; white-space: nowrap; }
output { font-weight: 600; }
.line { display: flex; align-items: center; gap: 6px; height: 24px; }
input { flex: 1; min-width: 0; margin: 0; accent-color: var(--accent); cursor: pointer; }
button { padding: 0 5px; font: inherit; font-size: 13px; line-height: 1.4; color: inherit;
  background: transparent; border-radius: 4px; cursor: pointer;
  border: 1px solid color-mix(in srgb, currentColor 40%, transparent); }
:host(.inline) div:has(> label) { display: flex; gap: 8px; align-items: center; }
:host(.inline) .line { flex: 1; }
"""


class Scrubber(Plain):
    """A range from `start` to `end`; messages say where the user moves it, or None for its button.

    Attributes
    ----------
    shown
        Where it stands.
    plays
        What its button says that plays through it; without words there is none.
    playing
        Whether it does.
    """

    label = param.String(default="")
    help = param.String(default="")
    text = param.String(default="", doc="What is written beside the label.")
    start = param.Integer(default=0)
    end = param.Integer(default=1)
    shown = param.Integer(default=0)
    plays = param.String(default="")
    playing = param.Boolean(default=False)

    _esm = script("say.js", "elements.js", "scrubber.js")
    _stylesheets: ClassVar[list[str]] = [STYLE]


def scrubber(
    width: int, wish: Callable[[int], None], play: Callable[[], None] | None = None, **options: Any
) -> Scrubber:
    """Make one for a row, where its label needs this width, px.

    `wish` is told what is wanted, `play` when the button is pressed.
    """

    def hear(place: int | None) -> None:
        if place is not None:
            wish(place)
        elif play is not None:
            play()

    made = Scrubber(
        margin=(0, 8),
        min_width=width,
        sizing_mode="stretch_width",
        styles={"flex": f"1 1 {width}px"},
        **options,
    )
    made.on_msg(lambda message: hear(message.data))
    return made
