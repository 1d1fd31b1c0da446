"""Lines of a file with a table: separator of its columns, rows, and head."""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from solver.files.columns import TableColumn, are_units, column_of, is_spelt_as_unit
from solver.files.disk import Refuse
from solver.files.numerals import is_gap, is_numeral

BLANKS = "  "
"""Separator of columns that stand at least two blanks apart."""
SEPARATORS = (
    "\t",
    ";",
    ",",
    " ",
    BLANKS,
)
"""Separators of columns, the preferred ones first."""
SAMPLE = 200
LAST = 20
"""Lines by which the separator is chosen: spread over a file, and at its end."""
FARTHEST = 100
"""Lines of text above rows among which a head is sought."""
_MARK = re.compile(r"#|%|//|!|;")
_WORD = re.compile(r"\s*[^\W\d]")
_RULE = re.compile(r"[\s;,|+]*([-=_*~.])\1{2,}[-=_*~.\s;,|+]*")


class Line(NamedTuple):
    """A line of a file: its number, from 1, its text, and its cells.

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
        """Return whether a cell is neither a number nor a gap."""
        return True in self.are_words

    @property
    def width(self) -> int:
        """Number of cells up to the last one that is a number or a gap."""
        width = len(self.cells)
        while width and self.are_words[width - 1]:
            width -= 1
        return width

    @property
    def is_text(self) -> bool:
        """Return whether the line may be a head, units, as in `s;1;kN`, or a title."""
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
    """Make a line of cells, and judge which of them are numbers and which are words."""
    are_numbers = tuple(map(is_numeral, cells))
    are_words = (False,) * len(cells)
    if False in are_numbers:
        pairs = zip(cells, are_numbers, strict=True)
        are_words = tuple(
            not is_number and not is_gap(cell) for cell, is_number in pairs
        )
    return Line(number, text, tuple(cells), are_numbers, are_words, is_comment)


@dataclass(eq=False)
class Block:
    """Rows of one table, without another head among them, and the lines around them.

    Attributes
    ----------
    above
        Lines above the rows, up to the table before.
    passed
        Lines between rows that are neither rows nor the head again.
    repeats
        Number of times that the head is repeated between rows.
    """

    above: list[Line]
    rows: list[Line]
    passed: list[Line] = field(default_factory=list)
    repeats: int = 0

    @property
    def size(self) -> int:
        """Number of rows that have two numbers or more."""
        return sum(row.n_numbers > 1 for row in self.rows)

    @cached_property
    def width(self) -> int:
        """Number of columns of most rows, without words at their end."""
        return Counter(row.width for row in self.rows).most_common(1)[0][0]

    @cached_property
    def is_known(self) -> bool:
        """Return whether a line above may be a head that names a quantity."""
        near = self.above[-FARTHEST:]
        return any(len(line.cells) > 1 and _is_known(line.cells) for line in near)

    @cached_property
    def texts_above(self) -> set[tuple[str, ...]]:
        """Cells of the lines above."""
        return {line.cells for line in self.above}


def text_of(data: bytes | str, refuse: Refuse) -> str:
    """Text of a file; refuse other content."""
    if isinstance(data, str):
        text = data
    else:
        marks = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
        is_wide = data[:2] in marks or data[1:2] == b"\0"
        try:
            text = data.decode("utf-16" if is_wide else "utf-8")
        except UnicodeDecodeError:
            text = data.decode("cp1252", "replace")
    # A file of DOS may end with Ctrl-Z.
    text = text.removeprefix("\ufeff").rstrip("\x1a")
    if re.search(r"[\0-\x08\x0e-\x1f]", text):
        raise refuse("it is no text: save the table as CSV")
    return text


def lines_of_text(data: bytes | str, refuse: Refuse) -> tuple[str, list[Line]]:
    """Separator of the columns of a file, and its lines but empty ones and rules."""
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
    """Return whether a line has no cells, or is a rule between others."""
    return not line.cells or bool(_RULE.fullmatch(line.text))


def _separator_of(texts: Sequence[str]) -> str:
    """Separator by which most cells of most lines are numbers, and widths are alike."""
    sample = [*texts[:: max(1, len(texts) // SAMPLE)], *texts[-LAST:]]

    def score(separator: str) -> tuple[float, float]:
        lines = [_line(0, text, separator) for text in sample]
        rows = [line for line in lines if _has_two(line)]
        shares = []
        for row in rows:
            count = len(row.cells) - row.cells.count("")
            shares.append((count - sum(row.are_words)) / count)
        widths = Counter(row.width for row in rows)
        return round(sum(shares), 9), max(widths.values(), default=0)

    return max(SEPARATORS, key=score)


def _has_two(line: Line) -> bool:
    """Return whether a line has two numbers, or a number and a gap that is written."""
    filled = filter(None, line.cells)
    gaps = [cell for cell in filled if is_gap(cell)]
    has_number = line.n_numbers > 0
    return not line.is_comment and has_number and line.n_numbers + len(gaps) > 1


def _line(number: int, text: str, separator: str) -> Line:
    """Make a line; of a comment the mark is dropped, as its words may be a head."""
    plain = text.strip(" \f")
    line = line_of(number, plain, _split(plain, separator))
    if line.cells and _is_comment(plain, line.cells[0], separator):
        words = plain.lstrip("#%/!; \t")
        return line_of(number, words, _split(words, separator), is_comment=True)
    if line.has_words and _MARK.search(plain):
        before = _without_comment(plain, separator)
        if before:
            return line_of(number, plain, before)
        return line
    return line


def _is_comment(text: str, first: str, separator: str) -> bool:
    """Return whether a text begins with the mark of a comment.

    `#N/A` is a gap, and a cell that is % alone a unit.
    """
    mark = _MARK.match(text)
    if mark is None or mark[0] == separator or is_gap(first):
        return False
    if first != mark[0] or _is_blank(separator):
        return True
    return separator == "\t" and first != "%"


def _without_comment(text: str, separator: str) -> list[str]:
    """Cells before a comment behind two numbers or more; empty without one."""
    for mark in _MARK.finditer(text):
        before = text[mark.start() - 1 : mark.start()]
        stands_apart = before.isspace() or before == separator
        # Behind a number % is its unit, unless words follow.
        is_unit = mark[0] == "%" and not _WORD.match(text, mark.end())
        if mark[0] != separator and stands_apart and not is_unit:
            cells = _split(text[: mark.start()], separator)
            numerals = [cell for cell in cells if is_numeral(cell)]
            if len(numerals) > 1:
                return cells
            return []
    return []


def _split(text: str, separator: str) -> list[str]:
    """Cells of a text up to the last filled one."""
    if separator == BLANKS:
        cells = re.split(r" {2,}|\t", text.strip())
    elif separator == " ":
        # Other blanks may stand within numbers.
        cells = re.split(r"[ \t]+", text.strip())
    elif '"' in text:
        cells = next(csv.reader([text], delimiter=separator), [])
    else:
        cells = text.split(separator)
    cells = [cell.strip() for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def block_of(
    lines: Sequence[Line], separator: str, refuse: Refuse
) -> tuple[Block, list[str]]:
    """Table that has most rows, and words on others; refuse two of the same size."""
    blocks = list(_blocks(lines, separator))
    if not blocks:
        raise refuse("it has no points: give lines of numbers")
    largest = max(block.size for block in blocks)
    chosen = [block for block in blocks if block.size == largest]
    if len(chosen) > 1:
        first, second = (block.rows[0].number for block in chosen[:2])
        raise refuse(
            f"tables of {largest} rows begin at lines {first} and {second}: leave one"
        )
    others = [block.rows[0].number for block in blocks if block is not chosen[0]]
    passed = [f"another table passed over (line {line})" for line in others]
    _leave_summary(chosen[0])
    return chosen[0], passed


def _blocks(lines: Sequence[Line], separator: str) -> Iterator[Block]:
    """Yield tables; a table ends at the head of another one.

    A head that is repeated does not end its table.
    """
    block: Block | None = None
    between: list[Line] = []
    for line in lines:
        if line.is_comment or line.is_text:
            between.append(line)
            continue
        heads = _heads_among(between, line, block, separator)
        if block is None or heads:
            is_row = _is_first(line, between)
        else:
            is_row = _is_next(line, block, separator)
        if not is_row:
            between.append(line)
            continue
        if block is None or any(head.cells not in block.texts_above for head in heads):
            if block is not None:
                yield block
            block = Block(above=between, rows=_broken_rows(between, line))
        else:
            if heads:
                block.repeats += 1
            block.passed += [
                other for other in between if other.cells not in block.texts_above
            ]
        block.rows.append(line)
        between = []
    if block is not None:
        block.passed += [line for line in between if not line.is_comment]
        yield block


def _heads_among(
    between: Sequence[Line], row: Line, block: Block | None, separator: str
) -> list[Line]:
    """Lines since the last row of a table that may be the head of a row below them."""
    heads = [
        other for other in between[-FARTHEST:] if _is_head_of(other, row, separator)
    ]
    if block is None or not block.is_known:
        return heads
    return [head for head in heads if _is_comment_or_known(head)]


def _is_comment_or_known(head: Line) -> bool:
    """Return whether a line is a comment, or names a quantity.

    Words that name no quantity may tell of the test, as in `phase;unloading`.
    """
    return head.is_comment or _is_known(head.cells)


def _is_head_of(line: Line, row: Line, separator: str) -> bool:
    """Return whether a line of words may be the head of rows: a name for each column.

    Comments, and lines divided by blanks, may be prose: of a head two names are known.
    """
    if not line.is_text or len(row.cells) < 2:
        return False
    if not line.is_comment and not _is_blank(separator):
        return len(line.cells) == len(row.cells)
    texts = _names_in(line, row.width, separator)
    known = [column_of(0, 0, text).is_known for text in texts]
    return len(texts) == row.width and sum(known) > 1


def _is_known(words: Sequence[str]) -> bool:
    """Return whether a name of a line is that of a quantity, or has a unit."""
    return any(column_of(0, 0, word).is_known for word in words)


def _is_first(line: Line, between: Sequence[Line]) -> bool:
    """Return whether a line may be the first row: `N1,0,7` below a head, or numbers."""
    if not line.has_words:
        return len(line.cells) > 1
    is_below_head = bool(between) and between[-1].is_text and len(between[-1].cells) > 1
    return line.n_numbers > 1 and (is_below_head or not line.are_words[0])


def _is_next(line: Line, block: Block | None, separator: str) -> bool:
    """Return whether a line may be a further row.

    A line that begins with a word is a row if the first row does, or if cells are
    divided by a sign, and there are as many as in the first row.
    """
    if block is None or not line.n_numbers:
        return not line.has_words
    first = block.rows[0]
    if not line.are_words[0] or first.are_words[0]:
        return True
    return len(line.cells) == len(first.cells) and not _is_blank(separator)


def _broken_rows(between: Sequence[Line], row: Line) -> list[Line]:
    """First row of a table as a list, if a word stands there in place of a number.

    It is the line right above the first row of numbers, and as wide as that; else the
    list is empty.
    """
    if not between or between[-1].number != row.number - 1:
        return []
    line = between[-1]
    if line.is_text or line.is_comment or not line.n_numbers:
        return []
    if len(line.cells) == len(row.cells):
        return [line]
    return []


def _leave_summary(block: Block) -> None:
    """Pass over first rows of another width than most rows, if no head is above."""
    if block.above and block.above[-1].is_text:
        return
    first = 0
    while block.rows[first].width != block.width:
        first += 1
    block.passed += block.rows[:first]
    del block.rows[:first]


def _is_blank(separator: str) -> bool:
    """Return whether columns are divided by blanks."""
    return separator in (" ", BLANKS)


def headed(block: Block, separator: str, refuse: Refuse) -> list[TableColumn]:
    """Columns of a table, by the lowest head that fits, and its line of units."""
    names: list[TableColumn] = []
    units: tuple[int, list[str]] = (0, [])
    texts = _texts_of_head(block, separator)
    # From the rows upwards
    for line, words in reversed(texts):
        is_head_found = any(column.is_known for column in names)
        if are_units(words):
            may_be_prose = line.is_comment or _is_blank(separator)
            is_prose = may_be_prose and len(words) != block.width
            fits_names = not names or len(words) == len(names)
            if not units[1] and not is_prose and fits_names:
                units = line.number, words
            if is_head_found:
                break
            continue
        if is_head_found:
            break
        named = [
            column_of(place, line.number, text) for place, text in enumerate(words)
        ]
        is_known = any(column.quantities[0] for column in named)
        if _fits(named, block, separator) and (is_known or not names):
            names = named
    if not names and not units[1]:
        _check_nearest(texts, block, separator, refuse)
    if not names:
        n_columns = max(block.width, len(units[1]))
        names = [TableColumn(place) for place in range(n_columns)]
    return [column.with_units(*units, refuse) for column in names]


def _texts_of_head(block: Block, separator: str) -> list[tuple[Line, list[str]]]:
    """Lines above the rows that may be a head or units, each with its words."""
    near = [line for line in block.above if line.is_text][-FARTHEST:]
    texts = []
    for line in near:
        words = _names_in(line, block.width, separator)
        if len(words) > 1 and not _has_numbers(words):
            texts.append((line, words))
    return texts


def _has_numbers(words: Sequence[str]) -> bool:
    """Return whether a line of words has numbers, other than the unit 1."""
    return any(is_numeral(word) and word != "1" for word in words)


def _fits(named: Sequence[TableColumn], block: Block, separator: str) -> bool:
    """Return whether there is a column for each name.

    The last columns may be empty, or have words alone.
    """
    if len(named) <= block.width:
        return len(named) == block.width
    has_words = any(any(row.are_words[block.width :]) for row in block.rows)
    has_units_apart = any(
        is_spelt_as_unit(column.name) and not column.is_known for column in named
    )
    return has_words or not (_is_blank(separator) or has_units_apart)


def _check_nearest(
    texts: Sequence[tuple[Line, list[str]]],
    block: Block,
    separator: str,
    refuse: Refuse,
) -> None:
    """Refuse a head right above the rows that has too few names, or too many."""
    if not texts:
        return
    line, words = texts[-1]
    known = [word for word in words if _is_known([word])]
    # A comment, or words between blanks, may be prose that names a quantity.
    may_be_prose = line.is_comment or _is_blank(separator)
    needed = 2 if may_be_prose else 1
    if len(known) >= needed:
        count = f"{len(words)} names for {block.width} columns"
        raise refuse(f"line {line.number} has {count}: give one for each")


def _names_in(line: Line, width: int, separator: str) -> list[str]:
    """Names in a line: its cells, or a division that has a name for each column.

    In comments, and in lines divided by blanks, a name may have blanks within, or one
    in front of its bracket, and commas may stand between names. A comment may follow.
    """
    cells = list(line.cells)
    divisions = [cells]
    if line.is_comment or _is_blank(separator):
        plain = line.text.strip()
        divisions = [
            re.split(r"\s+(?![\[(])", plain),
            re.split(r"\s{2,}|\t", plain),
            re.split(r"\s*[,;\t]\s*", plain),
            cells,
        ]
    short = re.split(r"\s(?:#|//|!)", line.text)[0]
    if short != line.text:
        divisions.append(_split(short, separator))
    fitting = [names for names in divisions if len(names) == width]
    known = [names for names in fitting if _is_known(names)]
    return [*known, *fitting, *divisions][0]


def fitted(block: Block, width: int, separator: str, refuse: Refuse) -> list[list[str]]:
    """Cells of rows, as many as there are columns."""
    cells = []
    for row in block.rows:
        # Where blanks divide columns nothing says which cell of a short row lacks.
        if _is_blank(separator) and row.width < block.width:
            cells.append([""] * width)
        else:
            cells.append(_cells_of(row, width, refuse))
    return cells


def _cells_of(row: Line, width: int, refuse: Refuse) -> list[str]:
    """Cells of a row, as many as there are columns, without words behind the last."""
    cells = list(row.cells)
    lacking = width - len(cells)
    if lacking >= 0:
        return cells + [""] * lacking
    if row.are_words[width - 1]:
        return [*cells[: width - 1], " ".join(cells[width - 1 :])]
    if row.are_words[width]:
        return cells[:width]
    raise refuse(f"line {row.number} has {len(cells)} cells for {width} columns")
