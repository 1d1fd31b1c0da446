"""The rules by which runs share processes, with processes and a clock that are played."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.worker import seat as seats
from app.worker.orders import Leave, Pace, Park, Run, Seek, Step, Watch
from app.worker.reports import Parked, Ready, Refused, Taken, Unrivalled, Waiting
from app.worker.roster import Roster


class Actor:
    """Stands for a worker process, and answers only when it is made to."""

    def __init__(self) -> None:
        self.orders: list[Any] = []
        self.run: Run | None = None
        self.killed = False

    def send(self, order: Any) -> None:
        assert not self.killed
        self.orders.append(order)

    def kill(self) -> None:
        self.killed = True

    def answers(self) -> Any:
        """Read the next order and give the first answer that a worker would give, or None."""
        if not self.orders:
            return None
        match self.orders.pop(0):
            case Run() as order:
                self.run = order
                return Taken(order.ticket)
            case Park(ticket=ticket, keep=keep):
                return Parked(ticket, self.run if keep else None)
            case Leave() | Pace() | Step() | Seek() | Watch():
                return None


class Stage:
    """A roster of actors under a clock that is set by hand."""

    def __init__(self, size: int) -> None:
        self.now = 0.0
        self.actors: list[Actor] = []
        self.roster = Roster(size, self._hire, lambda: self.now)

    def _hire(self) -> Any:
        self.actors.append(Actor())
        return self.actors[-1]

    def seat(self) -> seats.Seat:
        return seats.Seat(None, lambda report: None)  # type: ignore[arg-type]

    def report(self, actor: Any, report: Any) -> Any:
        found = self.roster.report(actor, report)
        self.roster.tend()
        return found

    def take(self, seat: seats.Seat) -> Any:
        """Let the process of a seat get ready and take its run."""
        assert seat.post is not None
        actor: Any = seat.post.member
        self.report(actor, Ready())
        self.report(actor, actor.answers())
        return actor

    def wait(self, seconds: float) -> None:
        self.now += seconds
        self.roster.tend()


def test_busy_process_has_fifty_milliseconds_to_take_a_new_run_and_orders_do_not_add_to_it() -> (
    None
):
    stage, ticket = Stage(1), 1
    seat = stage.seat()
    stage.roster.run(seat, Run(ticket, "bar", {}))
    stage.roster.tend()
    busy = stage.take(seat)
    for ticket in range(2, 7):
        stage.roster.run(seat, Run(ticket, "bar", {}))
        stage.wait(0.009)
    assert not busy.killed
    stage.wait(0.009)
    assert busy.killed
    assert seat.post is not None
    assert seat.post.member is not busy
    assert stage.take(seat).killed is False
    assert seat.next is not None
    assert seat.next.ticket == 6


def test_turns_without_progress_get_longer() -> None:
    stage = Stage(1)
    pair = [stage.seat(), stage.seat()]
    for seat in pair:
        stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    lengths = []
    for turn in range(6):
        seat = pair[turn % 2]
        actor, begun = stage.take(seat), stage.now
        while not actor.orders:
            stage.wait(0.01)
        lengths.append(round(stage.now - begun, 1))
        stage.report(actor, actor.answers())
    assert lengths == [0.5, 0.5, 1.0, 1.0, 2.0, 2.0]


def test_time_for_setting_up_is_not_taken_from_the_turn() -> None:
    stage = Stage(1)
    pair = [stage.seat(), stage.seat()]
    for seat in pair:
        stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    actor, begun = stage.take(pair[0]), stage.now
    stage.wait(0.4)
    assert pair[0].post is not None
    turn = pair[0].post.turn
    stage.report(actor, Unrivalled(turn))
    while not actor.orders:
        stage.wait(0.01)
    assert stage.now - begun == pytest.approx(0.9, abs=0.02)


def test_processes_that_never_start_are_not_hired_forever() -> None:
    stage = Stage(2)
    seat = stage.seat()
    stage.roster.run(seat, Run(1, "bar", {}))
    stage.roster.tend()
    fates = []
    actor: Any
    for actor in stage.actors:
        delivery = stage.roster.gone(actor)
        if delivery is not None:
            fates.append(delivery[1].again)  # type: ignore[union-attr]
            stage.roster.go_on(seat)
        stage.roster.tend()
    assert fates == [True, True, False]
    assert len(stage.actors) <= 4


MOVES = st.lists(
    st.tuples(
        st.sampled_from(["run", "seek", "close", "answer", "wait", "die", "idle", "end", "refuse"]),
        st.integers(0, 4),
        st.sampled_from([0.001, 0.06, 0.6, 40.0]),
    ),
    max_size=80,
)


@settings(derandomize=True, deadline=None, max_examples=300)
@given(moves=MOVES)
def test_whatever_happens_no_run_is_lost_and_no_more_than_size_are_at_work(
    moves: list[tuple[str, int, float]],
) -> None:
    stage = Stage(2)
    five = [stage.seat() for _ in range(5)]
    for ticket, (move, number, seconds) in enumerate(moves, start=1):
        seat = five[number]
        post = seat.post
        actors = [actor for actor in stage.actors if not actor.killed]
        actor: Any = actors[number % len(actors)] if actors else None
        if move == "run":
            stage.roster.run(seat, Run(ticket, "bar", {}))
        elif move == "seek":
            stage.roster.send(seat, Seek(seat.ticket, 1))
        elif move == "close":
            stage.roster.leave(seat)
        elif move == "wait":
            stage.now += seconds
        elif move == "die" and actor:
            actor.killed = True
            delivery = stage.roster.gone(actor)
            if delivery:
                stage.roster.go_on(delivery[0])
        elif move == "answer" and actor:
            stage.roster.report(actor, Ready())
            if (answer := actor.answers()) is not None:
                stage.roster.report(actor, answer)
        elif move == "idle" and post and post.at_work:
            stage.roster.report(post.member, Waiting(post.turn))
        elif move == "refuse" and post and post.at_work:
            stage.roster.report(post.member, Refused(post.turn, ""))
        stage.roster.tend()
        check(stage, five)
    settle(stage, five)


def check(stage: Stage, five: list[seats.Seat]) -> None:
    """Check what always holds."""
    posts = list(stage.roster._posts.values())
    waiting = list(stage.roster._queue)
    assert sum(not post.free for post in posts) <= 2
    assert len(posts) <= 3
    assert len(waiting) == len(set(waiting))
    for seat in five:
        assert (seat.post is not None) + (seat in waiting) <= 1
        assert seat.post is None or (seat.post.seat is seat and seat.post in posts)
        if seat.next is None:
            assert seat.post is None
            assert seat not in waiting


def settle(stage: Stage, five: list[seats.Seat]) -> None:
    """Let all processes answer: then every run gets its turn, and every process can be free."""
    due = {seat for seat in five if seat in stage.roster._queue}
    for _ in range(200):
        for actor in [actor for actor in stage.actors if not actor.killed]:
            stage.report(actor, Ready())
            while (answer := actor.answers()) is not None:
                stage.report(actor, answer)
        due -= {seat for seat in five if seat.post is not None and seat.post.at_work}
        stage.wait(0.6)
    assert not due
    for seat in five:
        stage.roster.leave(seat)
    for actor in [actor for actor in stage.actors if not actor.killed]:
        while actor.orders:
            stage.report(actor, actor.answers())
    assert all(post.free for post in stage.roster._posts.values())
    assert not stage.roster._queue
