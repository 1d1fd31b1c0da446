"""The keys of the page, and what its words mean."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui

from app.browser import HELP
from app.widgets import dialog

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


def glossary() -> pmui.Dialog:
    """A dialog of both."""
    tables = pn.pane.HTML(f"{_table(HELP)}{_table(WORDS)}", sizing_mode="stretch_width")
    return dialog("Keys and words", tables, width_option="md")


def _table(entries: dict[str, str]) -> str:
    rows = "".join(f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in entries.items())
    return f'<table style="text-align:left;font-size:14px;margin-bottom:12px">{rows}</table>'
