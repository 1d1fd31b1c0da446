"""Tables as spreadsheets, measuring machines and programs write them: bytes become named columns.

**Text** is UTF-8, UTF-16, or else cp1252. **Columns** stand apart by tabs, semicolons, commas or
blanks: whichever makes most cells of the last lines numbers. Beside all but commas, decimals may
have commas, in all of the table or nowhere. Empty lines, empty cells at the end of a line and
comments (`#`, `%`) are passed over.

**The head** is the last line that names a quantity among the lines of words, none of them a number,
right above the numbers; a line of units may follow. Lines above, such as `Rate (Hz),100`, are
passed over.

**A unit** stands behind the name in brackets, a slash, "in", a comma, blank or underscore:
`Kraft [kN]`, `time/s`, `Kraft in kN`, `force, kN`, `force kN`, `force_kN`. A bare name has the
unit of what it is read for. A unit that is unknown, or measures something else, is refused.

**A column is chosen** by its name: that of the setting, else a word of `solver.columns.WORDS` for
its quantity, else a name that ends with one (`axial force`, `Prüfzeit`), else, of names that say
nothing, by its unit. Others are passed over. Only where no head says anything, the first two are
taken as they stand. What was understood is said: every table that is read has a message.
"""

from __future__ import annotations

import codecs
import csv
import math
import re
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.columns import TableColumn, are_units, column_of, examples_of, is_spelt_as_unit, size_in
from solver.disk import LARGEST, TOO_LARGE, Refuse

Row = tuple[int, list[str]]
"""Number of a line, and its cells."""
SEPARATORS = "\t;, "
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+|\d+,\d+)(e[+-]?\d+)?|[+-]?(nan|inf|infinity)", re.I)


@dataclass(frozen=True)
class Table:
    """A table as it was read: columns, lines of numbers, and what makes its refusal."""

    columns: Sequence[TableColumn]
    rows: Sequence[Row]
    separator: str
    refuse: Refuse

    def find(
        self, columns: Sequence[TableColumn], kinds: Collection[str], unit: str = "", key: str = ""
    ) -> TableColumn | None:
        """Column of a quantity among some, as described above; refuse several as likely."""
        rules: list[Callable[[TableColumn], object]] = [
            lambda column: key and column.key == key,
            lambda column: column.quantities[1] and column.quantities[0].intersection(kinds),
            lambda column: column.quantities[0].intersection(kinds),
            lambda column: (
                unit and column.unit and not column.quantities[0] and size_in(column.unit, unit)
            ),
        ]
        for rule in rules:
            likely = [column for column in columns if rule(column)]
            if len(likely) > 1:
                names = " and ".join(repr(column.name or column.unit) for column in likely)
                raise self.refuse(f"{names} may both be meant: rename all columns but one")
            if likely:
                return likely[0]
        return None

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
            wanted = f"{' or '.join(sorted(kinds))} in {examples_of(unit)}"
            has = ", ".join(repr(column.name) for column in self.columns)
            raise self.refuse(f"its head names no {wanted} (it has {has}): {remedy}")
        return column

    def read(
        self,
        columns: Sequence[TableColumn],
        names: Sequence[str],
        units: Sequence[str],
    ) -> tuple[Array, str]:
        """Numbers of some columns in their units, (n_columns, n_rows), and what was understood.

        Names are those of columns that lack one. A unit of another quantity is refused, and a cell
        that is no finite number, with its line.
        """
        sizes = [
            column.size(unit, self.refuse) for column, unit in zip(columns, units, strict=True)
        ]
        numbers = self._numbers(columns)
        heads = zip(columns, names, units, strict=True)
        parts = ", ".join(column.message(name, unit) for column, name, unit in heads)
        unit = columns[-1].unit or units[-1]
        low, high = numbers[-1].min(), numbers[-1].max()
        ends = f"from {low:g} to {high:g}{'' if unit in ('', '-', '1') else f' {unit}'}"
        others = [repr(column.name) for column in self.columns if column not in columns]
        passed = f"; passed over: {', '.join(others)}" if others else ""
        message = f"{parts}, {numbers.shape[1]} points, {ends}{passed}"
        return numbers * np.array(sizes)[:, None], message

    def _numbers(self, columns: Sequence[TableColumn]) -> Array:
        places = [column.place for column in columns]
        cells = [[row[place] for place in places] for _, row in self.rows]
        if self.separator != "," and self._has_decimal_commas(cells):
            cells = [[text.replace(",", ".") for text in row] for row in cells]
        numbers = np.array([[_number(text) for text in texts] for texts in cells])
        wrong = np.argwhere(~np.isfinite(numbers))
        if len(wrong):
            row, place = wrong[0]
            (line, whole), text, name = self.rows[row], cells[row][place], columns[place].name
            if not name:
                shown = self.separator.join(whole)
                raise self.refuse(f"line {line} is {shown!r}, not {len(columns)} finite numbers")
            remedy = "leave such rows out" if _is_number(text) else "give a number"
            raise self.refuse(f"line {line} has {text!r} as {name}: {remedy}")
        return numbers.T

    def _has_decimal_commas(self, cells: list[list[str]]) -> bool:
        """Whether decimals have commas; of both signs the rarer one is refused, with its line."""
        signs = Counter(sign for row in cells for text in row for sign in ",." if sign in text)
        if len(signs) == 2:
            (common, _), (rare, _) = signs.most_common()
            every = zip(self.rows, cells, strict=True)
            line, text = next((n, text) for (n, _), row in every for text in row if rare in text)
            names = {",": "comma", ".": "point"}
            raise self.refuse(
                f"line {line} has {text!r}, with a decimal {names[rare]} where others have a "
                f"{names[common]}: write all of them alike, and thousands without a sign"
            )
        return "," in signs


def read_table(data: bytes | str, refuse: Refuse) -> Table:
    """Table as it is read, as described above.

    What is too large, no text or without numbers is refused, and lines that do not fit the head.
    """
    if len(data) > LARGEST:
        raise refuse(TOO_LARGE)
    lines = _text(data, refuse).splitlines()
    try:
        separator, rows = _rows(lines)
    except csv.Error as problem:
        raise refuse(str(problem)) from None
    heads, start = _heads(rows)
    if start == len(rows):
        raise refuse("it has no points: give lines of numbers")
    width = Counter(len(cells) for _, cells in rows[start:]).most_common(1)[0][0]
    columns = _columns(heads, lines, separator, width, refuse)
    for line, cells in rows[start:]:
        if len(cells) > len(columns):
            raise refuse(f"line {line} has {len(cells)} cells for {len(columns)} columns")
        cells += [""] * (len(columns) - len(cells))
    return Table(columns, rows[start:], separator, refuse)


def _text(data: bytes | str, refuse: Refuse) -> str:
    if isinstance(data, str):
        text = data
    else:
        is_wide = data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) or data[1:2] == b"\0"
        try:
            text = data.decode("utf-16" if is_wide else "utf-8")
        except UnicodeDecodeError:
            text = data.decode("cp1252", "replace")
    if "\0" in text:
        raise refuse("it is no text: save the table as CSV")
    return text.removeprefix("\ufeff")


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None


def _number(cell: str) -> float:
    """Number of a cell; NaN for what is none."""
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _rows(lines: Sequence[str]) -> tuple[str, list[Row]]:
    """Split lines at the separator under which most cells of the last ones are numbers."""
    last = [line for line in lines if line.strip()][-60:]

    def score(separator: str) -> int:
        rows = [_cells(line, separator) for line in last]
        counts = [(sum(map(_is_number, cells)), len(cells)) for cells in rows]
        return sum(2 * numbers - cells for numbers, cells in counts if numbers > 1)

    separator = max(SEPARATORS, key=score)
    rows = [(number, _cells(line, separator)) for number, line in enumerate(lines, start=1)]
    return separator, [(number, cells) for number, cells in rows if cells]


def _cells(line: str, separator: str) -> list[str]:
    """Cells of a line, without empty ones at its end; none of a comment with numbers."""
    text = line.strip(" ").lstrip("#%")
    table = [text.split()] if separator == " " else csv.reader([text], delimiter=separator)
    cells = [cell.strip() for cell in next(iter(table), [])]
    while cells and not cells[-1]:
        cells.pop()
    is_comment = text != line.strip(" ")
    return [] if is_comment and any(map(_is_number, cells)) else cells


def _heads(rows: Sequence[Row]) -> tuple[Sequence[Row], int]:
    """Lines of words right above the numbers, and the place of the first line of numbers."""

    def is_head(place: int) -> bool:
        cells = rows[place][1]
        return len(cells) > 1 and (are_units(cells) or not any(map(_is_number, cells)))

    def is_first(place: int) -> bool:
        cells = rows[place][1]
        numbers = sum(map(_is_number, cells))
        return numbers > 1 and (numbers == len(cells) or (place > 0 and is_head(place - 1)))

    first = start = next(filter(is_first, range(len(rows))), 0)
    while first > 0 and is_head(first - 1):
        first -= 1
    if first == start:
        numbers = (place for place, (_, cells) in enumerate(rows) if any(map(_is_number, cells)))
        first, start = 0, next(numbers, len(rows))
    return rows[first:start], start


def _columns(
    heads: Sequence[Row], lines: Sequence[str], separator: str, width: int, refuse: Refuse
) -> Sequence[TableColumn]:
    """Columns as the lowest line that names a quantity says, and the line of units below it."""
    columns: list[TableColumn] = []
    units: Row = (0, [])
    for line, cells in reversed(heads):
        texts = _between_blanks(lines[line - 1], width) if separator == " " else cells
        if are_units(texts):
            units = line, texts
            continue
        named = [column_of(place, line, text) for place, text in enumerate(texts)]
        columns = columns or named
        if any(column.quantities[0] for column in named):
            columns = named
            break
    columns = columns or [TableColumn(place) for place in range(len(units[1]))]
    columns = [column.with_units(*units, refuse) for column in columns]
    has_units_apart = any(is_spelt_as_unit(column.name) for column in columns)
    if len(columns) == width or (len(columns) > width and separator != " " and not has_units_apart):
        return columns
    if any(column.is_known for column in columns):
        line, count = heads[-1][0], len(columns)
        raise refuse(f"line {line} has {count} names for {width} columns: give one for each")
    return [TableColumn(place) for place in range(width)]


def _between_blanks(text: str, width: int) -> list[str]:
    """Split a line of names at blanks, which may stand in front of a bracket or within a name."""
    plain = text.strip("#% \t")
    names = re.split(r"\s+(?![\[(])", plain)
    apart = re.split(r"\s{2,}|\t", plain)
    return apart if len(apart) == width else names
