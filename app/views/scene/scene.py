"""The figure of the scene, and what is done in it with the pointer."""

from __future__ import annotations

from typing import Any

import numpy as np
import panel as pn
from bokeh.core.properties import value
from bokeh.events import Pan, PanEnd, PanStart, Tap
from bokeh.models import ColumnDataSource, Range1d
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import BODY, EDGE, GHOST
from app.views.scene.layout import Layout, layout_of
from app.views.scene.outlines import Outlines, outlines_of
from app.views.scene.picture import Columns, Handle, Picture
from app.views.view import View, source
from solver.scenes import behind

WIDTH, HEIGHT = 950.0, 190.0
"""Of the figure until the browser tells, px."""
NEAR, CLOSE = 22.0, 14.0
"""Pixels within which a handle is held, and an interface is tapped."""
KEPT = 0.3, 1.5
"""Shares of the full length between which arrows stay as they are scaled."""
TEXT = {"text_font": value("Roboto, sans-serif"), "text_baseline": "middle"}
SOURCES = {
    "image": "x y", "parts": "x y", "rims": "x y", "holds": "x y", "ghost": "x y", "broken": "x y",
    "bands": "xs ys color width edge", "arrows": "xs ys color width", "heads": "xs ys color",
    "handles": "x y color", "words": "x y text align color", "keys": "x y color",
    "notes": "x y text align",
}  # fmt: skip


class Scene(View):
    """The deformed bodies at the selected instant, what holds them, rubs, and acts on them.

    Arrows are dragged by their ends, and a tap selects an interface.
    """

    name = "Scene"
    shows_status = True

    def make(self) -> figure:
        """A new figure."""
        made = figure(
            sizing_mode="stretch_both", min_height=90, tools="", toolbar_location=None,
            x_range=Range1d(0, WIDTH), y_range=Range1d(0, HEIGHT), min_border=0,
        )  # fmt: skip
        made.axis.visible = made.grid.visible = False
        made.outline_line_color = None
        made.background_fill_alpha = made.border_fill_alpha = 0.0
        self.sources = {name: source(*columns.split()) for name, columns in SOURCES.items()}
        self._draw(made)
        self._size = {"inner_width": WIDTH, "inner_height": HEIGHT}
        self._layout: tuple[object, Layout] | None = None
        self._outlines: dict[str, Outlines] = {}
        self._peaks: dict[str, float] = {}
        self._factor: float | None = None
        self._shown: tuple[Frame, Selection, Frame | None] | None = None
        self._frame: Frame | None = None
        self.picture: Picture | None = None
        self._held: tuple[Handle, Picture, float] | None = None
        for event, react in (
            (PanStart, self._hold), (Pan, self._drag), (PanEnd, self._let_go), (Tap, self._select),
        ):  # fmt: skip
            made.on_event(event, react)
        for size in ("inner_width", "inner_height"):
            made.on_change(size, self._resize)
        return made

    def _draw(self, made: figure) -> None:
        of = self.sources
        made.patch("x", "y", source=of["image"], color=BODY, fill_alpha=0.22, line_alpha=0.0)
        body = {
            "fill_color": BODY,
            "fill_alpha": 0.5 if self.shows_status else 0.0,
            "line_color": EDGE,
        }
        made.patch("x", "y", source=of["parts"], line_alpha=0.55, line_width=0.8, **body)
        made.line("x", "y", source=of["ghost"], color=GHOST, width=1.2, dash="dashed")
        made.line("x", "y", source=of["rims"], color=EDGE, width=1.4)
        made.line("x", "y", source=of["holds"], color=EDGE, width=1.3)
        if self.shows_status:
            for color, width in ((EDGE, "edge"), ("color", "width")):
                made.multi_line("xs", "ys", source=of["bands"], color=color, line_width=width)
        made.line("x", "y", source=of["broken"], color="#D55E00", width=3)
        made.multi_line("xs", "ys", source=of["arrows"], color="color", line_width="width")
        made.patches("xs", "ys", source=of["heads"], color="color")
        made.scatter(
            "x", "y", source=of["handles"], size=11, fill_color="white", line_color="color",
            line_width=2.5,
        )  # fmt: skip
        more = {"text_align": "align", "text": "text", **TEXT}
        made.text(
            "x", "y", source=of["words"], text_color="color", text_font_size="14px",
            text_font_style="bold", **more,
        )  # fmt: skip
        if self.shows_status:
            made.scatter("x", "y", source=of["keys"], marker="square", size=11, color="color")
        made.text("x", "y", source=of["notes"], text_color="#78858C", text_font_size="12px", **more)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the bodies at the selected instant."""
        self._shown = frame, selection, ghost
        made, run = self.figure, frame.run
        layout = self._layout_of(frame)
        if frame is not self._frame:
            if self._frame is None or self._frame.run.settings.scene != run.settings.scene:
                self._factor, self._peaks = None, {}
            self._frame = frame
            largest = np.nanmax(np.abs(frame.deformed.nodes), axis=(0, 2), initial=0.0)
            self._factor = layout.fitting((float(largest[0]), float(largest[1])), self._factor)
            self._scale_arrows(frame)
        made.x_range.end, made.y_range.end = layout.width, layout.height
        assert self._factor is not None
        self.picture = picture = Picture(
            frame, run.column(selection.phase), layout, self._factor,
            self._outlines_of("frame", frame), self._peaks, behind(run.settings), self.shows_status,
        )  # fmt: skip
        for name, columns in picture.columns().items():
            put(self.sources[name], columns)
        put(self.sources["ghost"], self._ghost(picture, selection, ghost))

    def _layout_of(self, frame: Frame) -> Layout:
        key = frame.run.geometry, *self._size.values()
        if self._layout is None or self._layout[0] != key:
            self._layout = key, layout_of(*key)
        return self._layout[1]

    def _outlines_of(self, role: str, frame: Frame) -> Outlines:
        known, geometry = self._outlines.get(role), frame.run.geometry
        if known is None or not (known.geometry is geometry or known.suits(geometry)):
            self._outlines[role] = outlines_of(geometry)
        return self._outlines[role]

    def _scale_arrows(self, frame: Frame) -> None:
        """Keep how long arrows are for their values, while they stay long enough and fit."""
        for act in frame.run.geometry.description.acts:
            peak = float(np.abs(act.values).max())
            kept = self._peaks.get(act.where)
            if kept is None or not (self._held or KEPT[0] <= peak / kept <= KEPT[1]):
                self._peaks[act.where] = peak

    def _ghost(self, picture: Picture, selection: Selection, ghost: Frame | None) -> Columns:
        """The outline of the run that is compared with, where it is of the same bodies."""
        if ghost is None or ghost.run.settings.scene != picture.frame.run.settings.scene:
            return {"x": [], "y": []}
        column = ghost.run.column(selection.phase)
        x, y = picture.ghost(ghost, column, self._outlines_of("ghost", ghost)).T
        return {"x": x.astype(np.float32), "y": y.astype(np.float32)}

    def _resize(self, name: str, old: float, new: float) -> None:
        self._size[name] = max(float(new), 60.0)
        if self._shown is not None:
            with pn.io.hold():
                self.update(*self._shown)

    # ------------------------------------------------------------------- pointer

    def _hold(self, event: Any) -> None:
        """Take hold of the handle under the pointer."""
        picture = self.picture
        if picture is None or not picture.handles:
            return
        at = picture.to_local(event.x, event.y)
        nearest = min(picture.handles, key=lambda handle: float(np.hypot(*(handle.place - at))))
        if np.hypot(*(nearest.place - at)) <= NEAR:
            present = getattr(picture.frame.run.settings, nearest.setting)
            self._held = nearest, picture, float(present)

    def _drag(self, event: Any) -> None:
        if self._held is not None:
            self.state.drag(self._held[0].setting, self._value(event))

    def _let_go(self, event: Any) -> None:
        if self._held is not None:
            name, value = self._held[0].setting, self._value(event)
            self._held = None
            self.state.change(**{name: value})

    def _value(self, event: Any) -> float:
        """The value that the pointer gives what is held, within the range of its slider."""
        assert self._held is not None
        handle, picture, present = self._held
        dragged = handle.value(present, picture.to_local(event.x, event.y))
        low, high = self.state.settings.definitions()[handle.setting].softbounds
        return float(f"{np.clip(dragged, min(low, present), max(high, present)):.3g}")

    def _select(self, event: Any) -> None:
        """Select the interface that was tapped."""
        picture = self.picture
        if picture is None:
            return
        away = np.hypot(*(picture.points - [event.x, event.y]).T)
        if not np.any(away <= CLOSE):
            return
        chain = int(picture.frame.run.geometry.chains[int(np.nanargmin(away))])
        self.state.select(interface=list(picture.frame.run.interfaces)[chain])


def put(shown: ColumnDataSource, columns: Columns) -> None:
    """Set a source, if it changes."""
    if not all(_same(shown.data[name], values) for name, values in columns.items()):
        shown.data = columns


def _same(known: Any, values: Any) -> bool:
    if isinstance(values, np.ndarray) and values.dtype.kind == "f":
        return np.array_equal(np.asarray(known, dtype=values.dtype), values, equal_nan=True)
    return list(known) == list(values)
