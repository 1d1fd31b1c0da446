"""Cases of the trade on the page: a gallery of their pictures, and the open one beside its run."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn

from app.lessons.catalogue import CASES, PENDING, settings_of
from app.lessons.guide import Guide, text_button
from app.state import PageState
from app.units import number, unit_for
from app.widgets import button, looks, mask_of
from solver.definitions import about
from solver.study.cases.case import Case
from solver.study.quantities.quantity import Quantity

ANSWERS_STAY = "Decomposition", "Method", "Stop"
"""Groups of settings that leave what is known as it is."""


class CasePanel(Guide):
    """The case that a page is in, if it is in one; its dialog is the gallery."""

    kind, known = "case", CASES

    def __init__(self, state: PageState, changed: Callable[[], None]) -> None:
        super().__init__(state, "Cases of the trade", changed)
        state.param.watch(lambda event: self.show(), "case")

    def show(self) -> None:
        """Show the case that is open, or none."""
        case = CASES.get(self._state.case)
        if case is None:
            self._fill(list, [])
        else:
            self._fill(partial(self._parts, case), [case.quantity.name])

    def _list(self) -> Any:
        cards = [
            button(
                case.title,
                partial(self.open, name),
                variant="text",
                margin=0,
                sx={"&.MuiButton-root::before": mask_of(case.picture)},
                **looks("picture"),
            )
            for name, case in CASES.items()
        ]
        return pn.FlexBox(*cards, gap="4px", margin=0)

    def _number(self, case: Case) -> str:
        """What is known beside what the run finds."""
        frame, quantity, is_known = self._state.frame, case.quantity, self._is_known(case)
        found = math.nan if frame is None else frame.readings.get(quantity.name, math.nan)
        run, off = PENDING, ""
        if math.isfinite(found):
            run = _written(found, quantity)
            off = f" ({100.0 * abs(found / case.known - 1.0):.1f} % off)" if is_known else ""
        known = "known" if is_known else "known before the change"
        words = f"{known} **{_written(case.known, quantity)}**, this run **{run}**{off}"
        return f"{quantity.title}: {words}"

    def _is_known(self, case: Case) -> bool:
        """Whether what is known is of these settings, however they are solved."""
        settings = self._state.settings
        definitions, mesh = settings.definitions(), {*settings.MESH, "instants"}
        return all(
            name in mesh or about(definitions[name]).group in ANSWERS_STAY
            for name in settings.changed(settings_of(case))
        )

    def _parts(self, case: Case) -> list[Any]:
        place = f"<small>Case {list(CASES).index(case.name) + 1} of {len(CASES)}</small>"
        head = f"{place}\n\n### {case.title}\n\n**{_raised(case.question)}**"
        known = f"*{_raised(case.formula)}*. {_raised(case.how)}\n\n<small>{case.source}</small>"
        change = f"{known}\n\n#### What to change first\n\n{case.change}"
        buttons = pn.FlexBox(
            text_button("As it was", partial(self.open, case.name), variant="outlined"),
            text_button("All settings", self._end),
            margin=(8, 0),
        )
        texts = (lambda: head, partial(self._number, case), lambda: change)
        return [*map(self._markdown, texts), *map(self._control, case.controls), buttons]


def _written(value: float, quantity: Quantity) -> str:
    """A value with its unit; two that differ by a thousandth differ."""
    if quantity.is_share:
        return f"{number(100.0 * value)} %"
    return unit_for(abs(value), quantity.unit)(value, 4)


def _raised(text: str) -> str:
    """Text with powers and indices as such."""
    text = re.sub(r"\^(\d+)", r"<sup>\1</sup>", text.replace("*", "\\*"))
    return re.sub(r"_(\w+)", r"<sub>\1</sub>", text)
