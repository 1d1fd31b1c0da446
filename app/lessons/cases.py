"""Cases of the trade: a gallery of pictures, and the text next to a case's run."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn

from app.lessons.catalogue import CASES, PENDING
from app.state import PageState
from app.widgets import PlainText, button, looks, mask_of
from solver.files.amounts import number, unit_for
from solver.study.quantities.quantity import Quantity
from solver.study.trade_case import Case


def gallery(begin: Callable[[str], None]) -> pn.FlexBox:
    """A gallery of cases: a button with a picture for each."""
    cards = [
        button(
            case.title,
            partial(begin, name),
            variant="text",
            margin=0,
            sx={"&.MuiButton-root::before": mask_of(case.picture)},
            **looks("picture"),
        )
        for name, case in CASES.items()
    ]
    return pn.FlexBox(*cards, gap="4px", margin=0)


def texts_of(case: Case, state: PageState) -> list[Callable[[], str]]:
    """Parts of the text of a case (Markdown), updated with each frame.

    They are its question, its known value beside that of the run, and the reason of
    that value with its source. Before the last one stands the formula.
    """
    head = f"## {case.title}\n\n**{_raised(case.question)}**"
    change = (
        f"{_raised(case.how)}\n\n<small>{case.source}</small>"
        f"\n\n### What to change first\n\n{case.change}"
    )
    return [lambda: head, lambda: _known_beside_found(case, state), lambda: change]


def formula_of(case: Case) -> Any:
    """Pane of the formula of a case: typeset, or as plain text."""
    if not case.typeset:
        plain = PlainText(margin=0)
        plain.object = case.formula
        return plain
    # KaTeX is among Panel's own files: nothing is asked from another address.
    formula = rf"$\displaystyle {case.typeset}$"
    return pn.pane.LaTeX(
        formula, renderer="katex", margin=(4, 0, 10, 0), styles={"font-size": "16px"}
    )


def _known_beside_found(case: Case, state: PageState) -> str:
    """Markdown of the known value of a quantity, and of that of the run so far."""
    frame = state.frame
    quantity = case.quantity
    is_known = case.knows(state.settings)
    found = math.nan
    if frame is not None:
        found = frame.readings.get(quantity.name, math.nan)
    run = PENDING
    off = ""
    if math.isfinite(found):
        run = _written(found, quantity)
        if is_known:
            off = f" ({_off(found / case.known)} off)"
    known = "known before the change"
    if is_known:
        known = "known"
    words = f"{known} **{_written(case.known, quantity)}**, this run **{run}**{off}"
    return f"{quantity.title}: {words}"


def _off(ratio: float) -> str:
    """Text of the deviation of a value from the known one, by their ratio."""
    distance = abs(ratio - 1.0)
    if distance > 1.0:
        return "more than 100 %"
    return f"{100.0 * distance:.1f} %"


def _written(value: float, quantity: Quantity) -> str:
    """Text of a value with its unit, with four digits; shares in per cent."""
    if quantity.is_share:
        return f"{number(100.0 * value)} %"
    return unit_for(abs(value), quantity.unit)(value, 4)


def _raised(text: str) -> str:
    """HTML of a text with superscripts and subscripts."""
    text = re.sub(r"\^(\d+)", r"<sup>\1</sup>", text.replace("*", "\\*"))
    return re.sub(r"_(\w+)", r"<sub>\1</sub>", text)
