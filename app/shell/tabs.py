"""The tabs of the page: the live run, what if, and the reports beside it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.components.panes import looks
from app.reports.report import Report
from app.reports.reports import PaperFigures, StabilityReport, StudyReport
from app.session.session import Session
from app.shell.address import TABS
from app.whatif.whatif import WhatIf

IN_HEADER = {
    "& button": {
        "color": "#fff",
        "borderColor": "rgba(255, 255, 255, 0.6)",
        "textTransform": "none",
        "whiteSpace": "nowrap",
        "padding": "3px 14px",
        "fontSize": "15px",
    },
    "& button.Mui-selected, & button.Mui-selected:hover": {
        "color": "#0b3d66",
        "backgroundColor": "#fff",
    },
}
"""White on the blue of the header, in both themes."""
BELOW = {"& button": {"textTransform": "none", "padding": "4px 0", "flex": "1 1 0"}}


class Tabs:
    """The choice between the live run, which goes on in any case, and what is beside it.

    Parameters
    ----------
    session
        Has all of it made.
    live
        The live run.
    what_if
        The tab that asks over ranges.
    changed
        Called when another one was chosen.

    Attributes
    ----------
    bar
        The choice.
    main
        What is chosen, of which nothing else is seen.
    """

    def __init__(
        self, session: Session, live: Any, what_if: WhatIf, changed: Callable[[], None]
    ) -> None:
        self._live = live
        self._changed = changed
        beside: list[WhatIf | Report] = [
            what_if,
            PaperFigures(session.figures),
            StudyReport(session),
            StabilityReport(session.stability),
        ]
        self._beside = dict(zip(TABS[1:], beside, strict=True))
        self.bar = pmui.RadioButtonGroup(
            options=list(TABS), value=TABS[0], size="small", margin=(0, 12), sx=IN_HEADER
        )
        self.bar.param.watch(self._on_choice, "value")
        self.main = pn.Column(live, *(tab.view for tab in self._beside.values()), **looks("main"))

    @property
    def shows_the_run(self) -> bool:
        """Whether the live run is looked at."""
        return bool(self._live.visible)

    @property
    def report(self) -> Report | None:
        """The report that is looked at, or None where all settings do something."""
        found = self._beside.get(self.bar.value)
        return found if isinstance(found, Report) else None

    def refresh(self) -> None:
        """Show what the sweep and the reports have come to."""
        for tab in self._beside.values():
            tab.refresh()

    def catch_up(self, *, is_news: bool) -> None:
        """Follow the sweep and the reports, and what is drawn of the one that is looked at."""
        if is_news:
            self.refresh()
        if seen := self._beside.get(self.bar.value):
            seen.put_drawn()

    def leave_the_header(self) -> None:
        """Stand above what is chosen: a phone's header has no room."""
        if self.bar not in self.main:
            self.bar.param.update(sx=BELOW, sizing_mode="stretch_width", margin=(6, 10))
            self.main.insert(0, self.bar)

    def _on_choice(self, event: Any) -> None:
        self._live.visible = event.new == TABS[0]
        for name, tab in self._beside.items():
            tab.view.visible = event.new == name
            if event.new == name:
                tab.open()
        self._changed()
