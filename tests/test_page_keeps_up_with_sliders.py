"""However fast settings change, the server does each newest one and nothing twice."""

from __future__ import annotations

from typing import Any

import panel as pn
import pytest
from clock import Clock
from lone_link import LoneLink

from app.controls.sidebar import MOMENT, Sidebar
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import HELD_STILL, Session
from app.shell.dashboard import Dashboard
from app.shell.transport import Transport
from app.wire.orders import WHOLE
from app.wire.reports import Facts, Picture
from solver.scenes.bar import BarSettings


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def link() -> LoneLink:
    return LoneLink()


@pytest.fixture
def session(clock: Clock, link: LoneLink) -> Session:
    settings = BarSettings.checked({"method": "paper", "finish": "accuracy"})
    return Session(Pages(1), ReportExecutor(), settings, link.hire, clock)


@pytest.fixture
def changed(session: Session, monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, Any]]:
    """Keep what the session is told to change."""
    found: list[tuple[str, Any]] = []
    change = session.change

    def note(name: str, value: Any, *, by_hand: bool = False) -> None:
        found.append((name, value))
        change(name, value, by_hand=by_hand)

    monkeypatch.setattr(session, "change", note)
    return found


@pytest.fixture
def sidebar(session: Session) -> Sidebar:
    return Sidebar(session, lambda name: None)


def move(sidebar: Sidebar, name: str, value: Any) -> None:
    sidebar.hear(name, value, True, 1)


def test_the_first_move_is_obeyed_at_once(sidebar: Sidebar, changed: list[Any]) -> None:
    move(sidebar, "peak", 910.0)
    assert changed == [("peak", 910.0)]


def test_of_the_moves_of_a_moment_the_newest_of_each_setting_counts(
    sidebar: Sidebar, session: Session, changed: list[Any], clock: Clock
) -> None:
    for value in (910.0, 920.0, 930.0):
        move(sidebar, "peak", value)
    for value in (9, 8):
        move(sidebar, "substructures", value)
    clock.pass_(MOMENT)
    assert changed == [("peak", 910.0), ("peak", 930.0), ("substructures", 8)]
    assert (session.wanted.peak, session.wanted.substructures) == (930.0, 8)
    assert sidebar.view.shown["peak"] == 930.0


def test_after_a_moment_without_a_move_the_next_is_obeyed_at_once_again(
    sidebar: Sidebar, changed: list[Any], clock: Clock
) -> None:
    move(sidebar, "peak", 910.0)
    move(sidebar, "peak", 920.0)
    clock.pass_(2 * MOMENT)
    move(sidebar, "peak", 930.0)
    assert changed[-1] == ("peak", 930.0)


def test_a_move_that_waits_is_made_before_the_scene_is_left(
    sidebar: Sidebar, session: Session
) -> None:
    move(sidebar, "peak", 910.0)
    move(sidebar, "peak", 920.0)
    move(sidebar, "the-scene", "strand")
    assert session.wanted.scene == "strand"
    move(sidebar, "the-scene", "bar")
    assert session.wanted.peak == 920.0


def test_reset_keeps_a_change_that_waits_for_the_first_picture(session: Session) -> None:
    session.start()
    session.change("friction", 0.5)
    assert session.settings.friction == 0.3
    session.start()
    assert session.settings.friction == session.wanted.friction == 0.5


def test_a_refused_move_is_told_and_the_others_are_made(
    sidebar: Sidebar, session: Session, clock: Clock
) -> None:
    sidebar._on_setting("peak", 910.0)
    sidebar._on_setting("friction", -1.0)
    sidebar._on_setting("substructures", 9)
    clock.pass_(MOMENT)
    assert session.wanted.substructures == 9
    assert session.refusal.startswith("Friction")


def shown(session: Session, link: LoneLink) -> None:
    """Let the worker show the run at work."""
    link.say(Picture(session.ticket, Facts(), b""))
    session.collect()


def test_a_dragged_slider_hurries_and_let_go_it_replays(
    sidebar: Sidebar, session: Session, link: LoneLink, clock: Clock
) -> None:
    session.start()
    shown(session, link)
    move(sidebar, "peak", 910.0)
    assert (link.orders[-1].follows_hand, link.orders[-1].pace) == (True, None)
    assert link.orders[-1].settings.finish == "at-once"
    move(sidebar, "peak", 920.0)
    clock.pass_(MOMENT)
    assert link.orders[-1].settings.peak == 910.0
    shown(session, link)
    assert (link.orders[-1].settings.peak, link.orders[-1].follows_hand) == (920.0, True)
    move(sidebar, "peak", None)
    shown(session, link)
    last = link.orders[-1]
    assert (last.settings.peak, last.follows_hand, last.pace) == (920.0, False, WHOLE)
    assert last.settings.finish == "accuracy"
    assert last.label == "peak 920 N"
    count = len(link.orders)
    shown(session, link)
    session.let_go()
    assert len(link.orders) == count


def test_a_slider_that_stands_still_is_replayed_in_the_scale_that_there_is_until_it_is_let_go(
    session: Session, link: LoneLink, clock: Clock
) -> None:
    session.start()
    shown(session, link)
    session.change("peak", 910.0, by_hand=True)
    shown(session, link)
    clock.pass_(0.9 * HELD_STILL)
    assert link.orders[-1].follows_hand
    clock.pass_(0.1 * HELD_STILL)
    assert not link.orders[-1].follows_hand
    assert link.orders[-1].settings.peak == 910.0
    assert session.look.is_held
    session.let_go()
    assert not session.look.is_held


def test_a_page_at_rest_has_nothing_to_do(session: Session, link: LoneLink, clock: Clock) -> None:
    pn.extension(notifications=True)
    dashboard = Dashboard(session)
    dashboard.loaded()
    link.say(Picture(session.ticket, Facts(is_over=True), b""))
    clock.pass_(0.0)
    assert session.is_over
    dashboard._delivery._on_painted(1)
    assert clock.is_idle
    dashboard._sidebar._on_setting("peak", 910.0)
    clock.pass_(2 * MOMENT)
    assert clock.is_idle


def test_an_instant_is_chosen_also_before_a_run_has_a_picture(session: Session) -> None:
    transport = Transport(session)
    session.start()
    assert session.facts is None
    transport.choose_time(0.25 * session.settings.duration)
    assert session.look.phase == 0.25
    last = session.settings.instants - 1
    transport._choose_instant(last)
    assert session.look.phase == 1.0
    transport.move_instant(-1)
    assert session.look.phase == (last - 1) / last
