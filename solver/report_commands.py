"""The commands of `python -m solver` that measure and write reports."""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path
from typing import Any

from solver.console import add_command, given, writing
from solver.definitions import SettingError
from solver.files import scene_settings
from solver.study.cases.case import case_from_file
from solver.study.figures.figure import FILE, write_figures
from solver.study.figures.modes import paper_figures
from solver.study.figures.paper_runs import paper_runs
from solver.study.page import aligned, head_of, line_of
from solver.study.proof import report as proof
from solver.study.speed.measured_times import error_against_time, times_at_sizes
from solver.study.speed.study_report import (
    FILES as STUDY_FILES,
)
from solver.study.speed.study_report import (
    conditions,
    notes,
    sizes_table,
    table,
    write_curves,
    write_study,
)
from solver.study.stability.draws import random_cases
from solver.study.stability.report import (
    FILES,
    NOTES,
    RANDOM_NOTES,
    RANDOM_TITLE,
    SHOWN,
    TITLE,
    entries,
    last_lines,
    write_stability,
)
from solver.study.stability.stability_case import JudgedRun, extreme_cases, judged_runs


def add_reports(commands: Any) -> None:
    """Add the commands that measure and write reports."""
    figures = add_command(commands, "figures", "draw the paper's Figs. 3 to 8 again", _figures)
    purpose = "error against run time, all methods side by side"
    study = add_command(commands, "study", purpose, _study, of_scene=True)
    study.add_argument("--repeats", type=int, default=5, help="passes whose median is taken")
    study.add_argument("--large", action="store_true", help="sizes that take minutes, too")
    purpose = "stiff and extreme cases, or random runs, each with a verdict"
    stable = add_command(commands, "stability", purpose, _stability)
    stable.add_argument("scenes", nargs="*", metavar="SCENE", help="names of the catalogue; all")
    kinds = stable.add_mutually_exclusive_group()
    kinds.add_argument("--quick", action="store_true", help="a quarter of the cases")
    kinds.add_argument("--random", type=int, metavar="N", help="so many random runs, instead")
    stable.add_argument("--seed", type=int, default=1, help="of the random runs")
    purpose = "what is known beside what is found, row by row"
    proven = add_command(commands, "proof", purpose, _proof)
    own = "cases of one's own (.toml)"
    proven.add_argument("files", nargs="*", type=Path, metavar="FILE", help=own)
    for name, parser in (
        ("figures", figures),
        ("study", study),
        ("stability", stable),
        ("proof", proven),
    ):
        parser.add_argument("--out", type=Path, default=Path(name), metavar="DIR")


def _figures(chosen: argparse.Namespace) -> int:
    with writing(chosen.out, FILE):
        figures = paper_figures(paper_runs())
        note = write_figures(figures, chosen.out)
    for figure in figures:
        print(f"{figure.heading} ({figure.verdict})")
        for finding in figure.findings:
            print(f"  {'+' if finding.holds else '-'} {finding.text}")
    print("\n".join([*filter(None, [note]), f"{FILE} in {chosen.out}"]))
    return 0


def _study(chosen: argparse.Namespace) -> int:
    if chosen.repeats < 1:
        raise SettingError("--repeats", chosen.repeats, "a whole number from 1", "give 1 or more")
    settings, _ = given(chosen)
    with writing(chosen.out):
        # What is measured is written at once: the rest takes longer, and somebody may end it.
        curves = error_against_time(settings, chosen.repeats)
        write_curves(curves, chosen.out)
        sizes = times_at_sizes(settings, large=chosen.large)
        note = write_study(settings, chosen.repeats, curves, sizes, chosen.out)
    print("\n".join(conditions(settings, chosen.repeats)), end="\n\n")
    print(aligned(table(curves)))
    print("", aligned(sizes_table(settings, sizes)), *notes(settings, sizes), sep="\n")
    if note:
        print(note)
    print(f"{len(STUDY_FILES)} files in {chosen.out}")
    return 0


def _stability(chosen: argparse.Namespace) -> int:
    scenes = [scene_settings(scene).scene for scene in chosen.scenes]
    for name, least in (("random", 1), ("seed", 0)):
        value = getattr(chosen, name)
        if value is not None and value < least:
            raise SettingError(f"--{name}", value, f"a whole number from {least}", "raise it")
    cases = extreme_cases(scenes, quick=chosen.quick)
    title, notes = TITLE, NOTES
    if chosen.random is not None:
        cases = random_cases(scenes, chosen.random, chosen.seed)
        title, notes = RANDOM_TITLE, RANDOM_NOTES
    runs: list[JudgedRun] = []
    with writing(chosen.out, *FILES):
        print(head_of(SHOWN))
        is_whole = False
        with contextlib.suppress(KeyboardInterrupt):  # what is done by then is written
            for run in judged_runs(cases):
                print(line_of(entries(run), SHOWN), flush=True)
                runs.append(run)
            is_whole = True
        write_stability(runs, title, notes, chosen.out)
    print("\n".join([*last_lines(runs, notes), f"{len(FILES)} files in {chosen.out}"]))
    if not is_whole:
        raise KeyboardInterrupt
    return 0 if all(run.passed for run in runs) else 1


def _proof(chosen: argparse.Namespace) -> int:
    own = [proof.known_case(case_from_file(path)) for path in chosen.files]
    rows = []
    with writing(chosen.out, *proof.FILES):
        print(head_of(proof.SHOWN))
        for case in own or proof.cases():
            for row in proof.rows_of(case):
                print(line_of(proof.entries(row), proof.SHOWN), flush=True)
                rows.append(row)
        proof.write_proof(rows, chosen.out)
    print(f"{proof.summary(rows)}\n{len(proof.FILES)} files in {chosen.out}")
    return 0 if all(row.holds for row in rows) else 1
