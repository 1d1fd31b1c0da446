"""Pages of a class show what its leader's page shows, which is computed once."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Iterator
from contextvars import copy_context
from dataclasses import replace
from functools import partial
from typing import Any

import panel as pn
import pytest
from panel.io.state import set_curdoc

from app import classroom
from app.class_dialog import ClassDialog
from app.classroom import ClassMember, begin_with_class, find
from app.frame import Frame
from app.history import History
from app.messages import Needs, Order, Ready, Start
from app.state import PageState, default_settings
from app.worker.sampling import Sampler
from solver.scenes import discretise
from solver.study.scene_run import finished_run

LESSON = "how-fast-how-big"
Callback = Callable[[], Any]


class Document:
    """A document whose next tick comes in the context that asked, when called."""

    def __init__(self) -> None:
        self.due: list[Callback] = []

    def add_next_tick_callback(self, callback: Callback) -> None:
        self.due.append(partial(copy_context().run, callback))

    def add_timeout_callback(self, callback: Callback, milliseconds: int) -> None:
        pass


class Worker:
    """Double of a page's supervisor: its process is there or not, and its orders."""

    def __init__(self, state: PageState) -> None:
        self.state = state
        self.is_there = False
        self.orders: list[Order] = []

    def begin(self) -> None:
        self.is_there = True
        self.state.send = self.orders.append

    def end(self) -> None:
        self.is_there = False


class Seat:
    """A page of a class without a browser."""

    def __init__(self, scene: str = "bar", address: str = "") -> None:
        self.state = PageState(default_settings(scene))
        self.document = Document()
        self.worker: Any = Worker(self.state)
        self.member = ClassMember(self.state, self.worker, self.document)
        if not self.member.enter(address):
            self.worker.begin()
            self.state.run()


def tick(*seats: Seat) -> None:
    """Run all pending callbacks of all documents."""
    while any(seat.document.due for seat in seats):
        for seat in seats:
            due = seat.document.due
            seat.document.due = []
            for callback in due:
                callback()


def show(seat: Seat, frame: Frame) -> Frame:
    """Send a frame of the present run from the leader's worker."""
    shown = replace(frame, run=replace(frame.run, number=seat.state.number))
    seat.state.history = History()
    seat.state.history.add(shown)
    seat.state.param.update(newest=shown, frame=shown)
    return shown


@pytest.fixture(scope="module")
def frame() -> Frame:
    settings = default_settings("bar").replace(elements=10, instants=11)
    run = finished_run(settings)
    sampler = Sampler(discretise(settings), settings, 1)
    return sampler.frame(
        run.iterate, run.solution.records, run.solution.status, Needs()
    )


@pytest.fixture
def leader() -> Iterator[Seat]:
    seat = Seat()
    seat.member.begin()
    tick(seat)
    yield seat
    seat.member.leave()


def code_of(leader: Seat) -> str:
    assert leader.member.room is not None
    return leader.member.room.code


def test_a_follower_sees_what_the_leader_sees_and_has_no_worker(
    leader: Seat, frame: Frame
) -> None:
    follower = Seat("rope", code_of(leader))
    shown = show(leader, frame)
    leader.state.select(phase=0.3, stage="local")
    leader.state.settings = leader.state.settings.replace(peak=600.0)
    tick(leader, follower)
    assert follower.state.frame is shown
    assert follower.state.settings is leader.state.settings
    assert follower.state.selection.phase == 0.3
    assert follower.state.selection.stage == "local"
    assert not follower.worker.is_there
    assert leader.member.message == f"Class {code_of(leader)}: 1 follows."


def test_a_followers_page_is_changed_as_its_own_document(
    leader: Seat, frame: Frame
) -> None:
    follower = Seat("rope", code_of(leader))
    tick(leader, follower)
    changed: list[Any] = []
    follower.state.param.watch(lambda event: changed.append(pn.state.curdoc), "frame")
    with set_curdoc(leader.document):
        show(leader, frame)
    tick(leader, follower)
    assert changed == [follower.document]


def test_who_comes_late_has_the_present_frame_at_once(
    leader: Seat, frame: Frame
) -> None:
    shown = show(leader, frame)
    assert Seat("rope", code_of(leader).lower()).state.frame is shown


@pytest.mark.parametrize("leads_on", [True, False])
def test_a_page_is_made_with_what_its_class_shows(leader: Seat, leads_on: bool) -> None:
    leader.state.change(peak=600.0)
    leader.state.lesson = LESSON
    if leads_on:
        address = leader.state.room
    else:
        address = code_of(leader)
    made = PageState(default_settings("rope"), room=address)
    begin_with_class(made)
    assert made.settings is leader.state.settings
    assert made.lesson == LESSON
    assert made.room == address


def test_of_several_news_a_follower_takes_the_last(leader: Seat, frame: Frame) -> None:
    follower = Seat("bar", code_of(leader))
    tick(leader, follower)
    seen: list[Any] = []
    follower.state.param.watch(lambda event: seen.append(event.new), "frame")
    frames = [show(leader, replace(frame, iteration=number)) for number in (1, 2, 3)]
    assert len(follower.document.due) == 1
    tick(leader, follower)
    assert seen == [frames[-1]]


def test_whoever_changes_anything_goes_on_alone_and_may_follow_again(
    leader: Seat, frame: Frame
) -> None:
    follower = Seat("bar", code_of(leader))
    show(leader, frame)
    tick(leader, follower)
    follower.state.send(Ready())
    assert follower.member.follows
    assert follower.state.change(peak=700.0)
    assert follower.worker.is_there
    order = follower.worker.orders[-1]
    assert isinstance(order, Start)
    assert order.settings.values()["peak"] == 700.0
    assert follower.state.history is not leader.state.history
    tick(leader, follower)
    assert leader.state.settings.values()["peak"] != 700.0
    follower.member.enter(follower.member.left)
    assert follower.state.frame is leader.state.frame
    assert not follower.worker.is_there


def test_a_class_is_asked_and_sees_the_counts_and_the_answer_with_its_leader(
    leader: Seat,
) -> None:
    first, second = (Seat("bar", code_of(leader)) for _ in range(2))
    seats = leader, first, second
    leader.state.lesson = LESSON
    tick(*seats)
    assert first.state.lesson == LESSON
    first.state.prediction = 3
    first.state.prediction = 1
    second.state.prediction = 0
    tick(*seats)
    poll = leader.state.poll
    assert poll is not None
    assert (poll.leads, poll.predicted, poll.present, poll.counts) == (True, 2, 2, ())
    leader.member.open_counts()
    tick(*seats)
    assert first.state.poll is not None
    assert first.state.poll.counts == (1, 1, 0, 0)
    assert first.state.is_asked
    leader.state.prediction = 3
    tick(*seats)
    assert not any(seat.state.is_asked for seat in seats)


def test_another_lesson_counts_anew(leader: Seat) -> None:
    follower = Seat("bar", code_of(leader))
    for lesson, predicted in ((LESSON, 1), ("best-k", 0)):
        leader.state.lesson = lesson
        tick(leader, follower)
        if predicted:
            follower.state.prediction = 0
        tick(leader, follower)
        assert leader.state.poll is not None
        assert leader.state.poll.predicted == predicted


def test_the_leaders_page_loaded_again_leads_on(leader: Seat, frame: Frame) -> None:
    follower = Seat("bar", code_of(leader))
    leader.state.change(peak=600.0)
    leader.state.lesson = LESSON
    again = Seat("rope", leader.state.room)
    leader.member.close()
    assert again.member.leads
    assert again.worker.is_there
    assert again.state.settings.values()["peak"] == 600.0
    assert again.state.lesson == LESSON
    shown = show(again, frame)
    tick(again, follower)
    assert follower.state.frame is shown
    again.member.leave()


def test_a_class_waits_five_minutes_for_its_leader(
    leader: Seat, monkeypatch: pytest.MonkeyPatch
) -> None:
    follower = Seat("bar", code_of(leader))
    now = classroom.time.monotonic()
    leader.member.close()
    tick(follower)
    assert "away" in follower.member.message
    monkeypatch.setattr(classroom.time, "monotonic", lambda: now + 299.0)
    assert find(follower.state.room) is not None
    monkeypatch.setattr(classroom.time, "monotonic", lambda: now + 301.0)
    assert find(follower.state.room) is None
    follower.member.notify()
    tick(follower)
    assert "has ended" in follower.member.message


def test_a_key_that_is_wrong_does_not_lead(leader: Seat) -> None:
    other = Seat("bar", f"{code_of(leader)}.0000")
    assert not other.member.leads
    assert other.member.follows


def test_a_code_that_there_is_not_is_told_and_the_page_runs() -> None:
    seat = Seat("bar", "XXXX5")
    assert "There is no class XXXX5" in seat.state.refusal
    assert seat.worker.is_there


def test_whoever_joins_opens_the_page_of_the_class(leader: Seat) -> None:
    seat = Seat("rope")
    visited: list[str] = []
    dialog = ClassDialog(seat.member, visited.append)
    dialog.open()
    dialog._field.value = "XXXX"
    dialog._join()
    assert dialog._field.helper_text.startswith("There is no class XXXX")
    dialog._field.value = code_of(leader).lower()
    dialog._join()
    assert visited == [code_of(leader)]
    # All else is as it was: the browser leaves for the other page.
    assert seat.worker.is_there


def test_a_picture_that_moves_does_not_bring_the_poll_again(leader: Seat) -> None:
    follower = Seat("bar", code_of(leader))
    leader.state.lesson = LESSON
    tick(leader, follower)
    seen: list[Any] = []
    follower.state.param.watch(seen.append, ["poll", "lesson", "settings"])
    leader.state.select(phase=0.3)
    tick(leader, follower)
    assert follower.state.selection.phase == 0.3
    assert not seen


def test_a_class_keeps_nothing_of_its_leaders_page_but_what_followers_see(
    frame: Frame,
) -> None:
    leader = Seat()
    leader.member.begin()
    code = code_of(leader)
    follower = Seat("rope", code)
    shown = show(leader, frame)
    tick(leader, follower)
    page = weakref.ref(leader.member)
    leader.member.close()
    tick(leader, follower)
    del leader
    gc.collect()
    assert page() is None
    assert follower.state.frame is shown
    assert follower.member.message.startswith(f"The leader of class {code} is away")
    follower.member.leave()


def test_a_class_that_is_over_is_forgotten_once_a_page_is_closed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    leader = Seat()
    other = Seat()
    leader.member.begin()
    code = code_of(leader)
    leader.member.close()
    other.member.close()
    assert code in classroom.CLASSROOMS
    monkeypatch.setattr(classroom, "KEPT", -1.0)
    other.member.close()
    assert code not in classroom.CLASSROOMS
