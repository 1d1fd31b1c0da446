"""Commands of `python -m solver`: run a scene, list what there is, measure, draw figures."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import os
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path

from solver.commands.console import (
    INTERRUPTED,
    add_command,
    announce,
    given,
    print_json,
    refusing,
    warn,
)
from solver.commands.examples import add_examples
from solver.commands.reports import add_reports
from solver.commands.runs import add_checks
from solver.discrete import Problem
from solver.discrete.problem import nothing_acts
from solver.files.disk import check_place, why
from solver.files.saved import save_result, scene_settings, summary
from solver.latin import Ending, solve, solve_in_slabs
from solver.latin.stages.blocks import one_blas_thread
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import distance_to, held_instants
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.definitions import SettingError, about, allowed
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.finished import (
    FinishedRun,
    KeyFigure,
    Known,
    figures_of,
    known_reference,
)
from solver.study.quantities.quantity import Quantity

REFUSED = 2
OUT_OF_MEMORY = 3
"""Exit codes."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code of one command.

    0: converged. 1: stopped otherwise. 2: refused input. 3: out of memory. 130: ended
    by Ctrl-C.
    """
    try:
        return _exit_code(arguments)
    except KeyboardInterrupt:
        warn("ended; files that are written stay")
        return INTERRUPTED


def _exit_code(arguments: Sequence[str] | None) -> int:
    parser = _parser()
    chosen, options = parser.parse_known_args(arguments)
    if options and not hasattr(chosen, "passed_on"):
        parser.error(f"unrecognized arguments: {' '.join(options)}")
    chosen.passed_on = options
    if sys.stdout is None:
        print(
            "slipfront: nothing can be printed: standard output is closed",
            file=sys.stderr,
        )
        return REFUSED
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
    except OSError as trouble:
        # Python must not complain at its own end, as where whoever reads has enough ("|
        # head").
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(trouble, BrokenPipeError):
            warn(f"nothing can be printed: {why(trouble)}")
            return REFUSED
    except MemoryError:
        remedy = "take a coarser mesh or fewer instants, or for `run` --no-reference"
        warn(f"this takes more memory than there is: {remedy}")
        return OUT_OF_MEMORY
    return code


def _parser() -> argparse.ArgumentParser:
    is_installed = Path(sys.argv[0]).stem == "slipfront"
    if is_installed:
        prog = "slipfront"
    else:
        prog = "python -m solver"
    parser = argparse.ArgumentParser(prog=prog, description=__doc__)
    commands = parser.add_subparsers(required=True)
    run = add_command(
        commands, "run", "run one scene to its stop rule", _run, of_scene=True
    )
    run.add_argument(
        "--out", type=Path, metavar="FILE.npz", help="write the result here"
    )
    run.add_argument(
        "--json", action="store_true", help="print the key figures as JSON"
    )
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
    run.add_argument(
        "--of", default="", metavar="NAME,...", help="print quantities of the run, too"
    )
    add_command(commands, "scenes", "list the scenes", _scenes)
    settings = add_command(
        commands, "settings", "list the settings of a scene", _settings
    )
    settings.add_argument("scene")
    add_reports(commands)
    add_checks(commands)
    add_examples(commands)
    for further in entry_points(group="slipfront.commands"):
        with contextlib.suppress(ImportError):  # the engine may be there alone
            further.load()(commands)
    return parser


def _run(chosen: argparse.Namespace) -> int:
    limit = math.inf if chosen.limit is None else chosen.limit
    if chosen.limit is not None and not 0.0 < limit < math.inf:
        raise SettingError(
            "--limit", limit, "seconds above 0", "give more, or leave it out"
        )
    asked = [reading(name.strip()) for name in chosen.of.split(",") if name.strip()]
    place = "a file in an existing folder that can be written"
    if chosen.out is not None:
        with refusing(chosen.out, place):  # before the run, and not after it
            check_place(chosen.out)
    settings, tables = given(chosen)
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    if nothing_acts(problem):
        warn("nothing acts on the structure: all loads are zero")
    method = method_of(settings)
    method = replace(method, stop=replace(method.stop, seconds=limit))
    watch = chosen.reference or any(one.reads == "indicators" for one in asked)
    announce(settings, problem, reference=chosen.reference, limit=limit)
    if chosen.reference:
        known = _known(problem, limit)
    else:
        known = Known()
    distance = None
    if known.reference is not None:
        distance = distance_to(known.reference, problem)
    if chosen.slab is None:
        solution = solve(problem, method, distance=distance, watch=watch, spent=spent)
    else:
        solution = solve_in_slabs(
            problem, method, chosen.slab, distance=distance, spent=spent
        )
    if chosen.out is not None:
        with refusing(chosen.out, place):
            save_result(chosen.out, settings, solution)
    # Matrices are small: threads that wait for each other take longer than the whole
    # run.
    with one_blas_thread:
        loose = int((~held_instants(problem, solution.iterate.contact_force)).sum())
    if loose:
        warn(
            f"at {loose} of {problem.n_instants} instants nothing says where a body lies: its "
            "displacement is one of many there, and counts in no error"
        )
    with contextlib.suppress(BrokenPipeError):  # whoever reads has enough
        run = FinishedRun(settings, solution, known_loss=known.lost_from)
        _print_figures(run, asked, tables, chosen.json)
    return 0 if solution.status.ending is Ending.CONVERGED else 1


OF_WHOLE_RUN = ("slipped_share", "dissipation")
"""Quantities beside the key figures of the loop."""


def _print_figures(
    run: FinishedRun,
    asked: Sequence[Quantity],
    tables: Mapping[str, str],
    as_json: bool,
) -> None:
    """Print what a run came to; nothing of its states where instants are lost."""
    figures = summary(run.settings, run.solution)
    of_loop: Sequence[KeyFigure] = ()
    of_run: Sequence[Quantity] = ()
    if run.lost_from is None:
        of_loop = figures_of(run)
        of_run = [QUANTITIES[name] for name in OF_WHOLE_RUN]
    else:
        figures["lost_from"] = _loss(run.problem, run.lost_from)
    if not as_json:
        _print_lines(figures)
        for figure in of_loop:
            print(f"{figure.name:<20} {_in_words(run, figure)}")
        for one in of_run:
            number = _number(one(run), one.unit)
            print(f"{one.name:<20} {number} ({one.title}, whole run)")
        for one in asked:
            print(f"{one.name:<20} {_number(one(run), one.unit)}")
        return
    figures |= {figure.name: figure.largest for figure in of_loop}
    figures |= {one.name: one(run) for one in of_run}
    figures["key_figures"] = {figure.name: _told(run, figure) for figure in of_loop}
    if asked:
        figures["quantities"] = {one.name: one(run) for one in asked}
    print_json({**figures, "tables": tables, "settings": run.settings.values()})


def _print_lines(figures: Mapping[str, object]) -> None:
    for name, value in figures.items():
        for line in value if isinstance(value, list) else [value]:
            print(f"{name:<20} {f'{line:.6g}' if isinstance(line, float) else line}")


def _loss(problem: Problem, first: int) -> float:
    """Tell from when on there is no solution, of its first instant; that time, s."""
    count = problem.n_instants
    time_lost = float(problem.instants[first])
    lost = f"no solution is found at {count - first} of {count} instants"
    warn(f"no key figures are told: {lost}, from {time_lost:.4g} s on")
    return time_lost


def _in_words(run: FinishedRun, figure: KeyFigure) -> str:
    """A key figure in words: its largest value and when that is, and its last."""
    at = f"at {run.problem.instants[figure.instant]:.6g} s"
    largest = _number(figure.largest, figure.unit)
    last = _number(figure.last, figure.unit)
    return f"{largest} ({figure.title}, largest, {at}; last {last})"


def _told(run: FinishedRun, figure: KeyFigure) -> dict[str, object]:
    """A key figure for scripts: its largest value and when that is, s, and its last."""
    return {
        "title": figure.title,
        "unit": figure.unit,
        "largest": figure.largest,
        "largest_at": float(run.problem.instants[figure.instant]),
        "last": figure.last,
    }


def _number(value: float, unit: str) -> str:
    if math.isnan(value):
        return "none"
    return f"{value:.6g} {unit}".strip()


def _known(problem: Problem, limit: float) -> Known:
    """The reference, or none where there is none in time, and what is said of it."""
    end = time.perf_counter() + limit
    known = known_reference(problem, lambda: time.perf_counter() > end)
    if known.reference is None:
        warn(f"no errors are known: {known.doubt}")
    elif known.doubt:
        warn(f"{known.doubt}; errors are to one of them")
    return known


def _scenes(_chosen: argparse.Namespace) -> int:
    for name, kind in CATALOGUE.items():
        print(f"{name:<10} {kind.title} ({kind.source})")
    return 0


def _settings(chosen: argparse.Namespace) -> int:
    kind = scene_settings(chosen.scene)
    definitions = kind.definitions()
    papers = kind.defaults("paper")
    width = max(map(len, definitions)) + 1
    for name, definition in definitions.items():
        unit = about(definition).unit or "-"
        default = json.dumps(definition.default)
        if papers[name] != definition.default:
            default += f" (method=paper: {json.dumps(papers[name])})"
        print(f"{name:<{width}} {unit:<5} default {default:<10} {allowed(definition)}")
        print(f"{'':<{width}} {definition.doc}")
        for preset, line in about(definition).presets.items():
            print(f"{'':<{width}}   {preset}: {line}")
    return 0
