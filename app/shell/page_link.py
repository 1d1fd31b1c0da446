"""The link that comes back to what stands on the page: kept in its address, and copied."""

from __future__ import annotations

from typing import Any

import panel as pn

from app.components.pulse import Pulse
from app.controls.sidebar import Sidebar
from app.session.classroom import Room
from app.session.session import Session
from app.shell.address import (
    PACES,
    Sight,
    left_out,
    query_of,
    settings_from_query,
    sight_from_query,
    twin_from_query,
)
from app.shell.stage import Stage
from app.teaching.teaching import Teaching
from app.whatif.question import Question
from app.whatif.whatif import WhatIf
from app.wire.reports import Facts
from solver.definitions import about
from solver.settings import Settings

Standing = tuple[Settings, Sight, Room | None, Settings | None, Question | None]
COPIED = "Copied: the link to what stands here."
WITHOUT = "It leaves out what is too long for a link: {}. Save gives a file that has all."
REFUSED = "Not copied, as the browser does not let the page: take the link from the address bar."


class PageLink:
    """What the address of a page has to say.

    Parameters
    ----------
    session
        Of the page.
    pulse
        Is told the address, and whether it is to be copied.
    tab
        The choice of tabs.
    sidebar
        Knows the views that are wanted.
    teaching
        Knows its lesson.
    stage
        Knows how much stands around the plots.
    what_if
        Knows what is asked over ranges.
    """

    def __init__(
        self,
        session: Session,
        pulse: Pulse,
        tab: Any,
        sidebar: Sidebar,
        teaching: Teaching,
        stage: Stage,
        what_if: WhatIf,
    ) -> None:
        self._session, self._pulse, self._stage = session, pulse, stage
        self._tab, self._sidebar, self._teaching, self._what_if = tab, sidebar, teaching, what_if
        self._stood: Standing | None = None
        pulse.param.watch(lambda event: self._tell(is_done=event.new > 0), "copied")

    def follow(self, *, replaces: bool = False) -> None:
        """Have the address say where the page stands; another tab is one to come back from.

        One that was not chosen, but is where the page begins or has come back to, `replaces`.
        """
        stands, stood = self._stands(), self._stood
        if stands == stood:
            return
        is_new = stood is not None and stands[1].tab != stood[1].tab and not replaces
        entries = self._pulse.entries + is_new
        self._stood = stands
        self._pulse.param.update(query=query_of(*stands), entries=entries)

    def restore(self, query: str) -> str:
        """Give the session what an address says; give the name of its lesson."""
        session, wanted = self._session, self._session.wanted
        settings, _ = settings_from_query(query)
        if settings.scene == wanted.scene:
            # What an address has no room for is as it is.
            kept = {name: getattr(wanted, name) for name in left_out(wanted)}
            settings = settings.replace(**kept)
        twin, _ = twin_from_query(query, settings)
        sight, _ = sight_from_query(query)
        if (twin and twin.values()) != (session.twin and session.twin.values()):
            session.twin = twin
            session.start(settings)
        else:
            session.adopt(settings)
        session.watch(phase=sight.instant)
        return sight.lesson

    def copy(self) -> None:
        """Copy the link; the page says so once it is done."""
        self.follow()
        self._pulse.copy += 1

    def _tell(self, *, is_done: bool) -> None:
        if (notes := pn.state.notifications) is None:
            return
        wanted = self._session.wanted
        names = left_out(wanted, self._session.twin)
        if not is_done:
            notes.error(REFUSED, duration=8000)
        elif names:
            titles = ", ".join(about(wanted.definitions()[name]).title for name in names)
            notes.warning(f"{COPIED} {WITHOUT.format(titles)}", duration=8000)
        else:
            notes.success(COPIED, duration=3000)

    def _stands(self) -> Standing:
        session = self._session
        sight = Sight(
            tab=self._tab.value,
            instant=round(session.look.phase, 4),
            pace=next(name for name, pace in PACES.items() if pace == session.pace),
            lesson=self._teaching.name,
            iteration=waits_at(session.facts, goes_on=session.goes_on),
            view=self._stage.view,
            plots="" if self._teaching.name else self._sidebar.plots,
        )
        room, question = session.attendance.follows, self._what_if.question
        return session.wanted, sight, room, session.twin, question


def waits_at(facts: Facts | None, *, goes_on: bool) -> int:
    """Give the iteration that is looked at, or 0 where the run is followed, or at its end."""
    if facts is None or facts.is_broken:
        return 0
    is_last = facts.iteration == facts.done
    return 0 if is_last and (goes_on or facts.is_over) else facts.iteration
