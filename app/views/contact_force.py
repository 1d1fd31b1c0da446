"""Friction along the interface beside the reference, and what lies between them."""

from __future__ import annotations

from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import ERROR, EXACT, GHOST, LATIN, REFERENCE
from app.views.view import View, legend, plot, source


class ContactForce(View):
    """Friction force at the selected instant, LATIN on top of the reference, the error shaded."""

    name = "Friction force"

    def make(self) -> figure:
        """A new figure."""
        made = plot("x, m", "N")
        self.source = source("x", "latin", "reference", "upper", "lower")
        self.ghost, self.exact = source("x", "y"), source("x", "y")
        area = made.varea("x", "reference", "latin", source=self.source, color=ERROR, alpha=0.35)
        exact = made.line("x", "y", source=self.exact, color=EXACT, width=4, alpha=0.6)
        ghost = made.line("x", "y", source=self.ghost, color=GHOST, width=1.5, dash="dotted")
        reference = made.line("x", "reference", source=self.source, color=REFERENCE, width=1.5)
        latin = made.line("x", "latin", source=self.source, color=LATIN, width=2.5)
        for side in ("upper", "lower"):
            bound = made.line("x", side, source=self.source, color=GHOST, dash="dashed")
        legend(
            made,
            {
                "LATIN": [latin],
                "reference": [reference],
                "error": [area],
                "bound": [bound],
                "closed form": [exact],
                "run before": [ghost],
            },
        )
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the friction force along the selected interface."""
        run = frame.run
        name, column = selection.interface_of(run), run.column(selection.phase)
        interface, fields = run.interfaces[name], frame.contact.get(name)
        if fields is None:
            return
        x, latin = interface.positions, fields.friction[:, column]
        reference = run.reference[name].friction[:, column] if run.reference else latin
        if interface.bound is not None:
            bound = interface.bound[:, min(column, interface.bound.shape[1] - 1)]
        else:
            bound = interface.coefficient[:, 0] * fields.pressure[:, column]
        self.source.data = {
            "x": x, "latin": latin, "reference": reference, "upper": bound, "lower": -bound,
        }
        before = ghost.contact.get(name) if ghost is not None else None
        self.ghost.data = (
            {"x": ghost.run.interfaces[name].positions, "y": before.friction[:, ghost.run.column(selection.phase)]}
            if before is not None
            else {"x": [], "y": []}
        )
        known = run.known("friction")
        self.exact.data = (
            {"x": known[0].across, "y": known[0].up[:, column]} if known else {"x": [], "y": []}
        )
