"""The command `python -m solver sweep`: a quantity of a run over one or two settings."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.disk import write
from solver.files import settings_from_command
from solver.remarks import print_tables
from solver.report_commands import writing
from solver.running.executors import FORMS, opened
from solver.running.pool import GoneError
from solver.study.page import write_page
from solver.study.sweep import Plan, Row, VersionsDifferError, patience, plan_of, sweep
from solver.study.sweep.adaptive import Chooser, sweep_adaptively
from solver.study.sweep.growth import growth
from solver.study.sweep.journal import Journal, journal_of
from solver.study.sweep.plan import FORM
from solver.study.sweep.point import field_file
from solver.study.sweep.report import counts, sections, title_of
from solver.study.sweep.table import csv_of, write_parquet

LIMIT = 600.0
"""Seconds that a run may take, unless somebody says otherwise."""
OFTEN, SELDOM = 0.2, 10.0
"""Seconds between two lines of progress, on a terminal and elsewhere."""


def add_sweep(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("sweep", help="a quantity of a run over one or two settings")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--vary", action="append", default=[], metavar="RANGE", help=FORM)
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument("--of", required=True, metavar="NAME,...", help="what is asked of a run")
    parser.add_argument("--out", type=Path, default=Path("sweep"), metavar="DIR")
    parser.add_argument("--on", default="processes", metavar="EXECUTOR", help=FORMS)
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds that a run may take")
    parser.add_argument("--fields", action="store_true", help="keep the fields of every run")
    parser.add_argument(
        "--adaptive", type=int, metavar="N", help="no more than N runs, where the answer bends"
    )
    parser.add_argument("--cold", action="store_true", help="start no run from its neighbour")
    parser.set_defaults(command=_sweep)


def _sweep(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    plan = plan_of(settings, chosen.vary, [name.strip() for name in chosen.of.split(",")])
    if not chosen.limit > 0.0:
        raise SettingError("--limit", chosen.limit, "seconds above zero", "raise it")
    if chosen.adaptive is not None:
        Chooser(plan, chosen.adaptive)
    print_tables(tables)
    for name in plan.idle():
        print(
            f"slipfront: {name} does nothing with the other settings as they are", file=sys.stderr
        )
    with writing(chosen.out):
        with journal_of(plan, chosen.out) as journal:
            try:
                run(plan, journal, chosen)
            except (KeyboardInterrupt, GoneError) as end:
                why = f"slipfront: {end}" if str(end) else "Stopped"
                print(f"{why}; the same command goes on from here.", file=sys.stderr)
        rows = [journal.rows[number] for number in sorted(journal.rows)]
        files = write_report(plan, rows, chosen.out)
    print("\n".join([counts(plan, rows), *growth(plan, rows)]))
    print(f"{len(files)} files in {chosen.out}")
    return 0 if len(rows) >= wanted(plan, chosen) and all(row.holds for row in rows) else 1


def run(plan: Plan, journal: Journal, chosen: argparse.Namespace) -> None:
    """Run what of a plan has no row in its journal yet, and say how far it is.

    Raises
    ------
    SettingError
        For an executor that there is not, or one of other versions.
    """
    fields, done = None, journal.done
    if chosen.fields:
        folder = (chosen.out / "fields").resolve()
        folder.mkdir(exist_ok=True)
        fields = str(folder)
        done = {number for number in done if (folder / field_file(number)).exists()}
    with opened(chosen.on, patience(chosen.limit)) as pool:
        limits: dict[str, Any] = {"limit": chosen.limit, "fields": fields}
        if chosen.adaptive is not None:
            known = [journal.rows[number] for number in done]
            rows = sweep_adaptively(plan, pool, chosen.adaptive, known=known, **limits)
        else:
            rows = sweep(plan, pool, done=done, warm=not chosen.cold, **limits)
        try:
            for row in told(rows, wanted(plan, chosen), len(done)):
                journal.add(row)
        except VersionsDifferError as refusal:
            here = "workers of the same versions as this command"
            raise SettingError("--on", chosen.on, here, str(refusal)) from None


def wanted(plan: Plan, chosen: argparse.Namespace) -> int:
    """Count the runs that a command asks for."""
    return plan.size if chosen.adaptive is None else min(plan.size, int(chosen.adaptive))


def told(rows: Iterable[Row], size: int, done: int) -> Iterator[Row]:
    """Say on stderr, as rows pass, how many there are and how long the others will take."""
    on_terminal = sys.stderr.isatty()
    start, ends = ("\r", "") if on_terminal else ("", "\n")
    began = said = time.monotonic()
    for number, row in enumerate(rows, start=1):
        yield row
        now = time.monotonic()
        is_last = done + number == size
        if now - said > (OFTEN if on_terminal else SELDOM) or (is_last and on_terminal):
            left = (now - began) / number * (size - done - number)
            line = f"{done + number} of {size} runs, {left:.0f} s left"
            print(f"{start}{line:<40}", end="\n" if is_last else ends, file=sys.stderr, flush=True)
            said = now


def write_report(plan: Plan, rows: list[Row], folder: Path) -> list[Path]:
    """Write `sweep.csv`, `sweep.html` and, with pyarrow, `sweep.parquet`; give these files.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    table, page_file = folder / "sweep.csv", folder / "sweep.html"
    write(table, csv_of(plan, rows))
    if note := write_page(page_file, title_of(plan), sections(plan, rows)):
        print(note)
    parquet = folder / "sweep.parquet"
    return [table, page_file, *([parquet] if write_parquet(plan, rows, parquet) else [])]
