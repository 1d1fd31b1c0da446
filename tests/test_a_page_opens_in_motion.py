"""A page that is opened plays the load's cycle until the first touch, or three times."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from clock import Clock
from lone_link import lone_session

from app.components.pulse import Pulse
from app.lessons.lesson import LESSONS
from app.session.session import Session
from app.shell import opening as module
from app.shell import transport
from app.shell.address import Sight, sight_from_query
from app.shell.opening import LOOPS, Opening
from app.shell.transport import PLAYED_IN, Transport
from app.wire.reports import Facts
from solver.scenes.bar import BarSettings

OVER = Facts(iteration=3, done=3, instants=11, is_over=True)


class Page:
    """A page without a browser, whose first run has not ended yet."""

    def __init__(self, clock: Clock, *, calm: bool = False, is_still: bool = False) -> None:
        self.session: Session = lone_session(BarSettings.checked({"instants": 11}), clock)
        self.pulse, self.clock = Pulse(calm=calm), clock
        self.transport = Transport(self.session)
        self.opening = Opening(self.session, self.pulse, self.transport, is_still=is_still)

    def ends(self, facts: Facts = OVER) -> None:
        self.session.facts = facts

    def seen(self, seconds: float) -> list[float]:
        """Give the instants that are looked at, as time goes by."""
        found = []
        for _ in range(round(seconds / (PLAYED_IN / 10))):
            self.clock.pass_(PLAYED_IN / 10)
            found.append(round(self.session.look.phase, 2))
        return found


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(transport, "time", SimpleNamespace(monotonic=lambda: made.now))
    return made


def test_it_moves_once_the_run_has_ended_and_rests_after_three_cycles(clock: Clock) -> None:
    page = Page(clock)
    page.ends(Facts(iteration=2, done=2, instants=11))
    assert set(page.seen(PLAYED_IN)) == {0.75}
    page.ends()
    seen = page.seen(LOOPS * PLAYED_IN + 2.0)
    assert len(set(seen)) > 9
    assert sum(late < early for early, late in pairwise(seen)) == LOOPS
    assert seen[-1] == 0.75
    assert not page.session.opens
    page.ends()
    assert set(page.seen(PLAYED_IN)) == {0.75}


def test_the_first_touch_ends_it_for_good_at_the_instant_that_it_began_with(clock: Clock) -> None:
    page = Page(clock)
    page.ends()
    page.seen(0.4 * PLAYED_IN)
    assert page.session.look.phase != 0.75
    page.pulse.calm = True
    assert page.session.look.phase == 0.75
    assert set(page.seen(PLAYED_IN)) == {0.75}
    assert not page.session.opens


def test_who_plays_or_chooses_an_instant_has_it_so(clock: Clock) -> None:
    page = Page(clock)
    page.ends()
    page.seen(0.4 * PLAYED_IN)
    page.pulse.calm = True
    page.transport.choose_time(0.2)
    page.transport.play()
    assert page.transport._instant.playing
    assert page.seen(2 * PLAYED_IN)[-1] == 1.0


@pytest.mark.parametrize(
    "changes",
    [
        {"lesson": next(iter(LESSONS.values()))},
        {"view": "embed"},
        {"view": "present"},
        {"tab": "Study"},
    ],
)
def test_it_does_not_move_where_something_else_is_looked_at(
    clock: Clock, changes: dict[str, Any]
) -> None:
    page = Page(clock)
    page.session.param.update(**changes)
    page.ends()
    assert set(page.seen(PLAYED_IN)) == {0.75}


@pytest.mark.parametrize("how", [{"calm": True}, {"is_still": True}])
def test_it_does_not_move_where_it_is_not_to(clock: Clock, how: dict[str, bool]) -> None:
    page = Page(clock, **how)
    page.ends()
    assert set(page.seen(PLAYED_IN)) == {0.75}


def test_it_does_not_move_in_a_tab_that_nobody_sees_nor_where_pictures_take_long(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    hidden, large = Page(clock), Page(clock)
    hidden.pulse.hidden = True
    hidden.ends()
    monkeypatch.setattr(module, "LARGEST", 10)
    large.ends()
    for page in (hidden, large):
        assert set(page.seen(PLAYED_IN)) == {0.75}


@pytest.mark.parametrize(
    ("query", "is_still"),
    [("", False), ("?scene=block", False), ("?instant=0.75", True), ("?iteration=3", True)],
)
def test_an_address_may_name_a_moment(query: str, is_still: bool) -> None:
    sight, _ = sight_from_query(query)
    assert sight.is_still is is_still
    assert Sight(is_still=is_still).instant == 0.75
