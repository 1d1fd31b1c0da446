"""Run, step, reset; pace; going back to an iterate; playing through time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

from app.browser import Echoes
from app.frame import Selection
from app.server import PAGES
from app.state import ANSWER, PACES, SEARCH, PageState, known
from app.widgets import button, looks, wrapped

PLAYED_IN = 6.0
"""Seconds in which one plays through the interval."""
LIVELY = 60.0
"""Seconds for which a page plays by itself; several share them, as they do the server's
thread."""
TOUCHED = [
    *(
        "settings",
        "is_dragged",
        "iteration",
        "running",
        "pinned",
        "tab",
        "lesson",
        "case",
        "room",
    ),
]
"""What changes when somebody does something."""
TICK = 50
"""Milliseconds between two instants that are shown, at least."""
FOLLOWS = 400
"""Milliseconds between two moves of the iteration's slider by itself: of values that
follow each other more quickly the browser sends the older one back (see `Echoes`)."""
HELD = 1.0
"""Seconds after a move of it for which it stays where the hand has left it."""
PIN = "Keep this run, drawn dotted, to compare others with; or let it go"
WATCH = {"Watch": "accuracy", "Answer": "at-once"}


class Transport:
    """The buttons and sliders that move through a run.

    `view` stands in the row above the scene, `play_button` beside the time line.
    """

    def __init__(self, state: PageState, document: Any) -> None:
        self._state = state
        self._document = document
        self._playing: Any = None
        self._is_lively = False
        self._is_touched = self._is_guided or state.selection != Selection()
        self._moved_at = -math.inf
        self._echoes = Echoes()
        self._run = _button("pause", "Run or pause (space)", self._toggle)
        self.play_button = _button("play_circle", "Play through time (t)", self.play)
        self.play_button.margin = (10, 2)
        self._pin = _button("push_pin", PIN, state.pin)
        self.view = wrapped(
            self._run,
            _button("skip_previous", "From the start (r)", state.reset),
            _button("skip_next", "One iteration (s)", state.step),
            self._pin,
            *self._choices(),
        )
        shown = [
            "settings",
            "frame",
            "newest",
            "running",
            "is_costly",
            "pinned",
            "is_dragged",
        ]
        state.param.watch(lambda *events: self._show(), shown)
        state.param.watch(self._touch, TOUCHED)
        document.add_periodic_callback(self._follow, FOLLOWS)
        self._show()

    def _choices(self) -> list[Any]:
        """What is watched, how fast, and which iteration."""
        self._way = pmui.RadioButtonGroup(
            options=WATCH,
            value="accuracy",
            size="small",
            margin=(4, 6),
            description="Watch the search from nothing, or have the answer at once.",
            **looks("words"),
        )
        self._way.param.watch(lambda event: self._choose_way(event.new), "value")
        pace = pmui.Select.from_param(
            self._state.param.pace,
            options=list(PACES),
            size="small",
            width=136,
            margin=(6, 4),
        )
        # Counted from the newest: so its value rests while a run goes on.
        self._iteration = pmui.IntSlider(
            label="Iterations back",
            start=-1,
            end=0,
            value=0,
            show_value=False,
            size="small",
            width=110,
            margin=(0, 8),
            **looks("small-label"),
        )
        self._iteration.param.watch(lambda event: self._seek(event.new), "value")
        return [self._way, pace, self._iteration]

    def keys(self) -> dict[str, Any]:
        """What keys do, by their names."""
        return {
            " ": self._toggle,
            "s": self._state.step,
            "r": self._state.reset,
            "t": self.play,
            "ArrowLeft": lambda: self._move(-1),
            "ArrowRight": lambda: self._move(1),
            "Shift+ArrowLeft": lambda: self._move_iteration(-1),
            "Shift+ArrowRight": lambda: self._move_iteration(1),
        }

    @property
    def _goes_on(self) -> bool:
        """Whether the run goes on until it is paused."""
        state = self._state
        return state.running and not state.is_over and not state.is_costly

    def _toggle(self) -> None:
        """Run, pause, or run anew what has ended."""
        if self._goes_on:
            self._state.pause()
        else:
            self._state.go_on()

    def play(self, until: float = 1.0) -> None:
        """Go through time from the selected instant, up to a share of the interval, or stop.

        It stops as well once another instant is selected.
        """
        if self._playing is not None:
            self.stop()
            return
        began = time.monotonic()
        shown = self._state.selection.phase
        first = shown if shown < until else 0.0

        def play_on() -> None:
            nonlocal shown
            passed = time.monotonic() - began
            if self._state.selection.phase != shown:
                self.stop()
            elif self._is_lively and passed > LIVELY / max(PAGES.count, 1):
                self.stop()
                # As the page began.
                self._state.select(phase=Selection.phase)
            else:
                shown = (first + passed / PLAYED_IN) % until
                self._state.select(phase=shown)

        self._playing = self._document.add_periodic_callback(play_on, TICK)
        self.play_button.icon = "pause_circle"

    def stop(self) -> None:
        """Go through time no more."""
        if self._playing is not None:
            self._document.remove_periodic_callback(self._playing)
            self._playing = None
            self._is_lively = False
            self.play_button.icon = "play_circle"

    @property
    def _is_guided(self) -> bool:
        """Whether a lesson, a case or a class says what is seen."""
        return bool(self._state.lesson or self._state.case or self._state.room)

    def _enliven(self) -> None:
        """Play by itself what the first search of a scene has found, until somebody does something.

        Whoever has the answer at once goes on from it.
        """
        frame = self._state.frame
        self._is_touched = True
        if self._state.settings.finish == SEARCH["finish"] and not frame.run.is_idle:
            self.play()
            self._is_lively = True

    def _touch(self, *events: Any) -> None:
        """Stop what plays by itself; another scene does so anew.

        Other settings are seen at the instant of the page's beginning, an arrow where
        it is held.
        """
        changed = {event.name: event for event in events}
        settings = changed.get("settings")
        is_new = settings is not None and settings.old.scene != settings.new.scene
        self._is_touched = self._is_guided or not is_new
        if self._is_lively:
            self.stop()
            if settings is not None:
                self._state.select(phase=Selection.phase)

    def _move(self, instants: int) -> None:
        """Select an instant so many later."""
        self.stop()
        frame = self._state.frame
        if frame is not None:
            times = frame.run.instants
            column = frame.run.column(self._state.selection.phase) + instants
            column = min(max(column, 0), len(times) - 1)
            self._state.select(phase=float(times[column] / times[-1]))

    def _move_iteration(self, way: int) -> None:
        """Show the kept iterate before the one that is shown, or after it."""
        state = self._state
        if state.frame is not None:
            shown = state.frame.iteration
            state.seek(state.history.after(shown) if way > 0 else shown - 1)

    def _seek(self, back: int) -> None:
        """Show the iteration to which the slider was moved."""
        if not self._echoes.has(back):
            self._moved_at = time.monotonic()
            self._state.seek(self._last + back if back < 0 else None)

    def _choose_way(self, finish: str) -> None:
        if finish != self._state.settings.finish:
            values = SEARCH if finish == SEARCH["finish"] else ANSWER
            self._state.change(**known(self._state.settings, values))

    def _show(self) -> None:
        """Show how the run goes; the next move of a hand is sooner there than the button."""
        state = self._state
        if state.is_dragged:
            return
        if state.is_costly:
            waiting = "warning"
        elif state.is_over:
            waiting = "replay"
        else:
            waiting = "play_arrow"
        self._run.icon = "pause" if self._goes_on else waiting
        self._pin.color = "default" if state.pinned is None else "primary"
        if state.settings.finish in WATCH.values():
            self._way.value = state.settings.finish

    def _follow(self) -> None:
        """Show which iteration is shown."""
        frame = self._state.frame
        slider = self._iteration
        if self._state.is_over and not self._is_touched:
            self._enliven()
        if frame is None or time.monotonic() < self._moved_at + HELD:
            return
        is_newest = frame is self._state.newest
        if is_newest:
            back = 0
        else:
            back = min(frame.iteration - self._last, -1)
        start = min(1 - self._last, -1)
        # As each change is a message, it may end half-way while a run is followed.
        if is_newest and not self._state.is_over and start <= slider.start <= start / 2:
            start = slider.start
        if (start, back) != (slider.start, slider.value):
            slider.param.update(
                start=start, value=self._echoes.give(back, slider.value)
            )

    @property
    def _last(self) -> int:
        """Number of the newest iterate; an answer comes after the last one of the search."""
        newest = self._state.newest
        if newest is None:
            return 0
        return newest.iteration + newest.is_answer


def _button(icon: str, description: str, act: Callable[[], None]) -> pmui.Button:
    """A button with an icon alone; an IconButton would keep its first one."""
    return button(
        "",
        act,
        icon=icon,
        description=description,
        variant="text",
        color="default",
        margin=2,
        **looks("icon"),
    )
