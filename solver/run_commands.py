"""The commands that check runs: `mesh`, `compare`, `lesson`."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.disk import read_bytes, why
from solver.files import settings_from_command
from solver.latin import Ending, Status, solve
from solver.latin.cost import run_cost
from solver.lessons.lesson import check
from solver.lessons.reading import lesson_from_file
from solver.remarks import prepared, print_tables, warn
from solver.scenes import discretise, loop_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.comparison import CAN, FEWEST, FRICTION, Comparison, read_results
from solver.study.measured_loop import (
    ALIKE,
    LoopComparison,
    axes_of,
    is_a_loop,
    read_loop,
    rms,
)
from solver.study.mesh import (
    TIME_STEP,
    Refinement,
    answer,
    decides,
    instants_around,
    meshes_around,
    size_of,
    value_on,
    which_to_refine,
)
from solver.study.quantities import reading
from solver.study.quantities.quantity import Quantity


def add_checks(commands: Any) -> None:
    """Add the commands."""
    mesh = _of_a_scene(
        commands, "mesh", "whether elements and instants are enough for a quantity", _mesh
    )
    mesh.add_argument("--of", required=True, metavar="NAME", help="what is asked of a run")
    compare = _of_a_scene(
        commands, "compare", "how far a run is from a measured loop, or another program", _compare
    )
    compare.add_argument(
        "--with", type=Path, required=True, metavar="FILE.csv", dest="file", help="their table"
    )
    compare.add_argument("--interface", default="", metavar="NAME", help="the first one without")
    compare.add_argument("--json", action="store_true", help="print it as JSON")
    lesson = commands.add_parser("lesson", help="test what lessons claim")
    lesson.add_argument("files", nargs="+", type=Path, metavar="FILE", help="lessons (.toml)")
    lesson.set_defaults(command=_lesson)


def _of_a_scene(
    commands: Any, name: str, purpose: str, command: Callable[[argparse.Namespace], int]
) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(name, help=purpose)
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.set_defaults(command=command)
    return parser


def _mesh(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    asked = reading(chosen.of)
    if not decides(settings, asked):
        can = "a quantity of what a run comes to, that this scene has"
        raise SettingError("--of", chosen.of, can, "`python -m solver sweep` lists them")
    print_tables(tables)
    values: dict[str, float] = {}
    refinements = []
    for runs, own in (meshes_around(settings), instants_around(settings)):
        for run in runs:
            if size_of(run) not in values:
                values[size_of(run)] = _value(run, asked)
        coarse, middle, fine = (values[size_of(run)] for run in runs)
        refinements.append(Refinement((coarse, middle, fine), own))
    elements, instants = refinements
    unit = asked.unit
    print(f"Elements: {answer(elements, unit)}")
    print(f"Instants: {answer(instants, unit, TIME_STEP)}")
    if which := which_to_refine(elements, instants):
        print(which)
    return 0 if which else 1


def _value(settings: Settings, asked: Quantity) -> float:
    """Quantity of a run, printed; before it what that will take, if it is much."""
    most, size = settings.max_iterations, size_of(settings)
    cost = run_cost(discretise(settings), method_of(settings), most, with_reference=False)
    if cost.is_large:
        print(f"slipfront: {size} will take about {cost}", file=sys.stderr, flush=True)
    value = value_on(settings, asked)
    print(f"{size:>32}  {value:.6g} {asked.unit}".rstrip(), flush=True)
    return value


def _compare(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    try:
        data = read_bytes(chosen.file)
    except (OSError, ValueError) as trouble:
        raise SettingError("--with", str(chosen.file), CAN, why(trouble)) from None
    if is_a_loop(data, chosen.file.name):
        return _compare_loop(chosen, settings, tables, data)
    results = read_results(data, chosen.file.name, settings)
    tables = {**tables, results.source: results.message}
    problem = prepared(settings, chosen.changes, tables)
    if chosen.interface and chosen.interface not in problem.rubbing:
        known = ", ".join(problem.rubbing)
        raise SettingError("--interface", chosen.interface, known, "choose one of these")
    comparison = Comparison(results, problem, chosen.interface)
    if comparison.counted < FEWEST:
        can = f"at least {FEWEST} rows that both cover"
        raise SettingError("--with", str(chosen.file), can, "give points along this interface")
    solution = solve(problem, method_of(settings))
    figures = {
        "quantity": results.quantity,
        "interface": comparison.interface if results.quantity == FRICTION else None,
        "distance": comparison.of(solution.iterate),
        "rows": len(results.times),
        "rows_compared": comparison.counted,
        "tables": tables,
    }
    return _print_distance(figures, results.source, solution.status, as_json=chosen.json)


def _print_distance(
    figures: Mapping[str, Any], source: str, status: Status, *, as_json: bool
) -> int:
    """Print how far a run is from what was brought; the command's exit code."""
    if as_json:
        print(json.dumps({**figures, "status": str(status.ending)}))
    else:
        far = f"{figures['quantity']}: {100.0 * figures['distance']:.4g} % from {source}"
        print(f"{far}, at {figures['rows_compared']} of {figures['rows']} rows")
    return 0 if status.ending is Ending.CONVERGED else 1


def _compare_loop(
    chosen: argparse.Namespace, settings: Settings, tables: Mapping[str, str], data: bytes
) -> int:
    problem = prepared(settings, chosen.changes, tables)
    loop = loop_of(settings, problem)
    measured = read_loop(data, chosen.file.name, axes_of(loop))
    print_tables({measured.source: measured.message})
    tables = {**tables, measured.source: measured.message}
    beside = LoopComparison(measured, loop, problem)
    solution = solve(problem, method_of(settings))
    differences, drive = beside.differences(*beside.both(solution.iterate))
    figures = {
        "quantity": beside.quantity,
        "interface": None,
        "distance": rms(differences),
        "given": beside.given,
        "distance_given": rms(drive),
        "rows": len(measured.force),
        "rows_compared": len(differences),
        "tables": tables,
    }
    if rms(drive) > ALIKE:
        warn(beside.drive_message(drive))
    return _print_distance(figures, measured.source, solution.status, as_json=chosen.json)


def _lesson(chosen: argparse.Namespace) -> int:
    lessons = [lesson_from_file(path) for path in chosen.files]
    missed = 0
    for lesson in lessons:
        print(f"{lesson.name}: {lesson.title}")
        for holds, line in check(lesson):
            print(f"  {line}", flush=True)
            missed += not holds
    return int(missed > 0)
