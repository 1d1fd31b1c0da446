"""Lines of a file with a table: separator of columns, and cells of each line."""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from solver.files.columns import are_units
from solver.files.numerals import is_gap, is_numeral
from solver.settings.values import Refuse

BLANKS = "  "
"""Separator of columns that stand at least two blanks apart."""
SEPARATORS = (
    "\t",
    ";",
    ",",
    "|",
    " ",
    BLANKS,
)
"""Separators of columns, the preferred ones first."""
SAMPLE = 200
LAST = 20
"""Lines by which the separator is chosen: spread over a file, and at its end."""
_MARK = re.compile(r"#|%|//|!|;")
_WORD = re.compile(r"\s*[^\W\d]")
_RULE = re.compile(r"[\s;,|+]*([-=_*~.])\1{2,}[-=_*~.\s;,|+]*")


class Line(NamedTuple):
    """A line of a file: number (from 1), text and cells.

    A cell is a number, a gap, or else a word.
    """

    number: int
    text: str
    cells: tuple[str, ...]
    are_numbers: tuple[bool, ...]
    are_words: tuple[bool, ...]
    is_comment: bool = False

    @property
    def n_numbers(self) -> int:
        """Number of cells that are numbers."""
        return self.are_numbers.count(True)

    @property
    def has_words(self) -> bool:
        """Check whether a cell is neither a number nor a gap."""
        return True in self.are_words

    @property
    def width(self) -> int:
        """Number of cells up to the last one that is a number or a gap."""
        # Words behind the last number are remarks, and no column.
        width = len(self.cells)
        while width and self.are_words[width - 1]:
            width -= 1
        return width

    @property
    def is_text(self) -> bool:
        """Check whether the line may be a head, units, as in `s;1;kN`, or a title."""
        if not self.has_words:
            return False
        pairs = list(zip(self.cells, self.are_numbers, strict=True))
        words = [cell for cell, is_number in pairs if not is_number]
        numbers = {cell for cell, is_number in pairs if is_number}
        if not numbers:
            return True
        # A row may have a label with digits, as N1, that reads like a unit.
        has_digits = any(char.isdigit() for char in "".join(words))
        return numbers == {"1"} and not has_digits and are_units(words)


def line_of(
    number: int, text: str, cells: Sequence[str], *, is_comment: bool = False
) -> Line:
    """Make a line from cells, and classify cells as numbers or words."""
    are_numbers = tuple(map(is_numeral, cells))
    are_words = (False,) * len(cells)
    # Almost all lines have numbers alone: these need no second look.
    if False in are_numbers:
        pairs = zip(cells, are_numbers, strict=True)
        are_words = tuple(
            not is_number and not is_gap(cell) for cell, is_number in pairs
        )
    return Line(number, text, tuple(cells), are_numbers, are_words, is_comment)


def text_of(
    data: bytes | str, refuse: Refuse, remedy: str = "save the table as CSV"
) -> str:
    """Decode a file as text; refuse other content, with a remedy."""
    if isinstance(data, str):
        text = data
    else:
        # UTF-16 without a mark has a zero byte behind every Latin letter.
        marks = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
        is_wide = data[:2] in marks or data[1:2] == b"\0"
        try:
            text = data.decode("utf-16" if is_wide else "utf-8")
        except UnicodeDecodeError:
            # Old spreadsheets and machines write the Western code page.
            text = data.decode("cp1252", "replace")
    # A file of DOS may end with Ctrl-Z.
    text = text.removeprefix("\ufeff").rstrip("\x1a")
    if re.search(r"[\0-\x08\x0e-\x1f]", text):
        raise refuse(f"it is no text: {remedy}")
    return text


def lines_of_text(data: bytes | str, refuse: Refuse) -> tuple[str, list[Line]]:
    """Separator of the columns of a file, and its lines but empty ones and rules.

    Raises
    ------
    SettingError
        If the text cannot be read as CSV.
    """
    texts = re.split(r"\r\n|\n|\r", text_of(data, refuse))
    filled = [
        (number, text) for number, text in enumerate(texts, start=1) if text.strip()
    ]
    try:
        separator = _separator_of([text for _, text in filled])
        lines = [_line(number, text, separator) for number, text in filled]
    except csv.Error as problem:
        raise refuse(str(problem)) from None
    return separator, [line for line in lines if not _is_empty(line)]


def _is_empty(line: Line) -> bool:
    """Check whether a line has no cells, or is a rule of dashes."""
    return not line.cells or bool(_RULE.fullmatch(line.text))


def _separator_of(texts: Sequence[str]) -> str:
    """Separator that gives most cells with numbers, and rows of equal width."""
    # Heads may be long and of another kind, so lines from all of the file count.
    sample = [*texts[:: max(1, len(texts) // SAMPLE)], *texts[-LAST:]]

    def score(separator: str) -> tuple[float, float]:
        lines = [_line(0, text, separator) for text in sample]
        rows = [line for line in lines if _has_two(line)]
        shares = []
        for row in rows:
            # Empty cells speak neither for a separator nor against it.
            count = len(row.cells) - row.cells.count("")
            shares.append((count - sum(row.are_words)) / count)
        widths = Counter(row.width for row in rows)
        # Rounded, as equal sums may differ by their last bit; of equals the first
        # separator wins.
        return round(sum(shares), 9), max(widths.values(), default=0)

    return max(SEPARATORS, key=score)


def _has_two(line: Line) -> bool:
    """Check whether a line has two numbers, or a number and a written gap."""
    filled = filter(None, line.cells)
    gaps = [cell for cell in filled if is_gap(cell)]
    has_number = line.n_numbers > 0
    return not line.is_comment and has_number and line.n_numbers + len(gaps) > 1


def _line(number: int, text: str, separator: str) -> Line:
    """Make a line; comments lose their mark, as they may contain the head."""
    plain = text.strip(" \f")
    line = line_of(number, plain, split_cells(plain, separator))
    if line.cells and _is_comment(plain, line.cells[0], separator):
        words = plain.lstrip("#%/!; \t")
        return line_of(number, words, split_cells(words, separator), is_comment=True)
    if line.has_words and _MARK.search(plain):
        before = _without_comment(plain, separator)
        if before:
            return line_of(number, plain, before)
        return line
    return line


def _is_comment(text: str, first: str, separator: str) -> bool:
    """Check whether a text begins with the mark of a comment.

    `#N/A` is a gap, and a cell that is % alone a unit.
    """
    mark = _MARK.match(text)
    if mark is None or mark[0] == separator or is_gap(first):
        return False
    if first != mark[0] or is_blank(separator):
        return True
    return separator == "\t" and first != "%"


def _without_comment(text: str, separator: str) -> list[str]:
    """Cells before a comment at the end of a row of numbers; empty without one."""
    for mark in _MARK.finditer(text):
        before = text[mark.start() - 1 : mark.start()]
        stands_apart = before.isspace() or before == separator
        # Behind a number % is its unit, unless words follow.
        is_unit = mark[0] == "%" and not _WORD.match(text, mark.end())
        if mark[0] != separator and stands_apart and not is_unit:
            cells = split_cells(text[: mark.start()], separator)
            numerals = [cell for cell in cells if is_numeral(cell)]
            if len(numerals) > 1:
                return cells
            return []
    return []


def split_cells(text: str, separator: str) -> list[str]:
    """Split a text into cells, without empty cells at the end."""
    if separator == BLANKS:
        cells = re.split(r" {2,}|\t", text.strip())
    elif separator == " ":
        # Other blanks may stand within numbers.
        cells = re.split(r"[ \t]+", text.strip())
    elif '"' in text:
        cells = next(csv.reader([text], delimiter=separator), [])
    else:
        cells = text.split(separator)
    return up_to_last_filled([cell.strip() for cell in cells])


def up_to_last_filled(cells: list[str]) -> list[str]:
    """Cells without empty ones at the end."""
    count = len(cells)
    while count and not cells[count - 1]:
        count -= 1
    return cells[:count]


def is_blank(separator: str) -> bool:
    """Check whether blanks separate the columns."""
    return separator in (" ", BLANKS)
