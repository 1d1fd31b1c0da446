"""The scene with its bodies coloured by stress."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColorBar, LinearColorMapper
from bokeh.palettes import Cividis256, diverging_palette
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.units import unit_for
from app.views.scene.scene import Scene, put
from app.views.view import source

SIGNED = diverging_palette(
    ("#053061", "#2166AC", "#67A9CF", "#D1E5F0", "#F2F2F2"),
    ("#67001F", "#B2182B", "#EF8A62", "#FDDBC7", "#F2F2F2"),
    n=9,
    midpoint=0.5,
)


class Stress(Scene):
    """A stress in every quadrilateral that is drawn, at the selected instant."""

    name = "Stress"
    needs = frozenset({"stress"})
    shows_status = False

    def _draw(self, made: figure) -> None:
        self.colors = LinearColorMapper(palette=Cividis256, low=0.0, high=1.0)
        self.quads = source("xs", "ys", "value")
        color = {"field": "value", "transform": self.colors}
        made.patches("xs", "ys", source=self.quads, fill_color=color, line_color=color)
        self.bar = ColorBar(
            color_mapper=self.colors, width=9, padding=2, margin=0, title_standoff=4,
            title_text_font_size="11px", title_text_font_style="normal",
            major_label_text_font_size="11px", background_fill_alpha=0.0,
        )  # fmt: skip
        made.add_layout(self.bar, "right")
        super()._draw(made)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the stress at the selected instant, as far as the frame has it."""
        super().update(frame, selection, ghost)
        stress, picture = frame.extras.get("stress"), self.picture
        if stress is None or picture is None:
            put(self.quads, {"xs": [], "ys": [], "value": []})
            return
        largest = float(np.abs(stress.values).max())
        unit = unit_for(largest, stress.unit)
        high = _rounded(largest / unit.factor)
        signed = float(stress.values.min()) < -1e-3 * largest
        self.colors.update(
            palette=SIGNED if signed else Cividis256, low=-high if signed else 0.0, high=high
        )
        self.bar.title = f"{stress.title}, {unit.name}"
        corners = picture.layout.page(picture.nodes[frame.run.geometry.quads], picture.tilt)
        across, up = np.moveaxis(np.round(corners, 1), -1, 0)
        values = stress.values[:, picture.column] / unit.factor
        put(self.quads, {"xs": across.tolist(), "ys": up.tolist(), "value": values})


def _rounded(size: float) -> float:
    """A size rounded up to 1, 1.5, 2, 3, 5 or 7 times a power of ten, so that it seldom changes."""
    power = 10.0 ** np.floor(np.log10(size)) if size > 0.0 else 1.0
    steps = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0)
    return float(next(step for step in steps if step * power >= 0.999 * size) * power)
