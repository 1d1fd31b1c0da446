"""The figure of the scene, in which the pointer drags and selects."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from bokeh.events import Pan, PanEnd, PanStart, Tap
from bokeh.plotting import figure

from app.frame import LINEAR, LOCAL, Frame, Run, Selection
from app.views.acts import Arrows, Rest
from app.views.colors import (
    BODY,
    EDGE,
    FORCE,
    GHOST,
    GROUND,
    HALO,
    HINT,
    KEYS,
    UNSEEN,
)
from app.views.hints import NONE, hints_of
from app.views.labels import labels_of
from app.views.layout import Canvas, Layout, layout_of
from app.views.parts import bare
from app.views.picture import Picture
from app.views.view import View
from solver.arrays import Array
from solver.files.amounts import number
from solver.settings.scene import Settings

WIDTH = 950.0
HEIGHT = 190.0
"""Size of the figure until the browser reports its own, px."""
NEAR = 22.0
CLOSE = 14.0
"""Distances within which a handle is held, and an interface is tapped, px."""
KEPT = 0.3, 1.15
"""Largest values over full length between which arrows keep their scale: longer ones
would end outside of the picture."""
STAGES = {
    LOCAL: "local stage: forces obey the law",
    LINEAR: "linear stage: bodies in balance",
}
"""Notes on the stage that is shown while a run waits."""


class Scene(View):
    """The deformed bodies at the selected instant, with supports, interfaces and loads.

    Arrows are dragged by their ends; a tap selects a substructure, and an interface.
    """

    name = "Scene"
    is_bare = False

    def make(self) -> None:
        """Draw all layers of the picture, and react to the pointer and to the size."""
        plot = bare(90, (0, WIDTH), (0, HEIGHT), x_axis_type=None)
        self._figure = plot
        self._draw(plot)
        self._peaks: dict[str, float] = {}
        self._dragged: dict[str, tuple[Arrows, Settings]] = {}
        self._factor: float | None = None
        self._settled: tuple[object, float] | None = None
        self.picture: Picture | None = None
        self._held: tuple[Arrows | Rest, Picture] | None = None
        self._moved_to = 0.0
        plot.on_event(PanStart, self._hold)
        plot.on_event(Pan, self._drag)
        plot.on_event(PanEnd, self._let_go)
        plot.on_event(Tap, self._select)
        self.follow_size(WIDTH, HEIGHT)

    def _draw(self, plot: figure) -> None:
        """Add all layers from the bottom to the top, and the legend."""
        look = {"fill_alpha": 0.22, "hatch_alpha": 0.5, "hatch_scale": 8.0}
        colors = {"fill_color": GROUND, "hatch_color": GROUND, "line_color": GROUND}
        self.add("ground", "Patches", "xs ys", hatch_pattern=".", **look, **colors)
        self.add("image", "Patch", color=BODY, fill_alpha=0.22, line_alpha=0.0)
        self.add(
            "bodies",
            "Patch",
            fill_alpha=0.0 if self.is_bare else 0.5,
            fill_color=BODY,
            line_color=EDGE,
            line_width=0.8,
            line_alpha=0.55,
        )
        self.add("ghost", color=GHOST, width=1.2, dash="dashed")
        self.add("strokes", "MultiLine", "xs ys line_color line_width")
        self.add(
            "heads",
            "Patches",
            "xs ys line_color",
            fill_color="line_color",
            also="line_width",
        )
        self.add(
            "marks",
            "Scatter",
            "x y line_color",
            size=11,
            fill_color="white",
            line_width=2.5,
        )
        self._draw_words()
        keys = {"note": UNSEEN}
        if not self.is_bare:
            keys = KEYS | {"selected": HALO, "around": GROUND} | keys
        self.mark(keys)
        self._keys = self.legend(*keys, place="center")
        for name in keys.keys() - KEYS.keys():
            self.show(name, False, may_come_back=False)
        self._keys.location = "bottom_left"

    def _draw_words(self) -> None:
        """Add the words with their lines, and the marks of a first visit."""
        self.add(
            "leaders",
            "MultiLine",
            "xs ys",
            color=FORCE,
            line_dash="dotted",
            line_width=1.5,
        )
        self.add(
            "words",
            "Text",
            "x y text text_align text_color",
            text_font_style="bold",
            text_baseline="middle",
        )
        if not self.is_bare:
            # By this name a touch finds them (`HOLD`, `browser.py`).
            self.sources["marks"].name = "handles"
            self.add(
                "hints",
                "Text",
                "x y text text_align",
                text_color="white",
                text_baseline="middle",
                background_fill_color=HINT,
                padding=5,
                border_radius=4,
            )

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the bodies at the selected instant."""
        plot = self.figure
        run = frame.run
        layout = self._layout_of(frame)
        self._scale(frame, layout)
        self._shown = frame, selection, ghost
        plot.x_range.end = layout.canvas.width
        plot.y_range.end = layout.canvas.height
        column = run.column(selection.phase)
        shown = frame
        if selection.stage == LOCAL:
            shown = self.state.before_linear(frame)
        selected = run.interface(selection.interface)
        picture = Picture(
            shown,
            column,
            layout,
            self._factor,
            self._peaks,
            selected,
            self._rests(run),
        )
        self.picture = picture
        for arrows in picture.arrows:
            if arrows.setting and len(arrows.handles):
                self._dragged[arrows.setting] = arrows, run.settings
        for name, columns in picture.columns().items():
            self.fill(name, **columns)
        words, leaders = labels_of(picture)
        self.fill("words", **words)
        self.fill("leaders", **leaders)
        if not self.is_bare:
            hints = NONE
            if self.state.is_new:
                hints = hints_of(picture)
            self.fill("hints", **hints)
            # Hints take the place of keys where a picture is small.
            lowest = min(hints["y"], default=math.inf)
            self._keys.visible = bool(lowest > layout.row * (layout.key_rows + 0.5))
        # In the place of the ghost a structure that collapses shows its mechanism.
        past: dict[str, Any] = {"x": [], "y": []}
        if ghost is not None:
            past = picture.ghost(ghost, ghost.run.column(selection.phase))
        if run.mechanism is not None and run.instants[column] >= run.collapses_at:
            past = picture.mechanism(run.mechanism)
        self.fill("ghost", **past)
        self._show_keys(picture, selection.stage)

    def _layout_of(self, frame: Frame) -> Layout:
        type_size = float(self.words.removesuffix("px"))
        surroundings = None
        if self.state.trade_case is not None:
            surroundings = self.state.trade_case.surroundings
        canvas = Canvas(
            frame.run.geometry, self.is_bare, type_size, *self.room, surroundings
        )
        return layout_of(canvas)

    def _scale(self, frame: Frame, layout: Layout) -> None:
        """Choose the magnification and the scale of arrows for a new frame."""
        shown = None
        if self._shown is not None:
            shown = self._shown[0]
        if shown is None or shown.run.settings.scene != frame.run.settings.scene:
            self._factor = None
            self._peaks = {}
            self._dragged = {}
        # Along the time of a frame the scale stays, so that motions can be compared.
        self._factor = self._magnification(frame, layout)
        if shown is not frame:
            self._scale_arrows(frame)

    def _magnification(self, frame: Frame, layout: Layout) -> float:
        """Factor on displacements: that of the end of the run, for all of its iterates.

        Runs of one structure in one figure share it as long as motion is visible and
        fits. While the end of a run is not known, its iterates have theirs.
        """
        largest = frame.deformed.largest
        end = self._end_of(frame)
        if end is None:
            return layout.fitting(largest, self._factor)
        key = frame.run.structure, layout.canvas.width, layout.canvas.height
        before = None
        if self._settled is not None and self._settled[0] == key:
            before = self._settled[1]
        factor = layout.fitting(end, before)
        self._settled = key, factor
        return layout.limited(largest, factor)

    def _end_of(self, frame: Frame) -> Array | None:
        """Largest displacements at the end of a run along x and y, (2,), m, if known.

        They are those of its reference; of a run without one, those of its last frame.
        """
        newest = self._newest(frame)
        if newest.run.reference_moved is not None:
            return newest.run.reference_moved
        if newest.status is not None:
            return newest.deformed.largest
        return None

    def _rests(self, run: Run) -> list[Rest]:
        """Handles of loads that were drawn before, and are zero in a run."""
        settings = run.settings
        places = settings.load_settings().values()
        rests = []
        for name, (arrows, drawn) in self._dragged.items():
            if name in places and getattr(settings, name) == 0.0:
                rests.append(arrows.rest(float(getattr(drawn, name))))
        return rests

    def _show_keys(self, picture: Picture, stage: str) -> None:
        """Show the keys of status, selected contact and ground; with a note.

        The note has the magnification and the stage.
        """
        frame = picture.frame
        layout = picture.layout
        run = frame.run
        can_open = any(each.strength is None for each in run.interfaces.values())
        self.show("open", can_open)
        selected = ""
        if len(picture.halo):
            selected = picture.selected
        self.show("selected", selected)
        surroundings = layout.canvas.surroundings
        ground = ""
        if surroundings is not None:
            ground = surroundings.ground
        self.show("around", ground)
        notes = []
        if self._factor:
            notes.append(f"displacement × {number(self._factor)}")
        is_waiting = not self.state.running and not frame.is_answer
        if is_waiting and not self.is_bare:
            # A phone has room for one of both notes.
            notes.append(STAGES[stage])
        elif run.geometry.description.height is None:
            notes.append("thickness not to scale")
        self.show("note", "; ".join(notes))
        arrangement = []
        if layout.angle or not layout.key_rows:
            arrangement = ["column"]
        self._keys.css_classes = arrangement

    def _scale_arrows(self, frame: Frame) -> None:
        """Keep the scale of arrows while they fit and are seen, or are dragged."""
        shortest, longest = KEPT
        for act in frame.run.geometry.description.acts:
            peak = float(np.abs(act.values).max())
            kept = self._peaks.get(act.where)
            if kept is not None:
                if self._held or shortest <= peak / kept <= longest:
                    continue
            self._peaks[act.where] = peak

    def _hold(self, event: Any) -> None:
        """Begin to drag the arrow whose handle is under the pointer."""
        picture = self.picture
        if picture is None or not picture.draggable:
            return
        at = picture.to_local(event.x, event.y)
        nearest = min(
            picture.draggable, key=lambda each: float(np.hypot(*(each.handle - at)))
        )
        if np.hypot(*(nearest.handle - at)) <= NEAR:
            self._held = nearest, picture
            self._moved_to = self._value(event)
            self.state.is_dragged = True

    def _drag(self, event: Any) -> None:
        if self._held is not None:
            self._moved_to = self._value(event)
            self.state.drag(self._held[0].setting, self._moved_to)

    def _let_go(self, event: Any) -> None:
        """Release the arrow at its last value.

        The event itself has no place where the browser has broken off a touch.
        """
        if self._held is not None:
            name = self._held[0].setting
            self._held = None
            self.state.release(name, self._moved_to)

    def _value(self, event: Any) -> float:
        """Value of the dragged load at the pointer, within the range of its slider."""
        arrows, picture = self._held
        present = float(getattr(picture.frame.run.settings, arrows.setting))
        dragged = arrows.scaled(present, picture.to_local(event.x, event.y))
        low, high = self.state.settings.definitions()[arrows.setting].softbounds
        # A value that was typed may lie outside of the range of the slider.
        clipped = np.clip(dragged, min(low, present), max(high, present))
        return float(f"{clipped:.3g}")

    def _select(self, event: Any) -> None:
        """Select the substructure nearest to a tap, and a near interface."""
        picture = self.picture
        if picture is None:
            return
        run = picture.frame.run
        at = picture.to_local(event.x, event.y)
        middles = picture.nodes[run.geometry.cells].mean(axis=1)
        nearest = np.hypot(*(middles - at).T).argmin()
        chosen: dict[str, Any] = {"substructure": int(run.geometry.parts[nearest])}
        away = np.hypot(*(picture.points - at).T)
        if np.any(away <= CLOSE):
            # Points are NaN where a line of them is broken.
            chain = int(run.geometry.chains[int(np.nanargmin(away))])
            chosen["interface"] = list(run.interfaces)[chain]
        self.state.select(**chosen)
