"""Commands of `python -m solver`: run a scene, list what there is, measure, draw figures."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np

from solver.definitions import SettingError, about, allowed
from solver.discrete import Problem
from solver.discrete.problem import nothing_acts
from solver.disk import check_place, why
from solver.files import (
    save_result,
    scene_settings,
    settings_from_command,
    summary,
)
from solver.latin import Ending, Solution, solve, solve_in_slabs
from solver.latin.cost import RunCost, run_cost
from solver.reference.condensation import NoReferenceError
from solver.reference.distance import Distance, distance_to, held_instants
from solver.reference.incremental import reference_of
from solver.reference.solution import Interrupted
from solver.refusal import RefusedError
from solver.remarks import print_tables, remarks_before, warn
from solver.report_commands import REFUSED, add_reports
from solver.run_commands import add_checks
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.sweep_command import add_sweep

OUT_OF_MEMORY, INTERRUPTED = 3, 130
"""Exit codes; the other is what shells have for a program that is ended by Ctrl-C."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code of one command.

    0: converged. 1: stopped otherwise. 2: refused input. 3: out of memory. 130: ended by Ctrl-C.
    """
    parser = _parser()
    chosen, options = parser.parse_known_args(arguments)
    if options and not hasattr(chosen, "passed_on"):
        parser.error(f"unrecognized arguments: {' '.join(options)}")
    chosen.passed_on = options
    code = 0
    try:
        code = chosen.command(chosen)
        sys.stdout.flush()
    except RefusedError as refusal:
        warn(str(refusal))
        return REFUSED
    except NoReferenceError as refusal:
        warn(f"there is nothing to compare with: {refusal}")
        return REFUSED
    except BrokenPipeError:
        # Whoever reads has enough (as with "| head"); Python must not complain at its own end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as trouble:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        warn(f"nothing can be printed: {why(trouble)}")
        return REFUSED
    except (MemoryError, RuntimeError) as trouble:
        if isinstance(trouble, RuntimeError) and "MALLOC" not in str(trouble):  # that of SuperLU
            raise
        remedy = "take a coarser mesh or fewer instants, or for `run` --no-reference"
        warn(f"this takes more memory than there is: {remedy}")
        return OUT_OF_MEMORY
    except KeyboardInterrupt:
        warn("ended; files that are written stay")
        return INTERRUPTED
    return code


def _parser() -> argparse.ArgumentParser:
    is_installed = Path(sys.argv[0]).stem == "slipfront"
    prog = "slipfront" if is_installed else "python -m solver"
    parser = argparse.ArgumentParser(prog=prog, description=__doc__)
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
    run.add_argument(
        "--limit",
        type=float,
        metavar="SECONDS",
        help="end after so long with what there is by then; the reference is given up likewise",
    )
    run.add_argument(
        "--slab",
        type=int,
        metavar="INSTANTS",
        help="solve slab after slab of so many instants: those of a cycle, where a load has many",
    )
    run.set_defaults(command=_run)
    scenes = commands.add_parser("scenes", help="list the scenes")
    scenes.set_defaults(command=_scenes)
    settings = commands.add_parser("settings", help="list the settings of a scene")
    settings.add_argument("scene")
    settings.set_defaults(command=_settings)
    add_reports(commands)
    add_sweep(commands)
    add_checks(commands)
    for further in entry_points(group="slipfront.commands"):
        with contextlib.suppress(ImportError):  # the engine may be there alone
            further.load()(commands)
    return parser


def _run(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    if chosen.out is not None:
        with _writing(chosen.out):  # before the run, and not after it
            check_place(chosen.out)
    limit = _limit(chosen)
    print_tables(tables)
    warn(*remarks_before(settings, chosen.changes))
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if nothing_acts(problem):
        warn("nothing acts on the structure: all loads are zero")
    method = method_of(settings)
    method = replace(method, stop=replace(method.stop, seconds=limit))
    most, beside = settings.max_iterations, chosen.reference
    _announce(run_cost(problem, method, most, with_reference=beside), limit)
    distance = _distance(problem, limit) if chosen.reference else None
    if chosen.slab is None:
        solution = solve(problem, method, distance=distance, watch=chosen.reference, spent=spent)
    else:
        solution = solve_in_slabs(problem, method, chosen.slab, distance=distance, spent=spent)
    if chosen.out is not None:
        with _writing(chosen.out):
            save_result(chosen.out, settings, solution)
    loose = int((~held_instants(problem, solution.iterate.contact_force)).sum())
    if loose:
        warn(
            f"at {loose} of {problem.n_instants} instants nothing says where a body lies: its "
            "displacement is one of many there, and counts in no error"
        )
    with contextlib.suppress(BrokenPipeError):  # whoever reads has enough
        _print_figures(settings, solution, tables, chosen.json)
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _limit(chosen: argparse.Namespace) -> float:
    """Seconds that the run may take."""
    if chosen.limit is None:
        return math.inf
    if not 0.0 < chosen.limit < math.inf:
        raise SettingError("--limit", chosen.limit, "seconds above 0", "give more, or leave it out")
    return float(chosen.limit)


def _announce(cost: RunCost, limit: float) -> None:
    """Print what a long or large run will take, before it begins."""
    if not cost.is_large:
        return
    line = f"this will take about {cost}"
    if cost.reference > 0.2 * cost.seconds:
        share = round(100.0 * cost.reference / cost.seconds)
        line += f", {share} % of the time for the reference, which --no-reference leaves out"
    if limit < cost.seconds:
        line += f"; --limit ends it after {limit:g} s"
    warn(line)


@contextlib.contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Refuse a file that cannot be written."""
    try:
        yield
    except OSError as problem:
        can = "a file in an existing folder that can be written"
        raise SettingError("--out", str(path), can, why(problem)) from None


def _print_figures(
    settings: Settings, solution: Solution, tables: Mapping[str, str], as_json: bool
) -> None:
    figures = summary(settings, solution)
    if as_json:
        plain = {
            name: None if isinstance(value, float) and not math.isfinite(value) else value
            for name, value in figures.items()
        }
        print(json.dumps({**plain, "tables": tables, "settings": settings.values()}))
    else:
        for name, value in figures.items():
            for line in value if isinstance(value, list) else [value]:
                print(f"{name:<20} {_number(name, line) if isinstance(line, float) else line}")


def _number(name: str, value: float) -> str:
    """Text of a relative error, or the ratio of squares that the indicator is: rounding as 0."""
    rounding = float(np.finfo(float).eps) ** (2 if name == "indicator" else 1)
    return f"{0.0 if abs(value) < rounding else value:.6g}"


def _distance(problem: Problem, limit: float) -> Distance | None:
    """Distance to the reference, or None where there is none in time."""
    end = time.perf_counter() + limit
    try:
        reference = reference_of(problem, lambda: time.perf_counter() > end)
    except Interrupted:
        warn("no errors are known: the reference takes longer")
        return None
    except NoReferenceError as refusal:
        warn(f"no errors are known: {refusal}")
        return None
    lost, several = np.count_nonzero(~reference.converged), np.count_nonzero(reference.ambiguous)
    if lost:
        message = f"the reference finds no solution at {lost} of {problem.n_instants} instants"
        if reference.collapse is not None:
            message += f": there is no equilibrium from {reference.collapse.time:.4g} s on"
        elif reference.jumps_at is not None:
            message += ": friction softens until the structure jumps"
        warn(f"no errors are known: {message}")
        return None
    if several:
        warn(f"there are several solutions at {several} instants; errors are to one of them")
    return distance_to(reference, problem)


def _scenes(_chosen: argparse.Namespace) -> int:
    for name, entry in CATALOGUE.items():
        print(f"{name:<10} {entry.title} ({entry.source})")
    return 0


def _settings(chosen: argparse.Namespace) -> int:
    kind = scene_settings(chosen.scene)
    definitions, papers = kind.definitions(), kind.defaults("paper")
    width = max(map(len, definitions)) + 1
    for name, definition in definitions.items():
        unit = about(definition).unit or "-"
        default = json.dumps(definition.default)
        if papers[name] != definition.default:
            default += f" (method=paper: {json.dumps(papers[name])})"
        print(f"{name:<{width}} {unit:<5} default {default:<10} {allowed(definition)}")
        print(f"{'':<{width}} {definition.doc}")
    return 0
