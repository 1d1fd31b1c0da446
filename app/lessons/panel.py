"""A lesson on the page: its question, the choice, and then what was measured."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.frame import Selection
from app.lessons.catalogue import (
    LESSONS,
    Control,
    filled,
    kinds_of,
    parts_of,
    place_of,
    readings_of,
)
from app.lessons.curve import DrawnCurve
from app.lessons.guide import Guide, text_button
from app.lessons.handout import handout
from app.state import PageState, Poll
from app.transport import Transport
from app.views.view import View
from app.widgets import download, looks
from solver.lessons import SUBJECTS, Lesson

WITHOUT = -1
"""The prediction of who wants to see the answer without one."""


class LessonPanel(Guide):
    """The lesson that a page is in, if it is in one.

    The transport plays the picture while the question is open; `open_counts` has a class see how
    many predicted what.
    """

    kind, known = "lesson", LESSONS

    def __init__(
        self,
        state: PageState,
        transport: Transport,
        changed: Callable[[], None],
        open_counts: Callable[[], None],
    ) -> None:
        super().__init__(state, "Lessons", changed)
        self._transport, self._open_counts = transport, open_counts
        self._curve: DrawnCurve | None = None
        self._choices = pn.Column(margin=0)
        self._shown: tuple[str, bool] | None = None
        state.param.watch(lambda *events: self.show(), ["lesson", "prediction", "poll"])

    @property
    def kinds(self) -> tuple[type[View], ...] | None:
        """The plots that stand beside it; None without a lesson."""
        lesson = LESSONS.get(self._state.lesson)
        return kinds_of(lesson, is_answered=not self._state.is_asked) if lesson else None

    def predict(self, choice: int) -> None:
        """Take a prediction, which alone, or of who leads, goes on to the answer."""
        poll = self._state.poll
        self._state.prediction = choice
        if poll is None or poll.leads:
            # One watches from the start what was out of sight.
            self._state.run()

    def show(self) -> None:
        """Show the question, or the answer, of the lesson, and what a class predicts."""
        state, lesson = self._state, LESSONS.get(self._state.lesson)
        shown = state.lesson, state.is_asked
        if shown != self._shown:
            self._shown = shown
            self._build(lesson)
        if lesson is not None:
            self._choices[:] = [*self._choices_of(lesson, state.poll), *self._of_class(state.poll)]

    def _list(self) -> Any:
        return pn.FlexBox(*map(self._titles, SUBJECTS), gap="8px 32px", margin=0)

    def _titles(self, subject: str) -> pn.Column:
        title = f"#### {'Mechanics' if subject == 'mechanics' else 'The method'}"
        buttons = [
            text_button(lesson.title, partial(self.open, name), **looks("choice"), variant="text")
            for name, lesson in LESSONS.items()
            if lesson.subject == subject
        ]
        return pn.Column(pn.pane.Markdown(title, margin=(0, 8)), *buttons, width=380, margin=0)

    def _build(self, lesson: Lesson | None) -> None:
        state = self._state
        self._transport.stop()
        if lesson is None:
            self._fill(list, [])
            return
        if state.is_asked or self._curve is None or self._curve.lesson is not lesson:
            self._curve = DrawnCurve(lesson) if lesson.draw else None
        if self._curve is not None and not state.is_asked:
            # A figure's own models change under the document's lock, which a click does not have.
            pn.state.execute(self._curve.reveal, schedule=True)
        self._fill(partial(self._parts, lesson), readings_of(lesson))
        self._look(lesson)

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
        title = f"<small>{place_of(lesson)}</small>\n\n### {lesson.title}"
        figures = [pn.pane.Bokeh(self._curve.figure, margin=0)] if self._curve else []
        question = [*self._paragraphs((f"**{lesson.question}**",)), self._choices]
        explore = text_button("Explore freely", self._end, variant="text")
        if self._state.is_asked:
            paragraphs = self._paragraphs((title, *lesson.text))
            return [*paragraphs, *figures, *question, explore]
        explanation = self._paragraphs(lesson.explanation)
        buttons = pn.FlexBox(*self._onward(lesson), explore, margin=(8, 0))
        head = self._paragraphs((title,))
        return [*head, *question, self._verdict(lesson), *figures, *explanation, buttons]

    def _verdict(self, lesson: Lesson) -> pmui.Alert:
        """The right choice and why, in the colour of whether it was predicted."""
        prediction, choice = self._state.prediction, lesson.choices[lesson.right]
        is_right, is_open = prediction == lesson.right, prediction in (None, WITHOUT)
        text = f"{'Right: ' if is_right else ''}{choice}. {lesson.why}"
        severity = "info" if is_open else "success" if is_right else "warning"
        return pmui.Alert(
            object=text, severity=severity, margin=(4, 0), sizing_mode="stretch_width"
        )

    def _onward(self, lesson: Lesson) -> list[Any]:
        """The way to the next lesson, which a follower waits for, and the handout."""
        make = partial(handout, self._state, lesson, self._curve)
        on_paper = download("Handout", f"{lesson.name}.html", make, size="small")
        following, poll = dict(pairwise(LESSONS)).get(lesson.name), self._state.poll
        if following is None or not (poll is None or poll.leads):
            return [on_paper]
        return [text_button("Next lesson", lambda: self.open(following)), on_paper]

    def _paragraphs(self, paragraphs: tuple[str, ...]) -> list[Any]:
        """Panes of text, with controls where they are named."""
        parts = (part for text in paragraphs for part in parts_of(text) if part)
        return [
            self._control(part.setting)
            if isinstance(part, Control)
            else self._markdown(lambda part=part: filled(part, self._state.frame))
            for part in parts
        ]

    def _choices_of(self, lesson: Lesson, poll: Poll | None) -> list[pmui.Button]:
        """Buttons of the choices; with what a class predicts of each once that is open."""
        counts = poll.counts if poll is not None else ()
        is_asked = self._state.is_asked
        if not (is_asked or counts):
            # Whoever is right or wrong reads it below.
            return []
        return [
            text_button(
                f"{choice}: {counts[number]}" if counts else choice,
                lambda number=number: self.predict(number),
                variant="contained" if number == self._state.prediction else "outlined",
                color="success" if not is_asked and number == lesson.right else "primary",
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
            return [show] if is_asked else []
        waits = " The answer comes with the class." if is_asked and not poll.leads else ""
        parts = [pn.pane.Markdown(f"{poll.predicted} of {poll.present} have predicted.{waits}")]
        if poll.leads and not poll.counts:
            parts.append(text_button("Open the counts", self._open_counts, variant="outlined"))
        if poll.leads and is_asked:
            parts.append(text_button("Go on to the answer", lambda: self.predict(WITHOUT)))
        return parts
