"""Parts that commands share: settings from arguments, messages, JSON, and folders."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from solver.discrete.problem import Problem
from solver.files.amounts import Unit
from solver.files.disk import LARGEST_RESULTS, check_place, read_bytes, why
from solver.files.paraview import PARAVIEW, contacts_of_series
from solver.files.saved import settings_from_command
from solver.files.tables import Table, read_table
from solver.files.typed import typed_amount
from solver.latin.run_cost import run_cost
from solver.scenes.method import method_of
from solver.scenes.remarks import remarks_before
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.page import NO_CHARTS, renderer

INTERRUPTED = 130
"""Exit code that shells have for a program that is ended by Ctrl-C."""
SECONDS = "seconds above 0"


def add_command(
    commands: Any,
    name: str,
    purpose: str,
    command: Callable[[argparse.Namespace], int],
    *,
    of_scene: bool = False,
    to_folder: bool = False,
) -> argparse.ArgumentParser:
    """Add a command, with arguments for a scene and its settings, or for a folder."""
    parser: argparse.ArgumentParser = commands.add_parser(name, help=purpose)
    parser.set_defaults(command=command)
    if of_scene:
        scene = "a name of the catalogue, or a saved settings file (.toml)"
        parser.add_argument("scene", help=scene)
        parser.add_argument(
            "--set", action="append", default=[], metavar="NAME=VALUE", dest="changes"
        )
    if to_folder:
        parser.add_argument("--out", type=Path, default=Path(name), metavar="DIR")
    return parser


def given(chosen: argparse.Namespace) -> tuple[Settings, Mapping[str, str]]:
    """Settings in the arguments of a command, and messages on their tables by name.

    The messages are printed, too, and a warning of settings that do not apply.
    """
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    print_tables(tables)
    warn(*remarks_before(settings, chosen.changes))
    return settings, tables


def names_in(options: Sequence[str]) -> list[str]:
    """Names between commas in an option, which may be given several times."""
    return [name.strip() for name in ",".join(options).split(",")]


def number_in(
    chosen: argparse.Namespace,
    option: str,
    allowed: str,
    unit: str = "",
    *,
    above: float,
    is_whole: bool = False,
) -> Any:
    """Number in an option, in a unit, or None if it is not given.

    It is read as settings are, and refused if it is not above a limit. Where it is to
    be whole it is an integer.
    """
    text = getattr(chosen, option)
    if not isinstance(text, str):
        return text
    refuse = partial(SettingError, f"--{option}", text, allowed)
    try:
        value = typed_amount(text, Unit(unit), unit)
    except ValueError as flaw:
        raise refuse(str(flaw)) from None
    if is_whole and value != int(value):
        raise refuse("write a whole number")
    if not value > above:
        raise refuse("raise it")
    if is_whole:
        return int(value)
    return value


def read_brought(chosen: argparse.Namespace, allowed: str) -> Table:
    """Read the table of the option `--with`: a file, or a series for ParaView."""
    refuse = partial(SettingError, "--with", str(chosen.file), allowed)
    data: bytes | str = read_bytes(chosen.file, refuse, LARGEST_RESULTS)
    if chosen.file.suffix == PARAVIEW:
        interface = getattr(chosen, "interface", "")
        data = contacts_of_series(chosen.file, refuse, interface)
    return read_table(data, chosen.file.name, "--with", allowed, LARGEST_RESULTS)


def warn(*messages: str) -> None:
    """Print messages to stderr, one a line."""
    for message in messages:
        print(f"slipfront: {message}", file=sys.stderr, flush=True)


@contextlib.contextmanager
def postponed_interrupt() -> Iterator[Callable[[], bool]]:
    """Context that postpones Ctrl-C to its end, and tells whether it was pressed.

    `KeyboardInterrupt` may come between any two steps of the main thread, and leave a
    lock of a library taken, or a process half started. A second press, since a
    process takes a second to start, counts as the first.

    Yields
    ------
    Whether Ctrl-C was pressed.

    Raises
    ------
    KeyboardInterrupt
        At the end of the body, if Ctrl-C was pressed.
    """
    pressed = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    # A process that ignores Ctrl-C, as under "nohup", continues to do so.
    if not is_main or before is not signal.default_int_handler:
        yield pressed.is_set
        return

    signal.signal(signal.SIGINT, lambda *_: pressed.set())
    try:
        yield pressed.is_set
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed.is_set():
        raise KeyboardInterrupt


def print_tables(tables: Mapping[str, str]) -> None:
    """Print messages on tables to stderr; they stand under the name of the setting."""
    for name, message in tables.items():
        warn(f"{name}: {message}")


def print_files(names: str, folder: Path) -> None:
    """Print the folder of files, and a line if their page has no charts."""
    if not renderer():
        print(NO_CHARTS)
    print(f"{names} in {folder}")


def print_json(values: Mapping[str, Any]) -> None:
    """Print values as JSON, with null for infinite numbers and NaN."""
    print(json.dumps(_finite(values)), flush=True)


def _finite(value: Any) -> Any:
    """Value with None in place of infinite numbers and NaN, at any depth."""
    if isinstance(value, dict):
        return {name: _finite(entry) for name, entry in value.items()}
    if isinstance(value, list):
        return [_finite(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def announce(
    settings: Settings,
    problem: Problem,
    run: str = "this",
    *,
    reference: bool = False,
    limit: float = math.inf,
) -> None:
    """Print the expected time and memory of a long or large run, before it begins.

    `run` is its name in the message, `limit` its time limit, s; a `reference` may be
    computed, too.
    """
    cost = run_cost(problem, method_of(settings), with_reference=reference)
    if not cost.is_large:
        return
    line = f"{run} will take about {cost}"
    if cost.reference > 0.2 * cost.seconds:
        share = round(100.0 * cost.reference / cost.seconds)
        line += f", {share} % of the time for the reference, "
        line += "which --no-reference leaves out"
    if limit < cost.seconds:
        line += f"; --limit ends it after {limit:g} s"
    warn(line)


@contextlib.contextmanager
def refusing(out: Path, allowed: str) -> Iterator[None]:
    """Context in which a failure to write becomes a refusal of the file or folder."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as problem:
        raise SettingError("--out", str(out), allowed, why(problem)) from None


@contextlib.contextmanager
def writing(folder: Path, *files: str) -> Iterator[None]:
    """Context with a folder for files; refuse a folder that cannot be written to.

    A new folder that is empty at the end is removed.
    """
    is_new = not folder.exists()
    try:
        with refusing(folder, "a folder that can be made and written to"):
            folder.mkdir(parents=True, exist_ok=True)
            for file in files or ("any",):
                check_place(folder / file)
            yield
    finally:
        if is_new:
            with contextlib.suppress(OSError):  # as of one that holds files
                folder.rmdir()
