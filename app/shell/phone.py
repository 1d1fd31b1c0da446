"""The page on a phone: the run and its plots, with all controls in a sheet below them."""

from __future__ import annotations

from typing import Any

from app.components.fold import Fold
from app.components.panes import column
from app.languages.language import Language
from app.shell.tabs import Tabs

ROOM = {"height": "100dvh", "& .main-content": {"paddingBottom": "50dvh"}}
"""Bars of a browser take nothing away, and the last plot can be seen above the open sheet."""


class Phone:
    """What changes on a page that a phone shows.

    Parameters
    ----------
    page, tabs
        The page, and its choice of tabs.
    live
        The live run.
    controls
        What goes into the sheet.
    say
        Says what stands on its handle.
    """

    def __init__(
        self, page: Any, tabs: Tabs, live: Any, controls: list[Any], say: Language
    ) -> None:
        self._page, self._tabs, self._live, self._say = page, tabs, live, say
        self._controls = controls
        self._sheet: Any = None
        self._is_bare = False

    def fit(self) -> None:
        """Have the page fit a phone from now on."""
        if self._sheet is not None:
            return
        self._page.param.update(
            header=[], sidebar=[], sidebar_open=False, sidebar_variant="temporary"
        )
        self._tabs.leave_the_header()
        self._live[:] = [part for part in self._live if part not in self._controls]
        controls = column(*self._controls, role="controls")
        handle = Fold(label=self._say("Controls"), keeps="card", sizing_mode="stretch_width")
        self._sheet = column(handle, controls, role="sheet")
        self._tabs.main.append(self._sheet)
        self.dress(is_bare=self._is_bare)

    def dress(self, *, is_bare: bool) -> None:
        """Leave the sheet and the tabs away where nothing stands around plots."""
        self._is_bare = is_bare
        if self._sheet is not None:
            self._sheet.visible = self._tabs.bar.visible = not is_bare
            if not is_bare:
                self._page.sx = ROOM
