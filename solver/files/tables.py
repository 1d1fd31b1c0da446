"""Tables of spreadsheets, measuring machines, programs: from bytes to named columns.

A file is read once, into a `Table`, from which paths, loops and results are taken.

**Text** is UTF-8, UTF-16, or else cp1252. A workbook (.xlsx) is read with openpyxl: its
first sheet, with the values that formulas had when it was saved.

**How it is read**, where it may be read in two ways:

=========================== ============================================================
Text                        Meaning
=========================== ============================================================
tab, `;`, `,`, `|`, blanks  The first of these under which most cells of most lines are
                            numbers divides columns. Two blanks or more do, and one does
                            not, only where all lines then have equally many columns.
`0,5` or `1.234,5`          A decimal comma, if no other cell has a decimal point
                            (`0.5`); both in one table are refused, with the line of the
                            rarer.
`1,234` beside `0.5`        1234: a comma before three digits stands between thousands
                            where others have decimal points; a point does beside
                            decimal commas.
`1,234` beside `1,5`        1.234, as decimals have commas.
`1,234` alone               Between semicolons a decimal comma, as that is why there are
                            semicolons; otherwise refused, with its line. Between
                            columns without quotes a comma divides columns.
`1.234` alone               1.234.
`1 234`, `1'234`            1234: a blank (also a narrow or no-break one) or an
                            apostrophe within groups of three, where blanks do not
                            divide columns.
`1.5D-03`, `1.5-103`, `−5`  Exponents of Fortran, and a printed minus.
`NaN`, `n/a`, `-`, empty    A gap. Rows that lack a number in a column that is read are
                            left out and counted. Between blanks a row with too few
                            cells is all gaps, as nothing says which cell lacks.
`inf`, `1e999`, words       No number: refused with the line, in a column that is read.
=========================== ============================================================

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
passed over. Only where no head names anything, the first two are taken as they stand.
Every table that is read has a message on how it was understood.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from solver.arrays import Array, Flags, Indices, read_only
from solver.files.amounts import Unit
from solver.files.columns import TableColumn
from solver.files.decimal_signs import notation_of
from solver.files.disk import LARGEST, too_large
from solver.files.numerals import is_gap, number
from solver.files.table_blocks import Block, block_of, fitted, headed
from solver.files.table_lines import lines_of_text
from solver.files.units import examples_of, size_in
from solver.files.workbooks import is_archive, lines_of_workbook
from solver.settings.values import Refuse, SettingError

STANDS_IN = {"displacement": "position"}
"""Quantities that may stand in for others that no column names."""
DIGITS = 6
"""Digits of the least and the largest value of a column in a message."""
MOST_SAID = 5
"""Largest number of lines that a message names."""


@dataclass(frozen=True, eq=False)
class Reading:
    """Numbers of some columns of a table, in given units.

    Attributes
    ----------
    numbers
        Numbers of every column, shape (n_columns, n_rows), finite.
    lines
        Line of the file of each row, from 1, shape (n_rows,).
    message
        Words on columns, units and rows, and on columns and rows passed over.
    """

    numbers: Array
    lines: Indices
    message: str


@dataclass(frozen=True, eq=False)
class Table:
    """A table of named columns, as read from a file.

    Attributes
    ----------
    columns
        Names and units of the columns.
    cells
        Texts of every row.
    numbers
        Numbers in the units of the columns, shape (n_columns, n_rows); NaN for a cell
        without a number.
    lines
        Line of the file of each row, from 1, shape (n_rows,).
    remarks
        Words on how the table was read, where there was a choice.
    source
        Name of the file or of another source.
    refuse
        Function from a remedy to a refusal.
    """

    columns: tuple[TableColumn, ...]
    cells: tuple[tuple[str, ...], ...]
    numbers: Array
    lines: Indices
    remarks: tuple[str, ...]
    source: str
    refuse: Refuse

    def given_as(self, name: str, allowed: str) -> Table:
        """Copy of the table whose refusals have the name of a setting or an option."""
        return replace(self, refuse=partial(SettingError, name, self.source, allowed))

    def with_columns(self, columns: Sequence[TableColumn]) -> Table:
        """Copy of the table with other columns; an extra one is the row's index."""
        named = replace(self, columns=tuple(columns))
        if len(columns) == len(self.columns):
            return named
        count = np.arange(len(self.lines), dtype=float)
        cells = tuple((*row, str(number)) for number, row in enumerate(self.cells))
        return replace(named, cells=cells, numbers=np.vstack([self.numbers, count]))

    def find(
        self,
        columns: Sequence[TableColumn],
        kinds: Collection[str],
        unit: str = "",
        key: str = "",
    ) -> TableColumn | None:
        """Find the column of a quantity by the rules above; refuse equally likely ones.

        Parameters
        ----------
        columns
            Columns to choose from.
        kinds
            Quantities that the column may have.
        unit
            Unit of the quantity, for columns whose names say nothing.
        key
            Name of the setting that the column is for.

        Returns
        -------
        The column; None if there is no likely one.
        """

        def has_key(column: TableColumn) -> bool:
            return bool(key) and column.key == key

        def is_word_for_it(column: TableColumn) -> bool:
            quantities, is_whole = column.quantities
            return is_whole and bool(quantities.intersection(kinds))

        def ends_with_it(column: TableColumn) -> bool:
            return bool(column.quantities[0].intersection(kinds))

        def has_its_unit(column: TableColumn) -> bool:
            if not unit or not column.unit or column.quantities[0]:
                return False
            return bool(size_in(column.unit, unit))

        # A stricter rule comes first: what merely ends with a word counts only where no
        # column is named so outright.
        for rule in (has_key, is_word_for_it, ends_with_it, has_its_unit):
            likely = [column for column in columns if rule(column)]
            # A column of words, such as the time of day, yields to one of numbers.
            with_numbers = [column for column in likely if self._has_numbers(column)]
            if with_numbers:
                likely = with_numbers
            if len(likely) > 1:
                names = [repr(column.name or column.unit) for column in likely]
                raise self.refuse(
                    f"{' and '.join(names)} may both be meant: rename all columns but "
                    "one"
                )
            if likely:
                return likely[0]
        return None

    def _has_numbers(self, column: TableColumn) -> bool:
        """Check whether any cell of a column is a finite number."""
        return bool(np.isfinite(self.numbers[column.number]).any())

    def choose(
        self,
        columns: Sequence[TableColumn],
        kinds: Collection[str],
        unit: str,
        key: str = "",
        remedy: str = "add that column",
    ) -> TableColumn:
        """Find the column of a quantity, as `find`; refuse a table without one."""
        column = self.find(columns, kinds, unit, key)
        if column is None:
            others = {STANDS_IN[kind] for kind in kinds if kind in STANDS_IN}
            column = self.find(columns, others)
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

        A unit of another quantity is refused, and a cell that is neither a finite
        number nor a gap, with its line.

        Parameters
        ----------
        columns
            Columns of this table.
        names
            Names for columns without one.
        units
            Units of the result.
        """
        sizes = []
        for column, unit in zip(columns, units, strict=True):
            sizes.append(column.size(unit, self.refuse))
        # Only columns that are read count: a remark without a number costs no row.
        has_all = self._rows_with(columns)
        numbers = self.numbers[[column.number for column in columns]][:, has_all]
        notes = [self._note_on_points(columns, names, units, numbers)]
        others = [repr(column.name) for column in self.columns if column not in columns]
        if others:
            notes.append(f"passed over: {', '.join(others)}")
        left_out = self.lines[~has_all]
        if len(left_out):
            rows = n_rows(len(left_out))
            notes.append(f"left out {rows} without a number ({_named(left_out)})")
        message = "; ".join([*notes, *self.remarks])
        return Reading(numbers * np.array(sizes)[:, None], self.lines[has_all], message)

    def _note_on_points(
        self,
        columns: Sequence[TableColumn],
        names: Sequence[str],
        units: Sequence[str],
        numbers: Array,
    ) -> str:
        """Message on columns, number of points, and range of the last column.

        Numbers have the units of the columns, shape (n_columns, n_rows).
        """
        heads = []
        for column, name, unit in zip(columns, names, units, strict=True):
            heads.append(column.message(name, unit))
        # The range shows at a glance whether a unit is a thousand times off.
        written = Unit("")
        least = written(float(numbers[-1].min()), DIGITS)
        largest = written(float(numbers[-1].max()), DIGITS)
        ends = f"from {least} to {largest}"
        last_unit = columns[-1].unit or units[-1]
        if last_unit not in ("", "-", "1"):
            ends = f"{ends} {last_unit}"
        return f"{', '.join(heads)}, {numbers.shape[1]} points, {ends}"

    def _rows_with(self, columns: Sequence[TableColumn]) -> Flags:
        """Rows with a number in all of some columns, (n_rows,); refuse words."""
        numbers = self.numbers[[column.number for column in columns]]
        is_finite = np.isfinite(numbers)
        has_all = np.asarray(is_finite.all(axis=0))
        for row in np.flatnonzero(~has_all):
            for index, column in enumerate(columns):
                is_number = is_finite[index, row]
                if not is_number and not is_gap(self.cells[row][column.number]):
                    raise self._refused_cell(columns, column, int(row))
        if not has_all.any():
            raise self.refuse("none of its rows has a number in each of these columns")
        return has_all

    def _refused_cell(
        self, columns: Sequence[TableColumn], column: TableColumn, row: int
    ) -> SettingError:
        """Refusal of a cell that is neither a finite number nor a gap."""
        line = self.lines[row]
        if not column.name:
            shown = ",".join(self.cells[row])
            return self.refuse(
                f"line {line} is {shown!r}, not {len(columns)} finite numbers"
            )
        # An infinite number was read as one, and cannot be mended by a number.
        remedy = "leave such rows out"
        if np.isnan(self.numbers[column.number, row]):
            remedy = "give a number"
        text = self.cells[row][column.number]
        return self.refuse(f"line {line} has {text!r} as {column.name}: {remedy}")


def _named(lines: Sequence[int] | Indices) -> str:
    """Text of some lines, the first few by number, as `lines 3, 8, 9`."""
    if len(lines) == 1:
        return f"line {lines[0]}"
    numbers = ", ".join(str(line) for line in lines[:MOST_SAID])
    more = ", ..." if len(lines) > MOST_SAID else ""
    return f"lines {numbers}{more}"


def n_rows(count: int) -> str:
    """Text of a number of rows."""
    if count == 1:
        return "1 row"
    return f"{count} rows"


def read_table(
    data: bytes | str, source: str, name: str, allowed: str, largest: int = LARGEST
) -> Table:
    """Table of a file or a text, as described above.

    A file of more than `largest` bytes, no text or without numbers is refused, and so
    are lines that do not fit the head. Refusals have the name of a setting or an
    option, and words on what is allowed.
    """
    refuse = partial(SettingError, name, source, allowed)
    # Before anything is parsed, as that takes time and memory by its size.
    if len(data) > largest:
        raise refuse(too_large(largest))
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
    line_numbers = np.array([row.number for row in block.rows])
    line_numbers.flags.writeable = False
    # One sign for the whole table: a column of whole numbers says nothing by itself.
    decimal, thousands = notation_of(block.rows, separator, refuse)
    return Table(
        columns=tuple(columns),
        cells=tuple(map(tuple, cells)),
        numbers=read_only(_numbers_of(cells, decimal)),
        lines=line_numbers,
        remarks=(*remarks, *thousands, *_interruptions(block), *others),
        source=source,
        refuse=refuse,
    )


def _numbers_of(cells: list[list[str]], decimal: str) -> Array:
    """Numbers of rows of cells under a decimal sign, (n_columns, n_rows)."""
    rows = []
    for row in cells:
        rows.append([number(cell, decimal) for cell in row])
    return np.array(rows).T


def _interruptions(block: Block) -> list[str]:
    """Messages on ignored lines between rows."""
    remarks = []
    if block.repeats == 1:
        remarks.append("its head comes again once")
    elif block.repeats > 1:
        remarks.append(f"its head comes again {block.repeats} times")
    if block.passed:
        remarks.append(f"passed over {_named([line.number for line in block.passed])}")
    return remarks
