"""A lesson on the page: its question, the choice, and then what was measured."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.controls import Control
from app.frame import Selection
from app.lessons.catalogue import LESSONS, kinds_of, lesson_after, readings_of, settings_of
from app.lessons.curve import DrawnCurve
from app.lessons.handout import handout
from app.lessons.text import filled, parts_of
from app.state import Poll
from app.state import PageState
from app.transport import Transport
from app.views.view import View
from solver.lessons.lesson import SUBJECTS, Lesson
from solver.lessons.lesson import Control as ControlPlace

PARAGRAPH = [":host p { margin: 0 0 8px; font-size: 15px; line-height: 1.4 }"]
WITHOUT = -1
"""The prediction of who wants to see the answer without one."""
SENTENCE = {"& .MuiButton-label": {"textAlign": "left"}, "&": {"textTransform": "none"}}
LEFT = {**SENTENCE, "&.MuiButton-root": {"justifyContent": "flex-start", "textAlign": "left"}}


class LessonPanel:
    """The lesson that a page is in, if it is in one.

    Parameters
    ----------
    state, transport
        Of the page; the transport plays the picture while the question is open.
    changed
        Called when other plots shall stand beside it.
    open_counts
        Has a class see how many predicted what.

    Attributes
    ----------
    view
        What stands beside the plots.
    dialog
        The list of all lessons.
    """

    def __init__(
        self,
        state: PageState,
        transport: Transport,
        changed: Callable[[], None],
        open_counts: Callable[[], None],
    ) -> None:
        self._state, self._transport = state, transport
        self._changed, self._open_counts = changed, open_counts
        self._texts: list[tuple[pn.pane.Markdown, str]] = []
        self._controls: list[Control] = []
        self._curve: DrawnCurve | None = None
        self._choices, self._class = pn.Column(margin=0), pn.Column(margin=0)
        self._shown: tuple[str, bool] = ("", False)
        self.view = pn.Column(css_classes=["lesson"], margin=(0, 8), visible=False)
        self.dialog = pmui.Dialog(
            title="Lessons", width_option="md", show_close_button=True, close_on_click=True
        )
        state.param.watch(lambda *events: self.show(), ["lesson", "prediction", "poll"])
        state.param.watch(lambda event: self._follow_settings(), "settings")

    @property
    def lesson(self) -> Lesson | None:
        """The lesson that is open."""
        return LESSONS.get(self._state.lesson)

    @property
    def kinds(self) -> tuple[type[View], ...] | None:
        """The plots that stand beside it; None without a lesson."""
        lesson = self.lesson
        if lesson is None:
            return None
        return kinds_of(lesson, is_answered=not self._state.is_asked)

    def open(self, name: str) -> None:
        """Begin a lesson, with its scene and settings."""
        self.dialog.open = False
        with param.parameterized.batch_call_watchers(self._state):
            self._state.param.update(lesson=name, prediction=None)
            self._state.adopt(settings_of(LESSONS[name]))

    def offer(self) -> None:
        """Show the list of all lessons."""
        if not self.dialog.objects:
            self.dialog[:] = [pn.FlexBox(*map(self._offers, SUBJECTS), gap="8px 32px", margin=0)]
        self.dialog.open = True

    def predict(self, choice: int) -> None:
        """Take a prediction, which alone, or of who leads, goes on to the answer."""
        poll = self._state.poll
        self._state.prediction = choice
        if poll is None or poll.leads:
            # One watches from the start what was out of sight.
            self._state.run()

    def update(self) -> None:
        """Bring the quantities in its sentences up to the frame."""
        for pane, text in self._texts:
            pane.object = filled(text, self._state.frame)

    def _offers(self, subject: str) -> pn.Column:
        lessons = [lesson for lesson in LESSONS.values() if lesson.subject == subject]
        title = f"#### {'Mechanics' if subject == 'mechanics' else 'The method'}"
        buttons = [
            _button(
                lesson.title,
                lambda event, name=lesson.name: self.open(name),
                sx=LEFT,
                variant="text",
            )
            for lesson in lessons
        ]
        return pn.Column(pn.pane.Markdown(title, margin=(0, 8)), *buttons, width=380, margin=0)

    def _follow_settings(self) -> None:
        """Leave a lesson for another scene; show its controls as settings are."""
        lesson = self.lesson
        if lesson is not None and self._state.settings.scene != lesson.settings.scene:
            self._state.lesson = ""
        for control in self._controls:
            control.update()

    def show(self) -> None:
        """Show the question, or the answer, of the lesson, and what a class predicts."""
        shown = self._state.lesson, not self._state.is_asked
        if shown != self._shown or self._curve_is_of_another:
            self._shown = shown
            self._build()
        if self.lesson is not None:
            self._show_choices(self.lesson, self._state.poll)
            self._class[:] = self._of_class(self._state.poll)

    @property
    def _curve_is_of_another(self) -> bool:
        lesson = self.lesson
        return lesson is not None and bool(lesson.draw) and self._curve is None

    def _build(self) -> None:
        state, lesson = self._state, self.lesson
        self._texts, self._controls = [], []
        self._transport.stop()
        if lesson is None:
            self._curve = None
            self.view.param.update(objects=[], visible=False)
            state.readings = []
            self._changed()
            return
        if state.is_asked:
            self._curve = DrawnCurve(lesson) if lesson.draw else None
            state.readings = readings_of(lesson)
        elif lesson.draw:
            self._curve = self._curve or DrawnCurve(lesson)
            # A figure's own models change under the document's lock, which a click does not have.
            pn.state.execute(self._curve.reveal, schedule=True)
        parts = self._question(lesson) if state.is_asked else self._answer(lesson)
        self.view.param.update(objects=[*self._head(lesson), *parts], visible=True)
        self.update()
        self._changed()
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

    def _head(self, lesson: Lesson) -> list[Any]:
        place = list(LESSONS).index(lesson.name) + 1
        title = f"<small>Lesson {place} of {len(LESSONS)}</small>\n\n### {lesson.title}"
        return [
            pn.pane.Markdown(title, margin=0, sizing_mode="stretch_width", stylesheets=PARAGRAPH)
        ]

    def _question(self, lesson: Lesson) -> list[Any]:
        """What stands before the choice."""
        curve = [pn.pane.Bokeh(self._curve.figure, margin=0)] if self._curve else []
        question = self._markdown(f"**{lesson.question}**")
        return [
            *self._paragraphs(lesson.text), *curve, question, self._choices, self._class,
            _button("Explore freely", lambda event: self._end(), variant="text"),
        ]  # fmt: skip

    def _answer(self, lesson: Lesson) -> list[Any]:
        """What stands after the choice."""
        prediction, choice = self._state.prediction, lesson.choices[lesson.right]
        is_right, is_open = prediction == lesson.right, prediction in (None, WITHOUT)
        text = f"{'Right: ' if is_right else ''}{choice}. {lesson.why}"
        severity = "info" if is_open else "success" if is_right else "warning"
        curve = [pn.pane.Bokeh(self._curve.figure, margin=0)] if self._curve else []
        following = lesson_after(lesson)
        paper = pmui.FileDownload(
            callback=lambda: handout(self._state, lesson, self._curve),
            filename=f"{lesson.name}.html",
            label="Handout",
            size="small",
        )
        buttons = [paper, _button("Explore freely", lambda event: self._end(), variant="text")]
        if following is not None:
            go_on = _button("Next lesson", lambda event: self.open(following.name))
            buttons.insert(0, go_on)
        question = self._markdown(f"**{lesson.question}**")
        return [
            question, self._choices, self._class,
            pmui.Alert(object=text, severity=severity, margin=(4, 0), sizing_mode="stretch_width"),
            *curve, *self._paragraphs(lesson.explanation),
            pn.FlexBox(*buttons, margin=(8, 0)),
        ]  # fmt: skip

    def _paragraphs(self, paragraphs: tuple[str, ...]) -> list[Any]:
        """Panes of text, with controls where they are named."""
        shown: list[Any] = []
        for part in (part for text in paragraphs for part in parts_of(text)):
            if isinstance(part, ControlPlace):
                self._controls.append(Control(part.setting, self._state))
                shown.append(self._controls[-1].view)
            elif part:
                shown.append(self._markdown(part))
        return shown

    def _markdown(self, text: str) -> pn.pane.Markdown:
        pane = pn.pane.Markdown(
            filled(text, self._state.frame),
            margin=0,
            sizing_mode="stretch_width",
            stylesheets=PARAGRAPH,
        )
        if "{value:" in text:
            self._texts.append((pane, text))
        return pane

    def _show_choices(self, lesson: Lesson, poll: Poll | None) -> None:
        """Buttons of the choices; with what a class predicts of each once that is open."""
        counts = poll.counts if poll is not None else ()
        is_asked, buttons = self._state.is_asked, []
        for number, choice in enumerate(lesson.choices):
            is_right = not is_asked and number == lesson.right
            buttons.append(
                _button(
                    f"{choice}: {counts[number]}" if counts else choice,
                    lambda event, number=number: self.predict(number),
                    variant="contained" if number == self._state.prediction else "outlined",
                    color="success" if is_right else "primary",
                    disabled=not is_asked,
                    sx=LEFT,
                )
            )
        # Whoever is right or wrong reads it below; of a class the counts stay.
        self._choices[:] = buttons if is_asked or counts else []

    def _of_class(self, poll: Poll | None) -> list[Any]:
        """What follows the choices: who has predicted, and the way to the answer."""
        is_asked = self._state.is_asked
        show = [_button("Show me", lambda event: self.predict(WITHOUT), variant="text")]
        if poll is None:
            return show if is_asked else []
        told = pn.pane.Markdown(
            f"{poll.predicted} of {poll.present} have predicted."
            f"{'' if poll.leads or not is_asked else ' The answer comes with the class.'}"
        )
        if not poll.leads:
            return [told]
        counts = _button("Open the counts", lambda event: self._open_counts(), variant="outlined")
        on = [_button("Go on to the answer", lambda event: self.predict(WITHOUT))]
        return [told, *([] if poll.counts else [counts]), *(on if is_asked else [])]

    def _end(self) -> None:
        """Leave the lesson; the run stays."""
        self._state.lesson = ""


def _button(label: str, does: Callable[[Any], None], **more: Any) -> pmui.Button:
    look = {"variant": "contained", "size": "small", "margin": (3, 0), "sx": SENTENCE, **more}
    return pmui.Button(label=label, on_click=does, **look)
