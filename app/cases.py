"""Cases of the trade on the page: a gallery of their pictures, and the open one beside its run."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn
import param

from app.controls import SettingControl
from app.lessons.catalogue import CASES, PENDING, plots_of, settings_of
from app.lessons.panel import PARAGRAPH
from app.state import PageState
from app.units import number, unit_for
from app.widgets import button, dialog, mask_of
from solver.definitions import about
from solver.scenes import mesh_of
from solver.study.cases.case import Case
from solver.study.quantities.quantity import Quantity

CARD = {
    "&.MuiButton-root": {
        "flexDirection": "column",
        "justifyContent": "flex-start",
        "width": "134px",
        "height": "124px",
        "padding": "6px 2px",
        "textTransform": "none",
        "lineHeight": 1.25,
    },
    "&.MuiButton-root::before": {
        "content": '""',
        "width": "96px",
        "height": "64px",
        "marginBottom": "6px",
        "flexShrink": 0,
        "backgroundColor": "currentColor",
    },
}
ANSWERS_STAY = "Decomposition", "Method", "Stop"
"""Groups of settings that leave what is known as it is."""
_button = partial(button, margin=(3, 8, 3, 0))


class CasePanel:
    """The case that a page is in, if it is in one.

    `changed` is called when another one is shown. `view` stands beside the plots, `dialog` is the
    gallery.
    """

    def __init__(self, state: PageState, changed: Callable[[], None]) -> None:
        self._state, self._changed = state, changed
        self._controls: list[SettingControl] = []
        self._numbers = _markdown("")
        self.view = pn.Column(css_classes=["lesson"], margin=(0, 8), visible=False)
        self.dialog = dialog("Cases of the trade", width_option="md")
        state.param.watch(lambda event: self.show(), "case")
        state.param.watch(lambda event: self._follow_settings(), "settings")
        state.param.watch(lambda event: self.update(), "frame")

    @property
    def case(self) -> Case | None:
        """The case that is open."""
        return CASES.get(self._state.case)

    def open(self, name: str) -> None:
        """Begin a case, with its scene and settings."""
        self.dialog.open = False
        with param.parameterized.batch_call_watchers(self._state):
            self._state.param.update(lesson="", case=name, plots=plots_of(name))
            self._state.adopt(settings_of(CASES[name]))

    def offer(self) -> None:
        """Show the gallery."""
        if not self.dialog.objects:
            cards = [
                button(
                    case.title, partial(self.open, name), variant="text", margin=0, sx=_card(case)
                )
                for name, case in CASES.items()
            ]
            self.dialog[:] = [pn.FlexBox(*cards, gap="4px", margin=0)]
        self.dialog.open = True

    def show(self) -> None:
        """Show the case that is open, or none."""
        case, self._controls = self.case, []
        if case is not None:
            self._state.readings = [case.quantity.name]
            self._controls = [SettingControl(name, self._state) for name in case.controls]
            self.view[:] = self._parts(case)
            self.update()
        elif not self._state.lesson:
            self._state.readings = []
        self.view.visible = case is not None
        self._changed()

    def update(self) -> None:
        """Bring the number of the run up to the frame."""
        case, frame = self.case, self._state.frame
        if case is None:
            return
        found = math.nan if frame is None else frame.readings.get(case.quantity.name, math.nan)
        quantity, is_known, run, off = case.quantity, self._is_known(case), PENDING, ""
        if math.isfinite(found):
            run = _written(found, quantity)
            off = f" ({100.0 * abs(found / case.known - 1.0):.1f} % off)" if is_known else ""
        known = "known" if is_known else "known before the change"
        words = f"{known} **{_written(case.known, quantity)}**, this run **{run}**{off}"
        self._numbers.object = f"{quantity.title}: {words}"

    def _is_known(self, case: Case) -> bool:
        """Whether what is known is of these settings, however they are solved."""
        settings = self._state.settings
        definitions, mesh = settings.definitions(), {*mesh_of(settings), "instants"}
        return all(
            name in mesh or about(definitions[name]).group in ANSWERS_STAY
            for name in settings.changed(settings_of(case))
        )

    def _parts(self, case: Case) -> list[Any]:
        place = f"<small>Case {list(CASES).index(case.name) + 1} of {len(CASES)}</small>"
        known = f"*{_raised(case.formula)}*. {_raised(case.how)}"
        buttons = pn.FlexBox(
            _button("As it was", partial(self.open, case.name), variant="outlined"),
            _button("All settings", self._end),
            margin=(8, 0),
        )
        return [
            _markdown(f"{place}\n\n### {case.title}\n\n**{_raised(case.question)}**"),
            self._numbers,
            _markdown(f"{known}\n\n<small>{case.source}</small>"),
            _markdown(f"#### What to change first\n\n{case.change}"),
            *(control.view for control in self._controls),
            buttons,
        ]

    def _follow_settings(self) -> None:
        """Leave a case for another scene; show its controls as settings are."""
        case = self.case
        if case is not None and self._state.settings.scene != case.settings.scene:
            self._end()
        for control in self._controls:
            control.update()

    def _end(self) -> None:
        """Leave the case; the run stays."""
        self._state.case = ""


def _card(case: Case) -> dict[str, Any]:
    """Look of a button that is a picture with its title."""
    before = "&.MuiButton-root::before"
    return CARD | {before: CARD[before] | mask_of(case.picture)}


def _markdown(text: str) -> pn.pane.Markdown:
    return pn.pane.Markdown(text, margin=0, sizing_mode="stretch_width", stylesheets=PARAGRAPH)


def _written(value: float, quantity: Quantity) -> str:
    """A value with its unit; two that differ by a thousandth differ."""
    if quantity.is_share:
        return f"{number(100.0 * value)} %"
    return unit_for(abs(value), quantity.unit)(value, 4)


def _raised(text: str) -> str:
    """Text with powers and indices as such."""
    text = re.sub(r"\^(\d+)", r"<sup>\1</sup>", text.replace("*", "\\*"))
    return re.sub(r"_(\w+)", r"<sub>\1</sub>", text)
