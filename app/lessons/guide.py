"""The text beside the plots: a lesson, with its question, choice and answer, or a case."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.controls import SettingControl
from app.frame import Selection
from app.lessons.cases import gallery, texts_of
from app.lessons.catalogue import (
    CASES,
    KNOWN,
    LESSONS,
    filled,
    kinds_of,
    parts_of,
    plots_of,
    readings_of,
    settings_of,
)
from app.lessons.curve import DrawnCurve
from app.lessons.handout import handout
from app.state import PageState, Poll
from app.transport import Transport
from app.views.view import View
from app.widgets import button, dialog, download, looks
from solver.study.lessons import SUBJECTS, Lesson
from solver.study.trade_case import Case

WITHOUT = -1
"""The prediction of who wants to see the answer without one."""
text_button = partial(button, margin=(3, 8, 3, 0))


class Guide:
    """The lesson or the case that a page is in, if it is in one.

    `view` stands beside the plots, `dialogs` are the lists of all lessons and of all
    cases; `changed` is called when another one is shown. The transport plays the
    picture while a question is open; `open_counts` has a class see how many predicted
    what.
    """

    def __init__(
        self,
        state: PageState,
        transport: Transport,
        changed: Callable[[], None],
        open_counts: Callable[[], None],
    ) -> None:
        self._state = state
        self._transport = transport
        self._changed = changed
        self._open_counts = open_counts
        self._texts: list[tuple[pn.pane.Markdown, Callable[[], str]]] = []
        self._controls: list[SettingControl] = []
        self._curve: DrawnCurve | None = None
        self._choices = pn.Column(margin=0)
        self._shown: tuple[str, str, bool] | None = None
        self.view = pn.Column(css_classes=["lesson"], margin=(0, 8), visible=False)
        self.dialogs = {
            "lesson": dialog("Lessons", width_option="md"),
            "case": dialog("Cases of the trade", width_option="md"),
        }
        state.param.watch(
            lambda *events: self.show(), ["lesson", "case", "prediction", "poll"]
        )
        state.param.watch(lambda event: self._follow_settings(), "settings")
        state.param.watch(lambda event: self.update(), "frame")

    def open(self, kind: str, name: str) -> None:
        """Begin a lesson or a case, with its scene and settings, in place of another."""
        self.dialogs[kind].open = False
        places = {"lesson": "", "case": "", "prediction": None, kind: name}
        with param.parameterized.batch_call_watchers(self._state):
            self._state.param.update(**places, plots=plots_of(places["case"]))
            self._state.adopt(settings_of(KNOWN[kind][name]))

    def offer(self, kind: str) -> None:
        """Show the list of all lessons, or of all cases."""
        listed = self.dialogs[kind]
        begin = partial(self.open, kind)
        if not listed.objects:
            listed[:] = [gallery(begin) if kind == "case" else _titles(begin)]
        listed.open = True

    def update(self) -> None:
        """Bring the quantities in its sentences up to the frame."""
        for pane, text in self._texts:
            pane.object = text()

    @property
    def kinds(self) -> tuple[type[View], ...] | None:
        """The plots that stand beside it; None without a lesson."""
        lesson = LESSONS.get(self._state.lesson)
        if lesson:
            return kinds_of(lesson, is_answered=not self._state.is_asked)
        return None

    def predict(self, choice: int) -> None:
        """Take a prediction, which alone, or of who leads, goes on to the answer."""
        poll = self._state.poll
        self._state.prediction = choice
        if poll is None or poll.leads:
            # One watches from the start what was out of sight.
            self._state.run()

    def show(self) -> None:
        """Show what is open: of a lesson the question or the answer, and what a class predicts."""
        state = self._state
        lesson = LESSONS.get(self._state.lesson)
        shown = state.lesson, state.case, state.is_asked
        if shown != self._shown:
            self._shown = shown
            self._build(lesson, CASES.get(state.case))
        if lesson is not None:
            self._choices[:] = [
                *self._choices_of(lesson, state.poll),
                *self._of_class(state.poll),
            ]

    def _build(self, lesson: Lesson | None, case: Case | None) -> None:
        state = self._state
        parts = list[Any]()
        readings = list[str]()
        self._transport.stop()
        self._texts = []
        self._controls = []
        if lesson is not None:
            self._prepare_curve(lesson)
            parts = self._parts(lesson)
            readings = readings_of(lesson)
        elif case is not None:
            parts = self._parts_of_case(case)
            readings = [case.quantity.name]
        state.readings = readings
        self.view.param.update(objects=parts, visible=bool(parts))
        self._changed()
        if lesson is not None:
            self._look(lesson)

    def _prepare_curve(self, lesson: Lesson) -> None:
        is_asked = self._state.is_asked
        curve = self._curve
        if is_asked or curve is None or curve.lesson is not lesson:
            if lesson.draw:
                curve = self._curve = DrawnCurve(lesson)
            else:
                curve = self._curve = None
        if curve is not None and not is_asked:
            # A figure's own models change under the document's lock, which a click does
            # not have.
            pn.state.execute(curve.reveal, schedule=True)

    def _parts_of_case(self, case: Case) -> list[Any]:
        buttons = pn.FlexBox(
            text_button(
                "As it was", partial(self.open, "case", case.name), variant="outlined"
            ),
            text_button("All settings", self._end),
            margin=(8, 0),
        )
        texts = map(self._markdown, texts_of(case, self._state))
        return [*texts, *map(self._control, case.controls), buttons]

    def _look(self, lesson: Lesson) -> None:
        """Look at what it speaks of: the moving picture, or the instant of its plots."""
        state = self._state
        state.select(interface=lesson.interface)
        if not state.is_asked:
            state.select(phase=lesson.instant)
        elif state.poll is None or state.poll.leads:
            state.select(phase=Selection.phase if lesson.until == 1.0 else 0.0)
            self._transport.play(lesson.until)

    def _parts(self, lesson: Lesson) -> list[Any]:
        """The question, and after the choice the answer with what explains it."""
        if self._curve:
            figures = [pn.pane.Bokeh(self._curve.figure, margin=0)]
        else:
            figures = []
        question = [*self._paragraphs((f"**{lesson.question}**",)), self._choices]
        explore = text_button("Explore freely", self._end, variant="text")
        if self._state.is_asked:
            paragraphs = self._paragraphs((f"### {lesson.title}", *lesson.text))
            return [*paragraphs, *figures, *question, explore]
        explanation = self._paragraphs(lesson.explanation)
        buttons = pn.FlexBox(*self._onward(lesson), explore, margin=(8, 0))
        head = self._paragraphs((f"### {lesson.title}",))
        return [
            *head,
            *question,
            self._verdict(lesson),
            *figures,
            *explanation,
            buttons,
        ]

    def _verdict(self, lesson: Lesson) -> pmui.Alert:
        """The right choice and why, in the colour of whether it was predicted."""
        prediction = self._state.prediction
        choice = lesson.choices[lesson.right]
        is_right = prediction == lesson.right
        is_open = prediction in (None, WITHOUT)
        text = f"{'Right: ' if is_right else ''}{choice}. {lesson.why}"
        if is_open:
            severity = "info"
        elif is_right:
            severity = "success"
        else:
            severity = "warning"
        return pmui.Alert(
            object=text, severity=severity, margin=(4, 0), sizing_mode="stretch_width"
        )

    def _onward(self, lesson: Lesson) -> list[Any]:
        """The way to the next lesson, which a follower waits for, and the handout."""
        make = partial(handout, self._state, lesson, self._curve)
        on_paper = download("Handout", f"{lesson.name}.html", make, size="small")
        following = dict(pairwise(LESSONS)).get(lesson.name)
        poll = self._state.poll
        if following is None or not (poll is None or poll.leads):
            return [on_paper]
        return [
            text_button("Next lesson", lambda: self.open("lesson", following)),
            on_paper,
        ]

    def _paragraphs(self, paragraphs: tuple[str, ...]) -> list[Any]:
        """Panes of text, with controls where they are named."""
        return [
            self._markdown(lambda part=part: filled(part, self._state.frame))
            if place % 2 == 0
            else self._control(part)
            for text in paragraphs
            for place, part in enumerate(parts_of(text))
            if part
        ]

    def _markdown(self, text: Callable[[], str]) -> pn.pane.Markdown:
        """A pane of text that follows the frame."""
        look = {"margin": 0, "sizing_mode": "stretch_width", **looks("paragraph")}
        pane = pn.pane.Markdown(text(), **look)
        self._texts.append((pane, text))
        return pane

    def _control(self, name: str) -> Any:
        """The control of a setting."""
        self._controls.append(SettingControl(name, self._state))
        return self._controls[-1].view

    def _choices_of(self, lesson: Lesson, poll: Poll | None) -> list[pmui.Button]:
        """Buttons of the choices; with what a class predicts of each once that is open."""
        if poll is not None:
            counts = poll.counts
        else:
            counts = ()
        is_asked = self._state.is_asked
        if not (is_asked or counts):
            # Whoever is right or wrong reads it below.
            return []
        return [
            text_button(
                f"{choice}: {counts[number]}" if counts else choice,
                lambda number=number: self.predict(number),
                variant="contained" if number == self._state.prediction else "outlined",
                color="success"
                if not is_asked and number == lesson.right
                else "primary",
                disabled=not is_asked,
                **looks("choice"),
            )
            for number, choice in enumerate(lesson.choices)
        ]

    def _of_class(self, poll: Poll | None) -> list[Any]:
        """What follows the choices: who has predicted, and the way to the answer."""
        is_asked = self._state.is_asked
        if poll is None:
            show = text_button("Show me", lambda: self.predict(WITHOUT), variant="text")
            if is_asked:
                return [show]
            return []
        if is_asked and not poll.leads:
            waits = " The answer comes with the class."
        else:
            waits = ""
        parts = [
            pn.pane.Markdown(
                f"{poll.predicted} of {poll.present} have predicted.{waits}"
            )
        ]
        if poll.leads and not poll.counts:
            parts.append(
                text_button("Open the counts", self._open_counts, variant="outlined")
            )
        if poll.leads and is_asked:
            parts.append(
                text_button("Go on to the answer", lambda: self.predict(WITHOUT))
            )
        return parts

    def _follow_settings(self) -> None:
        """Leave it for another scene; show its controls as settings are."""
        state = self._state
        shown = LESSONS.get(state.lesson) or CASES.get(state.case)
        if shown is not None and state.settings.scene != shown.settings.scene:
            self._end()
        for control in self._controls:
            control.update()

    def _end(self) -> None:
        """Leave it; the run stays."""
        self._state.param.update(lesson="", case="")


def _titles(begin: Callable[[str], None]) -> pn.FlexBox:
    """The lessons, by subject."""
    columns = []
    for subject in SUBJECTS:
        title = f"#### {'Mechanics' if subject == 'mechanics' else 'The method'}"
        buttons = [
            text_button(
                lesson.title, partial(begin, name), **looks("choice"), variant="text"
            )
            for name, lesson in LESSONS.items()
            if lesson.subject == subject
        ]
        heading = pn.pane.Markdown(title, margin=(0, 8))
        columns.append(pn.Column(heading, *buttons, width=380, margin=0))
    return pn.FlexBox(*columns, gap="8px 32px", margin=0)
