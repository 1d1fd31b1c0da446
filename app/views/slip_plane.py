"""Two points in the plane of their slips: what friction can hold moves, and pushes them."""

from __future__ import annotations

import numpy as np

from app.frame import Floats, Frame, Selection
from app.views.acts import gapped
from app.views.colors import DISPLACEMENT, ERROR, FORWARD, LATIN, REFERENCE, UNSEEN
from app.views.view import View
from solver.laws import FrictionLaw

FAR = 10.0
"""Times the plot by which a line goes beyond it."""


class SlipPlane(View):
    """Where two points have slipped, and the lines between which both stick."""

    name = "Slip plane"
    needs = frozenset({"slips"})

    # Two points rub, whose friction follows from what presses them.
    applies = staticmethod(
        lambda settings: settings.opens and settings.jumps == 4 and settings.law == FrictionLaw()
    )

    def _make(self) -> None:
        self.begin(("left slip", "m"), ("right slip", "m"))
        self.add("room", "Patch", color=DISPLACEMENT, alpha=0.3)
        self.add("left", color=LATIN, width=1.5)
        self.add("right", color=FORWARD, width=1.5)
        self.add("path", color=REFERENCE, width=2)
        self.add("now", "Scatter", color=ERROR, size=10)
        self.mark({"held": UNSEEN})
        self.legend(
            left="left slips", right="right slips", path="so far", room="free in the last cycle",
            held="contact alone holds the block",
        )  # fmt: skip

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show where both have slipped so far, and the lines at which they slip now."""
        slips, column = frame.extras.get("slips", {}), frame.run.column(selection.phase)
        self.show("held", slips is None)
        if not slips:
            for name in self.sources:
                self.draw(name, [], [])
            return
        slip, corners = slips["slip"], slips["room"].T
        both = np.concatenate([slip, corners], axis=1)
        for axis, values in zip((self.x, self.y), both, strict=True):
            axis.hold(frame.run.number, values, margin=0.1)
        self.draw("room", *corners)
        self.draw("path", *slip[:, : column + 1])
        self.draw("now", *slip[:, [column]])
        far = FAR * np.ptp(both, axis=1).max()
        for number, name in enumerate(("left", "right")):
            rows = slice(number, None, 2)
            self.draw(name, *_lines(slips["matrix"][rows], slips["limit"][rows, column], far))


def _lines(matrix: Floats, limit: Floats, far: float) -> Floats:
    """Lines A w = b as one curve broken by NaN, shape (2, n)."""
    sizes = np.linalg.norm(matrix, axis=1)
    feet = matrix * (limit / sizes**2)[:, None]
    along = far * np.stack([-matrix[:, 1], matrix[:, 0]], axis=1) / sizes[:, None]
    return gapped(np.stack([feet - along, feet + along], axis=1)).T
