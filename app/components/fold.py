"""A button that shows all of what stands behind it, or folds it again."""

from __future__ import annotations

from typing import ClassVar

import param

from app.components.innards import Plain
from app.components.panes import script

STYLE = """
button { width: 100%; height: 44px; font: inherit; color: inherit; cursor: pointer;
  background: transparent; border: 0; }
button::after { content: " ▴" / ""; }
button[aria-expanded=true]::after { content: " ▾" / ""; }
:host(.whole) button { height: 24px; padding: 0; white-space: nowrap; }
:host(.whole) button::after { content: " ▾" / ""; }
:host(.whole) button[aria-expanded=true]::after { content: " ▴" / ""; }
"""


class Fold(Plain):
    """The button.

    Attributes
    ----------
    label
        What it says.
    keeps
        Class of what has to stay in sight above what is unfolded, or empty.
    kept_as
        Name by which the browser remembers whether it is unfolded, or empty.
    """

    label = param.String()
    keeps = param.String()
    kept_as = param.String()

    _esm = script("within.js", "fold.js")
    _stylesheets: ClassVar[list[str]] = [STYLE]
