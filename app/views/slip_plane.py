"""Two points in the plane of their slips: what friction can hold moves, and pushes them."""

from __future__ import annotations

import numpy as np
from bokeh.plotting import figure

from app.frame import Floats, Frame, Selection
from app.views.colors import CUT, DISPLACEMENT, ERROR, FORWARD, LATIN, REFERENCE
from app.views.view import Axis, Key, View, extent, mark, plot, put, source
from solver.settings import Settings

FAR = 10.0
"""Times the plot by which a line goes beyond it."""


class SlipPlane(View):
    """Where two points have slipped, and the lines between which both stick."""

    name = "Slip plane"
    needs = frozenset({"slips"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether two points rub, whose friction follows from what presses them."""
        law = settings.values().get("friction_law")
        return settings.opens and law == "coulomb" and settings.n_jumps == 4

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        self._x, self._y = Axis(made, "x", "left slip", "m"), Axis(made, "y", "right slip", "m")
        self.lines = {name: source("x", "y") for name in ("left", "right", "path", "room", "now")}
        room = made.patch("x", "y", source=self.lines["room"], color=DISPLACEMENT, alpha=0.3)
        looks = {"left": (LATIN, 1.5), "right": (FORWARD, 1.5), "path": (REFERENCE, 2)}
        lines = {
            name: [made.line("x", "y", source=self.lines[name], color=color, width=width)]
            for name, (color, width) in looks.items()
        }
        made.scatter("x", "y", source=self.lines["now"], color=ERROR, size=10)
        self._key = Key(
            made,
            {
                "left slips": lines["left"],
                "right slips": lines["right"],
                "so far": lines["path"],
                "free in the last cycle": [room],
                "contact alone holds the block": [mark(made, CUT, alpha=0.0)],
            },
        )
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show where both have slipped so far, and the lines at which they slip now."""
        slips, column = frame.extras.get("slips", {}), frame.run.column(selection.phase)
        self._key.show(
            {
                "left slips": bool(slips),
                "right slips": bool(slips),
                "so far": bool(slips),
                "free in the last cycle": bool(slips) and len(slips["room"]) > 0,
                "contact alone holds the block": slips is None,
            }
        )
        if not slips:
            for name in self.lines:
                self._draw(name, np.zeros((2, 0)))
            return
        corners = slips["room"].T
        for axis, row in ((self._x, 0), (self._y, 1)):
            axis.hold(frame.run.number, *extent([slips["slip"][row], corners[row]]), 0.1)
        self._draw("room", corners)
        self._draw("path", slips["slip"][:, : column + 1])
        self._draw("now", slips["slip"][:, [column]])
        far = FAR * max(np.ptp(axis) for axis in np.concatenate([slips["slip"], corners], axis=1))
        for number, name in enumerate(("left", "right")):
            rows = slice(number, None, 2)
            self._draw(name, _lines(slips["matrix"][rows], slips["limit"][rows, column], far))

    def _draw(self, name: str, pairs: Floats) -> None:
        put(self.lines[name], x=self._x(pairs[0]), y=self._y(pairs[1]))


def _lines(matrix: Floats, limit: Floats, far: float) -> Floats:
    """Lines A w = b as one curve broken by NaN, shape (2, n)."""
    sizes = np.linalg.norm(matrix, axis=1)
    feet = matrix * (limit / sizes**2)[:, None]
    along = far * np.stack([-matrix[:, 1], matrix[:, 0]], axis=1) / sizes[:, None]
    ends = np.stack([feet - along, feet + along, np.full_like(feet, np.nan)], axis=1)
    return np.asarray(ends.reshape(-1, 2).T)
