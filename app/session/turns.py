"""Turns of a page on the event loop of its server, where alone its document is touched."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import Context
from functools import partial
from typing import Any

from tornado.ioloop import IOLoop

Act = Callable[[], object]


class Turns:
    """Has something done as soon as the loop is free, or after some time.

    What a thread adds to a document itself may be lost: Bokeh may be letting it go from a hold.
    What another page asks for would be done in that one's context, as Panel has it: with its
    document for the page's own. And what is changed while the browser builds the page is lost:
    Panel takes it for part of the page, which was sent before. So nothing has a turn until then.

    Parameters
    ----------
    take
        Has something done with the page's document, on the loop's own thread; without it nothing
        ever is.
    """

    def __init__(self, take: Callable[..., Any] | None = None) -> None:
        self._take = take
        self._loop = IOLoop.current() if take is not None else None
        self._timers: list[Timer] = []
        self._waits: list[Act] | None = []

    def begin(self) -> None:
        """Have done what waits for the page to be built; nothing waits for that from now on."""
        waited, self._waits = self._waits or [], None
        for act in waited:
            self._give(act)

    def soon(self, act: Act) -> None:
        """Have something done; any thread may ask for it."""
        if self._loop is not None:
            Context().run(self._loop.add_callback, self._give, act)

    def timer(self, act: Act) -> Timer:
        """Give what does something once its time has come."""
        self._timers.append(timer := Timer(self, act))
        return timer

    def later(self, seconds: float, act: Act) -> Act:
        """Have something done after some seconds; give what prevents it."""
        if self._loop is None:
            return lambda: None
        due = Context().run(self._loop.call_later, seconds, self._give, act)
        return partial(self._loop.remove_timeout, due)

    def close(self) -> None:
        """Do nothing more."""
        self._take = None
        for timer in self._timers:
            timer.stop()

    def _give(self, act: Act) -> None:
        if self._take is None:
            return
        if self._waits is not None:
            self._waits.append(act)
        else:
            self._take(act)


class Timer:
    """Does something once, some seconds after it was set last."""

    def __init__(self, turns: Turns, act: Act) -> None:
        self._turns, self._act = turns, act
        self._prevent: Act | None = None

    @property
    def is_set(self) -> bool:
        """Whether it is to come."""
        return self._prevent is not None

    def set(self, seconds: float) -> None:
        """Have it come so much later, and not when it was to come."""
        self.stop()
        self._prevent = self._turns.later(seconds, self._go)

    def stop(self) -> None:
        """Have it not come."""
        if self._prevent is not None:
            self._prevent()
        self._prevent = None

    def _go(self) -> None:
        # It may have been stopped, or set anew, while it waited for its turn.
        if self._prevent is not None:
            self._prevent = None
            self._act()
