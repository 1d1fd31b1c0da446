"""Results of another program, brought as a table over x and t.

Meshes differ, and with them nodal forces: so friction is brought as a force per length, N/m, of
rods, and per area, Pa, of bodies in the plane: the traction along the interface, on the body above.
How far they are from a run is told by `solver.study.other_programs.beside`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array
from solver.definitions import SettingError
from solver.scenes import kind_of
from solver.settings import Settings
from solver.tables import Refuse, Row, factors, name_of, split_table

FRICTION, DISPLACEMENT = "friction force", "displacement"
COLUMNS: Mapping[str, frozenset[str]] = {
    "x": frozenset({"x", "position"}),
    "t": frozenset({"t", "time"}),
    FRICTION: frozenset({"friction force", "friction"}),
    DISPLACEMENT: frozenset({"displacement", "u"}),
}
"""Columns, and what heads may call them."""
FEWEST = 4
"""Rows from which on a distance says anything."""
MOST = 20_000
"""Rows at most, which take a fifth of a second to read: a page's server does nothing else then."""
EDGE = 1e-6
"""Share of the body's length by which a point may lie beyond it: of rounded numbers."""
CAN = "CSV whose head names x, t, and friction force or displacement"
PER = {"rod": "N/m", "wires": "N/m", "plane": "Pa"}
"""Unit of friction, by what there is to see of a scene."""


@dataclass(frozen=True, eq=False)
class Brought:
    """Results of another program, in SI.

    Attributes
    ----------
    quantity
        `FRICTION`, on the body above, N/m of rods and Pa of bodies in the plane; or
        `DISPLACEMENT`, m.
    positions, times, values
        Of every row, shape (n_rows,); m, s.
    source, scene
        Name of the file, and of the scene that it is brought to.
    """

    quantity: str
    positions: Array
    times: Array
    values: Array
    source: str
    scene: str

    @cached_property
    def instants(self) -> Array:
        """Times of which there are rows, rising, s."""
        return np.unique(self.times)

    def nearest(self, time: float) -> tuple[float, Array, Array]:
        """Give the instant of its own that is nearest to a time, s; its points, and its values."""
        instant = float(self.instants[np.abs(self.instants - time).argmin()])
        rows = np.flatnonzero(self.times == instant)
        rows = rows[np.argsort(self.positions[rows])]
        return instant, self.positions[rows], self.values[rows]

    def at_end(self, end: float) -> tuple[Array, Array]:
        """Give times, rising, and values at the end of a body, m; nothing where there are none."""
        rows = np.flatnonzero(np.abs(self.positions - end) <= EDGE * end)
        rows = rows[np.argsort(self.times[rows])]
        return self.times[rows], self.values[rows]


def read_brought(text: str, source: str, settings: Settings) -> Brought:
    """Read results of another program for a scene.

    Parameters
    ----------
    text
        CSV as `solver.tables.split_table` takes it. Its head names the columns x (m), t (s), and
        friction force or displacement, in any order and with units if they are others; further
        columns are passed over, and rows may have any order.
    source
        Name of the file.
    settings
        Those in force, which say how long the body and the run are.

    Raises
    ------
    SettingError
        For a table that is too large, or without these columns; for what is no finite number,
        another unit, points outside of the body, or fewer than `FEWEST` rows during the run; for a
        displacement of other scenes than a single rod.
    """

    def refuse(remedy: str) -> SettingError:
        return SettingError("the results", source, CAN, remedy)

    heads, rows = split_table(text, refuse)
    columns = _columns(heads, refuse)
    quantity = list(columns)[-1]
    kind = kind_of(settings)
    if quantity == DISPLACEMENT and kind != "rod":
        raise refuse("displacements are compared along a single rod: give the friction force here")
    unit = PER[kind] if quantity == FRICTION else "m"
    places = list(columns.values())
    try:
        sizes = factors([_picked(row, places) for row in heads], ("m", "s", unit), refuse)
    except SettingError as refusal:
        if quantity == FRICTION and refusal.remedy.endswith(unit):
            raise refuse(
                f"{refusal.remedy}; divide nodal forces by what a node stands for"
            ) from None
        raise
    if len(rows) > MOST:
        raise refuse(f"it has {len(rows)} rows, and may have {MOST}: leave some out")
    table = _numbers([_picked(row, places) for row in rows], list(columns), refuse)
    x, t, values = table * np.array(sizes)[:, None]
    _check_places(x, t, [line for line, _ in rows], settings, refuse)
    x = np.clip(x, 0.0, settings.length)
    return Brought(quantity, x, t, values, source, settings.scene)


def _columns(heads: list[Row], refuse: Refuse) -> dict[str, int]:
    """Give where x, t and the quantity stand, by the lowest row of words that names any."""
    for _, cells in reversed(heads):
        names = [name_of(cell).replace("_", " ") for cell in cells]
        found = {
            name: next(place for place, one in enumerate(names) if one in called)
            for name, called in COLUMNS.items()
            if called.intersection(names)
        }
        if found:
            break
    else:
        raise refuse("name its columns in the first line, as in x,t,friction force")
    missing = [name for name in ("x", "t") if name not in found]
    if missing:
        raise refuse(f"its head names no column {missing[0]}: add it")
    if len(found) != 3:
        both = len(found) > 3
        raise refuse(
            f"its head names {'both' if both else 'neither'} friction force "
            f"{'and' if both else 'nor'} displacement: give one of them"
        )
    return found


def _picked(row: Row, places: list[int]) -> Row:
    line, cells = row
    return line, [cells[place] if place < len(cells) else "" for place in places]


def _numbers(rows: list[Row], names: list[str], refuse: Refuse) -> Array:
    """Give all numbers, shape (3, n_rows)."""
    try:
        found = np.array([cells for _, cells in rows], dtype=float).reshape(-1, 3).T
    except ValueError:
        found = np.full((3, len(rows)), np.nan)
    if np.isfinite(found).all():
        return found
    for line, cells in rows:
        for name, cell in zip(names, cells, strict=True):
            try:
                is_finite = math.isfinite(float(cell))
            except ValueError:
                raise refuse(f"line {line} has {cell!r} as {name}: give a number") from None
            if not is_finite:
                raise refuse(f"line {line} has {cell!r} as {name}: leave such rows out")
    return found


def _check_places(x: Array, t: Array, lines: list[int], settings: Settings, refuse: Refuse) -> None:
    length, duration = settings.length, settings.duration
    beyond = np.flatnonzero((x < -EDGE * length) | (x > (1.0 + EDGE) * length))
    if len(beyond):
        raise refuse(
            f"line {lines[beyond[0]]} has x = {x[beyond[0]]:g} m, outside of the body, which goes "
            f"from 0 to {length:g} m: shift or scale x"
        )
    during = int(((t >= 0.0) & (t <= duration)).sum())
    if during < FEWEST:
        raise refuse(
            f"{during or 'none'} of its {len(t)} rows lie in the run, which goes from 0 to "
            f"{duration:g} s: give at least {FEWEST}"
        )
