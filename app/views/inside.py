"""Pictures of what is inside bodies: stress, and lines of thrust."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import LinearColorMapper
from bokeh.palettes import Cividis256, RdBu11
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.axis import rounded_up
from app.views.colors import ERROR, LATIN
from app.views.layout import Layout
from app.views.parts import color_bar
from app.views.picture import Picture
from app.views.scene import Scene
from solver.files.amounts import unit_for

WIDEST = 9.0
FAINTEST = 0.01
"""Width of the line of the largest thrust, px, and share of it below which a thrust has
no line."""
STRESS_STEPS = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
"""Ends of the scale of stresses, times a power of ten: it seldom changes."""


class ExtraScene(Scene):
    """The scene without loads and interfaces, with an extra if the frame has it."""

    is_bare = True

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the bodies at the selected instant, and the extra."""
        super().update(frame, selection, ghost)
        (name,) = self.needs
        extra = frame.extras.get(name)
        if extra is None:
            self._clear()
        else:
            self._show(extra, self.picture)

    def _clear(self) -> None:
        """Leave nothing of the extra of a frame before."""
        self.clear(*self.needs)

    def _show(self, extra: Any, picture: Picture) -> None:
        raise NotImplementedError


class Stress(ExtraScene):
    """A stress in every cell that is drawn, at the selected instant."""

    name = "Stress"
    needs = frozenset({"stress"})

    def _draw(self, plot: figure) -> None:
        self.colors = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0)
        color = {"field": "value", "transform": self.colors}
        self.add(
            "stress",
            "Patches",
            "xs ys",
            also="value",
            fill_color=color,
            line_color=color,
        )
        self.bar = color_bar(plot, self.colors)
        super()._draw(plot)

    def _clear(self) -> None:
        super()._clear()
        # Its title may be of another scene.
        self.bar.visible = False

    def _show(self, extra: Any, picture: Picture) -> None:
        self.bar.visible = True
        title, si, values = extra
        largest = float(np.abs(values).max())
        unit = unit_for(largest, si)
        high = rounded_up(0.999 * largest / unit.factor, STRESS_STEPS)
        # Tension and compression have a scale with white in the middle.
        if float(values.min()) < -1e-3 * largest:
            self.colors.update(palette=RdBu11, low=-high, high=high)
        else:
            self.colors.update(palette=Cividis256, low=0.0, high=high)
        self.bar.title = f"{title}, {unit.name}"
        corners = picture.many(picture.nodes[picture.frame.run.geometry.cells])
        self.fill("stress", **corners, value=values[:, picture.column] / unit.factor)


class Thrust(ExtraScene):
    """Resultant forces of joints, as lines from body to body; hinges of a chain.

    The width of a line is in proportion to its force; the largest force of all instants
    has the widest line. Bodies are drawn as they were: there the forces act, which
    magnified displacements would part from them.
    """

    name = "Thrust"
    needs = frozenset({"thrust"})
    # Between two joints, as of a bolt, there is a single line.
    applies = staticmethod(
        lambda settings: settings.has_joints and settings.n_interfaces > 2
    )

    def _draw(self, plot: figure) -> None:
        super()._draw(plot)
        look = {"line_color": LATIN, "line_alpha": 0.8, "line_cap": "round"}
        self.add("thrust", "MultiLine", "xs ys line_width", **look)
        look = {"fill_color": "white", "line_color": ERROR, "line_width": 2.5}
        self.add("hinges", "Scatter", "x y", size=9, **look)

    def _clear(self) -> None:
        super()._clear()
        self.clear("hinges")

    def _magnification(self, frame: Frame, layout: Layout) -> float:
        return 0.0

    def _show(self, extra: Any, picture: Picture) -> None:
        largest = extra["largest"]
        share = extra["forces"][:, picture.column] / (largest or 1.0)
        is_drawn = share > FAINTEST
        lines = picture.layout.local(extra["lines"][is_drawn, :, :, picture.column])
        self.fill("thrust", **picture.many(lines), line_width=WIDEST * share[is_drawn])
        is_hinge = extra["hinges"][:, picture.column] > 0.0
        hinges = picture.layout.local(extra["lines"][is_hinge, 1, :, picture.column])
        x, y = picture.page(hinges).T
        self.fill("hinges", x=x, y=y)
        note = f"widest line {unit_for(largest, 'N')(largest)}"
        if len(hinges):
            note += f"; hinges: {len(hinges)}"
        self.show("note", note)
