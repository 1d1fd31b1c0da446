"""A lesson on paper: a question with space to write; overleaf answer and plots."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from bokeh.embed import file_html
from bokeh.resources import INLINE
from markdown_it import MarkdownIt

from app.charts import library
from app.lessons.catalogue import filled, kinds_of, without_controls
from app.lessons.curve import DrawnCurve
from app.server import address_for_others
from app.state import PageState
from app.templates import TEMPLATES
from app.views.scene import Scene
from app.views.view import View
from solver.study.lessons import Lesson

WIDTH = 660
HEIGHT = 230
"""Size of the picture, px; two plots stand side by side in its width."""


def handout(state: PageState, lesson: Lesson, curve: DrawnCurve | None) -> str:
    """HTML of a page to print, of the shown frame; needs no network.

    `curve` was drawn by hand, in a lesson that asks for a curve.
    """
    address = address_for_others()
    if address:
        address += f"?lesson={lesson.name}"
    picture = _drawn(Scene(state), state, lesson, WIDTH)
    kinds = [
        kind
        for kind in kinds_of(lesson, is_answered=True)
        if kind.applies(state.settings)
    ]
    figures = {"picture": picture}
    for kind in kinds:
        figures[kind.name] = _drawn(kind(state), state, lesson, WIDTH // 2 - 10)
    plots = [kind.name for kind in kinds]
    if curve is not None:
        blank = DrawnCurve(lesson)
        measured = DrawnCurve(lesson)
        measured.drawn.data = dict(curve.drawn.data)
        measured.reveal()
        figures |= {"blank": blank.figure, "curve": measured.figure}
        plots.insert(0, "curve")
    # The template finds figures by these names, which become parts of its HTML.
    for name, figure in figures.items():
        figure.name = re.sub(r"\W", "-", name)
    return file_html(
        list(figures.values()),
        INLINE,
        title=lesson.title,
        template=TEMPLATES.get_template("lessons/handout.html"),
        template_variables={
            "library": library(),
            "text": _html(lesson.text, state),
            "question": lesson.question,
            "choices": lesson.choices,
            "right": lesson.choices[lesson.right],
            "why": lesson.why,
            "explanation": _html(
                tuple(map(without_controls, lesson.explanation)), state
            ),
            "plots": [figures[name].name for name in plots],
            "has_curve": curve is not None,
            "address": address,
        },
        suppress_callback_warning=True,
    )


def _drawn(view: View, state: PageState, lesson: Lesson, width: int) -> Any:
    """A new figure of a view, for paper."""
    figure = view.figure
    figure.update(sizing_mode=None, width=width, height=HEIGHT, toolbar_location=None)
    # Nobody tells the size of a figure on paper: a round arch would not be round.
    view.lay_out(width, HEIGHT)
    if state.frame is not None:
        selection = replace(
            state.selection, phase=lesson.instant, interface=lesson.interface
        )
        view.update(state.frame, selection, None)
    return figure


def _html(paragraphs: tuple[str, ...], state: PageState) -> str:
    texts = (filled(text, state.frame) for text in paragraphs)
    return str(MarkdownIt("commonmark", {"html": True}).render("\n\n".join(texts)))
