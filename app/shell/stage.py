"""How much of the page stands around its plots: all, what a projector needs, or nothing."""

from __future__ import annotations

from typing import Any

from app.components.lens import Lens
from app.shell.address import VIEWS
from app.shell.gallery import Gallery

PAGE, PRESENT, EMBED = VIEWS
ALONE = {"& .header, & .main .MuiToolbar-root": {"display": "none"}}
MAGNIFIED = {PRESENT: 1.5}
BESIDE_A_LESSON = 0.8
"""Type of plots, and its share where they are smaller; that of words is in the style sheet."""


class Stage:
    """What shows the page in one of its views.

    Parameters
    ----------
    page, live, plots
        All of it, the run, and its plots.

    Attributes
    ----------
    view
        How it is shown now.
    lens
        What follows the pointer over plots.
    """

    def __init__(self, page: Any, live: Any, plots: Gallery) -> None:
        self._page = page
        self._plots = plots
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

    def magnify(self, *, has_lesson: bool) -> None:
        """Give plots the type that the view and their size ask for."""
        share = BESIDE_A_LESSON if has_lesson else 1.0
        self._plots.magnified = max(MAGNIFIED.get(self.view, 1.0) * share, 1.0)

    def show(self, view: str) -> None:
        """Show the page so."""
        if view == self.view:
            return
        if not self.is_bare:
            self._was_open = self._page.sidebar_open
        self.view = view
        self._page.param.update(
            sx=ALONE if self.is_bare else None,
            sidebar_open=self._was_open and not self.is_bare,
        )
