"""Results of another program, brought as a table over x and t.

Meshes differ, and with them nodal forces: so friction is brought as a force per length, N/m, of
rods, and per area, Pa, of bodies in the plane: the traction along the interface, on the body above.
How far they are from a run is told by `solver.study.other_programs.beside`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.columns import Refuse, TableColumn, size_in
from solver.definitions import SettingError
from solver.scenes import kind_of
from solver.settings import Settings
from solver.tables import Table, read_table

FRICTION, DISPLACEMENT = "friction force", "displacement"
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
    message
        What was understood of the file.
    """

    quantity: str
    positions: Array
    times: Array
    values: Array
    source: str
    scene: str
    message: str


def read_brought(data: bytes | str, source: str, settings: Settings) -> Brought:
    """Read results of another program for a scene.

    Parameters
    ----------
    data
        A table as `solver.tables` takes it, a file's bytes or its text. Its head names the columns
        x (m), t (s), and friction force or displacement, in any order and with units if they are
        others; further columns are passed over, and rows may have any order.
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

    table = read_table(data, refuse)
    kind = kind_of(settings)
    quantity, columns = _columns(table)
    if quantity == DISPLACEMENT and kind != "rod":
        raise refuse("displacements are compared along a single rod: give the friction force here")
    if len(table.rows) > MOST:
        raise refuse(f"it has {len(table.rows)} rows, and may have {MOST}: leave some out")
    units = "m", "s", PER[kind] if quantity == FRICTION else "m"

    def refuse_unit(remedy: str) -> SettingError:
        is_nodal = quantity == FRICTION and size_in(columns[2].unit, "N") is not None
        return refuse(
            f"{remedy}; divide nodal forces by what a node stands for" if is_nodal else remedy
        )

    sizes = [column.size(unit, refuse_unit) for column, unit in zip(columns, units, strict=True)]
    numbers = table.numbers(columns)
    message = table.message(columns, ("x", "t", quantity), units, numbers)
    x, t, values = numbers * np.array(sizes)[:, None]
    _check_places(x, t, [line for line, _ in table.rows], settings, refuse)
    x = np.clip(x, 0.0, settings.length)
    return Brought(quantity, x, t, values, source, settings.scene, message)


def _columns(table: Table) -> tuple[str, list[TableColumn]]:
    """Choose the columns of x, t, and the quantity that is named."""
    if not any(column.quantities[0] for column in table.columns):
        raise table.refuse("name its columns in the first line, as in x,t,friction force")
    kinds = "position", "time", FRICTION, DISPLACEMENT
    x, t, friction, displacement = (table.find(table.columns, {kind}) for kind in kinds)
    if x is None or t is None:
        raise table.refuse(f"its head names no column {'t' if x else 'x'}: add it")
    if friction and displacement:
        raise table.refuse("its head names both friction force and displacement: give one of them")
    if friction:
        return FRICTION, [x, t, friction]
    if displacement:
        return DISPLACEMENT, [x, t, displacement]
    raise table.refuse("its head names neither friction force nor displacement: give one of them")


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
