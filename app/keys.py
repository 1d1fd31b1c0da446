"""Keys, heard by the browser wherever nothing else takes them, and what words of the page mean."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui
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
WORDS = {
    "LATIN": "The method: in turns it obeys the contact laws point by point and the elasticity of "
    "the bodies, at all instants at once, until both agree.",
    "iteration": "One turn of the method; each improves all instants at once.",
    "indicator η": "How far apart the two stages of an iteration are. It is no error, as it also "
    "depends on the search direction k.",
    "k-free indicator": "By how much the iterate breaks the contact laws, as a share of the energy "
    "in play, whatever k is.",
    "search direction k": "The stiffness that joins the two stages. It changes how many iterations "
    "are needed, not the solution.",
    "error": "Distance to the reference, as a share of its size: of the contact force, or of the "
    "displacement.",
    "reference": "The solution of an incremental solver on the same mesh, instant by instant.",
    "closed form": "The exact solution by formula, without a mesh along the body.",
    "substructure": "A piece of a body; every iteration solves each by itself.",
    "multiscale": "A small coarse problem balances the mean forces of all substructures at every "
    "iteration. Without it (monoscale) a load travels one substructure an iteration.",
    "search, answer": "The search is LATIN's own iterates. The answer is found from their stick, "
    "slip and opening by one linear problem, and counts if it obeys all laws: certified.",
    "stick, slip, open": "Friction below its bound; friction at its bound, the point slides; no "
    "contact.",
    "PGD, mode": "Model reduction: a field is a sum of few modes, each a shape in space times a "
    "function of time.",
    "singular values": "Sizes of the modes that describe a field best: where they fall fast, a few "
    "modes suffice.",
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


def dialog() -> pmui.Dialog:
    """The list of keys and words."""
    rows = "".join(
        f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in {**HELP, **WORDS}.items()
    )
    table = f'<table style="text-align:left;font-size:14px">{rows}</table>'
    return pmui.Dialog(
        pn.pane.HTML(table, sizing_mode="stretch_width"),
        title="Keys and words",
        width_option="md",
        show_close_button=True,
        close_on_click=True,
    )
