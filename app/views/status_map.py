"""Stick and slip over space and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from bokeh.events import Pan, Tap
from bokeh.models import LinearColorMapper, Range1d, Span

from app.views.drawing import (
    BACKWARD,
    FORWARD,
    GREY,
    OPEN,
    STICK,
    VERMILION,
    Picture,
    empty,
    length_of,
    make_figure,
    set_range,
)
from app.views.legend import Key
from solver.settings import Settings

KEYS = (
    Key(BACKWARD, "square", "slip −"),
    Key(STICK, "square", "stick"),
    Key(FORWARD, "square", "slip +"),
    Key(VERMILION, "line", "chosen instant"),
)
INSTANT = Key(VERMILION, "line", "instant")


class StatusMap:
    """The contact status, the cuts, and the chosen instant, which a tap or a drag moves.

    Parameters
    ----------
    choose
        Called with the time, s, that was tapped.
    """

    name = "Stick and slip"
    watches = ""
    keys: Sequence[Key] = KEYS

    def __init__(self, choose: Callable[[float], None]) -> None:
        self.figure = make_figure(
            "Position x (m)", "Time t (s)", x_range=Range1d(0, 1), y_range=Range1d(0, 1)
        )
        self._image = empty("image", "x", "y", "dw", "dh")
        self._cuts = empty("x")
        self._drawn: tuple[object, ...] = ()
        made = self.figure
        made.grid.visible = False
        mapper = LinearColorMapper(palette=[BACKWARD, STICK, FORWARD, OPEN], low=0, high=3)
        made.image("image", x="x", y="y", dw="dw", dh="dh", source=self._image, color_mapper=mapper)
        made.vspan("x", source=self._cuts, line_color=GREY, line_width=1)
        self._instant = Span(location=0, dimension="width", line_color=VERMILION, line_width=3)
        made.add_layout(self._instant)
        made.on_event(Tap, lambda event: choose(event.y))
        made.on_event(Pan, lambda event: choose(event.y))

    def applies(self, settings: Settings) -> bool:
        """Friction is what the page is about."""
        return True

    def draw(self, picture: Picture) -> None:
        """Draw the map of the shown iterate."""
        run, frame = picture.run, picture.frame
        if run.begun is None or frame is None or frame.ticket != run.ticket:
            return
        begun = run.begun
        if self._drawn != (run.ticket, begun.interface):
            self._drawn = (run.ticket, begun.interface)
            self._cuts.data = {"x": begun.cuts}
            can_open = begun.coefficient is not None
            self.keys = (*KEYS[:3], Key(OPEN, "square", "open"), INSTANT) if can_open else KEYS
        half_x = 0.5 * _step(begun.positions)
        half_t = 0.5 * _step(begun.instants)
        first_x, last_x = float(begun.positions[0]), float(begun.positions[-1])
        first_t, last_t = float(begun.instants[0]), float(begun.instants[-1])
        set_range(self.figure.x_range, 0.0, length_of(run.settings))
        set_range(self.figure.y_range, first_t - half_t, last_t + half_t)
        image = np.ascontiguousarray((frame.status + 1).astype(np.uint8).T)
        self._image.data = {
            "image": [image],
            "x": [first_x - half_x],
            "y": [first_t - half_t],
            "dw": [last_x - first_x + 2 * half_x],
            "dh": [last_t - first_t + 2 * half_t],
        }
        time = float(begun.instants[picture.instant])
        if self._instant.location != time:
            self._instant.location = time


def _step(axis: np.ndarray) -> float:
    return float(axis[-1] - axis[0]) / (len(axis) - 1) if len(axis) > 1 else 1.0
