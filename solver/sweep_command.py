"""The command `python -m solver sweep`: a quantity of a run over one or two settings."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import BrokenExecutor
from typing import Any

from solver.console import add_command, print_files, print_tables, warn, writing
from solver.definitions import SettingError
from solver.disk import write
from solver.executors import FORMS, opened
from solver.files import settings_from_command
from solver.study.page import write_page
from solver.study.sweep.plan import FORM, LOST, STUCK, Plan, Row, plan_of
from solver.study.sweep.report import counts, csv_of, growth, lines_of, rows_in, sections, title_of
from solver.study.sweep.run import field_file, patience, sweep

TABLE, PAGE, FIELDS = "sweep.csv", "sweep.html", "fields"
LIMIT = 600.0
"""Seconds that a run may take, unless somebody says otherwise."""
OFTEN = 3.0
"""Seconds between two lines of progress."""


def add_sweep(commands: Any) -> None:
    """Add the command."""
    purpose = "quantities of a run over up to two settings"
    parser = add_command(commands, "sweep", purpose, _sweep, of_scene=True, to_folder=True)
    parser.add_argument("--vary", action="append", default=[], metavar="RANGE", help=FORM)
    parser.add_argument("--of", required=True, metavar="NAME,...", help="what is asked of a run")
    parser.add_argument("--on", default="processes", metavar="EXECUTOR", help=FORMS)
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds that a run may take")
    parser.add_argument("--fields", action="store_true", help="keep the fields of every run")
    parser.add_argument(
        "--adaptive", type=int, metavar="N", help="no more than N runs, where the answer bends"
    )
    parser.add_argument("--cold", action="store_true", help="start no run from its neighbour")


def _sweep(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    # Without a range it is a run, which has one row.
    vary = chosen.vary or [f"friction={settings.friction!r}"]
    plan = plan_of(settings, vary, [name.strip() for name in chosen.of.split(",")])
    if not chosen.limit > 0.0:
        raise SettingError("--limit", chosen.limit, "seconds above zero", "raise it")
    size = plan.size if chosen.adaptive is None else min(plan.size, chosen.adaptive)
    print_tables(tables)
    warn(*(f"{name} does nothing with the other settings as they are" for name in plan.idle()))
    with writing(chosen.out):
        rows = rows_in(chosen.out / TABLE, plan)
        try:
            run(plan, rows, size, chosen)
        except (KeyboardInterrupt, BrokenExecutor) as end:
            why = f"slipfront: {end}" if str(end) else "Stopped"
            print(f"{why}; the same command goes on from here.", file=sys.stderr)
        by_number = [rows[number] for number in sorted(rows)]
        write(chosen.out / TABLE, csv_of(plan, by_number))
        write_page(chosen.out / PAGE, title_of(plan), sections(plan, by_number))
    print("\n".join([counts(plan, by_number), *growth(plan, by_number)]))
    print_files(f"{TABLE} and {PAGE}", chosen.out)
    return 0 if len(rows) >= size and all(row.holds for row in by_number) else 1


def run(plan: Plan, rows: dict[int, Row], size: int, chosen: argparse.Namespace) -> None:
    """Run what of a plan has no row yet, append its rows to the table, and print how far it is.

    Raises
    ------
    SettingError
        For an executor that there is not, one of other versions, or what cannot be sampled.
    BrokenExecutor
        For one that does no more calls.
    """
    fields = None
    known = {n: row for n, row in rows.items() if row.ending not in (STUCK, LOST)}
    if chosen.fields:
        folder = (chosen.out / FIELDS).resolve()
        folder.mkdir(exist_ok=True)
        fields = str(folder)
        known = {n: row for n, row in known.items() if (folder / field_file(n)).exists()}
    options: dict[str, Any] = {"limit": chosen.limit, "fields": fields, "warm": not chosen.cold}
    if chosen.adaptive is not None:
        # Here and not above: it takes a sixth of a second, for which other commands need not wait.
        from solver.study.sweep.adaptive import Chooser

        options |= {"following": Chooser(plan, chosen.adaptive, known), "warm": False}
    table = chosen.out / TABLE
    with opened(chosen.on, patience(chosen.limit)) as executor:
        # As a whole, in case that its last line was cut off
        write(table, csv_of(plan, list(rows.values())))
        with table.open("a", encoding="utf-8", newline="") as lines:
            found = sweep(plan, executor, done=set(known), **options)
            for row in followed(found, size, len(known)):
                rows[row.number] = known[row.number] = row
                lines.write(lines_of(plan, [row]))
                lines.flush()


def followed(rows: Iterable[Row], size: int, done: int) -> Iterator[Row]:
    """Print on stderr, as rows pass, how many there are and how long the others will take."""
    began = printed = time.monotonic()
    for number, row in enumerate(rows, start=1):
        yield row
        now = time.monotonic()
        if now - printed > OFTEN:
            left = (now - began) / number * (size - done - number)
            line = f"{done + number} of {size} runs, {left:.0f} s left"
            print(line, file=sys.stderr, flush=True)
            printed = now
