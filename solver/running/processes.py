"""Processes of the engine's own, each with one BLAS thread, forked from a server that is ready."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterator
from importlib.machinery import ModuleSpec
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess

from solver.running.machine import LIMITS

ONE_THREAD = dict.fromkeys(LIMITS, "1")

_starting = threading.Lock()


def start_process(
    main: Callable[..., None], *arguments: object, preloaded: list[str]
) -> tuple[BaseProcess, Connection]:
    """Start a process, and give the caller's end of its pipe.

    Parameters
    ----------
    main, arguments
        What it does, from an importable module: called with its end of the pipe, and these.
    preloaded
        What the fork server imports, if this is the first process that it is asked for.
    """
    context = _context(preloaded)
    ours, theirs = context.Pipe()
    worker = context.Process(  # type: ignore[attr-defined]  # every concrete context has it
        target=main, args=(theirs, *arguments), name="slipfront-worker", daemon=True
    )
    with _starting, _children_surroundings():
        worker.start()
    # As long as this end were open here, the end of the process would not be seen.
    theirs.close()
    return worker, ours


def _context(preloaded: list[str]) -> BaseContext:
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(preloaded)
    return context


@contextlib.contextmanager
def _children_surroundings() -> Iterator[None]:
    """Let children start with one BLAS thread, and without importing the caller's main module.

    The main module of `panel serve` imports all of Panel, which would take each worker seconds.
    multiprocessing leaves out a main module that is named like a package's `__main__`.
    """
    main = sys.modules["__main__"]
    spec, before = main.__spec__, {name: os.environ.get(name) for name in ONE_THREAD}
    main.__spec__ = ModuleSpec("solver.__main__", None)
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        main.__spec__ = spec
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
