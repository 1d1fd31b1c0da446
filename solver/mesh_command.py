"""The command `python -m solver mesh`: whether a mesh is fine enough for a quantity."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from solver.definitions import SettingError
from solver.files import settings_from_command
from solver.latin.run_cost import run_cost
from solver.prepared import print_tables
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.mesh import Refinement, answer, decides, meshes_around, size_of, value_on
from solver.study.quantities.quantities import reading


def add_mesh(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("mesh", help="whether a mesh is fine enough for a quantity")
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
    meshes, own = meshes_around(settings)
    values = []
    for mesh in meshes:
        _announce(mesh)
        values.append(value_on(mesh, asked))
        size, unit = f"{size_of(mesh)} elements", asked.quantity.unit
        print(f"{size:>24}  {values[-1]:.6g} {unit}".rstrip(), flush=True)
    found = Refinement((values[0], values[1], values[2]), own)
    print(answer(found, asked.quantity.unit))
    return 0 if found.is_told else 1


def _announce(settings: Settings) -> None:
    """Say before a run what it will take, if that is much."""
    most = settings.max_iterations
    cost = run_cost(discretise(settings), method_of(settings), most, with_reference=False)
    if cost.is_large:
        said = f"slipfront: {size_of(settings)} elements will take about {cost}"
        print(said, file=sys.stderr, flush=True)
