"""What `panel serve app` runs once, before it answers: the first visitor waits for no import."""

import gc
import sys
from pathlib import Path
from typing import Any

from tornado.ioloop import IOLoop

ROOT = str(Path(__file__).resolve().parents[1])


def on_server_loaded(_server_context: Any) -> None:
    """Import what pages need, build a page that nobody sees, and watch the event loop."""
    # Here and not above: what a hook's module does to the path while it loads is undone.
    if ROOT not in sys.path:
        sys.path.insert(0, ROOT)
    from app.innards import alive_with, open_in_turn
    from app.serve import LATENESS, facts, rehearse

    rehearse()
    alive_with(facts)
    open_in_turn()
    IOLoop.current().spawn_callback(LATENESS.watch)
    # What is imported stays: without this, every full collection walks it for 0.15 s, in which
    # all pages stand still.
    gc.collect()
    gc.freeze()
