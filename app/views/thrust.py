"""Lines of thrust through many bodies: one sees the load find its way."""

from __future__ import annotations

import numpy as np

from app.frame import Frame, Selection
from app.units import unit_for
from app.views.colors import LATIN
from app.views.scene import Scene

WIDEST = 9.0
"""Width of the line of the largest force, px."""
LEAST = 0.01
"""Share of the largest force below which none is drawn."""


class Thrust(Scene):
    """Resultants of the joints, as lines between the middles of bodies, as wide as they are large.

    The largest force at the instant of the largest is the widest line of all instants.
    """

    name = "Thrust"
    needs = frozenset({"thrust"})
    shows_status = False
    applies = staticmethod(lambda settings: settings.features.bricks > 2)

    def _draw(self, made: object) -> None:
        super()._draw(made)
        look = {"line_color": LATIN, "line_alpha": 0.8, "line_cap": "round"}
        self.add("thrust", "MultiLine", "xs ys line_width", **look)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the forces in all joints at the selected instant, as far as the frame has them."""
        super().update(frame, selection, ghost)
        shown = frame.extras.get("thrust")
        if shown is None or self.picture is None:
            self.fill("thrust", xs=[], ys=[], line_width=[])
            return
        picture, column = self.picture, self.picture.column
        largest = float(shown["forces"].max())
        share = shown["forces"][:, column] / (largest or 1.0)
        drawn = share > LEAST
        lines = picture.layout.local(shown["lines"][drawn, :, :, column])
        x, y = np.moveaxis(np.round(picture.layout.page(lines, picture.tilt), 1), -1, 0)
        self.fill("thrust", xs=x.tolist(), ys=y.tolist(), line_width=WIDEST * share[drawn])
        unit = unit_for(largest, "N")
        self.show("note", f"widest line {unit(largest)}")
