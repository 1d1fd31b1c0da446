"""An animation looks at all instants, or iterations, in turn, and then where one looked before."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from lone_link import LoneLink

from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.takeaway.takeaway import MOST_PICTURES, Saver
from app.wire.orders import Pace, Seek, Tabulate, Watch
from app.wire.reports import Facts
from solver.scenes.bar import BarSettings

Film = tuple[Saver, Session, LoneLink]


@pytest.fixture
def film() -> Iterator[Film]:
    link = LoneLink()
    with closing(
        Session(Pages(1), ReportExecutor(), BarSettings.checked({}), link.hire)
    ) as session:
        session.start()
        session.facts = Facts(iteration=5, done=5, instants=9, instant=6)
        link.orders.clear()
        yield Saver(session), session, link


def answer(film: Film, **changes: Any) -> int:
    """Show what was ordered, and give the number of the picture that is to be taken."""
    saver, session, _ = film
    values = {"iteration": 5, "done": 5, "instants": 9, "instant": 6, **changes}
    session.facts = Facts(**values)
    return int(saver.view.shot)


def test_every_instant_is_taken_once_it_is_shown(film: Film) -> None:
    saver, session, link = film
    before = session.look
    saver.hear("animate", "instants")
    assert [type(order) for order in link.orders] == [Pace, Watch]
    for number in range(9):
        assert link.orders[-1].look.phase == pytest.approx(number / 8)
        assert answer(film, instant=(number + 5) % 9) == number
        assert answer(film, instant=number) == number + 1
        saver.hear("taken")
    assert saver.view.shot == 0
    assert session.look == before
    assert session.running


def test_iterations_are_sought_from_the_first_to_the_last(film: Film) -> None:
    saver, session, link = film
    session.pause()
    saver.hear("animate", "iterations")
    sought = []
    for number in range(1, 6):
        sought.append(link.orders[-1].iteration)
        answer(film, iteration=number)
        saver.hear("taken")
    assert sought == [1, 2, 3, 4, None]
    assert isinstance(link.orders[-1], Seek)
    assert not session.running


def test_another_run_ends_it(film: Film) -> None:
    saver, session, _ = film
    saver.hear("animate", "instants")
    answer(film, instant=0)
    session.start()
    assert answer(film) == 0
    saver.hear("animate", "instants")
    assert answer(film, instant=0) == 1


def test_there_are_no_more_pictures_than_a_file_should_have(film: Film) -> None:
    saver, session, _ = film
    session.facts = Facts(iteration=5, done=5000, instants=9)
    saver.hear("animate", "iterations")
    assert saver._film is not None
    goals = saver._film.goals
    assert (len(goals), goals[0], goals[-1]) == (MOST_PICTURES, 0, 4999)


def test_tables_are_asked_of_the_worker_and_a_program_is_written_here(film: Film) -> None:
    saver, _, link = film
    saver.hear("table", "points")
    assert link.orders == [Tabulate("points", 1)]
    saver.hear("program")
    name, text, number = saver.view.file
    assert (name, number) == ("slipfront-bar.py", 2)
    compile(text, name, "exec")
