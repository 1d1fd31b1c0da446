"""The page on a phone: the run and its plots, with all controls in a sheet below them."""

from __future__ import annotations

from typing import Any, ClassVar

import param

from app.components.innards import Plain
from app.components.panes import column, script
from app.shell.tabs import Tabs

ROOM = {"height": "100dvh", "& .main-content": {"paddingBottom": "50dvh"}}
"""Bars of a browser take nothing away, and the last plot can be seen above the open sheet."""
STYLE = """
button { width: 100%; height: 44px; font: inherit; color: inherit; cursor: pointer;
  background: transparent; border: 0; }
button::after { content: " ▴" / ""; }
button[aria-expanded=true]::after { content: " ▾" / ""; }
:host(.whole) button { height: 32px; }
:host(.whole) button::after { content: " ▾" / ""; }
:host(.whole) button[aria-expanded=true]::after { content: " ▴" / ""; }
"""


class Fold(Plain):
    """A button that shows all of what stands behind it, or folds it again.

    Attributes
    ----------
    label
        What it says.
    keeps
        Class of what has to stay in sight above what is unfolded, or empty.
    """

    label = param.String()
    keeps = param.String()

    _esm = script("within.js", "shell/fold.js")
    _stylesheets: ClassVar[list[str]] = [STYLE]


class Phone:
    """What changes on a page that a phone shows.

    Parameters
    ----------
    page, tabs
        The page, and its choice of tabs.
    live, figures
        The live run, and its key figures, which fold to a line.
    controls
        What goes into the sheet.
    """

    def __init__(self, page: Any, tabs: Tabs, live: Any, figures: Any, controls: list[Any]) -> None:
        self._page, self._tabs, self._live = page, tabs, live
        self._figures, self._controls = figures, controls
        self._sheet: Any = None

    def fit(self) -> None:
        """Have the page fit a phone from now on."""
        if self._sheet is not None:
            return
        self._page.param.update(
            header=[], sidebar=[], sidebar_open=False, sidebar_variant="temporary"
        )
        self._tabs.leave_the_header()
        whole = Fold(label="All", css_classes=["whole"], width=64)
        folding = column(whole, self._figures, role="folding")
        stays = [part for part in self._live if part not in self._controls]
        self._live[:] = [folding if part is self._figures else part for part in stays]
        controls = column(*self._controls, role="controls")
        handle = Fold(label="Controls", keeps="card", sizing_mode="stretch_width")
        self._sheet = column(handle, controls, role="sheet")
        self._tabs.main.append(self._sheet)
        self.dress(is_bare=False)

    def dress(self, *, is_bare: bool) -> None:
        """Leave the sheet away where nothing stands around plots."""
        if self._sheet is not None:
            self._sheet.visible = not is_bare
            if not is_bare:
                self._page.sx = ROOM
