"""The commands of `python -m solver` that measure and write reports."""

from __future__ import annotations

import argparse
import contextlib
from pathlib import Path
from typing import Any

from solver.console import add_command, given, print_files, writing
from solver.definitions import SettingError
from solver.files import scene_settings
from solver.study.cases.case import case_from_file
from solver.study.figures.figure import FILE, write_figures
from solver.study.figures.modes import paper_figures
from solver.study.figures.paper_runs import paper_runs
from solver.study.page import aligned, head_of, line_of
from solver.study.proof import report as proof
from solver.study.speed import study_report as study
from solver.study.speed.measured_times import error_against_time, times_at_sizes
from solver.study.stability import report as stability
from solver.study.stability.draws import random_cases
from solver.study.stability.stability_case import Row, extreme_cases, judged_runs, passed


def add_reports(commands: Any) -> None:
    """Add the commands that measure and write reports."""
    purpose = "draw the paper's Figs. 3 to 8 again"
    add_command(commands, "figures", purpose, _figures, to_folder=True)
    purpose = "error against run time, all methods side by side"
    parser = add_command(commands, "study", purpose, _study, of_scene=True, to_folder=True)
    parser.add_argument("--repeats", type=int, default=5, help="passes whose median is taken")
    parser.add_argument("--large", action="store_true", help="sizes that take minutes, too")
    purpose = "stiff and extreme cases, or random runs, each with a verdict"
    parser = add_command(commands, "stability", purpose, _stability, to_folder=True)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="names of the catalogue; all")
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--quick", action="store_true", help="a quarter of the cases")
    kinds.add_argument("--random", type=int, metavar="N", help="so many random runs, instead")
    parser.add_argument("--seed", type=int, default=1, help="of the random runs")
    purpose = "what is known beside what is found, row by row"
    parser = add_command(commands, "proof", purpose, _proof, to_folder=True)
    own = "cases of one's own (.toml)"
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help=own)


def _figures(chosen: argparse.Namespace) -> int:
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
    if chosen.repeats < 1:
        raise SettingError("--repeats", chosen.repeats, "a whole number from 1", "give 1 or more")
    settings, _ = given(chosen)
    with writing(chosen.out):
        # What is measured is written at once: the rest takes longer, and somebody may end it.
        curves = error_against_time(settings, chosen.repeats)
        study.write_curves(curves, chosen.out)
        sizes = times_at_sizes(settings, large=chosen.large)
        study.write_study(settings, chosen.repeats, curves, sizes, chosen.out)
    print("\n".join(study.conditions(settings, chosen.repeats)), end="\n\n")
    print(aligned(study.table(curves)))
    print("", aligned(study.sizes_table(settings, sizes)), *study.notes(settings, sizes), sep="\n")
    print_files(f"{len(study.FILES)} files", chosen.out)
    return 0


def _stability(chosen: argparse.Namespace) -> int:
    scenes = [scene_settings(scene).scene for scene in chosen.scenes]
    for name, least in (("random", 1), ("seed", 0)):
        value = getattr(chosen, name)
        if value is not None and value < least:
            raise SettingError(f"--{name}", value, f"a whole number from {least}", "raise it")
    cases = extreme_cases(scenes, quick=chosen.quick)
    title, notes = stability.TITLE, stability.NOTES
    if chosen.random is not None:
        cases = random_cases(scenes, chosen.random, chosen.seed)
        title, notes = stability.RANDOM_TITLE, stability.RANDOM_NOTES
    runs: list[Row] = []
    with writing(chosen.out, *stability.FILES):
        print(head_of(stability.SHOWN))
        is_whole = False
        with contextlib.suppress(KeyboardInterrupt):  # what is done by then is written
            for run in judged_runs(cases):
                print(line_of(run, stability.SHOWN), flush=True)
                runs.append(run)
            is_whole = True
        stability.write_stability(runs, title, notes, chosen.out)
    print(
        "\n".join(
            [*stability.last_lines(runs, notes), f"{len(stability.FILES)} files in {chosen.out}"]
        )
    )
    if not is_whole:
        raise KeyboardInterrupt
    return 0 if all(map(passed, runs)) else 1


def _proof(chosen: argparse.Namespace) -> int:
    own = [proof.known_case(case_from_file(path)) for path in chosen.files]
    rows = []
    with writing(chosen.out, *proof.FILES):
        print(head_of(proof.SHOWN))
        for case in own or proof.cases():
            for row in proof.rows_of(case):
                print(line_of(row, proof.SHOWN), flush=True)
                rows.append(row)
        proof.write_proof(rows, chosen.out)
    print(f"{proof.summary(rows)}\n{len(proof.FILES)} files in {chosen.out}")
    return 0 if all(map(proof.holds, rows)) else 1
