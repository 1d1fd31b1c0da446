"""The command `python -m solver fclib`: one instant of a run as a local contact problem."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.disk import check_place, why
from solver.files import settings_from_command
from solver.latin import Ending, solve
from solver.prepared import prepared
from solver.scenes.method import method_of
from solver.study.other_programs.fclib import (
    check_writer,
    contacts_of,
    instant_at,
    local_problem,
    save_fclib,
)


def add_fclib(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("fclib", help="one instant as a contact problem for others")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FILE.hdf5", help="write it here"
    )
    parser.add_argument(
        "--instant", type=float, metavar="SECONDS", help="the nearest one; the last without"
    )
    parser.set_defaults(command=_fclib)


def _fclib(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    check_writer()
    try:
        check_place(chosen.out)
    except OSError as problem_there:
        raise _refused(chosen.out, problem_there) from None
    problem = prepared(settings, chosen.changes, tables)
    instants = problem.instants
    time = float(instants[-1]) if chosen.instant is None else chosen.instant
    contacts, instant = contacts_of(problem), instant_at(time, instants)
    solution = solve(problem, method_of(settings))
    is_sure = solution.is_certified
    local = local_problem(contacts, solution.iterate, instant, settings.scene, certified=is_sure)
    try:
        save_fclib(chosen.out, local)
    except OSError as problem_there:
        raise _refused(chosen.out, problem_there) from None
    if not is_sure:
        said = "the run is not certified: where contacts stood before is what it has found"
        print(f"slipfront: {said}, and no solution stands in the file", file=sys.stderr)
    print(f"t = {instants[instant]:.6g} s, {len(local.friction)} points: {chosen.out}")
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _refused(path: Path, problem: OSError) -> SettingError:
    return SettingError(
        "--out", str(path), "a file in an existing folder that can be written", why(problem)
    )
