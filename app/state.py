"""The state of a page: settings, frames, selection, and orders to the worker."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import numpy as np
import param

from app import messages
from app.frame import LINEAR, LOCAL, Frame, Selection
from app.history import History
from app.messages import Needs, Order, Pace, Ready, Report, Show, Start, Step
from app.refusals import message_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.scene import Settings
from solver.study.comparison import OtherResults
from solver.study.measured_loop import MeasuredLoop
from solver.study.trade_case import Case, cases_by_name

SEARCH = {"start": "zero", "finish": "accuracy"}
"""Settings that show the search from its start, as a page begins."""
RUNS = count(1)
"""Numbers of the runs of all pages: a page that joins or leaves a class meets no number
twice."""
PACES = {
    "whole in 3 s": messages.WHOLE,
    "1 a second": 1.0,
    "5 a second": 5.0,
    "20 a second": 20.0,
    "fastest": math.inf,
}
WHAT_IF = "What if"
TABS = ["Live", WHAT_IF, "Fit", "Reports"]
VIEWS = ["page", "present"]
"""The page with its controls, and the view for a projector."""


@dataclass(frozen=True)
class Poll:
    """Predictions of a class, anonymously, for a page.

    `counts` of each choice are empty until the leader opens them.
    """

    leads: bool
    predicted: int
    present: int
    counts: tuple[int, ...] = ()
    is_answered: bool = False


def default_settings(scene: str) -> Settings:
    """Settings with which a page begins a scene."""
    return CATALOGUE[scene].checked(SEARCH)


class PageState(param.Parameterized):
    """The state of a page: set by widgets, watched by views.

    `send` passes orders on.
    """

    settings = param.ClassSelector(
        class_=Settings, allow_None=False, doc="Checked settings of the run."
    )
    selection = param.ClassSelector(
        class_=Selection, default=Selection(), doc="What views show."
    )
    frame = param.ClassSelector(
        class_=Frame, default=None, doc="The frame that is shown."
    )
    newest = param.ClassSelector(
        class_=Frame, default=None, doc="The newest frame of the run."
    )
    ghost = param.ClassSelector(
        class_=Frame, default=None, doc="Frame of the pinned or the last run."
    )
    pinned = param.ClassSelector(
        class_=History, default=None, doc="Frames of the pinned run."
    )
    iteration = param.Integer(default=None, doc="Iteration shown; None: the newest.")
    running = param.Boolean(default=True, doc="Whether the run goes on by itself.")
    pace = param.Selector(
        default="whole in 3 s", objects=list(PACES), doc="Iterations a second."
    )
    needs = param.ClassSelector(
        class_=frozenset,
        default=frozenset(),
        doc="Names of the extras that views in sight need.",
    )
    readings = param.List(default=[], doc="Quantities that a lesson or a case names.")
    is_stale = param.Boolean(
        doc="Whether what is shown is of a run before the present."
    )
    is_dragged = param.Boolean(doc="Whether a slider or an arrow is being dragged.")
    lesson = param.String(doc="Name of the lesson.")
    case = param.String(doc="Name of the case; in a lesson there is none.")
    prediction = param.Integer(
        default=None, doc="Number of the predicted choice; -1 if no choice was wanted."
    )
    poll = param.ClassSelector(
        class_=Poll, default=None, doc="Predictions of the class."
    )
    tab = param.Selector(default="Live", objects=TABS, doc="Title of the tab in sight.")
    question = param.String(doc="Question of the tab What if, as `Question` writes it.")
    view = param.Selector(
        default="page", objects=VIEWS, doc="The page with controls, or for a projector."
    )
    height = param.Integer(default=720, doc="Height of the browser's window, px.")
    is_narrow = param.Boolean(
        doc="Whether the window has no room for controls beside the run."
    )
    is_dark = param.Boolean(default=False, doc="Whether the page is shown in the dark.")
    is_new = param.Boolean(
        doc="Whether marks in the picture say what is to be seen: on a first visit."
    )
    given = param.Integer(
        default=0, doc="Number of values that the page gave to widgets."
    )
    shown = param.Integer(
        default=0, doc="Number of these that the browser has shown, in their order."
    )
    plots = param.List(default=[], doc="Names of the views on top of their cards.")
    room = param.String(doc="Code of the class that is followed.")
    brought = param.ClassSelector(
        class_=(OtherResults, MeasuredLoop),
        default=None,
        doc="Measured loop, or results of another program.",
    )
    refusal = param.String(doc="Sentence on a refused value.")
    message = param.String(
        doc="Sentence of the page on a loss, a cost, or a fault of its own."
    )
    is_costly = param.Boolean(
        default=False, doc="Whether the run waits to be agreed to."
    )
    has_failed = param.Boolean(default=False, doc="Whether the run ended by an error.")

    def __init__(self, settings: Settings, **values: Any) -> None:
        super().__init__(settings=settings, **values)
        self.send: Callable[[Order], None] = lambda order: None
        self.history = History()
        self._left: dict[str, Settings] = {}
        self.number = 0
        self.began = 0
        self._sent: Needs | None = None
        self._awaits_local = False
        self._last_run: Frame | None = None
        self.param.watch(lambda event: self.param.update(prediction=None), "lesson")
        needed = ["selection", "needs", "readings", "brought"]
        self.param.watch(lambda *events: self.send_needs(is_news=False), needed)
        self.param.watch(lambda event: self.send(Pace(PACES[event.new])), "pace")

    def change(self, **values: object) -> bool:
        """Change settings and run them.

        A refused value sets `refusal` and nothing else.
        """
        settings = self.settings
        for name, value in values.items():
            try:
                settings = settings.with_change(name, value)
            except RefusedError as refused:
                self.refusal = message_of(refused, settings, name, value)
                return False
        self.adopt(settings)
        return True

    def drag(self, name: str, value: float) -> None:
        """Run the value of a dragged slider, or say why it is refused.

        Only the answer is shown.
        """
        try:
            settings = self.settings.with_change(name, value)
        except RefusedError as refused:
            self.refusal = message_of(refused, self.settings, name, value)
            return
        # The worker begins while the page follows.
        self._start(answer(settings), is_dragged=True)
        self.param.update(refusal="", settings=settings)

    def release(self, name: str, value: float) -> None:
        """Run the value at which a slider is released.

        If it is refused, the last allowed value is run.
        """
        self.change(**{name: value})
        # The value was refused if the last run ordered is still that of a drag.
        if self.is_dragged:
            self.run()

    def adopt(self, settings: Settings) -> None:
        """Replace the settings and run them."""
        # They are found again when the scene is chosen again.
        self._left[self.settings.scene] = self.settings
        self.param.update(settings=settings, refusal="", running=True)
        self.run()

    def choose_scene(self, scene: str) -> None:
        """Change to another scene, with the last settings of that scene."""
        if scene != self.settings.scene:
            self.adopt(self._left.get(scene) or default_settings(scene))

    def run(self, *, is_agreed: bool = False) -> None:
        """Run the settings from the start at the present pace."""
        self.running = True
        self._start(self.settings, is_agreed=is_agreed)

    @property
    def is_over(self) -> bool:
        """Check whether the last ordered run has ended."""
        if self.has_failed:
            return True
        newest = self.newest
        if newest is None or newest.run.number != self.number:
            return False
        return newest.status is not None

    @property
    def is_fleeting(self) -> bool:
        """Check whether the reference of the frame comes with the next frame.

        The last run of the scene had a reference: entries of legends that vanish and
        come back at once would flicker.
        """
        has_last = self.ghost is not None and self.iteration is None
        return has_last and not self.frame.run.is_compared

    @property
    def is_asked(self) -> bool:
        """Check whether a lesson's question is unanswered.

        In a class it is open until the leader continues.
        """
        is_answered = self.prediction is not None
        if self.poll is not None:
            is_answered = self.poll.is_answered
        return bool(self.lesson) and not is_answered

    @property
    def trade_case(self) -> Case | None:
        """The open case, if the frame is of its scene."""
        case = cases_by_name().get(self.case)
        if case is None or self.frame is None:
            return None
        if case.settings.scene != self.frame.run.settings.scene:
            return None
        return case

    def pause(self) -> None:
        """Pause the run."""
        self.running = False
        self.send(Pace(0.0))

    def go_on(self) -> None:
        """Continue the run, or begin it again if it has ended."""
        if self.is_over or self.is_costly:
            self.run(is_agreed=self.is_costly)
            return
        self.show_stage(LINEAR)
        self.param.update(running=True, iteration=None)
        self.send(Pace(PACES[self.pace]))

    def step(self) -> None:
        """Show the next stage of the search, then pause.

        After a whole iteration that is the local stage of the next one, for which the
        worker does both stages; then its linear stage.
        """
        shown = self.frame
        newest = self.newest
        if self._awaits_local or self.selection.stage == LOCAL:
            self.show_stage(LINEAR)
        elif shown is not None and newest is not None and shown is not newest:
            with param.parameterized.batch_call_watchers(self):
                self.seek((self.iteration or shown.iteration) + 1)
                if not self.frame.is_answer:
                    self.show_stage(LOCAL)
        else:
            self._awaits_local = not self.is_over
            self.param.update(running=False, iteration=None)
            self.send(Step())

    def before_linear(self, frame: Frame) -> Frame:
        """A frame with the bodies at the positions of the previous linear stage.

        That of the iterate before, if it was kept; a search from nothing begins at
        rest.
        """
        moved = None
        if frame.iteration > 1:
            before = self.history.at(frame.iteration - 1)
            if before.iteration == frame.iteration - 1:
                moved = before.deformed
        elif frame.run.settings.start == SEARCH["start"]:
            moved = replace(
                frame.deformed,
                nodes=np.zeros_like(frame.deformed.nodes),
                points=np.zeros_like(frame.deformed.points),
            )
        if moved is None:
            return frame
        return replace(frame, deformed=replace(moved, status=frame.deformed.status))

    def show_stage(self, stage: str) -> None:
        """Show the iterate up to its local or its linear stage."""
        self._awaits_local = False
        if stage != self.selection.stage:
            self.select(stage=stage)

    def reset(self, iteration: int = 1) -> None:
        """Restart the run, and pause at an iteration."""
        self.running = False
        self._start(self.settings, 0.0, steps=iteration)

    def seek(self, iteration: int | None) -> None:
        """Show an earlier iterate; the newest for None, and beyond the last.

        Of an iterate that was not shown before, its frame is asked for; until it comes,
        the last one before it is shown.
        """
        newest = self.newest
        if newest is None:
            return
        frame = newest
        shown = None
        if iteration is not None and iteration < newest.place:
            shown = max(iteration, 1)
            frame = self.history.at(shown)
        with param.parameterized.batch_call_watchers(self):
            self.show_stage(LINEAR)
            self.param.update(iteration=shown, frame=frame, ghost=self._ghost_at(frame))
        if shown is not None and frame.iteration != shown:
            self.send(Show(shown))

    def _start(
        self, settings: Settings, pace: float | None = None, **options: Any
    ) -> None:
        """Order a run with options of `Start`; default pace: that of the page."""
        self.number = next(RUNS)
        is_dragged = options.get("is_dragged", False)
        self.show_stage(LINEAR)
        self.param.update(
            is_costly=False,
            has_failed=False,
            message="",
            iteration=None,
            is_dragged=is_dragged,
            # A slider moves on before each of its runs is shown.
            is_stale=self.frame is not None and not is_dragged,
        )
        if pace is None:
            pace = PACES[self.pace]
        self.send(Start(self.number, settings, pace, **options))

    def pin(self) -> None:
        """Pin the present run for comparison with later ones, or unpin it."""
        if self.frame is not None:
            self.pinned = None if self.pinned is not None else self.history
            self.ghost = self._ghost_at(self.frame)

    def _ghost_at(self, frame: Frame) -> Frame | None:
        """The frame for comparison: of the pinned or the last run.

        There is none where that run is of another structure.
        """
        ghost = self._last_run
        pinned = self.pinned
        if pinned is not None and pinned is not self.history:
            if frame.is_answer:
                ghost = pinned.newest
            else:
                ghost = pinned.at(frame.iteration)
        if ghost is None or ghost.run.structure != frame.run.structure:
            return None
        return ghost

    def take(self, report: Report) -> None:
        """Process a report of the worker."""
        match report:
            case messages.Began(number):
                self.began = number
            case messages.NewFrame(frame):
                self._show(frame)
            case messages.Earlier(frame) if frame.run.number == self.number:
                self._show_earlier(frame)
            case messages.Costly(number, text) if number == self.number:
                self.is_costly = True
                self.message = (
                    f"This run would take about {text}: press ⚠ (or space) to run it "
                    "anyway, or choose fewer elements, instants or bodies."
                )
            case messages.Failed(number, problem) if number == self.number:
                if isinstance(problem, RefusedError):
                    # Some of it only the making of the bodies tells.
                    problem = message_of(problem, self.settings)
                self.param.update(message=problem, has_failed=True)

    def _show(self, frame: Frame) -> None:
        # A frame of a run before: its worker waits for an answer all the same.
        if frame.run.number != self.number:
            self.send(Ready())
            return
        last = self.history.newest
        # Remarks on a run that follows a slider come with its reference.
        if self.is_dragged and last is not None and not frame.run.is_compared:
            frame = replace(frame, remarks=last.remarks)
        # The first frame of a run: the run before becomes the one to compare with.
        if last is None or last.run.number != self.number:
            if self.pinned is not self.history:
                self._last_run = last
            self.history = History()
        is_stepped = self._awaits_local and last is not None
        is_next = is_stepped and frame.iteration > last.iteration
        self.history.add(frame)
        with param.parameterized.batch_call_watchers(self):
            self.is_stale = False
            if is_next and not frame.is_answer:
                self.show_stage(LOCAL)
            self.newest = frame
            if self.iteration is None:
                self.ghost = self._ghost_at(frame)
                self.frame = frame
            else:
                self.send(Ready())

    def _show_earlier(self, frame: Frame) -> None:
        """Store an earlier frame, and show the frame if it is the requested one."""
        self.history.add(frame)
        if self.iteration == frame.iteration:
            self.param.update(frame=frame, ghost=self._ghost_at(frame))

    def send_needs(self, *, is_news: bool = True) -> None:
        """Order the visible extras and quantities, if they differ from the last order.

        A new worker is sent them in any case (`is_news`).
        """
        selection = self.selection
        needs = Needs(
            self.needs,
            selection.interface,
            selection.substructure,
            selection.position,
            tuple(self.readings),
            self.brought,
        )
        if is_news or needs != self._sent:
            is_more = not is_news and self._sent is not None
            self._sent = needs
            self.send(needs)
            # The newest frame comes by itself, an earlier one when it is asked for.
            if is_more and self.iteration is not None:
                self.send(Show(self.iteration))

    def turn(self, step: int = 1) -> None:
        """Select another interface, a number of interfaces further."""
        if self.frame is None:
            return
        run = self.frame.run
        names = run.surfaces
        shown = run.interface(self.selection.interface)
        if shown in names:
            shown = names[(names.index(shown) + step) % len(names)]
            self.select(interface=shown)

    def select(self, **values: Any) -> None:
        """Change the selection."""
        self.selection = replace(self.selection, **values)


def answer(settings: Settings) -> Settings:
    """Settings that give the answer at once, without a visible search."""
    if settings.finish != SEARCH["finish"]:
        return settings
    return settings.replace(**answering(settings))


def answering(settings: Settings) -> dict[str, str]:
    """Values of settings for which a run gives the answer at once.

    The start is that of the fast method; where this starts from zero, that of the
    settings stays.
    """
    values = {"finish": "at-once"}
    start = settings.of_method("fast")["start"]
    if start != SEARCH["start"]:
        values["start"] = start
    return values
