"""The keys of the page, and the dialog that lists them and the words of the page."""

from __future__ import annotations

from typing import ClassVar

import param

from app.components.innards import Plain
from app.components.panes import script

KEYS = (
    (" ", "Space", "run, pause, or replay a run that has ended"),
    ("s", "s", "do one iteration; of a run that has ended, show the next, or the first again"),
    ("r", "r", "start the run again"),
    ("t", "t", "play through time, or stop"),
    ("ArrowLeft", "←", "the instant before"),
    ("ArrowRight", "→", "the next instant"),
    ("Shift+ArrowLeft", "Shift ←", "the iteration before"),
    ("Shift+ArrowRight", "Shift →", "the next iteration"),
    ("Ctrl+z", "Ctrl Z", "undo the last change of settings, scene or lesson; a drag is one"),
    ("Ctrl+Shift+z", "Ctrl Shift Z", "do again what was undone"),
    ("Ctrl+y", "Ctrl Y", "the same"),
    ("", "Page ↓ ↑", "in presenter view, a lesson: what a class predicts, the answer, its parts"),
    ("p", "p", "presenter view, for a projector, and back"),
    ("f", "f", "one plot on the whole page: that with the pointer or the focus; Escape: back"),
    ("+", "+ −", "zoom in and out of that plot; so does the wheel with Ctrl"),
    ("0", "0", "all of that plot again; so does a double click"),
    ("?", "?", "these lists"),
)
"""Name of the key, how it is written, and what it does."""
IN_THE_BROWSER = ("f", "+", "-", "0", "?")
STYLE = """
button { font: inherit; color: inherit; background: transparent; cursor: pointer;
  width: 28px; height: 28px; border-radius: 14px;
  border: 1px solid color-mix(in srgb, currentColor 45%, transparent); }
.corner { display: flex; flex-direction: var(--stacked, row); gap: 8px; }
dialog { border: 0; border-radius: 8px; padding: 16px 24px 20px; font-size: 17px; line-height: 1.7;
  color: var(--mui-palette-text-primary); background: var(--mui-palette-background-paper);
  box-shadow: 0 8px 40px rgba(0, 0, 0, 0.5); }
dialog::backdrop { background: rgba(0, 0, 0, 0.35); }
dialog { max-width: 900px; max-height: 85vh; overflow-y: auto; }
h2 { margin: 0 0 8px; font-size: 20px; }
table + h2 { margin-top: 16px; }
th { padding-right: 20px; text-align: left; vertical-align: top; white-space: nowrap; }
.words { font-size: 15px; line-height: 1.4; }
.words td { padding-bottom: 4px; }
"""


class Keys(Plain):
    """A small button that lists keys and words; it hears keys wherever they are free.

    Messages are the names of keys that the server follows.

    Attributes
    ----------
    keys
        Which there are, as `KEYS` says.
    terms
        What words of the page mean, as `terms_in` says it.
    own
        Those that the browser follows by itself; plots hear them as the event "plot-key".
    hears
        Whether keys move the run: while it is looked at, once the page is built.
    presents
        Whether there is a way out of the presenter's view to be shown.
    """

    keys = param.List(default=[list(key) for key in KEYS])
    terms = param.List(default=[])
    own = param.List(default=list(IN_THE_BROWSER))
    hears = param.Boolean(default=False)
    presents = param.Boolean(default=False)

    _esm = script("say.js", "elements.js", "within.js", "glossary.js", "keys.js")
    _stylesheets: ClassVar[list[str]] = [STYLE]
