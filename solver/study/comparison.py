"""Results of another program over x and t, and the distance of a run to them.

Meshes differ, and with them nodal forces: so friction is brought as a force per length,
N/m, of rods, and per area, Pa, of bodies in the plane: the traction along the
interface, on the body above.

Our field is linear between its points and between its instants; so it has a value w(x,
t) at every row of the table, which has v. With d = w - v,

    distance = |d| / |v|,    |d|^2 = sum over instants of their weight times the mean of d^2 there.

The mean is over the points of that instant, each of which counts as half of the
distance to its neighbours does; an instant has the trapezoidal weight of the table's
own instants. So rows may lie anywhere, in any order, and a place that is sampled
densely counts no more for that. What only one of both covers is left out: rows beside
the body or the run, or where our force is an arbitrary share of what a support holds.
Where v vanishes everywhere, |w| stands in its place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates

from solver.arrays import Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.files.columns import TableColumn, size_in
from solver.files.disk import Refuse
from solver.files.tables import Reading, Table
from solver.reference.distance import Fields, determinate_forces
from solver.settings.scene import Settings

FRICTION = "friction force"
DISPLACEMENT = "displacement"
FEWEST = 4
"""Rows from which on a distance says anything."""
MOST = 20_000
"""Rows at most, which take a fifth of a second to read: a page's server does nothing
else then."""
EDGE = 1e-6
"""Share of the body's length by which a point may lie beyond it: of rounded numbers."""
CAN = "CSV whose head names x, t, and friction force or displacement"
PER = {"rod": "N/m", "wires": "N/m", "plane": "Pa"}
"""Unit of friction, by what there is to see of a scene."""


@dataclass(frozen=True, eq=False)
class OtherResults:
    """Results of another program for a scene, in SI, and what was understood of the file.

    The quantity is `FRICTION`, on the body above, N/m of rods and Pa of bodies in the
    plane, or `DISPLACEMENT`, m. Positions, m, times, s, and values are of every row,
    shape (n_rows,).
    """

    quantity: str
    positions: Array
    times: Array
    values: Array
    source: str
    scene: str
    message: str


def results_in(table: Table, settings: Settings) -> OtherResults:
    """The results of another program for a scene in a table.

    Its head names the columns x (m), t (s), and friction force or displacement, with
    units if they are others; further columns are passed over, and rows may have any
    order.

    Raises
    ------
    SettingError
        For a table that is too large, or without these columns; for what is no finite
        number, another unit, points outside of the body, or fewer than `FEWEST` rows
        during the run; for a displacement of other scenes than a single rod.
    """
    table = table.given_as("the results", CAN)
    kind = settings.kind
    quantity, columns = _columns(table)
    if quantity == DISPLACEMENT and kind != "rod":
        raise table.refuse(
            "displacements are compared along a single rod: give the friction force here"
        )
    units = "m", "s", PER[kind] if quantity == FRICTION else "m"
    if quantity == FRICTION and size_in(columns[2].unit, "N") is not None:
        nodal = "divide nodal forces by what a node stands for"
        columns[2].size(units[2], lambda remedy: table.refuse(f"{remedy}; {nodal}"))
    pairs = zip(columns, units, strict=True)
    reading = in_si(table, dict(zip(("x", "t", quantity), pairs, strict=True)))
    x, t, values = reading.numbers
    _check_places(x, t, reading.lines, settings, table.refuse)
    x = np.clip(x, 0.0, settings.length)
    return OtherResults(
        quantity, x, t, values, table.source, settings.scene, reading.message
    )


def in_si(table: Table, used: Mapping[str, tuple[TableColumn, str]]) -> Reading:
    """Numbers of columns with their units by name, and what was understood."""
    count = len(table.lines)
    if count > MOST:
        raise table.refuse(f"it has {count} rows, and may have {MOST}: leave some out")
    columns, units = zip(*used.values(), strict=True)
    return table.read(columns, list(used), units)


def _columns(table: Table) -> tuple[str, list[TableColumn]]:
    """The quantity that is named, and the columns of x, t, and of it."""
    if not any(column.quantities[0] for column in table.columns):
        raise table.refuse(
            "name its columns in the first line, as in x,t,friction force"
        )
    x, t = (table.find(table.columns, {kind}) for kind in ("position", "time"))
    if x is None or t is None:
        raise table.refuse(f"its head names no column {'t' if x else 'x'}: add it")
    fields = {
        kind: table.find(table.columns, {kind}) for kind in (FRICTION, DISPLACEMENT)
    }
    named = [(kind, column) for kind, column in fields.items() if column]
    if len(named) != 1:
        if named:
            which = "both friction force and"
        else:
            which = "neither friction force nor"
        raise table.refuse(f"its head names {which} displacement: give one of them")
    quantity, column = named[0]
    return quantity, [x, t, column]


def _check_places(
    x: Array, t: Array, lines: Indices, settings: Settings, refuse: Refuse
) -> None:
    length = settings.length
    duration = settings.duration
    beyond = np.flatnonzero((x < -EDGE * length) | (x > (1.0 + EDGE) * length))
    if len(beyond):
        raise refuse(
            f"line {lines[beyond[0]]} has x = {x[beyond[0]]:g} m, outside of the body, which goes "
            f"from 0 to {length:g} m: name its unit (x [mm]), or shift or scale x"
        )
    during = int(((t >= 0.0) & (t <= duration)).sum())
    if during < FEWEST:
        raise refuse(
            f"{during or 'none'} of its {len(t)} rows lie in the run, which goes from 0 to "
            f"{duration:g} s: give at least {FEWEST}"
        )


class Comparison:
    """Results of another program beside the runs of one problem; both cover `counted` rows.

    Friction is that of the interface, or of the first one if there is none of its name.
    """

    def __init__(
        self, results: OtherResults, problem: Problem, interface: str = ""
    ) -> None:
        names = list(problem.rubbing)
        self.results = results
        self._problem = problem
        if interface in names:
            self.interface = interface
        else:
            self.interface = names[0]
        x = results.positions
        t = results.times
        positions = problem.positions
        self._places = None
        self._sizes = np.ones((1, 1))
        if results.quantity == FRICTION:
            law = problem.rubbing[self.interface]
            self._places = problem.contact_places[self.interface][-1]
            self._sizes = law.by_point(law.weights)[:, None]
            positions = law.positions
        self._order = np.argsort(positions, kind="stable")
        grids = positions[self._order], problem.instants
        # Rows as fractional numbers of points and instants
        at = np.array(
            [
                np.interp(r, g, np.arange(len(g)))
                for r, g in zip((x, t), grids, strict=True)
            ]
        )
        counts = _covers(grids[0], x) & _covers(grids[1], t)
        if self._places is not None:
            unknown = ~determinate_forces(problem)[self._places][self._order]
            counts &= _interpolated(unknown.astype(float), at) == 0.0
        self.counted = int(counts.sum())
        self._at = at[:, counts]
        self._values = results.values[counts]
        if self.counted >= FEWEST:
            self._weights = weights_of(x[counts], t[counts])

    def of(self, fields: Fields) -> float:
        """Distance to an iterate, or to a reference; NaN of fewer than `FEWEST` rows."""
        if self.counted < FEWEST:
            return float("nan")
        if self._places is None:
            field = self._problem.at_rest(fields.displacement)
        else:
            field = fields.contact_force[self._places] / self._sizes
        own = _interpolated(field[self._order], self._at)
        size = self._norm(self._values) or self._norm(own) or 1.0
        return self._norm(own - self._values) / size

    def figures(self, fields: Fields) -> dict[str, Any]:
        """What is compared, the distance, and numbers of rows, by the names of scripts."""
        return {
            "quantity": self.results.quantity,
            "interface": None if self._places is None else self.interface,
            "distance": self.of(fields),
            "rows": len(self.results.times),
            "rows_compared": self.counted,
        }

    def _norm(self, values: Array) -> float:
        return float(np.sqrt(self._weights @ values**2))


def weights_of(positions: Array, times: Array) -> Array:
    """What every row counts, as above, shape (n_rows,)."""
    order = np.lexsort((positions, times))
    instants, number = np.unique(times[order], return_inverse=True)
    own = _halves(positions[order], np.diff(number) == 0)
    lengths = np.bincount(number, own, len(instants))
    # All points of an instant may be one.
    own[lengths[number] == 0.0] = 1.0
    lengths = np.bincount(number, own, len(instants))
    if len(instants) > 1:
        over_time = _halves(instants)
    else:
        over_time = np.ones(len(instants))
    weights = np.empty(len(times))
    weights[order] = over_time[number] * own / lengths[number]
    return weights


def _covers(grid: Array, places: Array) -> Flags:
    """Which places lie between the ends of a grid."""
    low = float(grid.min())
    high = float(grid.max())
    edge = EDGE * (high - low)
    return np.asarray((places >= low - edge) & (places <= high + edge))


def _interpolated(field: Array, at: Array) -> Array:
    """Field, shape (n_points, n_instants), at fractional numbers of both, shape (2, n)."""
    return np.asarray(map_coordinates(field, at, order=1, mode="nearest"))


def _halves(places: Array, joined: Flags | bool = True) -> Array:
    """Half of the distances to the neighbours, of places that rise where they are joined."""
    return np.convolve(np.diff(places) * joined, [0.5, 0.5])
