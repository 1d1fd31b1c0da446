"""The command `python -m solver compare`: how far a run is from results of another program."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from solver.definitions import SettingError
from solver.disk import read_bytes, why
from solver.files import settings_from_command
from solver.latin import Ending, solve
from solver.remarks import prepared
from solver.scenes.method import method_of
from solver.study.other_programs.beside import Beside
from solver.study.other_programs.brought import CAN, FEWEST, FRICTION, read_brought


def add_compare(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("compare", help="how far a run is from another program's results")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument(
        "--with", type=Path, required=True, metavar="FILE.csv", dest="file", help="their results"
    )
    parser.add_argument("--interface", default="", metavar="NAME", help="the first one without")
    parser.add_argument("--json", action="store_true", help="print it as JSON")
    parser.set_defaults(command=_compare)


def _compare(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    try:
        data = read_bytes(chosen.file)
    except (OSError, ValueError) as problem_there:
        raise SettingError("--with", str(chosen.file), CAN, why(problem_there)) from None
    brought = read_brought(data, chosen.file.name, settings)
    tables = {**tables, brought.source: brought.message}
    problem = prepared(settings, chosen.changes, tables)
    if chosen.interface and chosen.interface not in problem.rubbing:
        known = ", ".join(problem.rubbing)
        raise SettingError("--interface", chosen.interface, known, "choose one of these")
    beside = Beside(brought, problem, chosen.interface)
    if beside.counted < FEWEST:
        can = f"at least {FEWEST} rows that both cover"
        raise SettingError("--with", str(chosen.file), can, "give points along this interface")
    solution = solve(problem, method_of(settings))
    found, rows = beside.of(solution.iterate), len(brought.times)
    figures = {
        "quantity": brought.quantity,
        "interface": beside.interface if brought.quantity == FRICTION else None,
        "distance": found,
        "rows": rows,
        "rows_compared": beside.counted,
        "status": str(solution.status.ending),
        "tables": tables,
    }
    said = f"{brought.quantity}: {100.0 * found:.4g} % from {brought.source}"
    print(json.dumps(figures) if chosen.json else f"{said}, at {beside.counted} of {rows} rows")
    return 0 if solution.status.ending is Ending.CONVERGED else 1
