"""Commands that compare runs: `mesh`, `compare`, `fit`, `lesson`."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from solver.commands.console import (
    add_command,
    announce,
    given,
    names_in,
    print_files,
    print_json,
    print_tables,
    read_brought,
    warn,
    writing,
)
from solver.discrete import Problem
from solver.latin import Ending, Solution, solve
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings.definitions import properties_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.compared_runs import ComparedRun
from solver.study.comparison import CAN, FEWEST, Comparison, OtherResults
from solver.study.fit import MOST, fit
from solver.study.fit_report import FILES, as_json, lines, write_fit, write_loop
from solver.study.lessons import check, lesson_from_file
from solver.study.measured_loop import CAN as LOOP
from solver.study.measured_loop import LoopComparison, MeasuredLoop, loop_in
from solver.study.mesh import (
    TIME_STEP,
    Refinement,
    answer,
    decides,
    size_of,
    three_of,
    undivided,
    value_on,
    which_to_refine,
)
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.quantity import Quantity
from solver.study.table_use import brought_in

OFTEN = 0.3
"""Seconds between two reports on the progress of a fit, each a line and a file."""


def add_checks(commands: Any) -> None:
    """Add the commands that compare runs."""
    purpose = "whether elements and instants are enough for a quantity"
    mesh = add_command(commands, "mesh", purpose, _mesh, of_scene=True)
    mesh.add_argument(
        "--of", required=True, metavar="NAME", help="name of a quantity of the run"
    )
    purpose = "how far a run is from a measured loop, or another program"
    compare = add_command(commands, "compare", purpose, _compare, of_scene=True)
    compare.add_argument(
        "--interface", default="", metavar="NAME", help="the first one without"
    )
    purpose = "settings that bring a run nearest to a measured loop"
    fitting = add_command(commands, "fit", purpose, _fit, of_scene=True, to_folder=True)
    count = f"up to {MOST} settings"
    fitting.add_argument(
        "--vary", action="append", required=True, metavar="NAME,...", help=count
    )
    for parser in (compare, fitting):
        parser.add_argument(
            "--with",
            type=Path,
            required=True,
            metavar="FILE.csv",
            dest="file",
            help="their table",
        )
        parser.add_argument(
            "--json", action="store_true", help="print what was found as JSON"
        )
    lesson = add_command(commands, "lesson", "test what lessons claim", _lesson)
    lesson.add_argument(
        "files", nargs="+", type=Path, metavar="FILE", help="lessons (.toml)"
    )


def _mesh(chosen: argparse.Namespace) -> int:
    """Print a quantity on three meshes and three numbers of instants, and errors."""
    settings, _ = given(chosen)
    asked = reading(chosen.of)
    if not decides(settings, asked):
        known = [name for name, each in QUANTITIES.items() if decides(settings, each)]
        raise SettingError(
            "--of", chosen.of, ", ".join(known), "choose a quantity of this scene"
        )
    values: dict[str, float] = {}
    elements = None
    words = "They are those of the mesh, refined where it was made."
    if settings.MESH:
        elements = _refined(settings, settings.MESH, asked, values)
        words = answer(elements, asked.unit)
    instants = _refined(settings, ["instants"], asked, values)
    print(f"Elements: {words}")
    words = f"{answer(instants, asked.unit, TIME_STEP)} {undivided(settings)}"
    print(f"Instants: {words.rstrip()}")
    if elements is None:
        return 0 if instants.has_values else 1
    if which := which_to_refine(elements, instants):
        print(which)
    return 0 if which else 1


def _refined(
    settings: Settings, names: Sequence[str], asked: Quantity, values: dict[str, float]
) -> Refinement:
    """Refinement of a quantity over some settings, from three runs.

    `values` are those of runs by their size, which are run once.
    """
    runs, given_run = three_of(settings, names)
    for run in runs:
        size = size_of(run)
        if size not in values:
            announce(run, discretise(run), size)
            values[size] = value_on(run, asked)
            line = f"{size:>32}  {values[size]:.6g} {asked.unit}"
            print(line.rstrip(), flush=True)
    coarse, middle, fine = (values[size_of(run)] for run in runs)
    return Refinement((coarse, middle, fine), given_run)


def _compare(chosen: argparse.Namespace) -> int:
    """Compare a run with a measured loop, or with the results of another program."""
    settings, tables = given(chosen)
    table = read_brought(chosen, f"{CAN}; or displacement and force")
    structure = settings.structure()
    brought = brought_in(table, settings, structure.axes)
    problem = discretise(settings)
    _check_interface(chosen.interface, problem)
    comparison: LoopComparison | Comparison
    if isinstance(brought, MeasuredLoop):
        comparison = LoopComparison(brought, structure.loop(problem), problem)
    else:
        comparison = _comparison(chosen, brought, problem)
    print_tables({chosen.file.name: brought.message})
    announce(settings, problem)
    solution = solve(problem, method_of(settings))
    figures = comparison.figures(solution.iterate)
    _warn_of_doubts(comparison, solution, figures)
    if chosen.json:
        figures["tables"] = {**tables, chosen.file.name: brought.message}
        figures["status"] = str(solution.status.ending)
        print_json(figures)
    else:
        _print_distance(figures, chosen.file.name)
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _check_interface(interface: str, problem: Problem) -> None:
    """Refuse the name of an interface that a problem does not have."""
    if interface and interface not in problem.contacts:
        can = ", ".join(problem.contacts)
        raise SettingError("--interface", interface, can, "choose one of these")


def _comparison(
    chosen: argparse.Namespace, results: OtherResults, problem: Problem
) -> Comparison:
    """Compare with another program along an interface; refuse too few common points."""
    comparison = Comparison(results, problem, chosen.interface)
    if comparison.counted < FEWEST:
        can = f"at least {FEWEST} rows that both cover"
        raise SettingError(
            "--with", str(chosen.file), can, "give points along this interface"
        )
    return comparison


def _warn_of_doubts(
    comparison: LoopComparison | Comparison,
    solution: Solution,
    figures: dict[str, Any],
) -> None:
    """Warn of doubtful units, and of a distance that a lost solution does not have.

    Distances of a lost solution become NaN.
    """
    lost_from = solution.status.lost_from
    if lost_from is not None:
        time_lost = solution.iterate.problem.instants[lost_from]
        warn(f"no distance is told: no solution is found from {time_lost:.4g} s on")
        for name in figures.keys() & {"distance", "distance_given"}:
            figures[name] = math.nan
    elif isinstance(comparison, LoopComparison):
        warn(*comparison.drive_messages(figures["distance_given"]))
        loop = comparison.loop.along(solution.iterate)
        warn(*comparison.measured.doubts(*loop))


def _print_distance(figures: Mapping[str, Any], source: str) -> None:
    """Print the distance of a run from a table."""
    distance = "no distance"
    if not math.isnan(figures["distance"]):
        distance = f"{100.0 * figures['distance']:.4g} %"
    rows = f"{figures['rows_compared']} of {figures['rows']} rows"
    print(f"{figures['quantity']}: {distance} from {source}, at {rows}")


def _fit(chosen: argparse.Namespace) -> int:
    """Fit settings to a measured loop."""
    settings, tables = given(chosen)
    measured = loop_in(read_brought(chosen, LOOP), settings.structure().axes)
    announce(settings, discretise(settings))
    print_tables({measured.source: measured.message})
    names = names_in(chosen.vary)
    printed = 0.0

    def watch(runs: int, nearest: ComparedRun) -> None:
        """Print the progress, and write the loop of the nearest run into the folder."""
        nonlocal printed
        if not printed:
            run = nearest.run
            warn(*measured.doubts(run.displacement, run.force))
        if time.monotonic() - printed < OFTEN:
            return
        printed = time.monotonic()
        values = []
        for name, value in zip(names, nearest.values, strict=True):
            unit = properties_of(settings.definitions()[name]).unit
            values.append(f"{name} {value:.4g} {unit}".strip())
        distance = f"{100.0 * nearest.distance:.3g} % away"
        line = f"{runs} runs: {', '.join(values)}, {distance}"
        print(line, file=sys.stderr, flush=True)
        write_loop(nearest.run, chosen.out)

    with writing(chosen.out, *FILES):
        found = fit(settings, measured, names, watch)
        write_loop(found.nearest.run, chosen.out)
        if chosen.json:
            tables = {**tables, measured.source: measured.message}
            print_json({**as_json(found), "tables": tables})
        else:
            print("\n".join(lines(found, measured)), flush=True)
        write_fit(found, measured, chosen.out)
    if not chosen.json:
        print_files(", ".join(FILES), chosen.out)
    return 0 if found.nearest.run.solution.is_certified else 1


def _lesson(chosen: argparse.Namespace) -> int:
    """Test the claims of lessons."""
    lessons = [lesson_from_file(path) for path in chosen.files]
    missed = 0
    for lesson in lessons:
        print(f"{lesson.name}: {lesson.title}")
        for holds, line in check(lesson):
            print(f"  {line}", flush=True)
            missed += not holds
    return int(missed > 0)
