"""Work that pages have a server do: commands, one after the other, and sweeps, side by side."""

from __future__ import annotations

import atexit
import logging
import os
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import ClassVar

import panel as pn

from app.worker.commands import LOG, command
from solver.refusal import RefusedError
from solver.study.sweep.executors import opened, processors
from solver.study.sweep.plan import Plan, Row
from solver.study.sweep.run import patience, sweep

log = logging.getLogger(__name__)
LOOK = 500
"""Milliseconds between two looks of a page at its work."""
LIMIT = 60.0
"""Seconds that a run of a sweep may take: nobody waits longer for a point of a
chart."""
PROCESSES = "processes"
VARIABLE = "SLIPFRONT_EXECUTOR"
"""Of the environment: where sweeps run."""
SETTINGS = "settings.toml"
OUT = "out"


def follow(look: Callable[[], None], end: Callable[[], None]) -> None:
    """Have this page look at its work from time to time, and end it when the page is closed."""
    document = pn.state.curdoc
    if document is not None and document.session_context is not None:
        # Not before the browser is there: what changes while it loads may not reach it.
        pn.state.onload(lambda: document.add_periodic_callback(look, LOOK))
        document.on_session_destroyed(lambda context: end())


@cache
def executor() -> Executor:
    """What runs the commands of all pages: a process at a time, which write here.

    Two at a time would spoil each other's measurements, and thirty the server.
    """
    stack = ExitStack()
    atexit.register(stack.close)
    return stack.enter_context(opened(f"{PROCESSES}:1", n_calls=1))


class Job:
    """A command that is waiting, running, or done.

    Its arguments, as after `python -m solver`, may name the folder `OUT`, and files by
    the names of their texts.
    """

    def __init__(
        self, arguments: Sequence[str], texts: Mapping[str, str] | None = None
    ) -> None:
        self._place = TemporaryDirectory(
            prefix="slipfront-", ignore_cleanup_errors=True
        )
        self.folder = Path(self._place.name)
        for name, text in (texts or {}).items():
            (self.folder / name).write_text(text, encoding="utf-8")
        self._began = time.monotonic()
        self._is_cancelled = False
        self._future = executor().submit(command, tuple(arguments), self.folder)

    @property
    def is_over(self) -> bool:
        """Whether nothing more comes."""
        return self._future.done()

    @property
    def lines(self) -> list[str]:
        """What the command has printed so far, without empty lines."""
        file = self.folder / LOG
        if file.exists():
            text = file.read_text(encoding="utf-8")
        else:
            text = ""
        return [line.strip() for line in text.splitlines() if line.strip()]

    @property
    def files(self) -> dict[str, bytes]:
        """What the command has written, by name."""
        out = self.folder / OUT
        return {file.name: file.read_bytes() for file in sorted(out.glob("*"))}

    @property
    def progress(self) -> str:
        """How far it is, or why it came to nothing."""
        if not self._future.running() and not self.is_over:
            return "Waiting: another report is made first."
        if self.is_over:
            return self.failure
        return (
            f"{time.monotonic() - self._began:.0f} s: {(self.lines or ['Working'])[-1]}"
        )

    @property
    def failure(self) -> str:
        """Why it came to nothing in the end, or nothing."""
        if self._is_cancelled:
            return "Cancelled."
        if self._future.exception() is not None:
            return "Its process stopped unexpectedly; start it again."
        has_failed = self._future.result() not in (0, 1) or not (
            self.files or self.lines
        )
        if has_failed:
            return "\n".join(self.lines[-3:])
        return ""

    def cancel(self) -> None:
        """End it; a process at work is ended at once."""
        self._is_cancelled = self._is_cancelled or not self.is_over
        self._future.cancel()

    def close(self) -> None:
        """End it and leave nothing behind."""
        self.cancel()
        self._place.cleanup()


def share_of(named: str, users: int) -> str:
    """What each of so many sweeps has of an executor: of a cluster, which has a queue, all.

    A queue for all would have everybody wait for the longest run of anybody.
    """
    kind, _, named_count = named.partition(":")
    count = named_count or str(processors())
    is_local = kind == PROCESSES and count.isdecimal()
    if is_local:
        return f"{PROCESSES}:{max(1, int(count) // users)}"
    return named


class Sweep:
    """Runs of a plan, on a thread of its own.

    `rows` are those that have come; `message` says why it came to nothing, or is empty.
    """

    _under_way: ClassVar[set[Sweep]] = set()

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.rows: list[Row] = []
        self.message = ""
        self._is_cancelled = threading.Event()
        self.thread = threading.Thread(target=self._go, name="sweep", daemon=True)
        self.thread.start()

    @property
    def is_over(self) -> bool:
        """Whether nothing more comes."""
        return not self.thread.is_alive()

    @property
    def progress(self) -> str:
        """How many runs have come."""
        return f"{len(self.rows)} of {self.plan.size} runs"

    def cancel(self) -> None:
        """End it; what has come so far stays."""
        self._is_cancelled.set()

    def _go(self) -> None:
        self._under_way.add(self)
        on = share_of(os.environ.get(VARIABLE) or PROCESSES, len(self._under_way))
        try:
            with opened(on, patience(LIMIT)) as where:
                self.rows.extend(
                    sweep(
                        self.plan,
                        where,
                        limit=LIMIT,
                        cancelled=self._is_cancelled.is_set,
                    )
                )
        except RefusedError as refusal:
            self.message = str(refusal)
        except Exception as trouble:
            log.exception("A sweep broke.")
            text = f"{type(trouble).__name__}: {trouble}"
            self.message = f"The executor broke ({text}); start again."
        finally:
            self._under_way.discard(self)
        if self._is_cancelled.is_set():
            self.message = "Cancelled."
