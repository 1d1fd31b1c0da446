"""Who works at what: the pool's state machine, without threads and without a lock of its own.

A seat's run is in one of these states, told by `next`, the queue and `post`:

    empty      next is None
    queued     in the queue
    at work    has a post
    parked     none of these: it waits, and knows how to go on
    held       its process died, and the session is just being told

    empty, parked  --run-->                        queued
    at work        --run-->                        at work: its process is given the new order;
                                                   queued, if it was about to make room
    queued         --run-->                        queued, at the same place
    parked         --Pace, Step, Seek, Watch-->    queued
    queued         --a post is free-->             at work
    at work        --Parked, and it waits-->       parked
    at work        --Parked, with work left-->     queued, at the tail
    at work        --Refused-->                    empty
    at work        --no Taken in time-->           queued, at the head; the process is killed
    at work        --process gone-->               held, then queued; empty after two restarts
    any            --close-->                      empty, for good

A post is a process with what it does:

    free           no seat, nothing awaited
    at work        a seat; Taken is awaited until it has answered the Run
    making room    Parked is awaited, with the seat or, where that has gone, without

Each Run sent to a process has a turn of its own as its ticket, so that no report of an earlier
turn, of this or another seat, is taken for one of the present turn.
"""

from __future__ import annotations

import itertools
import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from app.worker.member import Member
from app.worker.orders import Park, Run
from app.worker.post import Post
from app.worker.reports import (
    Parked,
    Progress,
    Ready,
    Reference,
    Refused,
    Report,
    Taken,
    Unrivalled,
    Waiting,
)
from app.worker.seat import Change, Seat

ANSWER_BUSY = 0.05
"""Seconds in which a process at work has to answer an order that ends its run."""

ANSWER_FREE = 0.5
"""Seconds in which a process without a run has to answer; nothing slow is in its way."""

ANSWER_ROOM = 30.0
"""Seconds for making room: an iteration may be long, and killing would lose the run's work."""

Delivery = tuple[Seat, Report]
"""A report, and whose listener is to have it once the pool's lock is free."""


class Roster:
    """Seats, posts and the queue between them; whoever calls it holds the pool's lock.

    Parameters
    ----------
    size
        Runs that are at work at the same time, at most.
    hire
        Starts a process without waiting for it.
    clock
        Gives the time, s.
    """

    def __init__(
        self,
        size: int,
        hire: Callable[[], Member],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._size = size
        self._hire = hire
        self._clock = clock
        self._posts: dict[Member, Post] = {}
        self._queue: deque[Seat] = deque()
        self._turns = itertools.count(1)
        self._healthy = True

    @property
    def members(self) -> list[Member]:
        """All processes that are in use, or kept ready."""
        return list(self._posts)

    def at_work_beside(self, seat: Seat) -> int:
        """Count the posts at work at runs of other seats, and not only waiting."""
        return sum(
            post.seat is not None and post.seat is not seat and not post.idle
            for post in self._posts.values()
        )

    def run(self, seat: Seat, order: Run) -> None:
        """Take up a new run for a seat."""
        seat.begin(replace(order, previous=seat.parked) if order.warm else order)
        post = seat.post
        if post is not None and post.awaited is not Parked:
            self._put_to_work(seat, post, ANSWER_BUSY)
            return
        if post is not None:
            self._let_go(seat, post)
        if seat not in self._queue:
            self._queue.append(seat)

    def send(self, seat: Seat, change: Change) -> None:
        """Pass an order to a seat's run, or keep it until the run is at work."""
        if seat.next is None or change.ticket != seat.ticket:
            return
        seat.note(change)
        if seat.post is not None and seat.post.at_work:
            seat.post.stir(self._clock())
            seat.post.member.send(replace(change, ticket=seat.post.turn))
            return
        seat.postpone(change)
        self._enqueue(seat)

    def leave(self, seat: Seat) -> None:
        """Stop a seat's run."""
        seat.forget()
        if seat in self._queue:
            self._queue.remove(seat)
        if seat.post is not None:
            self._let_go(seat, seat.post)

    def report(self, member: Member, report: Report | Ready) -> Delivery | None:
        """Follow a report; give it if it is for a session."""
        post = self._posts.get(member)
        if post is None:
            return None
        if isinstance(report, Ready):
            self._ready(post)
            return None
        if report.ticket != post.turn:
            return None
        match report:
            case Taken():
                self._taken(post)
            case Waiting():
                post.idle = True
            case Parked():
                self._parked(post, report)
            case _ if post.seat is not None:
                return self._for_session(post, post.seat, report)
        return None

    def gone(self, member: Member) -> Delivery | None:
        """Follow the end of a process; if it had a run, that is held until `go_on`."""
        post = self._posts.pop(member, None)
        if post is None:
            return None
        self._healthy = post.ready
        seat = post.seat
        if seat is None:
            return None
        seat.post = None
        return seat, seat.lose()

    def go_on(self, seat: Seat) -> None:
        """Queue a run that was held, now that its session knows."""
        if seat.held:
            seat.held = False
            self._enqueue(seat)

    def tend(self) -> None:
        """Do all that is due: dismiss, put to work, make room, keep a process in reserve."""
        now = self._clock()
        for post in [post for post in self._posts.values() if post.deadline <= now]:
            self._dismiss(post)
        self._serve_queue()
        for post in self._in_the_way(now):
            post.expect(Parked, now + ANSWER_ROOM)
            post.member.send(Park(post.turn))
        # A process that fails to start is hired again for a run only, and those are counted.
        spare = any(post.free for post in self._posts.values())
        if self._healthy and not spare and len(self._posts) <= self._size:
            self._recruit()

    def next_due(self) -> float:
        """Give the time at which `tend` has something to do, if nothing happens before."""
        times = [post.deadline for post in self._posts.values()]
        if self._shortage() > 0:
            times += [post.ripe_at for post in self._posts.values() if post.at_work]
        return min(times, default=math.inf)

    def _enqueue(self, seat: Seat) -> None:
        if seat.post is None and not seat.held and seat not in self._queue:
            self._queue.append(seat)

    def _put_to_work(self, seat: Seat, post: Post, patience: float) -> None:
        assert seat.next is not None
        late = post.deadline if post.awaited is Taken else math.inf
        # A process that has the seat's run before at work has its last iterate too.
        after = post.turn if seat.post is post else None
        post.seat, seat.post = seat, post
        post.turn = next(self._turns)
        post.stir(self._clock())
        # A session that orders faster than the process answers must not put off the deadline.
        post.expect(Taken, min(late, self._clock() + patience * 2.0**seat.unanswered))
        post.member.send(replace(seat.next, ticket=post.turn, after=after))

    def _let_go(self, seat: Seat, post: Post) -> None:
        """Part a seat from its post, which has to give up the run at once."""
        post.seat, seat.post = None, None
        if post.awaited is not Parked:
            post.member.send(Park(post.turn, keep=False))
        post.expect(Parked, self._clock() + ANSWER_BUSY)

    def _ready(self, post: Post) -> None:
        post.ready = self._healthy = True
        if post.awaited is not None:
            post.expect(post.awaited, self._clock() + ANSWER_FREE)

    def _taken(self, post: Post) -> None:
        if post.awaited is not Taken or post.seat is None:
            return
        post.take(self._clock())
        post.seat.unanswered = 0
        for change in post.seat.pending:
            post.member.send(replace(change, ticket=post.turn))
        post.seat.pending = []

    def _parked(self, post: Post, report: Parked) -> None:
        if post.awaited is not Parked:
            return
        seat = post.seat
        if seat is not None and post.set_up_since is not None:
            seat.fruitless += 1
        post.clear()
        post.vacate()
        if seat is None:
            return
        seat.post = None
        if report.order is not None:
            seat.next = replace(report.order, ticket=seat.ticket)
        if seat.next is not None and (seat.pending or not seat.next.waits):
            self._enqueue(seat)

    def _for_session(self, post: Post, seat: Seat, report: Report) -> Delivery:
        if isinstance(report, Reference | Unrivalled):
            post.begin(self._clock())
        if isinstance(report, Progress):
            seat.done = report.records[-1].iteration
        delivery = seat, replace(report, ticket=seat.ticket)
        if isinstance(report, Refused):
            seat.forget()
            post.vacate()
            seat.post = None
        return delivery

    def _dismiss(self, post: Post) -> None:
        """Kill a process that does not answer; its run, if not yet taken, goes to another."""
        post.member.kill()
        post.deadline = math.inf
        if post.awaited is Parked and post.seat is not None:
            return
        del self._posts[post.member]
        if post.seat is not None:
            post.seat.post = None
            post.seat.unanswered += 1
            self._queue.appendleft(post.seat)

    def _serve_queue(self) -> None:
        while self._queue:
            free = [post for post in self._posts.values() if post.free]
            if len(self._posts) - len(free) >= self._size:
                return
            post = max(free, key=lambda post: post.ready) if free else self._recruit()
            self._put_to_work(self._queue.popleft(), post, ANSWER_FREE)

    def _recruit(self) -> Post:
        member = self._hire()
        self._posts[member] = Post(member)
        return self._posts[member]

    def _shortage(self) -> int:
        """Count the queued runs for which nobody makes room yet."""
        making_room = sum(post.awaited is Parked for post in self._posts.values())
        return len(self._queue) - making_room

    def _in_the_way(self, now: float) -> list[Post]:
        """Give the posts that have to make room: idle ones first, then those longest at work."""
        at_work = [post for post in self._posts.values() if post.at_work and post.ripe_at <= now]
        at_work.sort(key=lambda post: (not post.idle, post.since))
        return at_work[: max(self._shortage(), 0)]
