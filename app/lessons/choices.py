"""The choices of a question: buttons, and the predictions of a class."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import panel as pn

from app.state import PageState, Poll
from app.templates import html
from app.widgets import button, looks
from solver.study.lessons import Lesson

WITHOUT = -1
"""Prediction that represents a wish to see the answer without predicting."""
text_button = partial(button, margin=(3, 8, 3, 0))
WIDE = {"margin": 0, "sizing_mode": "stretch_width"}
"""Look of what is as wide as the text."""


class Choices:
    """The choices of a lesson's question, or a class's counts in its answer (`view`).

    Buttons stay while predictions of others come in: a click on a button that is made
    again meanwhile is lost. `predict` takes the number of a choice, `open_counts` shows
    a class the number of predictions of each.
    """

    def __init__(
        self,
        lesson: Lesson,
        state: PageState,
        predict: Callable[[int], None],
        open_counts: Callable[[], None],
    ) -> None:
        self._lesson = lesson
        self._state = state
        self._is_asked = state.is_asked
        self._buttons = [
            text_button(
                choice,
                partial(predict, number),
                visible=self._is_asked,
                **looks("choice"),
            )
            for number, choice in enumerate(lesson.choices)
        ]
        self._bars = [pn.pane.HTML("", **WIDE) for _ in self._buttons]
        pairs = zip(self._buttons, self._bars, strict=True)
        rows = [pn.Column(choice, bar, **WIDE) for choice, bar in pairs]
        self._choices = pn.Column(*rows, **WIDE)
        self._words = pn.pane.HTML("", margin=(6, 0), sizing_mode="stretch_width")
        answer = partial(predict, WITHOUT)
        self._show_me = text_button("Show me", answer, variant="text")
        self._open = text_button("Open the counts", open_counts, variant="outlined")
        self._go_on = text_button("Go on to the answer", answer)
        self.view = pn.Column(
            self._choices,
            self._words,
            pn.FlexBox(
                self._show_me, self._open, self._go_on, margin=0, **looks("onward")
            ),
            **WIDE,
        )
        self.show()

    def show(self) -> None:
        """Show the prediction of the page, and those of a class."""
        is_asked = self._is_asked
        poll = self._state.poll
        leads = poll is not None and poll.leads
        is_open = poll is not None and bool(poll.counts)
        for number, choice in enumerate(self._buttons):
            choice.variant = "outlined"
            if number == self._state.prediction:
                choice.variant = "contained"
        # The answer below says whether the prediction was right.
        self._choices.visible = is_asked or is_open
        self._words.visible = poll is not None
        self._show_me.visible = is_asked and poll is None
        self._open.visible = leads and not is_open
        self._go_on.visible = leads and is_asked
        words = ""
        if poll is not None:
            words = f"{poll.predicted} of {poll.present} have predicted."
            if is_asked and not leads:
                words += " The answer comes with the class."
        self._words.object = words
        for number, bar in enumerate(self._bars):
            bar.object = self._bar(number, poll)

    def _bar(self, number: int, poll: Poll | None) -> str:
        """HTML bar of the share of a class with a choice; empty until counts are open.

        In the answer the choice is named above, as its button is gone.
        """
        if poll is None:
            return ""
        count = None
        if poll.counts:
            count = poll.counts[number]
        title = ""
        if not self._is_asked:
            title = self._lesson.choices[number]
        return html(
            "lessons/choices.html",
            title=title,
            is_right=number == self._lesson.right,
            count=count,
            present=poll.present,
        )
