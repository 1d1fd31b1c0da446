"""Run, pause, step, reset; the pace; and the sliders over iterations and instants."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import panel_material_ui as pmui

from app.components.panes import button, row, select
from app.components.scrubber import scrubber
from app.picture.usual import ANSWER, WATCH
from app.session.session import Session
from app.session.state import PACES
from app.worker.painter import INSTANT, ITERATION
from solver.settings import Settings

LABELS = {
    "whole": "the whole in 3 s",
    "1": "1 iteration/s",
    "5": "5 iterations/s",
    "20": "20 iterations/s",
    "fastest": "as fast as it can",
}
ENDS = {WATCH: "Watch", ANSWER: "Answer"}
ITERATE = "Iterate"
"""Stands beside these where the run only iterates, as the paper's does."""
WAYS = (
    "Watch the method search until its own force is accurate enough, and then the certified answer "
    "beside it; or have the answer at once."
)
RUNS, REPLAYS = "Run or pause the iteration (space).", "Replay the run from its start (space)."
RESETS = "Start the run again, from its usual start (r)."
AGREES = "Run anyway, however long that takes (space)."
FIXED = 6
"""Buttons, pace and sliders, which always stand there."""
SMALL = {"& button": {"textTransform": "none", "padding": "4px 9px"}}
NARROW = {"minWidth": 0, "padding": "4px 7px"}
PLAYED_IN, SOONEST = 8.0, 0.025
"""Seconds in which one plays through time, and least between two instants that are shown."""


class Transport:
    """The buttons and sliders that move through a run.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._played: tuple[float, float] | None = None
        self._loops = 0
        self._ends: Callable[[], None] | None = None
        self._next = session.turns.timer(self.play_on)
        self._make_buttons()
        self._make_sliders()
        styles = {"flex": "1 1 288px"}
        self._sliders = row(self._iteration, self._instant, min_width=288, styles=styles)
        parts = self._run, self._step, self._reset, self._way, self._pace
        for part in parts:
            part.margin = (5, 4, 5, 10 if part is self._run else 4)
        self.view = row(*parts, self._sliders, align_items="center", css_classes=["transport"])
        watch = session.param.watch
        watch(lambda *events: self._show(), ["facts", "running", "look"])
        watch(lambda event: self._arrange(), "wanted")
        self._way.param.watch(lambda event: self._end(event.new), "value")
        self._show()
        self._arrange()

    def keys(self) -> dict[str, Callable[[], None]]:
        """Give what keys do, by their names."""
        return {
            " ": self.toggle,
            "s": self.step,
            "r": self.reset,
            "t": self.play,
            "ArrowLeft": partial(self.move_instant, -1),
            "ArrowRight": partial(self.move_instant, 1),
            "Shift+ArrowLeft": partial(self.move_iteration, -1),
            "Shift+ArrowRight": partial(self.move_iteration, 1),
        }

    def chooses(self) -> dict[str, Callable[[Any], None]]:
        """Give what a tap or a drag on a plot does, by what it chooses."""
        return {
            "instant": self.choose_time,
            "time": self.choose_time,
            "substructure": self.choose_substructure,
        }

    def toggle(self) -> None:
        """Run, pause, or replay what has ended."""
        if self._session.goes_on:
            self._session.pause()
        else:
            self._session.go()

    def step(self) -> None:
        """Do one iteration, or show the next of a run that has ended."""
        session, facts = self._session, self._session.facts
        if facts is not None and facts.is_over and facts.iteration < facts.done:
            session.seek(facts.iteration + 1)
        else:
            session.step()

    def reset(self) -> None:
        """Start again from the settings' own start."""
        self._session.start()

    def choose_time(self, time: float) -> None:
        """Look at the instant nearest to a time, s."""
        self._choose_phase(time / self._session.settings.duration)

    def move_instant(self, by: int) -> None:
        """Look at an instant so many later."""
        self._choose_instant(round(self._session.look.phase * self._last) + by)

    def move_iteration(self, by: int) -> None:
        """Look at an iteration so many later."""
        if (facts := self._session.facts) is not None:
            self._session.seek(max(facts.iteration + by, 1))

    def play(self) -> None:
        """Go through time from the chosen instant, or from the first; or stop."""
        if self.plays:
            self.stop()
            return
        phase = self._session.look.phase
        self._played = time.monotonic(), phase if phase < 1.0 else 0.0
        self._instant.playing = True
        self._next.set(0.0)

    def loop(self, times: int, ends: Callable[[], None]) -> None:
        """Go through time so often, from the first instant; then have something done."""
        self._loops, self._ends = times, ends
        self._played = time.monotonic(), 0.0
        self._next.set(0.0)

    def stop(self) -> None:
        """Go through time no more."""
        self._played, self._ends = None, None
        self._instant.playing = False
        self._next.stop()

    @property
    def plays(self) -> bool:
        """Whether one goes through time at present."""
        return self._played is not None

    def play_on(self) -> None:
        """Look at the instant that one has come to, and at the next when that has come."""
        if self._played is None:
            return
        began, phase = self._played
        last = max(self._last, 1)
        phase += (time.monotonic() - began) / PLAYED_IN
        self._session.watch(phase=min(int(phase * last) / last, 1.0))
        if phase >= 1.0:
            self._come_to_the_end()
        else:
            self._next.set(max(((int(phase * last) + 1) / last - phase) * PLAYED_IN, SOONEST))

    def _come_to_the_end(self) -> None:
        ends, self._loops = self._ends, self._loops - 1
        if ends is None:
            self.stop()
        elif self._loops > 0:
            self.loop(self._loops, ends)
        else:
            ends()

    def choose_substructure(self, number: float) -> None:
        """Look at the modes of another substructure, counted from 1."""
        last, place = self._session.settings.n_substructures - 1, round(number) - 1
        self._session.watch(substructure=None if place >= last else max(place, 0))

    def _arrange(self) -> None:
        """Show the sliders that apply."""
        settings = self._session.wanted
        offered = ENDS if settings.finish in ENDS else {**ENDS, settings.finish: ITERATE}
        self._way.param.update(options=self._options(offered), value=settings.finish)
        sliders = [self._iteration, self._instant]
        if settings.applies("pgd_modes") and settings.n_substructures > 1:
            sliders.append(self._substructure)
        if list(self._sliders) != sliders:
            self._show_substructure(settings)
            self._sliders[:] = sliders

    def _options(self, offered: Mapping[str, str]) -> dict[str, str]:
        """Give names, by what they are called."""
        return {self._session.say(title): name for name, title in offered.items()}

    def _end(self, finish: str) -> None:
        """Have the run end in another way; it begins anew."""
        if finish != self._session.wanted.finish:
            self._session.change("finish", finish)

    def place(self, more: list[Any]) -> None:
        """Put widgets behind the sliders, in place of those there."""
        parts = [*self.view.objects[:FIXED], *more]
        if list(self.view) != parts:
            self.view[:] = parts

    def _show(self) -> None:
        """Bring buttons and sliders to where the session is."""
        label, icon, does, facts = "Run", "play_arrow", RUNS, self._session.facts
        if self._session.goes_on:
            label, icon = "Pause", "pause"
        elif facts is not None and facts.is_over:
            label, icon, does = "Replay", "replay", REPLAYS
        elif facts is not None and facts.asks:
            label, icon, does = "Run anyway", "warning_amber", AGREES
        if self._run.icon != icon:
            say = self._session.say
            self._run.param.update(label=say(label), icon=icon, description=say(does))
        if self._substructure in self._sliders:
            self._show_substructure(self._session.settings)

    def _make_buttons(self) -> None:
        say = self._session.say
        self._run = button(
            say("Pause"),
            "pause",
            self.toggle,
            min_width=98,
            sx={"whiteSpace": "nowrap"},
            color="primary",
            description=say(RUNS),
        )
        beside: dict[str, Any] = {"variant": "outlined", "sx": NARROW}
        once, anew = say("Do one iteration and wait (s)."), say(RESETS)
        self._step = button(say("Step"), "", self.step, description=once, **beside)
        self._reset = button(say("Reset"), "", self.reset, description=anew, **beside)
        self._way = pmui.RadioButtonGroup(
            options=self._options(ENDS),
            value=WATCH,
            size="small",
            description=say(WAYS),
            margin=(4, 10),
            sx=SMALL,
        )
        self._pace = select(
            say("Pace"),
            self._options(LABELS),
            lambda name: self._session.set_pace(PACES[name]),
            value=next(name for name, pace in PACES.items() if pace == self._session.pace),
            width=134,
            description=say("Iterations shown in a second; waiting is no part of the run time."),
        )

    def _make_sliders(self) -> None:
        self._iteration = scrubber(
            138,
            self._session.seek,
            name=ITERATION,
            label="Iteration",
            start=1,
            end=2,
            help="Go back to any iteration done; at the right end it follows the run.",
        )
        self._instant = scrubber(
            118,
            self._choose_instant,
            self.play,
            name=INSTANT,
            label="Instant",
            help="The instant that is drawn; a tap on the map or the load path chooses it too.",
            plays="Play through time, or stop (t).",
        )
        self._substructure = scrubber(
            118,
            self.choose_substructure,
            label="Substructure",
            help="The one whose PGD modes are drawn; a tap on the map of basis sizes chooses it.",
            start=1,
        )

    @property
    def _last(self) -> int:
        """The last instant, also of a run that has no picture yet."""
        last: int = self._session.settings.n_instants - 1
        return last

    def _choose_instant(self, number: int) -> None:
        self._choose_phase(number / max(self._last, 1))

    def _choose_phase(self, phase: float) -> None:
        """Look at a share of the interval; who chooses one plays no more."""
        self.stop()
        self._session.watch(phase=min(max(phase, 0.0), 1.0))

    def _show_substructure(self, settings: Settings) -> None:
        last, chosen = settings.n_substructures, self._session.look.substructure
        at = last if chosen is None else min(chosen + 1, last)
        self._substructure.param.update(end=max(last, 2), shown=at, text=str(at))
