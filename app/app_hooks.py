"""What `panel serve app` runs once, before it answers: the first visitor waits for no import."""

import contextlib
import gc
import signal
import sys
from pathlib import Path
from typing import Any

from tornado.ioloop import IOLoop

ROOT = str(Path(__file__).resolve().parents[1])
LONGEST = 24 * 3600
"""Seconds for which a page may lose its network and go on; a lesson, or a day's work."""


def on_server_loaded(_server_context: Any) -> None:
    """Import what pages need, build a page that nobody sees, and watch the event loop."""
    # Here and not above: what a hook's module does to the path while it loads is undone.
    if ROOT not in sys.path:
        sys.path.insert(0, ROOT)
    from app.components.innards import (
        alive_with,
        answer_heads,
        ignore_the_lost,
        let_come_back,
        open_in_turn,
        send_by,
        stay_on_loop,
    )
    from app.server.packed import Packed
    from app.server.serve import LATENESS, NAMES, facts, rehearse
    from app.shell.log import leave_out_the_unsent

    rehearse()
    alive_with(facts)
    answer_heads(NAMES.__contains__)
    send_by(Packed)
    let_come_back(LONGEST)
    open_in_turn()
    stay_on_loop()
    ignore_the_lost()
    leave_out_the_unsent()
    IOLoop.current().spawn_callback(LATENESS.watch)
    heed_interrupts()
    # What is imported stays: without this, every full collection walks it for 0.15 s, in which
    # all pages stand still.
    gc.collect()
    gc.freeze()


def heed_interrupts() -> None:
    """Have an interrupt end the server between two tasks of its loop, as a termination does.

    Raised in the midst of one, it may be lost, or leave a page locked that the server waits for.
    """
    loop: Any = IOLoop.current()

    def end() -> None:
        # Another one ends it whatever it is at.
        loop.asyncio_loop.remove_signal_handler(signal.SIGINT)
        print("Interrupted, shutting down")
        loop.stop()

    # Loops of Windows heed no signals.
    with contextlib.suppress(NotImplementedError):
        loop.asyncio_loop.add_signal_handler(signal.SIGINT, end)
