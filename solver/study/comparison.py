"""Results of another program over x and t, and the distance of a run to them.

Meshes differ, and with them nodal forces: so friction is brought as a force per length,
N/m, of rods, and per area, Pa, of bodies in the plane: the traction along the
interface, on the body above.

Our field is linear between its points and between its instants; so it has a value w(x,
t) at every row of the table, which has v. With d = w - v,

    distance = |d| / |v|,
    |d|^2 = sum over instants of their weight times the mean of d^2 there.

The mean is over the points of that instant, with half of the distance to their
neighbours as weights; an instant has the trapezoidal weight of the table's instants. So
rows may lie anywhere, in any order, and a position that is sampled densely counts no
more for that. Rows that only one of both covers are left out: rows beside the body or
the run, or where our force is an arbitrary share of the force that a support holds.
Where v vanishes everywhere, |w| stands in its place.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from solver.arrays import Array, Flags, Indices
from solver.discrete.problem import Problem
from solver.files.columns import TableColumn
from solver.files.tables import Reading, Table
from solver.files.units import size_in
from solver.reference.distance import Fields, determinate_forces
from solver.settings.scene import Settings
from solver.settings.values import Refuse

FRICTION = "friction force"
DISPLACEMENT = "displacement"
FEWEST = 4
"""Smallest number of rows of a comparison."""
MOST = 40_000
"""Largest number of rows: reading them takes half a second of a page's server."""
EDGE = 1e-6
"""Share of the body's length by which rounding may put a point beyond its end."""
CAN = "CSV whose head names x, t, and friction force or displacement"
PER = {"rod": "N/m", "wires": "N/m", "helices": "N/m", "plane": "Pa"}
"""Unit of friction by the kind of a scene."""


@dataclass(frozen=True, eq=False)
class OtherResults:
    """Results of another program for a scene, in SI.

    Attributes
    ----------
    quantity
        `FRICTION`, on the body above, N/m of rods and Pa of bodies in the plane, or
        `DISPLACEMENT`, m.
    positions, times
        Position, m, and time, s, of every row, shape (n_rows,).
    values
        Values of the quantity, same shape.
    source, message
        Name of the file, and how its columns were understood.
    scene
        Name of the scene.
    contacts
        Name of the interface of every row, same shape; None without such a column.
    """

    quantity: str
    positions: Array
    times: Array
    values: Array
    source: str
    scene: str
    message: str
    contacts: NDArray[np.str_] | None = None

    def on(self, interface: str, known: Collection[str]) -> OtherResults:
        """Rows of an interface; all rows if no row names a known interface."""
        if self.contacts is None or not np.isin(self.contacts, list(known)).any():
            return self
        rows = self.contacts == interface
        return replace(
            self,
            positions=self.positions[rows],
            times=self.times[rows],
            values=self.values[rows],
            contacts=self.contacts[rows],
        )


def results_in(table: Table, settings: Settings, most: float = MOST) -> OtherResults:
    """Read the results of another program for a scene from a table.

    The head names the columns x (m), t (s), and friction force or displacement, with
    units if they are others; where several interfaces have rows, a column contact names
    them. Further columns are ignored, and rows may have any order. There may be `most`
    of them.

    Raises
    ------
    SettingError
        For a table that is too large, or without these columns; for what is no finite
        number, another unit, points outside of the body, or fewer than `FEWEST` rows
        during the run; for a displacement of other scenes than a single rod.
    """
    table = table.given_as("the results", CAN)
    check_count(
        table, most, "leave some out, or give all of them to the command compare"
    )
    kind = settings.kind
    quantity, columns = _columns(table)
    if quantity == DISPLACEMENT and kind != "rod":
        remedy = "give the friction force here"
        raise table.refuse(f"displacements are compared along a single rod: {remedy}")
    position, time, column = columns
    unit = "m"
    if quantity == FRICTION:
        unit = PER[kind]
        _refuse_nodal_forces(table, column, unit)
    used = {"x": (position, "m"), "t": (time, "s"), quantity: (column, unit)}
    table, names = _with_contacts(table)
    reading = in_si(table, used)
    x, t, values = reading.numbers
    _check_places(x, reading.lines, settings.contact_length, table.refuse)
    _check_times(t, settings.duration, table.refuse)
    if names is not None:
        names = names[np.isin(table.lines, reading.lines)]
    return OtherResults(
        quantity=quantity,
        positions=np.clip(x, 0.0, settings.contact_length),
        times=t,
        values=values,
        source=table.source,
        scene=settings.scene,
        message=reading.message,
        contacts=names,
    )


def check_count(
    table: Table, most: float = MOST, remedy: str = "leave some out"
) -> None:
    """Refuse more than `most` rows."""
    count = len(table.lines)
    if count > most:
        raise table.refuse(f"it has {count} rows, and may have {most:.0f}: {remedy}")


def _with_contacts(table: Table) -> tuple[Table, NDArray[np.str_] | None]:
    """Split off the column of interfaces: its names, shape (n_rows,), and the rest.

    What was taken out is not said to be passed over.
    """
    column = table.find(table.columns, {"interface"})
    if column is None:
        return table, None
    others = tuple([each for each in table.columns if each is not column])
    names = np.array([row[column.number] for row in table.cells])
    return replace(table, columns=others), names


def _refuse_nodal_forces(table: Table, column: TableColumn, unit: str) -> None:
    """Refuse a column of friction in newtons: nodal forces depend on the mesh."""
    # Newtons are no unit of a traction, and here they are the likely mistake.
    if size_in(column.unit, "N") is not None:
        # Without its mesh nobody can tell what a nodal force of another program stands
        # for.
        nodal = "divide nodal forces by what a node stands for"
        column.size(unit, lambda remedy: table.refuse(f"{remedy}; {nodal}"))


def in_si(table: Table, used: Mapping[str, tuple[TableColumn, str]]) -> Reading:
    """Read columns, given with their units by name, as numbers in SI."""
    columns, units = zip(*used.values(), strict=True)
    return table.read(columns, list(used), units)


def _columns(table: Table) -> tuple[str, list[TableColumn]]:
    """Quantity that the head names, and columns of x, t and the quantity."""
    if not any(column.quantities[0] for column in table.columns):
        raise table.refuse(
            "name its columns in the first line, as in x,t,friction force"
        )
    # By their words alone: units are the same for positions and displacements.
    x = table.find(table.columns, {"position"})
    t = table.find(table.columns, {"time"})
    if x is None:
        raise table.refuse("its head names no column x: add it")
    if t is None:
        raise table.refuse("its head names no column t: add it")
    friction = table.find(table.columns, {FRICTION})
    displacement = table.find(table.columns, {DISPLACEMENT})
    if friction and displacement:
        named = "both friction force and displacement"
        raise table.refuse(f"its head names {named}: give one of them")
    if friction:
        return FRICTION, [x, t, friction]
    if displacement:
        return DISPLACEMENT, [x, t, displacement]
    named = "neither friction force nor displacement"
    raise table.refuse(f"its head names {named}: give one of them")


def _check_places(x: Array, lines: Indices, length: float, refuse: Refuse) -> None:
    """Refuse positions outside of the body.

    Parameters
    ----------
    x
        Positions, m, shape (n_rows,).
    lines
        Lines of the rows in the file, shape (n_rows,).
    length
        Largest position of the body, m.
    refuse
        Makes the refusal of the table.
    """
    beyond = np.flatnonzero((x < -EDGE * length) | (x > (1.0 + EDGE) * length))
    # A position outside is mostly one in millimetres.
    if len(beyond):
        first = beyond[0]
        raise refuse(
            f"line {lines[first]} has x = {x[first]:g} m, outside of the body, which "
            f"goes from 0 to {length:g} m: name its unit (x [mm]), or shift or scale x"
        )


def _check_times(t: Array, duration: float, refuse: Refuse) -> None:
    """Refuse too few times, s, (n_rows,), during a run of a duration, s."""
    during = int(((t >= 0.0) & (t <= duration)).sum())
    if during < FEWEST:
        raise refuse(
            f"{during or 'none'} of its {len(t)} rows lie in the run, which goes from "
            f"0 to {duration:g} s: give at least {FEWEST}"
        )


class Comparison:
    """Comparison of the results of another program with the runs of one problem.

    Attributes
    ----------
    results
        Results of the other program, on that interface if its rows are named.
    interface
        Name of the interface whose friction is compared: the one that is asked for, or
        else the first one.
    counted
        Number of rows that are compared.
    """

    def __init__(
        self, results: OtherResults, problem: Problem, interface: str = ""
    ) -> None:
        names = list(problem.contacts)
        self._problem = problem
        if interface in names:
            self.interface = interface
        else:
            self.interface = names[0]
        self.results = results = results.on(self.interface, names)
        x = results.positions
        t = results.times
        positions = problem.positions
        self._places = None
        self._sizes = np.ones((1, 1))
        # Friction is per length of the points of one interface.
        if results.quantity == FRICTION:
            law = problem.contacts[self.interface]
            self._places = problem.contacts.forces[self.interface][-1]
            self._sizes = law.by_point(law.weights)[:, None]
            positions = law.positions
        self._order = np.argsort(positions, kind="stable")
        points = positions[self._order]
        instants = problem.instants
        # Rows as fractional numbers of points and instants
        along = np.interp(x, points, np.arange(len(points)))
        over_time = np.interp(t, instants, np.arange(len(instants)))
        at = np.array([along, over_time])
        counts = _covers(points, x) & _covers(instants, t)
        # Where a support shares a force, friction at a point is arbitrary.
        if self._places is not None:
            unknown = ~determinate_forces(problem)[self._places][self._order]
            counts &= _interpolated(unknown.astype(float), at) == 0.0
        self.counted = int(counts.sum())
        self._at = at[:, counts]
        self._values = results.values[counts]
        if self.counted >= FEWEST:
            self._weights = weights_of(x[counts], t[counts])

    def of(self, fields: Fields) -> float:
        """Distance to an iterate or to a reference; NaN of fewer than `FEWEST` rows."""
        if self.counted < FEWEST:
            return float("nan")
        if self._places is None:
            field = self._problem.absolute(fields.displacement)
        else:
            field = fields.contact_force[self._places] / self._sizes
        ours = _interpolated(field[self._order], self._at)
        # Relative to the other results, or to ours where those vanish everywhere.
        size = self._norm(self._values) or self._norm(ours) or 1.0
        return self._norm(ours - self._values) / size

    def figures(self, fields: Fields) -> dict[str, Any]:
        """Quantity, interface, distance, and numbers of rows, for scripts."""
        interface = None
        if self._places is not None:
            interface = self.interface
        return {
            "quantity": self.results.quantity,
            "interface": interface,
            "distance": self.of(fields),
            "rows": len(self.results.times),
            "rows_compared": self.counted,
        }

    def _norm(self, values: Array) -> float:
        """Norm of values of the rows that are compared, shape (n_counted,)."""
        return float(np.sqrt(self._weights @ values**2))


def weights_of(positions: Array, times: Array) -> Array:
    """Weight of every row, as the module's docstring defines it, shape (n_rows,).

    Positions, m, and times, s, have the same shape.
    """
    # Rows by time, and by position within an instant.
    order = np.lexsort((positions, times))
    instants, number = np.unique(times[order], return_inverse=True)
    halves = _halves(positions[order], np.diff(number) == 0)
    lengths = np.bincount(number, halves, len(instants))
    # All points of an instant may be one.
    halves[lengths[number] == 0.0] = 1.0
    lengths = np.bincount(number, halves, len(instants))
    if len(instants) > 1:
        over_time = _halves(instants)
    else:
        over_time = np.ones(len(instants))
    weights = np.empty(len(times))
    weights[order] = over_time[number] * halves / lengths[number]
    return weights


def _covers(grid: Array, places: Array) -> Flags:
    """Mask of the positions, (n,), between the ends of a grid, (n_grid,)."""
    low = float(grid.min())
    high = float(grid.max())
    edge = EDGE * (high - low)
    return np.asarray((places >= low - edge) & (places <= high + edge))


def _interpolated(field: Array, at: Array) -> Array:
    """Interpolate a field, (n_points, n_instants), at fractional indices, (2, n)."""
    return np.asarray(scipy.ndimage.map_coordinates(field, at, order=1, mode="nearest"))


def _halves(places: Array, joined: Flags | bool = True) -> Array:
    """Half of the distance between both neighbours, shape (n,).

    Parameters
    ----------
    places
        Places, shape (n,), which rise where they are joined.
    joined
        Whether a place and the next one are neighbours, shape (n - 1,).
    """
    return np.convolve(np.diff(places) * joined, [0.5, 0.5])
