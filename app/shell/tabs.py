"""The tabs of the page: the live run, what if, and the reports beside it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.components.panes import looks
from app.reports.proof import ProofReport
from app.reports.report import Report
from app.reports.reports import PaperFigures, StabilityReport, StudyReport
from app.session.session import Session
from app.session.state import TABS
from app.whatif.whatif import WhatIf

IN_HEADER = {
    "& button": {
        "color": "#fff",
        "borderColor": "rgba(255, 255, 255, 0.6)",
        "textTransform": "none",
        "whiteSpace": "nowrap",
        "padding": "3px 6px",
        "fontSize": "14px",
        "letterSpacing": 0,
    },
    "& button.Mui-selected, & button.Mui-selected:hover": {
        "color": "#0b3d66",
        "backgroundColor": "#fff",
    },
    "@media (max-width: 899px)": {"& button": {"padding": "3px 4px"}},
}
"""White on the blue of the header, in both themes."""
BELOW = {"& button": {"textTransform": "none", "padding": "4px 0", "flex": "1 1 0"}}


class Tabs:
    """The choice between the live run, which goes on in any case, and what is beside it.

    Parameters
    ----------
    session
        Has all of it made, and the choice.
    live
        The live run.
    what_if
        The tab that asks over ranges.
    follow
        Opens the run of an address on the live tab.

    Attributes
    ----------
    bar
        The choice.
    main
        What is chosen, of which nothing else is seen.
    """

    def __init__(
        self, session: Session, live: Any, what_if: WhatIf, follow: Callable[[str], None]
    ) -> None:
        self._session = session
        self._live = live
        beside: list[WhatIf | Report] = [
            what_if,
            PaperFigures(session.asked.figures, session.turns.soon),
            StudyReport(session),
            StabilityReport(session.asked.stability, session.turns.soon),
            ProofReport(session, follow),
        ]
        self._beside = dict(zip(TABS[1:], beside, strict=True))
        self.bar = pmui.RadioButtonGroup(
            options={session.say(tab): tab for tab in TABS},
            value=TABS[0],
            size="small",
            margin=(0, 6),
            sx=IN_HEADER,
        )
        self.bar.param.watch(lambda event: session.param.update(tab=event.new), "value")
        session.param.watch(lambda event: self._show(event.new), "tab")
        session.param.watch(lambda *events: self._refresh(), ["wanted", "reported", "tab"])
        self.main = pn.Column(live, *(tab.view for tab in self._beside.values()), **looks("main"))

    @property
    def shows_the_run(self) -> bool:
        """Whether the live run is looked at."""
        return bool(self._session.tab == TABS[0])

    @property
    def report(self) -> Report | None:
        """The report that is looked at, or None where all settings do something."""
        found = self._beside.get(self._session.tab)
        return found if isinstance(found, Report) else None

    def _refresh(self) -> None:
        """Show what the sweep and the reports have come to."""
        for tab in self._beside.values():
            tab.refresh()

    def leave_the_header(self) -> None:
        """Stand above what is chosen: a phone's header has no room."""
        if self.bar not in self.main:
            self.bar.param.update(sx=BELOW, sizing_mode="stretch_width", margin=(6, 10))
            self.main.insert(0, self.bar)

    def _show(self, chosen: str) -> None:
        self.bar.value = chosen
        self._live.visible = chosen == TABS[0]
        for name, tab in self._beside.items():
            tab.view.visible = chosen == name
            if chosen == name:
                tab.open()
