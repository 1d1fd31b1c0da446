"""The tab *Proof*: what is known beside what the solver finds, with links that open the runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.components.links import Links
from app.reports.report import Report
from app.session.session import Session
from app.session.studies import proof_of
from app.views.bodies import axial
from app.views.catalogue import beside, drawn
from app.views.load import loop

EXACT = axial.VIEW, loop.VIEW
"""Views that show closed forms, and are not the first on their cards."""


class ProofReport(Report):
    """Every number that the solver is held to.

    Parameters
    ----------
    session
        Has it made.
    follow
        Opens the run of an address on the live tab.
    """

    title = "Proof"
    words = (
        "Closed forms, published numbers, and other programs on the same mesh where they are "
        "installed: each number beside what LATIN and the incremental solver find, whatever the "
        "settings of the page. A name that is a link opens that run, with what is known of it."
    )

    def __init__(self, session: Session, follow: Callable[[str], None]) -> None:
        super().__init__(session.asked.proof, session.turns.soon)
        self._session, self._follow = session, follow

    def _ask(self) -> None:
        self._job.ask("all cases", proof_of)

    def _choices(self) -> list[Any]:
        links = Links(width=0, height=0, margin=0)
        links.on_msg(lambda message: self.hear(message.data))
        return [links]

    def hear(self, address: str) -> None:
        """Open the run of a link, with the plots in which closed forms are drawn."""
        session = self._session
        self._follow(address)
        names = {view.name for view in drawn(session.wanted, session.chosen)}
        for view in EXACT:
            if view.applies(session.wanted):
                names -= {one.name for one in beside(view, session.wanted)}
                names.add(view.name)
        session.draw(names, is_named=True)
