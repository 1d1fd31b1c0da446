"""Commands that write reports: `figures`, `study`, `stability`, `proof`, `sweep`."""

from __future__ import annotations

import argparse
import sys
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import Any

from solver.commands.console import (
    INTERRUPTED,
    SECONDS,
    add_command,
    given,
    names_in,
    number_in,
    postponed_interrupt,
    print_files,
    print_tables,
    warn,
    writing,
)
from solver.files.disk import write
from solver.files.saved import scene_settings, settings_from_command
from solver.study import proof
from solver.study import stability_report as stability
from solver.study import study_report as study
from solver.study.measured_times import error_against_time, times_at_sizes
from solver.study.page import aligned, head_of, line_of
from solver.study.paper_figures import paper_figures
from solver.study.paper_runs import FILE, paper_runs, write_figures
from solver.study.random_runs import random_cases
from solver.study.stability import Row, extreme_cases, judged_runs, passed
from solver.study.sweep.executors import FORMS, opened
from solver.study.sweep.plan import FORM, LOST, STUCK, Plan, plan_of
from solver.study.sweep.plan import Row as SweepRow
from solver.study.sweep.report import counts, growth, write_sweep
from solver.study.sweep.run import longest_wait, sweep
from solver.study.sweep.table import csv_of, lines_of, rows_in
from solver.study.trade_case import case_from_file

TABLE = "sweep.csv"
PAGE = "sweep.html"
LIMIT = 600.0
"""Time limit of a run without `--limit`, s."""
FROM_1 = "a whole number from 1"
OFTEN = 3.0
"""Time between two lines of progress, s."""


def add_reports(commands: Any) -> None:
    """Add the commands that measure and write reports."""
    purpose = "draw the paper's Figs. 3 to 8 again"
    add_command(commands, "figures", purpose, _figures, to_folder=True)
    _add_study(commands)
    _add_stability(commands)
    purpose = "what is known beside what is found, row by row"
    parser = add_command(commands, "proof", purpose, _proof, to_folder=True)
    cases = "cases of one's own (.toml)"
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help=cases)
    _add_sweep(commands)


def _add_study(commands: Any) -> None:
    """Add `study`."""
    purpose = "error against run time, all methods side by side"
    parser = add_command(
        commands, "study", purpose, _study, of_scene=True, to_folder=True
    )
    parser.add_argument("--repeats", default=5, help="passes whose median is taken")
    parser.add_argument(
        "--large", action="store_true", help="sizes that take minutes, too"
    )


def _add_stability(commands: Any) -> None:
    """Add `stability`."""
    purpose = "stiff and extreme cases, or random runs, each with a verdict"
    parser = add_command(commands, "stability", purpose, _stability, to_folder=True)
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help="names of the catalogue; all"
    )
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--quick", action="store_true", help="a fifth of the cases")
    kinds.add_argument("--random", metavar="N", help="make N random runs instead")
    parser.add_argument("--seed", default=1, help="of the random runs")


def _add_sweep(commands: Any) -> None:
    """Add `sweep`."""
    purpose = "quantities of a run over up to two settings"
    parser = add_command(
        commands, "sweep", purpose, _sweep, of_scene=True, to_folder=True
    )
    parser.add_argument(
        "--vary", action="append", default=[], metavar="RANGE", help=FORM
    )
    parser.add_argument(
        "--of",
        action="append",
        required=True,
        metavar="NAME,...",
        help="names of quantities of the runs",
    )
    parser.add_argument("--on", default="processes", metavar="EXECUTOR", help=FORMS)
    parser.add_argument("--limit", default=LIMIT, help="seconds that a run may take")
    parser.add_argument(
        "--cold", action="store_true", help="start no run from its neighbour"
    )


def _figures(chosen: argparse.Namespace) -> int:
    """Draw the figures of the paper."""
    with writing(chosen.out, FILE):
        figures = paper_figures(paper_runs())
        write_figures(figures, chosen.out)
    for figure in figures:
        print(f"{figure.heading} ({figure.verdict})")
        for finding in figure.findings:
            print(f"  {'+' if finding.holds else '-'} {finding.text}")
    print_files(FILE, chosen.out)
    return 0


def _study(chosen: argparse.Namespace) -> int:
    """Measure error over run time of all methods, and run time over size."""
    repeats: int = number_in(chosen, "repeats", FROM_1, above=0, is_whole=True)
    settings, _ = given(chosen)
    with writing(chosen.out):
        # Curves are written at once: sizes take longer, and may be interrupted.
        curves = error_against_time(settings, repeats)
        study.write_curves(curves, chosen.out)
        sizes = times_at_sizes(settings, large=chosen.large)
        study.write_study(settings, repeats, curves, sizes, chosen.out)
    print("\n".join(study.conditions(settings, repeats)), end="\n\n")
    print(aligned(study.table(curves)))
    print()
    print(aligned(study.sizes_table(settings, sizes)))
    for note in study.notes(settings, sizes):
        print(note)
    print_files(f"{len(study.FILES)} files", chosen.out)
    return 0


def _stability(chosen: argparse.Namespace) -> int:
    """Run stiff and extreme cases, or random ones, and judge each."""
    scenes = [scene_settings(scene).scene for scene in chosen.scenes]
    count = number_in(chosen, "random", FROM_1, above=0, is_whole=True)
    seed = number_in(chosen, "seed", "a whole number from 0", above=-1, is_whole=True)
    cases = extreme_cases(scenes, quick=chosen.quick)
    if count is not None:
        cases = random_cases(scenes, count, seed)
    runs: list[Row] = []
    with writing(chosen.out, *stability.FILES):
        print(head_of(stability.SHOWN))
        try:
            for run in judged_runs(cases):
                print(line_of(run, stability.SHOWN), flush=True)
                runs.append(run)
        finally:  # runs before an interruption are written, too
            stability.write_stability(runs, chosen.out)
            print("\n".join(stability.last_lines(runs)))
            print(f"{len(stability.FILES)} files in {chosen.out}")
    return 0 if all(map(passed, runs)) else 1


def _proof(chosen: argparse.Namespace) -> int:
    """Compare results with known ones: of the given files, or of all cases."""
    cases = [proof.known_case(case_from_file(path)) for path in chosen.files]
    if not cases:
        cases = proof.cases()
    rows = []
    with writing(chosen.out, *proof.FILES):
        print(head_of(proof.SHOWN))
        for case in cases:
            for row in proof.rows_of(case):
                print(line_of(row, proof.SHOWN), flush=True)
                rows.append(row)
        proof.write_proof(rows, chosen.out)
    print(f"{proof.summary(rows)}\n{len(proof.FILES)} files in {chosen.out}")
    return 0 if all(map(proof.holds, rows)) else 1


def _sweep(chosen: argparse.Namespace) -> int:
    """Run a scene over up to two settings, and report quantities of the runs."""
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    # Without a range the sweep is a single run, in one row.
    vary = chosen.vary or [f"friction={settings.friction!r}"]
    plan = plan_of(settings, vary, names_in(chosen.of))
    limit: float = number_in(chosen, "limit", SECONDS, "s", above=0.0)
    print_tables(tables)
    for name in plan.idle():
        warn(f"{name} does nothing with the other settings as they are")
    with writing(chosen.out):
        rows = rows_in(chosen.out / TABLE, plan)
        is_ended = False
        try:
            _run(plan, rows, chosen, limit)
        except KeyboardInterrupt:
            is_ended = True
            warn("stopped; the same command goes on from here")
        except BrokenExecutor as end:
            warn(f"{end}; the same command goes on from here")
        by_number = [rows[number] for number in sorted(rows)]
        write(chosen.out / TABLE, csv_of(plan, by_number))
        write_sweep(plan, by_number, chosen.out / PAGE)
    print("\n".join([counts(plan, by_number), *growth(plan, by_number)]))
    print_files(f"{TABLE} and {PAGE}", chosen.out)
    if is_ended:
        return INTERRUPTED
    is_whole = len(rows) == plan.size
    return 0 if is_whole and all(row.holds for row in by_number) else 1


def _run(
    plan: Plan, rows: dict[int, SweepRow], chosen: argparse.Namespace, limit: float
) -> None:
    """Run the rest of a plan, append its rows to the table, and print the progress.

    No run may take longer than the limit, s. Runs that were stuck or lost before are
    tried again.
    """
    known = {row.number for row in rows.values() if row.ending not in (STUCK, LOST)}
    table = chosen.out / TABLE
    with (
        postponed_interrupt() as is_interrupted,
        opened(chosen.on, longest_wait(limit)) as executor,
    ):
        # The table is written again, as its last line may have been cut off.
        write(table, csv_of(plan, list(rows.values())))
        runs = sweep(
            plan,
            executor,
            done=set(known),
            limit=limit,
            warm=not chosen.cold,
            cancelled=is_interrupted,
        )
        progress = _Progress(plan.size, len(known))
        with table.open("a", encoding="utf-8", newline="") as lines:
            for row in runs:
                rows[row.number] = row
                known.add(row.number)
                lines.write(lines_of(plan, [row]))
                lines.flush()
                progress.show(len(known))


class _Progress:
    """Lines on the progress of a sweep, every few seconds."""

    def __init__(self, size: int, done: int) -> None:
        self._size = size
        self._before = done
        self._began = time.monotonic()
        self._printed = self._began

    def show(self, done: int) -> None:
        """Print the number of runs done, and the time left, unless just printed."""
        now = time.monotonic()
        if now - self._printed <= OFTEN:
            return
        self._printed = now
        seconds_per_run = (now - self._began) / (done - self._before)
        left = seconds_per_run * (self._size - done)
        line = f"{done} of {self._size} runs, {left:.0f} s left"
        print(line, file=sys.stderr, flush=True)
