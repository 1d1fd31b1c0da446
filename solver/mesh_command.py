"""The command `python -m solver mesh`: whether elements and instants are enough."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from solver.definitions import SettingError
from solver.files import settings_from_command
from solver.latin.run_cost import run_cost
from solver.remarks import print_tables
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings
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
from solver.study.quantities.quantities import Reading, reading


def add_mesh(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser(
        "mesh", help="whether elements and instants are enough for a quantity"
    )
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument("--of", required=True, metavar="NAME", help="what is asked of a run")
    parser.set_defaults(command=_mesh)


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
    unit = asked.quantity.unit
    print(f"Elements: {answer(elements, unit)}")
    print(f"Instants: {answer(instants, unit, TIME_STEP)}")
    if which := which_to_refine(elements, instants):
        print(which)
    return 0 if which else 1


def _value(settings: Settings, asked: Reading) -> float:
    """Take and print a quantity of a run; say before what it will take, if that is much."""
    most, size = settings.max_iterations, size_of(settings)
    cost = run_cost(discretise(settings), method_of(settings), most, with_reference=False)
    if cost.is_large:
        print(f"slipfront: {size} will take about {cost}", file=sys.stderr, flush=True)
    value = value_on(settings, asked)
    print(f"{size:>32}  {value:.6g} {asked.quantity.unit}".rstrip(), flush=True)
    return value
