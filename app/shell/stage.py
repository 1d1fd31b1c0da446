"""How much of the page stands around its plots: all, what a projector needs, or nothing."""

from __future__ import annotations

from typing import Any

from app.components.lens import Lens
from app.components.panes import HEADER
from app.session.session import Session
from app.session.state import VIEWS
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
    session
        Has the view that is chosen.
    page, live, plots
        All of it, the run, and its plots.

    Attributes
    ----------
    lens
        What follows the pointer over plots.
    """

    def __init__(self, session: Session, page: Any, live: Any, plots: Gallery) -> None:
        self._session = session
        self._page = page
        self._plots = plots
        self._was_open = True
        self.lens = Lens()
        live.append(self.lens)
        session.param.watch(self._show, "view")

    @property
    def is_bare(self) -> bool:
        """Whether there is nothing but the run, and of it a row of plots."""
        return bool(self._session.view != PAGE)

    def toggle(self) -> None:
        """Show the page as a projector needs it, or as usual again."""
        self._session.view = PAGE if self.is_bare else PRESENT

    def magnify(self, *, has_lesson: bool) -> None:
        """Give plots the type that the view and their size ask for."""
        share = BESIDE_A_LESSON if has_lesson else 1.0
        self._plots.magnified = max(MAGNIFIED.get(self._session.view, 1.0) * share, 1.0)

    def _show(self, event: Any) -> None:
        """Show the page so."""
        if event.old == PAGE:
            self._was_open = self._page.sidebar_open
        self._page.param.update(
            sx=ALONE if self.is_bare else HEADER,
            sidebar_open=self._was_open and not self.is_bare,
        )
