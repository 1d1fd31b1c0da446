"""Start of the server by `panel serve app`: settings, imports and worker processes."""

import gc
import sys
from pathlib import Path
from typing import Any

ROOT = str(Path(__file__).resolve().parents[1])
sys.path.insert(0, ROOT)

# The root is on the path only from here on.
from app.experiments.jobs import executor_name  # noqa: E402
from app.server import configure, lighten, most_pages, share_looks  # noqa: E402
from solver.refusal import RefusedError  # noqa: E402

try:
    # Else each page, or each sweep, would be refused by itself.
    most_pages()
    executor_name()
except RefusedError as refusal:
    sys.exit(str(refusal))
configure()
lighten()


def on_server_loaded(_server_context: Any) -> None:
    """Import the page, and start the process from which workers are forked."""
    # The path is as it was before this file was run.
    sys.path.insert(0, ROOT)
    # The first page would keep others waiting while it is imported.
    import app.page  # noqa: F401
    from app.worker.process import Worker

    share_looks()
    Worker(lambda worker, report: None).end()
    # What is imported stays: without this every full collection walks it for 0.15 s.
    gc.collect()
    gc.freeze()
    # Pages are made of many small objects that stay: collections took a tenth of their
    # making. Older objects are walked seldom, as Panel has all collected once a page is
    # closed.
    gc.set_threshold(50_000, 100, 20)
