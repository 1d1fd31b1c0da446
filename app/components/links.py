"""Links to runs, which the page itself follows, and not the browser by opening it anew."""

from __future__ import annotations

from app.components.innards import Plain
from app.components.panes import script


class Links(Plain):
    """What hears that a link of class `run` is followed, anywhere on the page: its address."""

    _esm = script("links.js")
