"""A measured loop, force over displacement, as tables have it, beside a run, and their distance.

A run has one of both given and finds the other: the force is compared where the
displacement is given, and else the displacement. With the difference d_j to row j of
the table,

    distance = sqrt(mean of d_j^2) / (largest - smallest measured value),

where each row counts alike. Rows that have a time are compared at that time, if it is
in the run, whose loop is linear between its instants.

Rows without times are matched along the path. What is given, in the table and in the
run, is cut into branches at its reversals (swings of less than 5 % of the range are
none). The branches of the table are laid on as many branches of the run that go the
same ways, so that their ends fit best; of equals on the last, which are those of a
steady loop. In a branch rows are matched by the value of what is given; beyond its ends
they are compared with these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.discrete.structure import Axes, Loop, LoopFields
from solver.files.columns import KINDS, TableColumn, unit_doubt
from solver.files.tables import Table
from solver.settings.definitions import SettingError
from solver.study.comparison import FEWEST, in_si
from solver.study.quantities.cycles import SMALLEST_SWING, turning_points

CAN = "CSV whose head names displacement and force of every row, and their time if it is known"
ALIKE = 0.02
"""Share of the range by which the ends of branches may differ, each, that fit equally
well."""


@dataclass(frozen=True, eq=False)
class MeasuredLoop:
    """A measured loop, in SI and the units of the loop of its scene, and what was read of the file.

    Displacement, force and times, s, have shape (n_rows,); without times rows are
    matched along the path. Of displacement and force `bare` has the names where the
    file gives no unit, else "".
    """

    displacement: Array
    force: Array
    times: Array | None
    units: tuple[str, str]
    source: str
    message: str
    bare: tuple[str, str] = ("", "")

    def unit_doubts(self, displacement: Array, force: Array) -> list[str]:
        """Sentences where it is some thousand times off a run's loop, (n_instants,) each.

        Only what has no unit in the file is doubted.
        """
        pairs = ((self.displacement, displacement), (self.force, force))
        doubts = [
            unit_doubt(name, unit, float(np.ptp(own)), float(np.ptp(run)), "the run")
            for (own, run), name, unit in zip(pairs, self.bare, self.units, strict=True)
            if name
        ]
        return [doubt for doubt in doubts if doubt]

    def csv(self) -> str:
        """Table of it, as `read_loop` takes it."""
        if self.times is None:
            times = {}
        else:
            times = {"time [s]": self.times}
        heads = [f"displacement [{self.units[0]}]", f"force [{self.units[1]}]"]
        return csv_of({**times, heads[0]: self.displacement, heads[1]: self.force})


def csv_of(columns: Mapping[str, Array]) -> str:
    """Columns of numbers by their heads as CSV."""
    rows = (
        ",".join(f"{value:.10g}" for value in row)
        for row in zip(*columns.values(), strict=True)
    )
    return "\n".join([",".join(columns), *rows, ""])


def columns_of(
    table: Table, axes: Axes
) -> tuple[TableColumn | None, TableColumn, TableColumn]:
    """Columns of time, where there is one, displacement and force that the head has to name."""
    columns = table.columns
    if not any(column.is_known for column in columns):
        raise table.refuse(
            "name its columns in the first line, as in displacement,force"
        )
    time = table.find(columns, {"time"}, "s")
    rest = [column for column in columns if column is not time]
    both = []
    for title, unit in axes:
        remedy = f"name that of {title}, {unit}"
        kinds = KINDS.get(unit, {unit})
        both.append(table.choose(rest, kinds, unit, remedy=remedy))
        rest.remove(both[-1])
    return time, both[0], both[1]


def loop_in(table: Table, axes: Axes) -> MeasuredLoop:
    """The loop in a table, for a loop of these titles and units.

    Raises
    ------
    SettingError
        For a table without these columns or in another unit, with too many rows or too
        few, with words or infinite numbers in them, or values that are all the same.
    """
    table = table.given_as("the measured loop", CAN)
    chosen = columns_of(table, axes)
    roles = zip(chosen, (("time", "s"), *axes), strict=True)
    used = {
        name: (column, unit) for column, (name, unit) in roles if column is not None
    }
    reading = in_si(table, used)
    *times, displacement, force = reading.numbers
    if len(force) < FEWEST:
        raise table.refuse(f"it has {len(force)} rows: give at least {FEWEST}")
    for values, (title, _) in zip((displacement, force), axes, strict=True):
        if np.ptp(values) == 0.0:
            raise table.refuse(f"{title} has the same value in all rows")
    message = reading.message
    if not times:
        message += "; matched along the path, as no time is given"
    _, across, up = chosen
    return MeasuredLoop(
        displacement=displacement,
        force=force,
        times=times[0] if times else None,
        units=(axes[0][1], axes[1][1]),
        source=table.source,
        message=message,
        bare=(_bare(across), _bare(up)),
    )


def _bare(column: TableColumn) -> str:
    """Name of a column without a unit; empty of one with a unit."""
    return "" if column.unit else column.name


class LoopComparison:
    """A measured loop beside the runs of one problem.

    Where `finds_force`, displacement is given and force is compared, else the other way
    round; `quantity` and `given` are their titles. The rows in `counted`, (n_rows,),
    are compared.
    """

    def __init__(self, measured: MeasuredLoop, loop: Loop, problem: Problem) -> None:
        self.measured = measured
        self.loop = loop
        self._instants = problem.instants
        (across, x), (up, y) = loop.axes
        if measured.units != (x, y):
            can = f"a loop of {across} ({x}) and {up} ({y})"
            raise self._refusal(can, "load one of this scene")
        self.finds_force = loop.finds_force(problem)
        if self.finds_force:
            self.given = across
            self.quantity = up
        else:
            self.given = up
            self.quantity = across
        self.counted = np.ones(len(measured.force), dtype=bool)
        if measured.times is not None:
            first, last = self._instants[[0, -1]]
            self.counted = (measured.times >= min(first, 0.0)) & (
                measured.times <= last
            )
            if self.counted.sum() < FEWEST:
                ends = f"{measured.times.min():g} s to {measured.times.max():g} s"
                remedy = (
                    "name the unit of its times (time [ms]), shift or scale them, set duration, "
                    "or leave the column of time out"
                )
                can = f"at least {FEWEST} rows in the run, which lasts {last:g} s"
                raise self._refusal(can, f"it goes from {ends}: {remedy}")
        pair = measured.displacement[self.counted], measured.force[self.counted]
        if self.finds_force:
            self._given, self._found = pair
        else:
            self._given, self._found = pair[::-1]
        self._sizes = [
            float(np.ptp(values)) or 1.0 for values in (self._given, self._found)
        ]

    def _refusal(self, can: str, remedy: str) -> SettingError:
        return SettingError("the measured loop", self.measured.source, can, remedy)

    def drive_messages(self, distance: float) -> list[str]:
        """A sentence where what is given is farther from the measured than branches that fit."""
        far = f"{100.0 * distance:.2g} % of its range from the measured"
        message = f"{self.given} of the run is {far}: give the run the measured path"
        if distance > ALIKE:
            return [message]
        return []

    def of(self, fields: LoopFields) -> float:
        """Distance to an iterate, or to a reference."""
        return float(self.figures(fields)["distance"])

    def figures(self, fields: LoopFields) -> dict[str, Any]:
        """What is compared and given, their distances, and numbers of rows, for scripts."""
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
        """What is found, and what is given, of a run less the rows that are compared, (n_counted,).

        Both are shares of the measured range. A table is refused whose branches are
        none of the run's.
        """
        if self.finds_force:
            given = displacement
            found = force
        else:
            given = force
            found = displacement
        if self.measured.times is not None:
            instants = np.arange(len(self._instants))
            places = np.interp(
                self.measured.times[self.counted], self._instants, instants
            )
        else:
            places = self._along_path(given)
        values = (
            np.interp(places, np.arange(len(line)), line) for line in (found, given)
        )
        pairs = zip(values, (self._found, self._given), self._sizes[::-1], strict=True)
        own, drive = ((value - measured) / size for value, measured, size in pairs)
        return own, drive

    def _along_path(self, given: Array) -> Array:
        """Places of the rows among the instants of a run, (n_counted,), fractions between them."""
        rows = branches(self._given)
        instants = branches(given)
        ways = np.sign(np.diff(self._given[rows]))
        own = np.sign(np.diff(given[instants]))
        misfits = {
            first: float(
                np.abs(
                    given[instants[first : first + len(rows)]] - self._given[rows]
                ).sum()
            )
            for first in range(len(own) - len(ways) + 1)
            if np.array_equal(own[first : first + len(ways)], ways)
        }
        if not misfits:
            counts = f"{len(own)} times, and the measured loop {len(ways)} times"
            remedy = "give the run such a load path, or every row its time"
            can = "rows along a path that the run goes, too"
            raise self._refusal(
                can, f"{self.given} of the run goes one way {counts}: {remedy}"
            )
        enough = min(misfits.values()) + ALIKE * self._sizes[0] * len(rows)
        first = max(place for place, misfit in misfits.items() if misfit <= enough)
        places = np.empty(len(self._given))
        parts = pairwise(instants[first : first + len(rows)])
        for (begin, end), (start, stop), way in zip(
            pairwise(rows), parts, ways, strict=True
        ):
            line = np.maximum.accumulate(way * given[start : stop + 1])
            inside = slice(begin + (begin > 0), end + 1)
            at = np.arange(start, stop + 1)
            places[inside] = np.interp(way * self._given[inside], line, at)
        return places


def branches(path: Array) -> Indices:
    """Where a path begins, turns back, and ends."""
    last = len(path) - 1
    ends = [0, *(place for place in turning_points(path) if 0 < place < last), last]
    if len(ends) > 2 and abs(path[ends[-2]] - path[last]) <= SMALLEST_SWING * np.ptp(
        path
    ):
        ends.pop(-2)
    return np.array(ends)


def rms(values: Sequence[float] | Array) -> float:
    """Root of the mean of squares."""
    return float(np.sqrt(np.mean(np.square(values))))
