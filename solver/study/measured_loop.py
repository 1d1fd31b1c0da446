"""A measured loop, force over displacement, and its distance to a run.

A run has one of both prescribed and finds the other: the force is compared where the
displacement is prescribed, and otherwise the displacement. With the difference d_j to
row j of the table,

    distance = sqrt(mean of d_j^2) / (largest - smallest measured value),

where each row counts alike. Rows that have a time are compared at that time, if it is
in the run, whose loop is linear between its instants.

Rows without times are matched along the path. The prescribed quantity, in the table and
in the run, is cut into branches at its reversals (swings of less than 5 % of the range
are ignored). The branches of the table are laid on as many branches of the run with the
same directions, so that their ends fit best; of equal fits the last one counts, which
is that of a steady loop. In a branch rows are matched by the prescribed value; beyond
the ends of a branch they are compared with its ends.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.structure import Axes, Loop
from solver.files.columns import TableColumn, quantities_of_axis
from solver.files.tables import Table, n_rows
from solver.files.units import size_in, unit_doubt
from solver.settings.values import SettingError
from solver.study.comparison import FEWEST, check_count, in_si
from solver.study.quantities.cycles import SMALLEST_SWING, turning_points

CAN = (
    "CSV whose head names displacement and force of every row, "
    "and their time if it is known"
)
STILL = 1e-6
"""Share of its range up to which a displacement stands still from step to step."""
ALIKE = 0.02
"""Share of the range up to which misfits of the ends of branches count as equal."""


@dataclass(frozen=True, eq=False)
class MeasuredLoop:
    """A measured loop, in SI, as it was read from a file.

    Attributes
    ----------
    displacement, force
        Values of every row, shape (n_rows,), in the units of the loop of the scene.
    times
        Times of the rows, shape (n_rows,), s; without them rows are matched along the
        path.
    units
        Units of displacement and force.
    source, message
        Name of the file, and how its columns were understood.
    names
        Names of the columns of displacement and force in the file.
    given
        Units of displacement, force and time in the file, empty where it gives none.
    """

    displacement: Array
    force: Array
    times: Array | None
    units: tuple[str, str]
    source: str
    message: str
    names: tuple[str, str] = ("", "")
    given: tuple[str, str, str] = ("", "", "")

    def doubts(self, displacement: Array, force: Array) -> list[str]:
        """Sentences on a loop that is doubtful beside a run.

        Displacement and force of the run have shape (n_instants,), in the units of the
        loop. Columns without a unit in the file may seem thousand times too large or
        small; rows without times cannot be matched where one of both stands still.
        """
        found = self._unit_doubts(displacement, force)
        stands = np.abs(np.diff(displacement)) <= STILL * np.ptp(displacement)
        change = float(np.abs(np.diff(force))[stands].sum())
        if self.times is None and change > SMALLEST_SWING * np.ptp(force):
            found.append(
                "In the run the force changes while the displacement stands still: "
                "such rows need their times to be compared"
            )
        return found

    def _unit_doubts(self, displacement: Array, force: Array) -> list[str]:
        """Sentences on columns that seem thousand times too large or small for a run.

        Displacement and force of the run have shape (n_instants,).
        """
        measured = (self.displacement, self.force)
        of_run = (displacement, force)
        doubts = []
        for column, name in enumerate(self.names):
            if not name or self.given[column]:
                continue
            size = float(np.ptp(measured[column]))
            expected = float(np.ptp(of_run[column]))
            unit = self.units[column]
            doubts.append(unit_doubt(name, unit, size, expected, "the run"))
        return [doubt for doubt in doubts if doubt]

    def csv(self) -> str:
        """Table of the loop as CSV in the units of the file, which `loop_in` reads."""
        across, up = self.units
        own_across, own_up, own_time = self.given
        columns: dict[str, Array] = {}
        if self.times is not None:
            columns |= _in_own("time", self.times, "s", own_time)
        columns |= _in_own("displacement", self.displacement, across, own_across)
        columns |= _in_own("force", self.force, up, own_up)
        return csv_of(columns)


def _in_own(name: str, values: Array, si: str, own: str) -> dict[str, Array]:
    """A column by its head, from values in SI, (n_rows,), in a unit of its own if any.

    Plain numbers, of the units 1 and -, are as in SI.
    """
    size = None
    if own.strip("-1"):
        size = size_in(own, si)
    if size is None:
        return {f"{name} [{si}]": values}
    return {f"{name} [{own}]": values / size}


def csv_of(columns: Mapping[str, Array]) -> str:
    """Columns of numbers, shape (n_rows,) each, by their heads, as CSV."""
    text = io.StringIO()
    rows = np.column_stack([*columns.values()])
    np.savetxt(text, rows, "%.10g", ",", header=",".join(columns), comments="")
    return text.getvalue()


def columns_of(
    table: Table, axes: Axes
) -> tuple[TableColumn | None, TableColumn, TableColumn]:
    """Columns of time (or None), displacement and force, by the head of a table.

    A table that does not name displacement and force is refused.
    """
    columns = table.columns
    if not any(column.is_known for column in columns):
        raise table.refuse(
            "name its columns in the first line, as in displacement,force"
        )
    time = table.find(columns, {"time"}, "s")
    rest = [column for column in columns if column is not time]
    both = []
    # A column that is taken is not asked again: both could have the same word.
    for title, unit in axes:
        remedy = f"name that of {title}, {unit}"
        kinds = quantities_of_axis(title, unit)
        both.append(table.choose(rest, kinds, unit, remedy=remedy))
        rest.remove(both[-1])
    return time, both[0], both[1]


def loop_in(table: Table, axes: Axes) -> MeasuredLoop:
    """Read the loop in a table, for a loop of these titles and units.

    Raises
    ------
    SettingError
        For a table without these columns or in another unit, with too many rows or too
        few, with words or infinite numbers in them, or values that are all the same.
    """
    table = table.given_as("the measured loop", CAN)
    check_count(table)
    time, across, up = columns_of(table, axes)
    (across_title, across_unit), (up_title, up_unit) = axes
    used = {}
    if time is not None:
        used["time"] = (time, "s")
    used[across_title] = (across, across_unit)
    used[up_title] = (up, up_unit)
    reading = in_si(table, used)
    *times, displacement, force = reading.numbers
    _check_rows(table, across_title, displacement)
    _check_rows(table, up_title, force)
    message = reading.message
    if not times:
        message += "; matched along the path, as no time is given"
    return MeasuredLoop(
        displacement=displacement,
        force=force,
        times=times[0] if times else None,
        units=(across_unit, up_unit),
        source=table.source,
        message=message,
        names=(across.name, up.name),
        given=(across.unit, up.unit, time.unit if time else ""),
    )


def _check_rows(table: Table, title: str, values: Array) -> None:
    """Refuse values, (n_rows,), that are too few or all the same."""
    if len(values) < FEWEST:
        raise table.refuse(f"it has {n_rows(len(values))}: give at least {FEWEST}")
    if np.ptp(values) == 0.0:
        raise table.refuse(f"{title} has the same value in all rows")


class LoopComparison:
    """Comparison of a measured loop with the runs of one problem.

    Attributes
    ----------
    measured, loop
        The measured loop, and the loop that the scene shows.
    finds_force
        Whether displacement is prescribed and force is compared, or the other way
        round.
    given, quantity
        Titles of the prescribed and of the compared quantity.
    counted
        Whether a row is compared, shape (n_rows,).
    """

    def __init__(self, measured: MeasuredLoop, loop: Loop, problem: Problem) -> None:
        self.measured = measured
        self.loop = loop
        self._instants = problem.instants
        (across, x), (up, y) = loop.axes
        if measured.units != (x, y):
            can = f"a loop of {across} ({x}) and {up} ({y})"
            raise self._refusal(can, "load one of this scene")
        self.counted = self._in_the_run()
        displacement = measured.displacement[self.counted]
        force = measured.force[self.counted]
        self.finds_force = loop.finds_force(problem)
        if self.finds_force:
            self.given = across
            self.quantity = up
            self._given = displacement
            self._found = force
        else:
            self.given = up
            self.quantity = across
            self._given = force
            self._found = displacement
        self._given_range = float(np.ptp(self._given)) or 1.0
        self._found_range = float(np.ptp(self._found)) or 1.0

    def _in_the_run(self) -> Flags:
        """Rows during the run, shape (n_rows,); all rows without times.

        A table with too few of them is refused.
        """
        times = self.measured.times
        if times is None:
            return np.ones(len(self.measured.force), dtype=bool)
        first, last = self._instants[[0, -1]]
        # From rest at zero, also where the first instant comes later.
        counted = (times >= min(first, 0.0)) & (times <= last)
        if counted.sum() < FEWEST:
            ends = f"{times.min():g} s to {times.max():g} s"
            remedy = (
                "name the unit of its times (time [ms]), shift or scale them, "
                "set duration, or leave the column of time out"
            )
            can = f"at least {FEWEST} rows in the run, which lasts {last:g} s"
            raise self._refusal(can, f"it goes from {ends}: {remedy}")
        return np.asarray(counted)

    def _refusal(self, can: str, remedy: str) -> SettingError:
        return SettingError("the measured loop", self.measured.source, can, remedy)

    def drive_messages(self, distance: float) -> list[str]:
        """Sentence on a prescribed path that differs from the measured one."""
        far = f"{100.0 * distance:.2g} % of its range from the measured"
        message = f"{self.given} of the run is {far}: give the run the measured path"
        if distance > ALIKE:
            return [message]
        return []

    def of(self, fields: LoopFields) -> float:
        """Distance to an iterate or to a reference, as a share of the range."""
        return float(self.figures(fields)["distance"])

    def figures(self, fields: LoopFields) -> dict[str, Any]:
        """Quantities that are compared and prescribed, distances, rows, for scripts."""
        differences, drive = self.differences(*self.loop.along(fields))
        return {
            "quantity": self.quantity,
            "interface": None,
            "distance": rms(differences),
            "given": self.given,
            "distance_given": rms(drive),
            "rows": len(self.measured.force),
            "rows_compared": len(differences),
        }

    def differences(self, displacement: Array, force: Array) -> tuple[Array, Array]:
        """Differences of a run from the rows that are compared, (n_counted,) each.

        The first are those of the compared quantity, the second those of the prescribed
        one, as shares of the measured range. A table is refused whose branches are none
        of the run's.

        Parameters
        ----------
        displacement, force
            Loop of the run, shape (n_instants,), in its units.
        """
        if self.finds_force:
            given = displacement
            found = force
        else:
            given = force
            found = displacement
        instants = np.arange(len(self._instants))
        # With times rows are matched by these; without, along the path.
        if self.measured.times is not None:
            times = self.measured.times[self.counted]
            places = np.interp(times, self._instants, instants)
        else:
            places = self._along_path(given)
        difference = np.interp(places, instants, found) - self._found
        drive = np.interp(places, instants, given) - self._given
        return difference / self._found_range, drive / self._given_range

    def _along_path(self, given: Array) -> Array:
        """Fractional indices of the rows among the instants of a run, (n_counted,).

        `given` is the prescribed quantity of the run, shape (n_instants,).
        """
        rows = branches(self._given)
        instants = branches(given)
        # Falling branches are turned over, so that their values rise.
        directions = np.sign(np.diff(self._given[rows]))
        first = self._first_branch(given, instants, rows)
        places = np.empty(len(self._given))
        of_run = pairwise(instants[first : first + len(rows)])
        of_table = pairwise(rows)
        for (start, stop), (begin, end), direction in zip(
            of_run, of_table, directions, strict=True
        ):
            # `interp` needs values that rise.
            line = np.maximum.accumulate(direction * given[start : stop + 1])
            at = np.arange(start, stop + 1)
            inside = slice(begin + (begin > 0), end + 1)
            places[inside] = np.interp(direction * self._given[inside], line, at)
        return places

    def _first_branch(self, given: Array, instants: Indices, rows: Indices) -> int:
        """First branch of the run to compare with the branches of the table.

        Parameters
        ----------
        given
            Prescribed quantity of the run, shape (n_instants,).
        instants, rows
            Ends of the branches of the run and of the table.
        """
        ends = self._given[rows]
        directions = np.sign(np.diff(ends))
        count = len(directions)
        of_run = np.sign(np.diff(given[instants]))
        misfits = {}
        # Only branches of the same directions can be laid on each other.
        for first in range(len(of_run) - count + 1):
            if np.array_equal(of_run[first : first + count], directions):
                ends_of_run = given[instants[first : first + len(rows)]]
                misfits[first] = float(np.abs(ends_of_run - ends).sum())
        if not misfits:
            counts = f"{len(of_run)} times, and the measured loop {count} times"
            remedy = "give the run such a load path, or every row its time"
            can = "rows along a path that the run goes, too"
            text = f"{self.given} of the run goes one way {counts}: {remedy}"
            raise self._refusal(can, text)
        # Of equal fits the last is that of a steady loop.
        enough = min(misfits.values()) + ALIKE * self._given_range * len(rows)
        return max(first for first, misfit in misfits.items() if misfit <= enough)


def branches(path: Array) -> Indices:
    """Indices of start, reversals and end of a path, (n_instants,)."""
    last = len(path) - 1
    turns = [turn for turn in turning_points(path) if 0 < turn < last]
    # A last swing that is too small is no branch of its own.
    if turns and abs(path[turns[-1]] - path[last]) <= SMALLEST_SWING * np.ptp(path):
        turns.pop()
    return np.array([0, *turns, last])


def rms(values: Sequence[float] | Array) -> float:
    """Root of the mean of the squares of values, shape (n,)."""
    return float(np.sqrt(np.mean(np.square(values))))
