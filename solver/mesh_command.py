"""The command `python -m solver mesh`: whether a mesh is fine enough for a quantity."""

from __future__ import annotations

import argparse
import math
import sys
from typing import Any

from solver.definitions import SettingError
from solver.files import settings_from_command
from solver.latin.run_cost import run_cost
from solver.scenes import discretise, mesh_of
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.finished import finished_run
from solver.study.mesh import Refinement, answer, meshes_around
from solver.study.quantities import Reading, reading


def add_mesh(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("mesh", help="whether a mesh is fine enough for a quantity")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument("--of", required=True, metavar="NAME", help="what is asked of a run")
    parser.set_defaults(command=_mesh)


def _mesh(chosen: argparse.Namespace) -> int:
    settings, asked = settings_from_command(chosen.scene, chosen.changes), reading(chosen.of)
    if asked.quantity.is_of_course or not asked.quantity.applies(settings):
        can = "a quantity of what a run comes to, that this scene has"
        raise SettingError("--of", chosen.of, can, "`python -m solver sweep` lists them")
    meshes, own = meshes_around(settings)
    values = []
    for mesh in meshes:
        values.append(_value(mesh, asked))
        print(f"{_size(mesh):>24}  {values[-1]:.6g} {asked.quantity.unit}".rstrip(), flush=True)
    found = Refinement((values[0], values[1], values[2]), own)
    print(answer(found, asked.quantity.unit))
    return 0 if found.is_told else 1


def _value(settings: Settings, asked: Reading) -> float:
    """Run a scene on one mesh, and say before if that takes long."""
    most = settings.max_iterations
    cost = run_cost(discretise(settings), method_of(settings), most, with_reference=False)
    if cost.is_large:
        print(f"slipfront: {_size(settings)} will take about {cost}", file=sys.stderr, flush=True)
    run = finished_run(settings, errors=False, indicators=False)
    return asked(run) if run.solution.is_certified else math.nan


def _size(settings: Settings) -> str:
    counts = " x ".join(str(getattr(settings, name)) for name in mesh_of(settings))
    return f"{counts} elements"
