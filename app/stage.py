"""How much of the page stands around its plots: all, what a projector needs, or nothing."""

from __future__ import annotations

from typing import Any

from app.address import VIEWS
from app.lens import Lens

PAGE, PRESENT, EMBED = VIEWS
ALONE = {"& .header, & .main .MuiToolbar-root": {"display": "none"}}
MAGNIFIED = {PRESENT: 1.5}
"""Type of plots; that of words is in the style sheet."""


class Stage:
    """What shows the page in one of its views.

    Parameters
    ----------
    page, live
        All of it, and the run.

    Attributes
    ----------
    view
        How it is shown now.
    lens
        What follows the pointer over plots.
    """

    def __init__(self, page: Any, live: Any) -> None:
        self._page = page
        self._was_open = True
        self.lens = Lens()
        live.append(self.lens)
        self.view = PAGE

    @property
    def is_bare(self) -> bool:
        """Whether there is nothing but the run, and of it a row of plots."""
        return self.view != PAGE

    def toggle(self) -> None:
        """Show the page as a projector needs it, or as usual again."""
        self.show(PAGE if self.is_bare else PRESENT)

    def show(self, view: str) -> None:
        """Show the page so."""
        if view == self.view:
            return
        if not self.is_bare:
            self._was_open = self._page.sidebar_open
        self.view = view
        self.lens.magnified = MAGNIFIED.get(view, 1.0)
        self._page.param.update(
            sx=ALONE if self.is_bare else None,
            sidebar_open=self._was_open and not self.is_bare,
        )
