"""Long work of pages: commands, one at a time on the server, and parallel sweeps."""

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
from solver.study.sweep.executors import check_name, opened, processors
from solver.study.sweep.plan import Plan, Row
from solver.study.sweep.run import longest_wait, sweep

log = logging.getLogger(__name__)
LOOK = 500
"""Milliseconds between two looks of a page at its work."""
LIMIT = 60.0
"""Largest time of a run of a sweep, s: nobody waits longer for a point of a chart."""
PROCESSES = "processes"
VARIABLE = "SLIPFRONT_EXECUTOR"
"""Variable of the environment that says where sweeps run."""
SETTINGS = "settings.toml"
OUT = "out"
"""File of the settings, and folder of the results, of a command."""


def follow(look: Callable[[], None], end: Callable[[], None]) -> None:
    """Call `look` periodically, and `end` when the page is closed."""
    document = pn.state.curdoc
    # Not before the browser is there: what changes while it loads may not reach it.
    pn.state.onload(lambda: document.add_periodic_callback(look, LOOK))
    document.on_session_destroyed(lambda context: end())


@cache
def executor() -> Executor:
    """The executor of the commands of all pages: one process at a time.

    Two commands at a time would spoil each other's measurements of time, and thirty
    would leave the server no processor.
    """
    stack = ExitStack()
    atexit.register(stack.close)
    return stack.enter_context(opened(f"{PROCESSES}:1", n_calls=1))


class Job:
    """A command that is waiting, running, or done.

    Its arguments, as after `python -m solver`, may name the folder `OUT`, and the files
    of `texts`, whose keys are names and whose values are contents.
    """

    def __init__(
        self, arguments: Sequence[str], texts: Mapping[str, str] | None = None
    ) -> None:
        self._directory = TemporaryDirectory(
            prefix="slipfront-", ignore_cleanup_errors=True
        )
        self.folder = Path(self._directory.name)
        for name, text in (texts or {}).items():
            (self.folder / name).write_text(text, encoding="utf-8")
        self._began = time.monotonic()
        self._is_cancelled = False
        self._future = executor().submit(command, tuple(arguments), self.folder)

    @property
    def is_over(self) -> bool:
        """Check whether the command is done or cancelled."""
        return self._future.done()

    @property
    def lines(self) -> list[str]:
        """Lines that the command has printed so far, without empty ones."""
        file = self.folder / LOG
        if not file.exists():
            return []
        lines = file.read_text(encoding="utf-8").splitlines()
        return [line.strip() for line in lines if line.strip()]

    @property
    def files(self) -> dict[str, bytes]:
        """Files that the command has written, by name."""
        out = self.folder / OUT
        return {file.name: file.read_bytes() for file in sorted(out.glob("*"))}

    @property
    def progress(self) -> str:
        """The command's time and last line, or why it failed; "" once it is done."""
        if not self._future.running() and not self.is_over:
            return "Waiting: another report is made first."
        if self.is_over:
            return self.failure
        last = "Working"
        if lines := self.lines:
            last = lines[-1]
        return f"{time.monotonic() - self._began:.0f} s: {last}"

    @property
    def failure(self) -> str:
        """Reason why the command failed, or ""."""
        if self._is_cancelled:
            return "Cancelled."
        if self._future.exception() is not None:
            return "Its process stopped unexpectedly; start it again."
        has_output = bool(self.files or self.lines)
        # 0 and 1 are results: a report of runs some of which fail ends with 1.
        if self._future.result() not in (0, 1) or not has_output:
            return "\n".join(self.lines[-3:])
        return ""

    def cancel(self) -> None:
        """End the command, and its process if there is one."""
        self._is_cancelled = self._is_cancelled or not self.is_over
        self._future.cancel()

    def close(self) -> None:
        """End the command and remove its folder."""
        self.cancel()
        self._directory.cleanup()


def executor_name() -> str:
    """Name of the executor of sweeps, as set, or local processes.

    Raises
    ------
    RefusedError
        If what is set names none.
    """
    named = os.environ.get(VARIABLE) or PROCESSES
    try:
        check_name(named)
    except RefusedError as refusal:
        about = refusal.value, refusal.allowed, refusal.remedy
        raise RefusedError(VARIABLE, *about) from None
    return named


def share_of(named: str, users: int) -> str:
    """Executor of one of several sweeps: a share of local processes, or a cluster.

    A cluster has a queue. One queue for all local sweeps would have everybody wait for
    the longest run of anybody.
    """
    kind, _, named_count = named.partition(":")
    count = named_count or str(processors())
    if kind == PROCESSES and count.isdecimal():
        return f"{PROCESSES}:{max(1, int(count) // users)}"
    return named


class Sweep:
    """Runs of a plan, in a separate thread.

    `rows` are the finished runs; `message` says why the sweep ended early, or is empty.
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
        """Check whether the sweep has ended."""
        return not self.thread.is_alive()

    @property
    def progress(self) -> str:
        """Number of finished runs."""
        return f"{len(self.rows)} of {self.plan.size} runs"

    def cancel(self) -> None:
        """End the sweep; finished runs stay."""
        self._is_cancelled.set()

    def _go(self) -> None:
        self._under_way.add(self)
        try:
            # Sweeps that are under way share the processors from here on.
            share = share_of(executor_name(), len(self._under_way))
            with opened(share, longest_wait(LIMIT)) as where:
                is_cancelled = self._is_cancelled.is_set
                rows = sweep(self.plan, where, limit=LIMIT, cancelled=is_cancelled)
                self.rows.extend(rows)
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
