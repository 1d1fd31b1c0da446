"""Buttons and sliders of a run: start, pause, step, pace, iterate, time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

from app.echoes import Echoes, linked, linked_to
from app.frame import Selection
from app.server import PAGES
from app.state import PACES, SEARCH, PageState, answering
from app.status import iterations
from app.widgets import button, changing_text, looks, wrapped
from solver.scenes import CATALOGUE

PLAYED_IN = 6.0
"""Time to play through the interval, s."""
LIVELY = 60.0
"""Time for which a page plays by itself, s; pages share it as they share the server's
thread."""
TOUCHED = [
    "settings",
    "is_dragged",
    "iteration",
    "running",
    "pinned",
    "tab",
    "lesson",
    "case",
    "room",
]
"""Parts of the state that change when a person does something."""
TICK = 50
"""Least time between two instants that are shown, ms."""
FOLLOWS = 400
"""Time between two moves of the iteration's slider by the page, ms: of values that
follow each other more quickly the browser sends the older one back (see `Echoes`)."""
HELD = 1.0
"""Time for which that slider rests after a move by hand, s."""
PIN = "Keep this run, drawn dotted, to compare others with; or let it go"
WATCH = {"Watch": "accuracy", "Answer": "at-once"}


class Transport:
    """The buttons and sliders to move through a run.

    `view` stands in the row above the scene, `play_button` beside the time line, and
    `scrub` below it, under the line `iterate`, which says what is shown.
    """

    def __init__(self, state: PageState, document: Any) -> None:
        self._state = state
        self._document = document
        self._playing: Any = None
        self._is_lively = False
        self._is_touched = self._is_guided or state.selection != Selection()
        self._moved_at = -math.inf
        self._echoes = Echoes(state)
        self._run = _button("pause", "Run or pause (space)", self._toggle)
        self.play_button = _button("play_circle", "Play through time (t)", self.play)
        self.play_button.margin = (10, 2)
        self._pin = _button("push_pin", PIN, state.pin, "of-page")
        # The label of a slider that follows quickly would be sent back (see `Echoes`).
        self.iterate = changing_text(margin=0, **looks("iterate"))
        self.scrub = self._make_scrub()
        self._show_scene: Callable[[], None] | None = None
        self._turns = wrapped(css_classes=["turn"])
        # Parts that are not always there are hidden by the style sheet.
        self.view = wrapped(
            self._run,
            _button("skip_previous", "From the start (r)", state.reset),
            _button("skip_next", "One stage of an iteration (s)", state.step),
            self._pin,
            self._turns,
            *self._make_choices(),
            **looks("transport"),
        )
        shown = [
            "settings",
            "frame",
            "newest",
            "running",
            "is_costly",
            "has_failed",
            "pinned",
            "is_dragged",
        ]
        state.param.watch(lambda *events: self._show(), shown)
        state.param.watch(self._touch, TOUCHED)
        document.add_periodic_callback(self._follow, FOLLOWS)
        self._show()

    def present(self) -> None:
        """Add the widgets of the view for a projector: choice of scene, and exit.

        A page has them once it has been such a view.
        """
        if self._show_scene is not None:
            return
        state = self._state
        scene = pmui.Select(
            label="Scene",
            options={name.capitalize(): name for name in CATALOGUE},
            value=state.settings.scene,
            size="small",
            width=176,
            margin=(6, 4),
            **looks("large", "of-projector"),
        )
        self._show_scene = linked(
            scene, state, lambda: state.settings.scene, state.choose_scene
        )

        def leave() -> None:
            state.view = "page"

        close = _button("close", "Back to the page (p)", leave, "of-projector")
        self.view.extend([scene, close])

    def _add_turns(self) -> None:
        """Add the buttons to choose a contact, if a run has several."""
        frame = self._state.frame
        if frame is not None and len(frame.run.surfaces) > 1 and not len(self._turns):
            back = _button("arrow_upward", "Contact before (I)", self._turn_back)
            on = _button("arrow_downward", "Next contact (i)", self._state.turn)
            self._turns.extend([back, on])

    def _make_choices(self) -> list[Any]:
        """Widgets to choose search or answer, and the pace."""
        finish = pmui.RadioButtonGroup(
            options=WATCH,
            value="accuracy",
            size="small",
            margin=(4, 6),
            description="Watch the search from nothing, or have the answer at once.",
            **looks("words", "of-page"),
        )

        def present() -> str | None:
            # A run may end in other ways, of which there is no button.
            chosen = self._state.settings.finish
            return chosen if chosen in WATCH.values() else None

        self._show_finish = linked(finish, self._state, present, self._choose_finish)
        pace = pmui.Select(
            label="Pace",
            options=list(PACES),
            value=self._state.pace,
            description="Iterations a second.",
            size="small",
            width=136,
            margin=(6, 4),
            **looks("of-page"),
        )
        return [finish, linked_to(self._state, "pace", pace)]

    def _make_scrub(self) -> pmui.IntSlider:
        """Make the slider to go back through the iterations.

        It counts from the newest iterate: so its value rests while a run continues.
        """
        slider = pmui.IntSlider(
            label="Iteration",
            start=-1,
            end=0,
            value=0,
            show_value=False,
            # The line above says which iteration it is.
            tooltips=False,
            size="small",
            sizing_mode="stretch_width",
            margin=0,
            **looks("scrub"),
        )
        slider.param.watch(lambda event: self._seek(event.new), "value")
        return slider

    def keys(self) -> dict[str, Any]:
        """Actions of the keys, by the names of keys in the browser."""
        return {
            " ": self._toggle,
            "s": self._state.step,
            "r": self._state.reset,
            "t": self.play,
            "i": self._state.turn,
            "I": self._turn_back,
            "ArrowLeft": lambda: self._move(-1),
            "ArrowRight": lambda: self._move(1),
            "Shift+ArrowLeft": lambda: self._move_iteration(-1),
            "Shift+ArrowRight": lambda: self._move_iteration(1),
        }

    @property
    def _goes_on(self) -> bool:
        """Check whether the run continues until it is paused."""
        state = self._state
        return state.running and not state.is_over and not state.is_costly

    def _toggle(self) -> None:
        """Run or pause; restart a run that has ended."""
        if self._goes_on:
            self._state.pause()
        else:
            self._state.go_on()

    def play(self, until: float = 1.0, *, by_itself: bool = False) -> None:
        """Play from the selected instant to a share of the interval, again and again.

        Playing ends, too, once another instant is selected. What plays by itself, as no
        person has asked for it, ends after a while where it began.
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
            elif by_itself and passed > LIVELY / max(PAGES.count, 1):
                self.stop()
                self._state.select(phase=first)
            else:
                shown = (first + passed / PLAYED_IN) % until
                self._state.select(phase=shown)

        # Instants come from the clock, so that a busy page skips some.
        self._playing = self._document.add_periodic_callback(play_on, TICK)
        self.play_button.icon = "pause_circle"

    def stop(self) -> None:
        """Stop playing."""
        if self._playing is not None:
            self._document.remove_periodic_callback(self._playing)
            self._playing = None
            self._is_lively = False
            self.play_button.icon = "play_circle"

    @property
    def _is_guided(self) -> bool:
        """Check whether a lesson, a case or a class decides what is shown."""
        return bool(self._state.lesson or self._state.case or self._state.room)

    def _enliven(self) -> None:
        """Play the result of a scene's first search until the user acts.

        A run that has the answer at once is not played.
        """
        frame = self._state.frame
        self._is_touched = True
        if self._state.settings.finish == SEARCH["finish"] and not frame.run.is_idle:
            self.play(by_itself=True)
            self._is_lively = True

    def _touch(self, *events: Any) -> None:
        """Stop automatic playing; another scene may play again.

        Changed settings are then shown at the initial instant. A dragged arrow stays at
        the instant at which it was taken hold of.
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
        """Select another instant, a number of instants later."""
        self.stop()
        frame = self._state.frame
        if frame is not None:
            times = frame.run.instants
            column = frame.run.column(self._state.selection.phase) + instants
            column = min(max(column, 0), len(times) - 1)
            self._state.select(phase=float(times[column] / times[-1]))

    def _turn_back(self) -> None:
        self._state.turn(-1)

    def _move_iteration(self, step: int) -> None:
        """Show the previous iterate (step -1), or the next one (1)."""
        state = self._state
        shown = state.iteration
        if shown is None:
            shown = self._last
        state.seek(shown + step)

    def _seek(self, back: int) -> None:
        """Show the iterate at the slider's position, counted back from the newest."""
        # The browser sends back what the page had set: nobody moved the slider.
        if self._echoes.has(back):
            return
        self._moved_at = time.monotonic()
        iteration = None
        if back < 0:
            iteration = self._last + back
        self._state.seek(iteration)

    def _choose_finish(self, finish: str) -> None:
        values = SEARCH
        if finish != SEARCH["finish"]:
            values = answering(self._state.settings)
        self._state.change(**values)

    def _show(self) -> None:
        """Show the state of the run, except while a slider is dragged.

        Each move begins a run that ends at once: the buttons would flicker.
        """
        state = self._state
        if state.is_dragged:
            return
        self._add_turns()
        if self._goes_on:
            self._run.icon = "pause"
        elif state.is_costly:
            self._run.icon = "warning"
        elif state.is_over:
            self._run.icon = "replay"
        else:
            self._run.icon = "play_arrow"
        self._pin.color = "default" if state.pinned is None else "primary"
        self._show_finish()
        if self._show_scene is not None:
            self._show_scene()

    def name_iterate(self) -> None:
        """Write the number of the shown iterate, and of all, above the slider."""
        frame = self._state.frame
        if frame.is_followed:
            self.iterate.text = "Answer"
        elif frame.is_answer:
            self.iterate.text = f"Answer after {iterations(frame.iteration)}"
        else:
            last = self._state.newest.iteration
            self.iterate.text = f"Iteration {frame.iteration} of {last}"

    def _follow(self) -> None:
        """Set the slider to the shown iterate, except after a move by the user."""
        frame = self._state.frame
        slider = self.scrub
        if frame is None:
            return
        if self._state.is_over and not self._is_touched:
            self._enliven()
        if time.monotonic() < self._moved_at + HELD:
            return
        is_newest = frame is self._state.newest
        back = 0
        if not is_newest:
            back = min(frame.iteration - self._last, -1)
        start = min(1 - self._last, -1)
        # As each change is a message, its start may lag behind while a run is followed,
        # down to half its length.
        if is_newest and not self._state.is_over and start <= slider.start <= start / 2:
            start = slider.start
        if (start, back) != (slider.start, slider.value):
            self._echoes.show(slider, back, start=start)

    @property
    def _last(self) -> int:
        """Place of the newest frame; 0 without one."""
        newest = self._state.newest
        if newest is None:
            return 0
        return newest.place


def _button(
    icon: str, description: str, act: Callable[[], None], *roles: str
) -> pmui.Button:
    """A button with only an icon; an `IconButton` would keep its first icon."""
    return button(
        "",
        act,
        icon=icon,
        description=description,
        variant="text",
        color="default",
        margin=2,
        **looks("icon", *roles),
    )
