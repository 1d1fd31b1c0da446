"""Commands of `python -m solver`: run a scene, list what there is, measure, draw figures."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from solver.definitions import SettingError, about, allowed
from solver.discrete import Problem
from solver.discrete.idle import nothing_acts
from solver.files import (
    remarks,
    save_result,
    scene_settings,
    settings_from_command,
    summary,
)
from solver.latin import Ending, Solution, solve
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import Distance, distance_to
from solver.scenes import CATALOGUE, discretise
from solver.settings import Settings
from solver.study import survey_report
from solver.study.error_against_time import error_against_time
from solver.study.growth import growth
from solver.study.iteration_cost import print_iteration_cost, print_overheads
from solver.study.paper_figures import paper_figures
from solver.study.reduction_cost import print_reduction_cost
from solver.study.row_report import prepare
from solver.study.stability import cases_of, stability
from solver.study.stability_report import HEAD, line, notes, passes, write_report
from solver.study.stability_report import summary as summary_of
from solver.study.stability_units import invariance
from solver.study.study_files import NO_PAGE, write_study
from solver.study.study_report import aligned, conditions, growth_table, table, verdicts
from solver.study.survey import Row, Verdict, survey
from solver.study.thread_gain import print_thread_gain

REFUSED = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; give the exit code: 0 converged, 1 stopped otherwise, 2 refused input."""
    chosen = _parser().parse_args(arguments)
    try:
        code: int = chosen.command(chosen)
    except SettingError as refusal:
        print(f"slipfront: {refusal}", file=sys.stderr)
        return REFUSED
    except NoReferenceError as refusal:
        print(f"slipfront: there is nothing to compare with: {refusal}", file=sys.stderr)
        return REFUSED
    except BrokenPipeError:
        # Whoever reads has enough (as with "| head"); Python must not complain at its own end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m solver", description=__doc__)
    commands = parser.add_subparsers(required=True)
    run = commands.add_parser("run", help="run one scene to its stop rule")
    run.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    run.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    run.add_argument("--out", type=Path, metavar="FILE.npz", help="write the result here")
    run.add_argument("--json", action="store_true", help="print the key figures as JSON")
    run.add_argument(
        "--no-reference",
        action="store_false",
        dest="reference",
        help="do without errors, and without the time of the incremental solver",
    )
    run.set_defaults(command=_run)
    scenes = commands.add_parser("scenes", help="list the scenes")
    scenes.set_defaults(command=_scenes)
    settings = commands.add_parser("settings", help="list the settings of a scene")
    settings.add_argument("scene")
    settings.set_defaults(command=_settings)
    _add_reports(commands)
    return parser


def _add_reports(commands: Any) -> None:
    """Add the commands that measure and write reports."""
    cost = commands.add_parser("benchmark", help="time per iteration, by stage, against its floor")
    cost.add_argument("--repeats", type=int, default=7, help="runs whose median is taken")
    cost.add_argument(
        "--reduction", action="store_true", help="separated bases against full fields instead"
    )
    cost.add_argument(
        "--threads", type=int, default=1, help="so many threads against one instead, on blocks"
    )
    cost.set_defaults(command=_benchmark)
    figures = commands.add_parser("figures", help="draw the paper's Figs. 3 to 8 again")
    figures.add_argument("--out", type=Path, default=Path("figures"), metavar="DIR")
    figures.set_defaults(command=_figures)
    study = commands.add_parser("study", help="error against run time, all methods side by side")
    study.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    study.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    study.add_argument("--out", type=Path, default=Path("study"), metavar="DIR")
    study.add_argument("--repeats", type=int, default=5, help="passes whose median is taken")
    study.add_argument(
        "--no-growth", action="store_false", dest="growth", help="leave out other sizes"
    )
    study.set_defaults(command=_study)
    stable = commands.add_parser("stability", help="stiff and extreme cases, each with a verdict")
    stable.add_argument("scene", nargs="?", help="a name of the catalogue; all without")
    stable.add_argument("--out", type=Path, default=Path("stability"), metavar="DIR")
    stable.add_argument("--quick", action="store_true", help="a quarter of the cases")
    stable.set_defaults(command=_stability)
    random = commands.add_parser("survey", help="random runs of all scenes, each judged")
    random.add_argument("scenes", nargs="*", metavar="SCENE", help="names of the catalogue; all")
    random.add_argument("--runs", type=int, default=100, help="number of runs")
    random.add_argument("--seed", type=int, default=1, help="of the draws")
    random.add_argument("--row", type=int, help="this row of one scene alone")
    random.add_argument("--out", type=Path, default=Path("survey"), metavar="DIR")
    random.set_defaults(command=_survey)


def _run(chosen: argparse.Namespace) -> int:
    settings = settings_from_command(chosen.scene, chosen.changes)
    if chosen.out is not None:
        _check_file(chosen.out)
    for remark in remarks(settings, chosen.changes):
        print(f"slipfront: {remark}", file=sys.stderr)
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if nothing_acts(problem):
        print("slipfront: nothing acts on the structure: all loads are zero", file=sys.stderr)
    distance = _distance(problem) if chosen.reference else None
    solution = solve(problem, settings, distance=distance, watch=chosen.reference, spent=spent)
    _print_figures(settings, solution, chosen.json)
    if chosen.out is not None:
        try:
            save_result(chosen.out, settings, solution)
        except OSError as problem_there:
            raise _refused_file(chosen.out, problem_there) from None
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _check_file(path: Path) -> None:
    """Refuse a file that cannot be written, before the run and not after it."""
    existed = path.exists()
    try:
        path.open("ab").close()
    except OSError as problem:
        raise _refused_file(path, problem) from None
    if not existed:
        path.unlink()


def _refused_file(path: Path, problem: OSError) -> SettingError:
    reason = problem.strerror or type(problem).__name__
    allowed_file = "a file in an existing folder that can be written"
    return SettingError("--out", str(path), allowed_file, reason)


def _print_figures(settings: Settings, solution: Solution, as_json: bool) -> None:
    figures = summary(settings, solution)
    if as_json:
        plain = {
            name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in figures.items()
        }
        print(json.dumps({**plain, "settings": settings.values()}))
    else:
        for name, value in figures.items():
            print(f"{name:<20} {value:.6g}" if isinstance(value, float) else f"{name:<20} {value}")


def _distance(problem: Problem) -> Distance | None:
    """Give the distance to the reference, or None where there is none."""
    try:
        reference = reference_of(problem)
    except NoReferenceError as refusal:
        print(f"slipfront: no errors are known: {refusal}", file=sys.stderr)
        return None
    lost, several = np.count_nonzero(~reference.converged), np.count_nonzero(reference.ambiguous)
    if lost:
        found = f"the reference finds no solution at {lost} of {problem.n_instants} instants"
        print(f"slipfront: no errors are known: {found}", file=sys.stderr)
        return None
    if several:
        found = f"there are several solutions at {several} instants; errors are to one of them"
        print(f"slipfront: {found}", file=sys.stderr)
    return distance_to(reference, problem)


def _scenes(chosen: argparse.Namespace) -> int:
    for name, entry in CATALOGUE.items():
        print(f"{name:<10} {entry.title} ({entry.source})")
    return 0


def _settings(chosen: argparse.Namespace) -> int:
    kind = scene_settings(chosen.scene)
    definitions, usual = kind.definitions(), kind.usual("paper")
    width = max(map(len, definitions)) + 1
    for name, definition in definitions.items():
        unit = about(definition).unit or "-"
        default = json.dumps(definition.default)
        if usual[name] != definition.default:
            default += f" (method=paper: {json.dumps(usual[name])})"
        print(f"{name:<{width}} {unit:<5} default {default:<10} {allowed(definition)}")
        print(f"{'':<{width}} {definition.doc}")
    return 0


def _check_repeats(chosen: argparse.Namespace) -> None:
    if chosen.repeats < 1:
        raise SettingError("--repeats", chosen.repeats, "a whole number from 1", "give 1 or more")


def _benchmark(chosen: argparse.Namespace) -> int:
    _check_repeats(chosen)
    if chosen.threads > 1:
        print_thread_gain(chosen.threads, chosen.repeats)
        return 0
    measure = print_reduction_cost if chosen.reduction else print_iteration_cost
    measure(chosen.repeats)
    if not chosen.reduction:
        print_overheads(chosen.repeats)
    return 0


def _figures(chosen: argparse.Namespace) -> int:
    try:
        from solver.study.drawing import write_figures
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] != "matplotlib":
            raise
        print(
            "slipfront: figures need matplotlib: pip install 'slipfront[figures]'", file=sys.stderr
        )
        return REFUSED
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        figures = paper_figures()
        files = write_figures(figures, chosen.out)
    except OSError as problem:
        allowed_folder = "a folder that can be made and written to"
        raise SettingError("--out", str(chosen.out), allowed_folder, str(problem)) from None
    for figure in figures:
        print(f"Fig. {figure.number}: {figure.title} ({figure.verdict})")
        for found in figure.findings:
            print(f"  {'+' if found.holds else '-'} {found.text}")
    print(f"{len(files)} files in {chosen.out}")
    return 0


def _study(chosen: argparse.Namespace) -> int:
    settings = settings_from_command(chosen.scene, chosen.changes)
    _check_repeats(chosen)
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        found = error_against_time(settings, chosen.repeats)
        sizes = growth(settings) if chosen.growth else []
        files, drawn = write_study(found, sizes, chosen.out)
    except OSError as problem:
        allowed_folder = "a folder that can be made and written to"
        raise SettingError("--out", str(chosen.out), allowed_folder, str(problem)) from None
    print("\n".join(conditions(found)), end="\n\n")
    print(aligned(table(found)), end="\n\n")
    print("\n".join(verdicts(found)))
    if sizes:
        print(f"\n{aligned(growth_table(sizes))}")
    if not drawn:
        print(NO_PAGE)
    print(f"{len(files)} files in {chosen.out}")
    return 0


def _stability(chosen: argparse.Namespace) -> int:
    scene = None if chosen.scene is None else scene_settings(chosen.scene).scene
    matrix = cases_of(scene, quick=chosen.quick)
    try:
        prepare(chosen.out, "stability")
        print(HEAD)
        rows = stability(matrix, lambda row: print(line(row), flush=True))
        apart = invariance() if scene in (None, "bar") else {}
        files = write_report(rows, apart, chosen.out)
    except BrokenPipeError:
        raise
    except OSError as problem:
        allowed_folder = "a folder that can be made and written to"
        raise SettingError("--out", str(chosen.out), allowed_folder, str(problem)) from None
    print("\n".join(["", summary_of(rows), *notes(apart), f"{len(files)} files in {chosen.out}"]))
    return 0 if passes(rows, apart) else 1


def _survey(chosen: argparse.Namespace) -> int:
    scenes = [scene_settings(scene).scene for scene in chosen.scenes] or list(CATALOGUE)
    for name, least in (("runs", 1), ("seed", 0), ("row", 0)):
        value = getattr(chosen, name)
        if value is not None and value < least:
            raise SettingError(f"--{name}", value, f"a whole number from {least}", "raise it")
    numbers = range(chosen.runs) if chosen.row is None else [chosen.row]
    rows: list[Row] = []
    try:
        prepare(chosen.out, "survey")
        print(survey_report.HEAD)
        with contextlib.suppress(KeyboardInterrupt):  # what is done by then is kept
            for row in survey(scenes, numbers, chosen.seed):
                rows.append(row)
                print(survey_report.line(row), flush=True)
        files = survey_report.write_report(rows, chosen.out)
    except BrokenPipeError:
        raise
    except OSError as problem:
        allowed_folder = "a folder that can be made and written to"
        raise SettingError("--out", str(chosen.out), allowed_folder, str(problem)) from None
    print("\n".join(["", *survey_report.ends(rows), f"{len(files)} files in {chosen.out}"]))
    return int(any(row.verdict is Verdict.WRONG for row in rows))
