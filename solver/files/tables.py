"""Tables as spreadsheets, measuring machines and programs write them: bytes become named columns.

A file is read once, into a `Table`; whatever reads a path, a loop or results takes
that.

**Text** is UTF-8, UTF-16, or else cp1252. A workbook (.xlsx) is read with openpyxl: its
first sheet, with the values that formulas had when it was saved.

**How it is read**, where it may be read in two ways:

=========================== ===================================================================
What stands there           What it is
=========================== ===================================================================
tab, `;`, `,`, blanks       The first of these under which most cells of most lines are numbers
                            stands between columns. Two blanks or more do, and one does
                            not, only where all lines then have equally many columns.
`0,5` or `1.234,5`          A decimal comma, if no other cell has a decimal point (`0.5`); both in
                            one table are refused, with the line of the rarer.
`1,234` beside `0.5`        1234: a comma before three digits stands between thousands where
                            others have decimal points; a point does beside decimal
                            commas.
`1,234` beside `1,5`        1.234, as decimals have commas.
`1,234` alone               Between semicolons a decimal comma, as that is why there are
                            semicolons; otherwise refused, with its line. Between
                            columns without quotes a comma is what divides them.
`1.234` alone               1.234.
`1 234`, `1'234`            1234: a blank (also a narrow or no-break one) or an apostrophe within
                            groups of three, where blanks do not divide columns.
`1.5D-03`, `1.5-103`, `−5`  Exponents of Fortran, and a printed minus.
`NaN`, `n/a`, `-`, empty    A gap. Rows that lack a number in a column that is read are left out
                            and counted. Between blanks a row with too few cells is all
                            gaps, as nothing says which lacks.
`inf`, `1e999`, words       No number: refused with the line, in a column that is read.
=========================== ===================================================================

**Comments** begin with `#`, `%`, `//`, `!`, or `;` where that divides no columns;
behind numbers they are cut off. Empty lines and rules (`-----`) are passed over.

**Rows** are lines of two numbers or more. Where lines of words part them, the table
that has most rows is taken, and others (results before the data) are passed over; of
equals both are refused. Lines of words that repeat the head, or are titles of pages,
part nothing. Words behind the last column are remarks, and a column of words is passed
over as any other.

**The head** is the lowest line of words above the rows that has a name for each column
and names a quantity; a line of units may stand below or above it, and text between. A
row may have a label.

**A unit** stands behind the name in brackets, a slash, "in", a comma, blank or
underscore: `Kraft [kN]`, `time/s`, `Kraft in kN`, `force, kN`, `force kN`, `force_kN`.
A bare name has the unit of what it is read for. A unit that is unknown, or measures
something else, is refused.

**A column is chosen** by its name: that of the setting, else a word of `columns.WORDS`
for its quantity, else a name that ends with one (`axial force`, `Prüfzeit`), else, of
names that say nothing, by its unit; a position stands in for a displacement. Others are
passed over. Only where no head says anything, the first two are taken as they stand.
What was understood is said: every table that is read has a message.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from solver.arrays import Array, Flags, Indices, read_only
from solver.files.columns import TableColumn, examples_of, size_in
from solver.files.disk import LARGEST, TOO_LARGE, Refuse
from solver.files.numerals import SIGNS, decimal_signs, is_gap, number
from solver.files.table_lines import (
    Block,
    Line,
    block_of,
    fitted,
    headed,
    lines_of_text,
)
from solver.files.workbooks import is_archive, lines_of_workbook
from solver.settings.definitions import SettingError

STANDS_IN = {"displacement": "position"}
"""Quantities by those that may stand in for them, where no column names them."""
MOST_SAID = 5
"""Lines that are named at most."""


@dataclass(frozen=True, eq=False)
class Reading:
    """Numbers that were read of a table, in the units that were asked for.

    Attributes
    ----------
    numbers
        Of every column, shape (n_columns, n_rows), finite.
    lines
        Of the file, from 1, shape (n_rows,).
    message
        Columns, units, rows, and what was passed over.
    """

    numbers: Array
    lines: Indices
    message: str


@dataclass(frozen=True, eq=False)
class Table:
    """A table as it was read.

    Attributes
    ----------
    columns
        Names and units of the columns.
    cells
        Texts of every row.
    numbers
        In the units of the columns, shape (n_columns, n_rows); NaN where a cell has
        none.
    lines
        Of the file, from 1, shape (n_rows,).
    remarks
        How it was read, where it might have been otherwise.
    source
        Name of the file, or of what else it came from.
    refuse
        Makes a refusal out of what is to be done.
    """

    columns: tuple[TableColumn, ...]
    cells: tuple[tuple[str, ...], ...]
    numbers: Array
    lines: Indices
    remarks: tuple[str, ...]
    source: str
    refuse: Refuse

    def given_as(self, name: str, allowed: str) -> Table:
        """The table as what it is given for, which its refusals name."""
        return replace(self, refuse=partial(SettingError, name, self.source, allowed))

    def with_columns(self, columns: Sequence[TableColumn]) -> Table:
        """The table under other names; one more than it has is that of the rows' numbers from 0."""
        named = replace(self, columns=tuple(columns))
        if len(columns) == len(self.columns):
            return named
        count = np.arange(len(self.lines), dtype=float)
        cells = tuple((*row, str(place)) for place, row in enumerate(self.cells))
        return replace(named, cells=cells, numbers=np.vstack([self.numbers, count]))

    def find(
        self,
        columns: Sequence[TableColumn],
        kinds: Collection[str],
        unit: str = "",
        key: str = "",
    ) -> TableColumn | None:
        """Column of a quantity among some, as described above; refuse several as likely."""
        rules: list[Callable[[TableColumn], object]] = [
            lambda column: key and column.key == key,
            lambda column: (
                column.quantities[1] and column.quantities[0].intersection(kinds)
            ),
            lambda column: column.quantities[0].intersection(kinds),
            lambda column: (
                unit
                and column.unit
                and not column.quantities[0]
                and size_in(column.unit, unit)
            ),
        ]
        for rule in rules:
            likely = [column for column in columns if rule(column)]
            # A column of words, as of the time of day, is not meant where another may
            # be.
            likely = [
                column for column in likely if self._has_numbers(column)
            ] or likely
            if len(likely) > 1:
                names = " and ".join(
                    repr(column.name or column.unit) for column in likely
                )
                raise self.refuse(
                    f"{names} may both be meant: rename all columns but one"
                )
            if likely:
                return likely[0]
        return None

    def _has_numbers(self, column: TableColumn) -> bool:
        return bool(np.isfinite(self.numbers[column.place]).any())

    def choose(
        self,
        columns: Sequence[TableColumn],
        kinds: Collection[str],
        unit: str,
        key: str = "",
        remedy: str = "add that column",
    ) -> TableColumn:
        """Column of a quantity among some, as described above; refuse a head that names none."""
        column = self.find(columns, kinds, unit, key)
        if column is None:
            column = self.find(
                columns, {STANDS_IN[kind] for kind in kinds if kind in STANDS_IN}
            )
        if column is None:
            wanted = f"{' or '.join(sorted(kinds))} in {examples_of(unit)}"
            has = ", ".join(repr(column.name) for column in self.columns)
            raise self.refuse(f"its head names no {wanted} (it has {has}): {remedy}")
        return column

    def read(
        self,
        columns: Sequence[TableColumn],
        names: Sequence[str],
        units: Sequence[str],
    ) -> Reading:
        """Numbers of some columns in some units, of the rows that have all of them.

        Names are those of columns that lack one. A unit of another quantity is refused,
        and a cell that is neither a finite number nor a gap, with its line.
        """
        sizes = [
            column.size(unit, self.refuse)
            for column, unit in zip(columns, units, strict=True)
        ]
        places = [column.place for column in columns]
        has_all = self._rows_with(columns)
        numbers = self.numbers[places][:, has_all]
        heads = zip(columns, names, units, strict=True)
        parts = ", ".join(column.message(name, unit) for column, name, unit in heads)
        unit = columns[-1].unit or units[-1]
        low = numbers[-1].min()
        high = numbers[-1].max()
        ends = f"from {low:g} to {high:g}{'' if unit in ('', '-', '1') else f' {unit}'}"
        notes = [f"{parts}, {numbers.shape[1]} points, {ends}"]
        others = [repr(column.name) for column in self.columns if column not in columns]
        if others:
            notes.append(f"passed over: {', '.join(others)}")
        if not has_all.all():
            count = int((~has_all).sum())
            if count == 1:
                rows = "1 row"
            else:
                rows = f"{count} rows"
            notes.append(
                f"left out {rows} without a number ({_named(self.lines[~has_all])})"
            )
        message = "; ".join([*notes, *self.remarks])
        return Reading(numbers * np.array(sizes)[:, None], self.lines[has_all], message)

    def _rows_with(self, columns: Sequence[TableColumn]) -> Flags:
        """Rows with a number in all of some columns, (n_rows,); refuse what is no number."""
        numbers = self.numbers[[column.place for column in columns]]
        has_all = np.asarray(np.isfinite(numbers).all(axis=0))
        for row in np.flatnonzero(~has_all):
            for column, value in zip(columns, numbers[:, row], strict=True):
                text = self.cells[row][column.place]
                if np.isfinite(value) or is_gap(text):
                    continue
                line = self.lines[row]
                if not column.name:
                    shown = ",".join(self.cells[row])
                    count = len(columns)
                    raise self.refuse(
                        f"line {line} is {shown!r}, not {count} finite numbers"
                    )
                if np.isnan(value):
                    remedy = "give a number"
                else:
                    remedy = "leave such rows out"
                raise self.refuse(
                    f"line {line} has {text!r} as {column.name}: {remedy}"
                )
        if not has_all.any():
            raise self.refuse("none of its rows has a number in each of these columns")
        return has_all


def _named(lines: Sequence[int] | Indices) -> str:
    """The first few of some lines, as `lines 3, 8, 9`."""
    said = ", ".join(str(line) for line in lines[:MOST_SAID])
    more = ", ..." if len(lines) > MOST_SAID else ""
    return f"{'line' if len(lines) == 1 else 'lines'} {said}{more}"


def read_table(data: bytes | str, source: str, name: str, allowed: str) -> Table:
    """Table of a file, or of text, as described above, which refusals call by a name.

    What is too large, no text or without numbers is refused, and lines that do not fit
    the head.
    """
    refuse = partial(SettingError, name, source, allowed)
    if len(data) > LARGEST:
        raise refuse(TOO_LARGE)
    remarks: list[str] = []
    if isinstance(data, bytes) and is_archive(data):
        separator = "\t"
        lines, sheet = lines_of_workbook(data, refuse)
        remarks.append(sheet)
    else:
        separator, lines = lines_of_text(data, refuse)
    block, others = block_of(lines, separator, refuse)
    columns = headed(block, separator, refuse)
    cells = fitted(block, len(columns), separator, refuse)
    places = np.array([row.number for row in block.rows])
    places.flags.writeable = False
    decimal, thousands = _notation(block.rows, separator, refuse)
    numbers = np.array([[number(cell, decimal) for cell in row] for row in cells]).T
    return Table(
        columns=tuple(columns),
        cells=tuple(map(tuple, cells)),
        numbers=read_only(numbers),
        lines=places,
        remarks=(*remarks, *thousands, *_interruptions(block), *others),
        source=source,
        refuse=refuse,
    )


def _interruptions(block: Block) -> list[str]:
    """Words on what stands between rows."""
    remarks = []
    if block.repeats:
        if block.repeats == 1:
            times = "once"
        else:
            times = f"{block.repeats} times"
        remarks.append(f"its head comes again {times}")
    if block.passed:
        remarks.append(f"passed over {_named([line.number for line in block.passed])}")
    return remarks


def _notation(
    rows: Sequence[Line], separator: str, refuse: Refuse
) -> tuple[str, list[str]]:
    """The decimal sign of a table, and words on signs between thousands, as described above."""
    if not any(
        "," in cell or cell.count(".") > 1 for row in rows for cell in row.cells
    ):
        return ".", []
    # Cells that are numbers under one decimal sign alone, and under both, by line.
    sure: dict[str, list[tuple[int, str]]] = {sign: [] for sign in SIGNS}
    unsure: dict[str, list[tuple[int, str]]] = {sign: [] for sign in SIGNS}
    for row in rows:
        for cell in row.cells:
            if "," in cell or "." in cell:
                signs = decimal_signs(cell)
            else:
                signs = ""
            if len(signs) == 1:
                sure[signs].append((row.number, cell))
            elif signs:
                unsure["," if "," in cell else "."].append((row.number, cell))
    _check_alike(sure, refuse)
    if not sure["."] and not sure[","] and unsure[","]:
        if unsure["."] or separator != ";":
            line, cell = unsure[","][0]
            decimals = cell.replace(",", ".")
            raise refuse(
                f"line {line} has {cell!r}, which may be {decimals} or "
                f"{cell.replace(',', '')}: write decimals with a point, and thousands "
                "without a sign"
            )
        return ",", []
    decimal = "," if sure[","] else "."
    other = "." if decimal == "," else ","
    has_thousands = bool(unsure[other]) or any(
        other in cell for _, cell in sure[decimal]
    )
    names = {",": "commas", ".": "points"}
    return decimal, [f"thousands with {names[other]}"] * has_thousands


def _check_alike(sure: dict[str, list[tuple[int, str]]], refuse: Refuse) -> None:
    """Refuse decimal points and commas in one table, with the line of the rarer."""
    if not sure["."] or not sure[","]:
        return
    rare = "," if len(sure[","]) <= len(sure["."]) else "."
    line, cell = sure[rare][0]
    names = {",": "comma", ".": "point"}
    common = "." if rare == "," else ","
    raise refuse(
        f"line {line} has {cell!r}, with a decimal {names[rare]} where others have a "
        f"{names[common]}: write all of them alike, and thousands without a sign"
    )
