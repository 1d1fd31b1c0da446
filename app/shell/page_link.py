"""The link that comes back to what stands on the page: kept in its address, and copied."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import panel as pn

from app.components.pulse import Pulse
from app.session.classroom import Room
from app.session.session import Session
from app.session.state import PACES
from app.shell.address import (
    Sight,
    left_out,
    query_of,
    settings_from_query,
    sight_from_query,
    twin_from_query,
)
from app.whatif.question import Question
from app.wire.reports import Facts
from solver.definitions import about
from solver.settings import Settings

WATCHED = (
    *("wanted", "twin", "look", "pace", "facts", "running", "room"),
    *("tab", "view", "chosen", "lesson", "question"),
)
Standing = tuple[Settings, Sight, Room | None, Settings | None, Question | None]
COPIED = "Copied: the link to what stands here."
WITHOUT = "It leaves out what is too long for a link: {}. Save settings gives a file that has all."
REFUSED = "Not copied, as the browser does not let the page: take the link from the address bar."


class PageLink:
    """What the address of a page has to say.

    Parameters
    ----------
    session
        Of the page.
    pulse
        Is told the address, and whether it is to be copied.
    lang
        The language that the address asked for.
    """

    def __init__(self, session: Session, pulse: Pulse, lang: str = "") -> None:
        self._session, self._pulse, self._lang = session, pulse, lang
        self._stood: Standing | None = None
        self._is_back = False
        pulse.param.watch(lambda event: self._tell(is_done=event.new > 0), "copied")
        session.param.watch(lambda *events: self.follow(), list(WATCHED))
        self.follow()

    @contextmanager
    def going_back(self) -> Iterator[None]:
        """Have no tab be one to come back from that is not chosen: the first, or one of before."""
        self._is_back = True
        try:
            with self._session.together():
                yield
        finally:
            self._is_back = False

    def follow(self) -> None:
        """Have the address say where the page stands; another tab is one to come back from."""
        stands, stood = self._stands(), self._stood
        if stands == stood:
            return
        is_new = stood is not None and stands[1].tab != stood[1].tab and not self._is_back
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
        session.tab = sight.tab
        return sight.lesson

    def copy(self) -> None:
        """Copy the link; the page says so once it is done."""
        self._pulse.copy += 1

    def _tell(self, *, is_done: bool) -> None:
        if (notes := pn.state.notifications) is None:
            return
        wanted, say = self._session.wanted, self._session.say
        names = left_out(wanted, self._session.twin)
        if not is_done:
            notes.error(say(REFUSED), duration=8000)
        elif names:
            titles = ", ".join(say(about(wanted.definitions()[name]).title) for name in names)
            notes.warning(f"{say(COPIED)} {say(WITHOUT).format(titles)}", duration=8000)
        else:
            notes.success(say(COPIED), duration=3000)

    def _stands(self) -> Standing:
        session, lesson = self._session, self._session.lesson
        sight = Sight(
            tab=session.tab,
            instant=Sight.instant if session.opens else round(session.look.phase, 4),
            pace=next(name for name, pace in PACES.items() if pace == session.pace),
            lesson=lesson.name if lesson else "",
            iteration=waits_at(session.facts, goes_on=session.goes_on),
            view=session.view,
            units=session.look.units,
            plots="" if lesson else session.plots,
            lang=self._lang,
        )
        return session.wanted, sight, session.room, session.twin, session.question


def waits_at(facts: Facts | None, *, goes_on: bool) -> int:
    """Give the iteration that is looked at, or 0 where the run is followed, or at its end."""
    if facts is None or facts.is_broken:
        return 0
    is_last = facts.iteration == facts.done
    return 0 if is_last and (goes_on or facts.is_over) else facts.iteration
