"""What one takes away from the page: pictures, tables, a program, an animation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

import param

from app.components.form import STYLE
from app.components.innards import Plain
from app.components.menu import STYLE as MENU
from app.components.panes import script
from app.picture.shown import thinned
from app.session.session import Session
from app.takeaway.snippet import snippet
from app.views.drawing.drawing import View
from app.wire.orders import Tabulate
from app.wire.reports import Facts
from app.worker.painter import TAKE_AWAY
from app.worker.tables import TABLES
from solver.study.other_programs.fclib import can_write

MOST_PICTURES = 60
"""Of an animation."""


class TakeAway(Plain):
    """Buttons that save what is seen; pictures are made in the browser, tables by the worker.

    Messages from the browser are `{kind, value}`: a "table" by its name, the "program", to
    "animate" over "instants" or "iterations", and that a picture for that is "taken".

    Attributes
    ----------
    views
        Name and slug of every view that is seen.
    tables
        What there are tables of.
    file
        Name and text to be saved, and a number that tells it from those before.
    caption
        Which run and moment is seen; pictures bring it.
    fclib
        Whether an instant can be saved for other solvers.
    shot
        Number of the picture to be taken for an animation; 0 when all of them are.
    """

    views = param.List(default=[])
    tables = param.List(default=list(TABLES))
    file = param.List(default=[])
    caption = param.String(default="")
    fclib = param.Boolean(default=False)
    shot = param.Integer(default=0)

    _esm = script(
        *("say.js", "elements.js", "menu.js", "exports.js"),
        *("takeaway/gif.js", "takeaway/takeaway.js"),
    )
    _stylesheets: ClassVar[list[str]] = [STYLE, MENU]


@dataclass
class Film:
    """An animation that is being taken.

    Attributes
    ----------
    over
        "instants" or "iterations".
    goals
        Those of which there are to be pictures, from 0.
    ticket
        Of the run.
    phase, iteration, goes_on
        Where one looked before, and whether the run went on.
    """

    over: str
    goals: list[int]
    ticket: int
    phase: float
    iteration: int
    goes_on: bool
    taken: int = 0


class Saver:
    """Gives what the user wants to take away.

    Parameters
    ----------
    session
        What is taken away.

    Attributes
    ----------
    view
        What stands on the page.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._count = 0
        self._film: Film | None = None
        self.view = TakeAway(name=TAKE_AWAY, fclib=can_write(), margin=0)
        self.view.on_msg(lambda message: self.hear(**message.data))
        session.param.watch(lambda *events: self._follow(), ["facts", "ticket"])

    def offer(self, views: Iterable[View]) -> None:
        """Offer pictures of these views."""
        self.view.views = [[view.name, view.slug] for view in views]

    def hear(self, kind: str, value: str = "") -> None:
        """Follow what the user does."""
        session, facts = self._session, self._session.facts
        self._count += 1
        if kind == "table":
            session.worker.send(Tabulate(value, self._count))
        elif kind == "program":
            text = snippet(session.settings, was_warm=facts is not None and facts.was_warm)
            self.view.file = [f"slipfront-{session.settings.scene}.py", text, self._count]
        elif kind == "animate" and facts is not None and self._film is None:
            self._begin(value, facts)
        elif kind == "taken" and self._film is not None:
            self._film.taken += 1
            self._go_on(self._film)

    def _follow(self) -> None:
        """Have a picture taken where the page shows what an animation waits for."""
        film, facts = self._film, self._session.facts
        if film is None:
            return
        if film.ticket != self._session.ticket:
            self._end(film)
        elif facts is not None:
            at = facts.instant if film.over == "instants" else facts.iteration - 1
            if at == film.goals[film.taken]:
                self.view.shot = film.taken + 1

    def _begin(self, over: str, facts: Facts) -> None:
        session = self._session
        goals = thinned(facts.instants if over == "instants" else facts.done, MOST_PICTURES)
        self._film = Film(
            over,
            [int(goal) for goal in goals],
            session.ticket,
            session.look.phase,
            facts.iteration,
            session.goes_on,
        )
        if session.goes_on:
            session.pause()
        self._go_on(self._film)

    def _go_on(self, film: Film) -> None:
        """Look at what comes next."""
        facts = self._session.facts
        if film.taken == len(film.goals) or facts is None:
            self._end(film)
            return
        goal = film.goals[film.taken]
        if film.over == "instants":
            self._session.watch(phase=goal / max(facts.instants - 1, 1))
        else:
            self._session.seek(goal + 1)
        self._follow()

    def _end(self, film: Film) -> None:
        """Look where one looked before."""
        self._film, self.view.shot = None, 0
        session = self._session
        session.watch(phase=film.phase)
        if film.ticket == session.ticket:
            session.seek(film.iteration)
            if film.goes_on:
                session.go()
