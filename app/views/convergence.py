"""True errors and indicators over the iterations."""

from __future__ import annotations

from bokeh.models import Range1d
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import DISPLACEMENT, ERROR, GHOST
from app.views.view import View, legend, plot, source

LEAST = 1e-4


class Convergence(View):
    """Error of the force bold, and eta on an axis that does not flatten it."""

    name = "Convergence"

    def make(self) -> figure:
        """A new figure."""
        made = plot("iteration", "error, indicator", y_axis_type="log", y_range=Range1d(LEAST, 10))
        self.history = source("iteration", "error_force", "error_displacement", "indicator")
        self.ghost = source("iteration", "error_force")
        made.line("iteration", "error_force", source=self.ghost, color=GHOST, dash="dotted")
        curves = {
            "force error": ("error_force", ERROR, 3.0),
            "displacement error": ("error_displacement", DISPLACEMENT, 2.0),
            "indicator η": ("indicator", GHOST, 1.5),
        }
        entries = {
            title: [made.line("iteration", name, source=self.history, color=color, width=width)]
            for title, (name, color, width) in curves.items()
        }
        legend(made, entries)
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show what the run has come to so far."""
        self.history.data = {name: frame.history[name] for name in self.history.column_names}
        columns = self.ghost.column_names
        self.ghost.data = {name: ghost.history[name] if ghost else [] for name in columns}
