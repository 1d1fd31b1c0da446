"""What `panel serve app` runs once, before it answers: the first visitor waits for no import."""

import gc
import sys
from pathlib import Path
from typing import Any

ROOT = str(Path(__file__).resolve().parents[1])


def on_server_loaded(server_context: Any) -> None:
    """Import what pages need, start a worker process, and build a page that nobody sees."""
    # Here and not above: what a hook's module does to the path while it loads is undone.
    if ROOT not in sys.path:
        sys.path.insert(0, ROOT)
    from app.serve import rehearse

    rehearse()
    # What is imported stays: without this, every full collection walks it for 0.15 s, in which
    # all pages stand still.
    gc.collect()
    gc.freeze()
