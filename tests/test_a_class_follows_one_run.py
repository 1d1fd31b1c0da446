"""One page leads a class, and all that join see its pictures, which are computed once."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace

import panel as pn
import pytest
from clock import Clock
from lone_link import LoneLink, lone_session
from shown_pages import ALL, SMALL, Shown
from unpacking import unpack

from app.lessons.lesson import LESSONS, NO_CHOICE
from app.picture.units import BY_SIZE, SI
from app.session.classroom import ROOMS, Room, Rooms, Seat
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.shell import banner
from app.shell.address import class_from_query, query_of
from app.shell.dashboard import Dashboard
from app.teaching.teaching import CHOICE
from app.wire.orders import Ready, Run, Watch
from app.wire.reports import Facts, Picture, Report
from solver.scenes.bar import BarSettings

BAR = BarSettings.checked({})
STEEPER = BAR.replace(friction=0.5)


def picture(number: int) -> Picture:
    return Picture(1, Facts(iteration=number, done=number), bytes([number]))


class Follower:
    """A page that follows, and what it was given."""

    def __init__(self, room: Room) -> None:
        self.given: list[Report] = []
        self.seat = room.seat(self.given.append)
        self.seat.send(Run(7, BAR))

    def paint(self) -> None:
        self.seat.send(Ready())


def test_a_follower_gets_the_newest_picture_as_soon_as_it_has_painted() -> None:
    room = Room("ABCD", BAR)
    quick, slow = Follower(room), Follower(room)
    slow.paint()
    for number in (1, 2, 3):
        quick.paint()
        room.show(BAR, (), picture(number))
    assert [one.block for one in quick.given] == [b"\1", b"\2", b"\3"]
    assert [one.block for one in slow.given] == [b"\1"]
    slow.paint()
    assert slow.given[-1] == Picture(7, picture(3).facts, b"\3")
    slow.paint()
    assert len(slow.given) == 2


def test_one_who_comes_late_or_has_lost_a_picture_gets_the_last_again() -> None:
    room = Room("ABCD", BAR)
    room.show(BAR, (), picture(1))
    late = Follower(room)
    late.paint()
    assert [one.block for one in late.given] == [b"\1"]
    late.seat.send(Ready(afresh=True))
    assert [one.block for one in late.given] == [b"\1", b"\1"]


def test_a_run_that_begins_after_its_picture_came_is_given_that_again() -> None:
    room = Room("ABCD", BAR)
    follower = Follower(room)
    follower.paint()
    room.show(STEEPER, (), picture(1))
    # Who leads has paused: no other picture comes.
    follower.seat.send(Run(8, STEEPER))
    follower.paint()
    assert follower.given[-1] == Picture(8, picture(1).facts, b"\1")


def test_who_leaves_is_given_nothing_more() -> None:
    room = Room("ABCD", BAR)
    one = Follower(room)
    assert room.present == 1
    one.paint()
    one.seat.close()
    room.show(BAR, (), picture(1))
    assert room.present == 0
    assert one.given == []


def test_codes_differ_and_are_found_however_they_are_written_until_the_class_ends() -> None:
    rooms = Rooms()
    opened = [rooms.open(BAR) for _ in range(200)]
    assert len({room.code for room in opened}) == 200
    first = opened[0]
    assert rooms.find(f" {first.code.lower()} ") is first
    rooms.end(first)
    assert first.is_over
    assert rooms.find(first.code) is None


@pytest.fixture
def pages() -> Iterator[tuple[Session, LoneLink, Session, LoneLink]]:
    """Give a page that leads and one that follows, with what would be their processes."""
    links = LoneLink(), LoneLink()
    both = Pages(2)
    leader, follower = (Session(both, ReportExecutor(), BAR, link.hire) for link in links)
    leader.start()
    leader.attendance.lead(leader.settings)
    room = leader.attendance.leads
    assert room is not None
    follower.attendance.follow(room)
    follower.start(room.settings)
    yield leader, links[0], follower, links[1]
    leader.attendance.end()
    for session in (leader, follower):
        session.close()
    room.end()
    assert ROOMS.find(room.code) is None


Two = tuple[Session, LoneLink, Session, LoneLink]


def test_a_follower_hires_no_process_and_shows_what_the_leader_shows(pages: Two) -> None:
    leader, link, follower, idle = pages
    follower.ask()
    leader.ask()
    assert link.orders[-1] == Ready(whole=True)
    link.say(picture(4))
    assert leader.collect() == [b"\4"]
    assert follower.collect() == [b"\4"]
    assert follower.facts == picture(4).facts
    assert idle.hired == 0
    assert not follower.worker.has_process


def test_a_follower_has_its_own_units_and_language(pages: Two) -> None:
    leader, link, follower, _ = pages
    own = (SI, "de")
    follower.watch(units=SI, language="de")
    leader.attendance.note()
    assert link.orders[-1] == Watch(leader.look)
    assert leader.look.others == (own,)
    assert (leader.look.units, leader.look.language) == (BY_SIZE, "en")
    follower.ask()
    link.say(replace(picture(4), others={own: b"vier"}))
    assert leader.collect() == [b"\4"]
    assert follower.collect() == [b"vier"]
    # Until the leader's page has painted again, there is the picture in its own words.
    follower.watch(language="fr")
    follower.ask()
    assert follower.collect() == [b"\4"]
    follower.start(STEEPER)
    follower.attendance.note()
    leader.attendance.note()
    assert (leader.look.others, follower.look.language) == ((), "fr")


def test_a_picture_is_told_once_more_in_what_each_of_a_class_has_chosen() -> None:
    own = (SI, "de")
    look = replace(ALL, others=(own, ALL.manner))
    page, alone = Shown(look), Shown(ALL.told_in(own))
    for one in (page, alone):
        one.run(1, "bar", SMALL["bar"])
    told, words = page.pictures[-1], alone.page
    assert list(told.others) == [own], "who has what the leader has gets the leader's"
    german = unpack(told.others[own])
    for name, attributes in words.items():
        if name.endswith((".title", "-axis", ".words", "color-bar")):
            assert json.dumps(german[name], default=str) == json.dumps(attributes, default=str)
    assert "Last" in german["load-path.title"]["text"]
    assert "kN" not in german["figures"]["text"]
    assert german["status"]["text"] != page.page["status"]["text"]
    page.obey(Watch(replace(look, phase=0.5)))
    assert german.keys() == unpack(page.pictures[-1].others[own]).keys(), "it is whole"


def test_a_follower_that_changes_a_setting_goes_on_alone_and_can_come_back(pages: Two) -> None:
    leader, link, follower, own = pages
    follower.ask()
    link.say(picture(4))
    leader.collect()
    follower.collect()
    follower.change("friction", 0.4)
    assert follower.attendance.follows is None
    assert own.hired == 1
    room = follower.attendance.left
    assert room is not None
    assert room.present == 0
    follower.attendance.follow(room)
    follower.start(room.settings)
    follower.ask()
    assert set(follower.collect()) == {b"\4"}
    assert own.is_closed


def test_a_reset_of_the_leader_does_not_send_followers_away(pages: Two) -> None:
    _, _, follower, _ = pages
    follower.start()
    assert follower.attendance.follows is not None


def test_the_address_of_a_follower_names_its_class_alone(pages: Two) -> None:
    leader, _, follower, _ = pages
    room = follower.attendance.follows
    assert room is not None
    query = query_of(STEEPER, None, room)
    assert query == f"?class={room.code}"
    assert class_from_query(query) == (room, "")
    leader.attendance.end()
    assert class_from_query(query) == (None, room.code)
    assert class_from_query("?class=") == class_from_query("?scene=bar") == (None, "")


def test_a_class_waits_some_minutes_for_its_leader_who_leads_on_by_its_key(
    pages: Two, monkeypatch: pytest.MonkeyPatch
) -> None:
    leader, *_ = pages
    room, ticket = leader.attendance.leads, leader.attendance.ticket
    assert room is not None
    code, _, key = ticket.partition(" ")
    assert (code, room.is_alone) == (room.code, False)
    leader.close()
    assert room.is_alone
    assert ROOMS.find(code) is room
    again = lone_session(BAR)
    for wrong in ("", code, f"{code} {key[:-1]}", f"{code} é"):
        assert not again.attendance.resume(wrong)
    assert again.attendance.resume(ticket)
    assert (again.attendance.leads, room.is_alone, room.present) == (room, False, 1)
    leader.close()
    assert again.attendance.leads is room, "the page from before ends nothing"
    again.close()
    monkeypatch.setattr("app.session.classroom.KEPT", -1.0)
    assert room.is_over
    assert ROOMS.find(code) is None
    assert not again.attendance.resume(ticket)


def test_a_page_whose_class_was_taken_over_leads_no_more(pages: Two) -> None:
    leader, link, follower, _ = pages
    room, ticket = leader.attendance.leads, leader.attendance.ticket
    other = lone_session(BAR)
    other.attendance.resume(ticket)
    assert (leader.attendance.leads, leader.attendance.ticket) == (None, "")
    assert other.attendance.leads is room
    follower.ask()
    link.say(picture(4))
    leader.collect()
    assert follower.collect() == []
    other.attendance.end()
    other.close()


def test_whoever_is_left_alone_with_a_question_may_see_the_answer(pages: Two) -> None:
    pn.extension(notifications=True)
    leader, _, follower, own = pages
    room = leader.attendance.leads
    assert room is not None
    room.settings = LESSONS["best-k"].settings
    room.ask("best-k", is_answered=False)
    dashboard = Dashboard(follower)
    teaching = dashboard._teaching
    follower.attendance.note()
    assert (teaching.view.lesson["follows"], teaching.view.lesson["alone"]) == (True, False)
    teaching._hear(CHOICE, 1, False, 1.0)
    assert follower.asks
    leader.close()
    follower.attendance.note()
    assert teaching.view.lesson["alone"]
    teaching._hear(CHOICE, NO_CHOICE, False, 2.0)
    assert (follower.asks, teaching.view.lesson["choice"]) == (False, 1)
    assert follower.attendance.follows is None
    assert own.hired == 1
    assert room.poll is not None
    assert room.poll.counts(3) == [0, 1, 0]


def test_a_class_at_rest_has_nothing_to_do_and_says_who_comes_and_goes() -> None:
    pn.extension(notifications=True)
    links, clocks = (LoneLink(), LoneLink()), (Clock(), Clock())
    leader, follower = (
        Session(Pages(2), ReportExecutor(), BAR, link.hire, clock)
        for link, clock in zip(links, clocks, strict=True)
    )
    pages = [Dashboard(leader)]
    pages[0].loaded()
    leader.attendance.lead(BAR)
    room = leader.attendance.leads
    assert room is not None
    follower.attendance.follow(room)
    pages.append(Dashboard(follower))
    pages[1].loaded()
    # Before any news of the class has come to it.
    assert "You follow" in pages[1]._banner._words.object

    def said() -> list[str]:
        for clock in clocks * 3:
            clock.pass_(1.0)
        assert all(clock.is_idle for clock in clocks)
        return [page._banner._words.object for page in pages]

    assert ["1 follows" in said()[0], "You follow" in said()[1]] == [True, True]
    follower.start(STEEPER)
    assert ["0 follow" in said()[0], "You have left" in said()[1]] == [True, True]
    leader.attendance.end()
    assert said() == ["", ""]


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1"])
def test_a_class_on_localhost_is_given_the_name_of_the_machine_or_told_how(
    monkeypatch: pytest.MonkeyPatch, host: str
) -> None:
    monkeypatch.setattr(banner, "_here", lambda: f"http://{host}:5006/app?scene=block#x")
    monkeypatch.setattr(banner, "names", lambda: ("lab-pc", "10.0.0.7"))
    taken: list[str] = []
    monkeypatch.setattr(banner, "accepts", taken.__contains__)
    assert banner.address_for_others() == ""
    told = banner._picture_of("ABCD")
    assert "<svg" not in told
    assert "BOKEH_ALLOW_WS_ORIGIN=lab-pc:5006" in told
    taken.append("10.0.0.7:5006")
    assert banner.address_for_others() == "http://10.0.0.7:5006/app"
    assert "http://10.0.0.7:5006/app?class=ABCD" in banner._picture_of("ABCD")
    monkeypatch.setattr(banner, "_here", lambda: "https://lab.example.org/app?scene=block")
    assert "https://lab.example.org/app?class=ABCD" in banner._picture_of("ABCD")


def test_a_poll_counts_the_last_prediction_of_everybody_and_ends_with_its_lesson() -> None:
    room = Room("ABCD", BAR)
    room.ask("best-k", is_answered=False)
    poll = room.poll
    assert poll is not None
    for voter, choice in (("one", 1), ("two", 0), ("one", 2)):
        poll.vote(voter, choice)
    assert (poll.predicted, poll.counts(4)) == (2, [1, 0, 1, 0])
    room.ask("best-k", is_answered=True)
    assert room.poll is poll
    assert poll.is_answered
    room.ask("coarse-problem", is_answered=False)
    assert room.poll is not poll
    assert room.poll is not None
    assert room.poll.predicted == 0
    room.ask("", is_answered=True)
    assert room.poll is None


def test_a_seat_stands_for_no_process() -> None:
    assert Seat(Room("ABCD", BAR), lambda report: None).pid is None
