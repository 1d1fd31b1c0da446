"""Keys, heard by the browser wherever nothing else takes them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bokeh.core.properties import Int, String
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import CustomJS

HELP = {
    "Space": "run, pause, or run anew",
    "s": "one iteration; of a run that has ended, show the next",
    "r": "start again, and wait after the first iteration",
    "t": "play through time, or stop",
    "← →": "the instant before, the next instant",
    "Shift ← →": "the iteration before, the next iteration",
    "p": "presenter view, for a projector, and back",
    "?": "this list, and what the words of the page mean",
}
LISTEN = """
document.addEventListener("keydown", (event) => {
  const target = event.composedPath()[0]
  const takes = target.closest?.(taken) || (event.key == " " && target.closest?.("button"))
  const name = (event.shiftKey && event.key.startsWith("Arrow") ? "Shift+" : "") + event.key
  if (takes || event.ctrlKey || event.metaKey || event.altKey || !names.includes(name)) { return }
  event.preventDefault()
  keys.pressed = name
  keys.count += 1
})
"""


TAKEN = "input, textarea, select, [role=slider], [role=tab], [role=dialog]"
"""Elements that take keys for themselves."""


class Keys(DataModel):
    """The last key that was pressed, and a count of them."""

    pressed: str = String(default="")  # type: ignore[assignment]
    count: int = Int(default=0)  # type: ignore[assignment]


def listen(document: Any, does: Mapping[str, Callable[[], Any]]) -> None:
    """Have keys do something, by their names in the browser."""
    keys = Keys(name="keys")
    keys.on_change("count", lambda name, old, new: does[keys.pressed]())
    document.add_root(keys)
    code = CustomJS(args={"keys": keys, "names": list(does), "taken": TAKEN}, code=LISTEN)
    document.js_on_event(DocumentReady, code)
