"""What is drawn, as tables of text, with the settings of all its runs in front."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from app.picture.frames import DrawnFields
from app.picture.recording import COLUMNS, History, Recording
from app.picture.shown import instant_of
from app.picture.units import SYSTEMS, of_files, scale_of, titled
from app.views.scene import Scene
from solver.checked import dump

Row = Sequence[object]
Factor = np.float32
UNITS = {"seconds": "run time (s)"}
"""Of the columns of a history; the others are counts and shares."""


def table(what: str, scene: Scene) -> str:
    """Write a table of what is looked at (CSV, with comments that begin with #).

    Parameters
    ----------
    what
        One of `TABLES`.
    scene
        Its fields are thinned as they are drawn.
    """
    written = io.StringIO()
    for line in _head(scene):
        written.write(f"# {line}\n")
    csv.writer(written, lineterminator="\n").writerows(TABLES[what](scene))
    return written.getvalue()


def _head(scene: Scene) -> Iterator[str]:
    stand, fields = scene.run.stand, scene.frame.fields
    yield f"Slipfront, {scene.run.settings.scene}, {stand.interface}"
    system = SYSTEMS[of_files(scene.look.units)]
    yield f"{scene.name} at {scene.run.called(scene.frame.iteration)}; {system}"
    shown, whole = len(stand.instants), scene.run.settings.n_instants
    if shown < whole:
        yield f"{shown} of {whole} instants"
    if scene.ghost is not None:
        yield f"{scene.ghost_name} at its own instants and points"
    assert fields.interface == stand.interface
    for name, run in _runs(scene):
        yield f"settings of {name}:"
        yield from dump(run.settings).splitlines()


def _runs(scene: Scene) -> list[tuple[str, Recording]]:
    found = [(scene.name, scene.run)]
    return found if scene.before is None else [*found, (scene.other, scene.before)]


def _fields(scene: Scene) -> Iterator[tuple[str, Recording, DrawnFields]]:
    """Give the fields that are drawn, each with its name and what it stands on."""
    yield scene.name, scene.run, scene.frame.fields
    if scene.ghost is not None:
        before, fields, _ = scene.ghost
        yield scene.other, before, fields
    if scene.run.reference is not None:
        yield "reference", scene.run, scene.run.reference


def _points(scene: Scene) -> Iterator[Row]:
    """Give the fields along the interface at the chosen instant."""
    has_pressure = scene.frame.fields.pressure is not None
    told = [("position", "m"), ("friction", "Pa" if has_pressure else "N/m"), ("pressure", "Pa")]
    heads, factors = _in_units(scene, told if has_pressure else told[:2])
    yield ["run", "time (s)", *heads, "status"]
    for name, run, fields in _fields(scene):
        column = instant_of(scene.look.phase, fields.friction.shape[1])
        columns = [run.stand.positions, fields.friction[:, column]]
        columns += [] if fields.pressure is None else [fields.pressure[:, column]]
        columns = [one / factor for one, factor in zip(columns, factors, strict=True)]
        time = _number(run.stand.instants[column])
        for values, status in zip(
            zip(*columns, strict=True), fields.status[:, column], strict=True
        ):
            yield [name, time, *map(_number, values), int(status)]


def _instants(scene: Scene) -> Iterator[Row]:
    """Give force and displacement of the loaded end over time."""
    axes = scene.run.stand.loop
    heads, (across, up) = _in_units(scene, [axes.across, axes.up])
    yield ["run", "time (s)", *heads]
    for name, run, fields in _fields(scene):
        load = run.stand.load if fields.load is None else fields.load
        if load is not None and run.stand.loop == axes:
            values = fields.end_displacement / across, load / up
            for row in zip(run.stand.all_instants, *values, strict=True):
                yield [name, *map(_number, row)]


def _in_units(scene: Scene, told: Sequence[tuple[str, str]]) -> tuple[list[str], list[Factor]]:
    """Give heads of columns, and what their values in SI are divided by."""
    units = of_files(scene.look.units)
    found = [scale_of(0.0, unit, units) for _, unit in told]
    heads = [titled(title, name) for (title, _), (_, name) in zip(told, found, strict=True)]
    return heads, [np.float32(factor) for factor, _ in found]


def _iterations(scene: Scene) -> Iterator[Row]:
    """Give the records of all iterations."""
    yield ["run", *(UNITS.get(name, name.replace("_", " ")) for name in COLUMNS)]
    for name, run in _runs(scene):
        yield from _records(name, run.history)
    if len(scene.run.beside):
        yield from _records("full linear stage", scene.run.beside)


def _records(name: str, history: History) -> Iterator[Row]:
    for row in zip(*(history.column(one) for one in COLUMNS), strict=True):
        yield [name, int(row[0]), *map(_number, row[1:])]


def _number(value: np.floating) -> str:
    """Write a number as exactly as it is kept; nothing where there is none."""
    return str(value.item() if value.dtype == np.float64 else value) if np.isfinite(value) else ""


TABLES: dict[str, Callable[[Scene], Iterable[Row]]] = {
    "points": _points,
    "instants": _instants,
    "iterations": _iterations,
}
"""Fields along the interface at the chosen instant, the loaded end over time, all records."""
