"""The text next to the plots: a lesson (question, choice, answer) or a case."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.browser import fade_first
from app.frame import Selection
from app.lessons.cases import formula_of, gallery, texts_of
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
from app.lessons.choices import WITHOUT, Choices, text_button
from app.lessons.curve import DrawnCurve
from app.lessons.handout import handout
from app.setting_control import SettingControl
from app.state import PageState
from app.transport import Transport
from app.views.type_size import TEXT
from app.views.view import View
from app.widgets import dialog, download, looks, rebuilt, up_to
from solver.study.lessons import SUBJECTS, Lesson
from solver.study.trade_case import Case

TO_TOP = """
cb_obj.scroll_position = 0
Bokeh.index.find_one(cb_obj)?.el.scrollIntoView()
"""
"""Script that brings the title of a new text into sight: the text itself scrolls, or in
a narrow window the page does."""


class Guide:
    """The open lesson or case of a page, if any.

    `view` is next to the plots while one `is_open`, `dialogs` are the lists of all
    lessons and of all cases; `changed` is called when another lesson or case is shown.
    The transport plays the picture once a question is answered; `open_counts` shows a
    class the number of predictions of each choice.
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
        self._choices: Choices | None = None
        self._shown: tuple[str, str, bool] | None = None
        self._type = TEXT
        self.view = pn.Column(css_classes=["lesson"], margin=(0, 8))
        self._rises = False
        self.dialogs = {
            "lesson": dialog("Lessons", width_option="md"),
            "case": dialog("Cases of the trade", width_option="md"),
        }
        state.param.watch(
            lambda *events: self.show(), ["lesson", "case", "prediction", "poll"]
        )
        state.param.watch(lambda event: self._follow_settings(), "settings")
        state.param.watch(lambda event: self.update(), "frame")

    @property
    def is_open(self) -> bool:
        """Check whether the page is in a lesson or a case."""
        return self._state.lesson in LESSONS or self._state.case in CASES

    def magnify(self, size: str) -> None:
        """Set the type size of the figure to draw on, as CSS has it."""
        self._type = size
        if self._curve is not None:
            self._curve.magnify(size)

    def open(self, kind: str, name: str) -> None:
        """Open a lesson or a case with its settings, and close another one."""
        self.dialogs[kind].open = False
        fade_first(self._state, partial(self._open, kind, name))

    def _open(self, kind: str, name: str) -> None:
        opened = {"lesson": "", "case": "", kind: name}
        plots = plots_of(opened["case"])
        if kind == "case":
            self._state.select(phase=CASES[name].instant)
        # In one step: else the text would be built once with the scene before.
        with param.parameterized.batch_call_watchers(self._state):
            self._state.param.update(**opened, prediction=None, plots=plots)
            self._state.adopt(settings_of(KNOWN[kind][name]))

    def offer(self, kind: str) -> None:
        """Show the list of all lessons, or of all cases."""
        listed = self.dialogs[kind]
        begin = partial(self.open, kind)
        # Filled when it is first opened: a page begins without all these buttons.
        if not listed.objects:
            offered = gallery if kind == "case" else _titles
            listed[:] = [offered(begin)]
        listed.open = True

    def update(self) -> None:
        """Update the quantities in the sentences to those of the frame."""
        for pane, text in self._texts:
            pane.object = text()

    def predict(self, choice: int) -> None:
        """Take a prediction; outside a class, or from its leader, show the answer."""
        state = self._state
        state.prediction = choice
        if not self._follows and state.settings.finish != "at-once":
            # The search was out of sight: it is watched from its start.
            state.run()

    def show(self) -> None:
        """Show the lesson or case that is open, and the predictions of a class."""
        state = self._state
        lesson = LESSONS.get(state.lesson)
        shown = state.lesson, state.case, state.is_asked
        if shown != self._shown:
            self._shown = shown
            self._build(lesson, CASES.get(state.case))
        elif self._choices is not None:
            self._choices.show()

    @property
    def _follows(self) -> bool:
        """Check whether the leader of a class decides when the answer is shown."""
        poll = self._state.poll
        return poll is not None and not poll.leads

    # In one message: the browser lays out and paints all figures for each change of
    # their sizes.
    @rebuilt()
    def _build(self, lesson: Lesson | None, case: Case | None) -> None:
        state = self._state
        parts = list[Any]()
        readings = list[str]()
        self._transport.stop()
        self._texts = []
        self._controls = []
        self._choices = None
        if lesson is not None:
            self._prepare_curve(lesson)
            parts = self._parts(lesson)
            readings = readings_of(lesson)
        elif case is not None:
            parts = self._parts_of_case(case)
            readings = [case.quantity.name]
        state.readings = readings
        if parts:
            self._rise()
            self.view[:] = parts
        self._changed()
        if not parts:
            # It has left the page.
            self.view.clear()
        # At last, as it plays what the plots beside show.
        if lesson is not None:
            self._look(lesson)

    def _rise(self) -> None:
        """Scroll texts to the top.

        Panel looks for callbacks of this kind in all of a page that has one, whenever
        anything new comes to it. The first text comes before the callback does: it is
        still hidden then.
        """
        if not self._rises:
            self._rises = True
            self.view.jscallback(children=TO_TOP)
            self.view.jscallback(visible=TO_TOP)

    def _prepare_curve(self, lesson: Lesson) -> None:
        """Make a figure to draw on for a question; reveal the curve in the answer."""
        is_asked = self._state.is_asked
        if is_asked or self._curve is None or self._curve.lesson is not lesson:
            self._curve = None
            if lesson.draw:
                self._curve = DrawnCurve(lesson)
                self._curve.magnify(self._type)
        if self._curve is not None and not is_asked:
            # A figure's own models change under the document's lock, which a click does
            # not have.
            pn.state.execute(self._curve.reveal, schedule=True)

    def _parts_of_case(self, case: Case) -> list[Any]:
        buttons = pn.FlexBox(
            text_button(
                "As it was", partial(self.open, "case", case.name), variant="outlined"
            ),
            text_button("All settings", self._end),
            margin=(8, 0),
        )
        texts = [self._markdown(text) for text in texts_of(case, self._state)]
        controls = []
        for name in case.controls:
            controls += self._control(name)
        return [*texts[:-1], formula_of(case), texts[-1], *controls, buttons]

    def _look(self, lesson: Lesson) -> None:
        """Select the instant of the answer, or play the picture of the question."""
        state = self._state
        state.select(interface=lesson.interface)
        if not state.is_asked:
            state.select(phase=lesson.instant)
        elif not self._follows:
            start = 0.0
            if lesson.until == 1.0:
                start = Selection.phase
            state.select(phase=start)
            self._transport.play(lesson.until, by_itself=True)

    def _parts(self, lesson: Lesson) -> list[Any]:
        """The question, and after the choice the answer with its explanation."""
        figures = []
        if self._curve:
            figures = [pn.pane.Bokeh(self._curve.figure, margin=0)]
        title = f"## {lesson.title}"
        choices = Choices(lesson, self._state, self.predict, self._show_counts)
        self._choices = choices
        question = [*self._paragraphs((f"**{lesson.question}**",)), choices.view]
        explore = text_button("Explore freely", self._end, variant="text")
        if self._state.is_asked:
            paragraphs = self._paragraphs((title, *lesson.text))
            return [*paragraphs, *figures, *question, explore]
        explanation = self._paragraphs(lesson.explanation)
        buttons = pn.FlexBox(*self._onward(lesson), explore, margin=(8, 0))
        return [
            *self._paragraphs((title,)),
            *question,
            self._verdict(lesson),
            *figures,
            *explanation,
            buttons,
        ]

    def _show_counts(self) -> None:
        """Open the counts, and scroll to the question."""
        self._open_counts()
        question = self.view.objects.index(self._choices.view) - 1
        self.view.scroll_to(question)

    def _verdict(self, lesson: Lesson) -> pmui.Alert:
        """The prediction, the right choice and its reason."""
        prediction = self._state.prediction
        right = lesson.choices[lesson.right]
        text = f"{right}. {lesson.why}"
        if prediction in (None, WITHOUT):
            severity = "info"
        elif prediction == lesson.right:
            severity = "success"
            text = f"Right: {text}"
        else:
            severity = "warning"
            chosen = lesson.choices[prediction]
            text = f"You chose “{chosen}”. Right is “{right}”. {lesson.why}"
        return pmui.Alert(
            object=text, severity=severity, margin=(4, 0), sizing_mode="stretch_width"
        )

    def _onward(self, lesson: Lesson) -> list[Any]:
        """Buttons of the handout and, unless a leader decides, of the next lesson."""
        make = partial(handout, self._state, lesson, self._curve)
        on_paper = download("Handout", f"{lesson.name}.html", make, size="small")
        following = dict(pairwise(LESSONS)).get(lesson.name)
        if following is None or self._follows:
            return [on_paper]
        begin = partial(self.open, "lesson", following)
        return [text_button("Next lesson", begin), on_paper]

    def _paragraphs(self, paragraphs: tuple[str, ...]) -> list[Any]:
        """Panes of text, with controls of the named settings."""
        panes = []
        for paragraph in paragraphs:
            # Texts and names of settings in turn.
            for number, part in enumerate(parts_of(paragraph)):
                if not part:
                    continue
                if number % 2 == 0:
                    panes.append(self._filled(part))
                else:
                    panes += self._control(part)
        return panes

    def _filled(self, part: str) -> pn.pane.Markdown:
        """A pane of text with quantities of the frame."""
        return self._markdown(lambda: filled(part, self._state.frame))

    def _markdown(self, text: Callable[[], str]) -> pn.pane.Markdown:
        """A pane of text that follows the frame."""
        look = {"margin": 0, "sizing_mode": "stretch_width", **looks("paragraph")}
        pane = pn.pane.Markdown(text(), **look)
        self._texts.append((pane, text))
        return pane

    def _control(self, name: str) -> list[Any]:
        """The parts of the control of a setting, one below the other."""
        control = SettingControl(name, self._state)
        self._controls.append(control)
        return control.views

    def _follow_settings(self) -> None:
        """Leave the lesson or case for another scene; show settings in its controls."""
        state = self._state
        shown = LESSONS.get(state.lesson) or CASES.get(state.case)
        if shown is not None and state.settings.scene != shown.settings.scene:
            self._end()
        for control in self._controls:
            control.update()

    def _end(self) -> None:
        """Leave the lesson or case; the run stays."""
        self._state.param.update(lesson="", case="")


def _titles(begin: Callable[[str], None]) -> pn.FlexBox:
    """The titles of all lessons by subject, as buttons."""
    columns = []
    for subject in SUBJECTS:
        title = "### The method"
        if subject == "mechanics":
            title = "### Mechanics"
        buttons = [
            text_button(
                lesson.title, partial(begin, name), **looks("choice"), variant="text"
            )
            for name, lesson in LESSONS.items()
            if lesson.subject == subject
        ]
        heading = pn.pane.Markdown(title, margin=(0, 8))
        columns.append(pn.Column(heading, *buttons, margin=0, **up_to(380)))
    return pn.FlexBox(*columns, gap="8px 32px", margin=0)


def kinds_beside(state: PageState) -> tuple[type[View], ...] | None:
    """The plots of the open lesson; None without a lesson."""
    lesson = LESSONS.get(state.lesson)
    if lesson:
        return kinds_of(lesson, is_answered=not state.is_asked)
    return None
