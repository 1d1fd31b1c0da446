"""The table in the lines of a file: rows, head and cells."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from solver.files.columns import TableColumn, are_units, column_of
from solver.files.numerals import is_numeral
from solver.files.table_lines import Line, is_blank, split_cells
from solver.files.units import is_spelt_as_unit
from solver.settings.values import Refuse

FARTHEST = 100
"""Lines of text above rows among which a head is sought."""


@dataclass(eq=False)
class Block:
    """Rows of one table, and the lines above and between them.

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
        """Number of rows with at least two numbers."""
        return sum(row.n_numbers > 1 for row in self.rows)

    @cached_property
    def width(self) -> int:
        """Most frequent number of columns, without words at the end of rows."""
        return Counter(row.width for row in self.rows).most_common(1)[0][0]

    @cached_property
    def is_known(self) -> bool:
        """Check whether a line above the rows names a quantity."""
        near = self.above[-FARTHEST:]
        return any(len(line.cells) > 1 and _is_known(line.cells) for line in near)

    @cached_property
    def texts_above(self) -> set[tuple[str, ...]]:
        """Cells of the lines above."""
        return {line.cells for line in self.above}


def block_of(
    lines: Sequence[Line], separator: str, refuse: Refuse
) -> tuple[Block, list[str]]:
    """The table with most rows, and messages on others; refuse two of equal size."""
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
    # Small tables before the data are results that a machine writes there.
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
        # What such a line is shows only by the row below it.
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
        # A new head begins another table; the same one again, as on each page, does
        # not.
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
    """Lines after the last row of a table that may be the head of a next table."""
    heads = [
        other for other in between[-FARTHEST:] if _is_head_of(other, row, separator)
    ]
    if block is None or not block.is_known:
        return heads
    return [head for head in heads if _is_comment_or_known(head)]


def _is_comment_or_known(head: Line) -> bool:
    """Check whether a line is a comment, or names a quantity.

    Words that name no quantity may tell of the test, as in `phase;unloading`.
    """
    return head.is_comment or _is_known(head.cells)


def _is_head_of(line: Line, row: Line, separator: str) -> bool:
    """Check whether a line of words may be the head: with a name for each column.

    Comments, and lines divided by blanks, may be prose: of a head two names are known.
    """
    if not line.is_text or len(row.cells) < 2:
        return False
    if not line.is_comment and not is_blank(separator):
        return len(line.cells) == len(row.cells)
    # Of prose one word may happen to name a quantity, hardly two in a line as wide as
    # the rows.
    texts = _names_in(line, row.width, separator)
    known = [column_of(0, 0, text).is_known for text in texts]
    return len(texts) == row.width and sum(known) > 1


def _is_known(words: Sequence[str]) -> bool:
    """Check whether a word of a line names a quantity, or has a unit."""
    return any(column_of(0, 0, word).is_known for word in words)


def _is_first(line: Line, between: Sequence[Line]) -> bool:
    """Check whether a line may be the first row: `N1,0,7` below a head, or numbers."""
    if not line.has_words:
        return len(line.cells) > 1
    is_below_head = bool(between) and between[-1].is_text and len(between[-1].cells) > 1
    return line.n_numbers > 1 and (is_below_head or not line.are_words[0])


def _is_next(line: Line, block: Block, separator: str) -> bool:
    """Check whether a line may be a further row.

    A line that begins with a word is a row if the first row does, or if cells are
    divided by a sign, and there are as many as in the first row.
    """
    if not line.n_numbers:
        return not line.has_words
    first = block.rows[0]
    if not line.are_words[0] or first.are_words[0]:
        return True
    return len(line.cells) == len(first.cells) and not is_blank(separator)


def _broken_rows(between: Sequence[Line], row: Line) -> list[Line]:
    """List of the first row of a table, if it has a word in place of a number.

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
    """Drop first rows with an unusual number of columns, unless a head is above."""
    if block.above and block.above[-1].is_text:
        return
    # Without a head numbers above the data, as a count of rows, look like rows.
    first = 0
    while block.rows[first].width != block.width:
        first += 1
    block.passed += block.rows[:first]
    del block.rows[:first]


def headed(block: Block, separator: str, refuse: Refuse) -> list[TableColumn]:
    """Columns of a table, by the lowest head that fits, and its line of units."""
    names: list[TableColumn] = []
    units: tuple[int, list[str]] = (0, [])
    texts = _texts_of_head(block, separator)
    # From the rows upwards
    for line, words in reversed(texts):
        is_head_found = any(column.is_known for column in names)
        if are_units(words):
            may_be_prose = line.is_comment or is_blank(separator)
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
            column_of(number, line.number, text) for number, text in enumerate(words)
        ]
        is_known = any(column.quantities[0] for column in named)
        if _fits(named, block, separator) and (is_known or not names):
            names = named
    # Without any head columns are taken in order, unless one was clearly meant.
    if not names and not units[1]:
        _check_nearest(texts, block, separator, refuse)
    if not names:
        n_columns = max(block.width, len(units[1]))
        names = [TableColumn(number) for number in range(n_columns)]
    return [column.with_units(*units, refuse) for column in names]


def _texts_of_head(block: Block, separator: str) -> list[tuple[Line, list[str]]]:
    """Lines above the rows that may be a head or units, and the words of each."""
    near = [line for line in block.above if line.is_text][-FARTHEST:]
    texts = []
    for line in near:
        words = _names_in(line, block.width, separator)
        if len(words) > 1 and not _has_numbers(words):
            texts.append((line, words))
    return texts


def _has_numbers(words: Sequence[str]) -> bool:
    """Check whether a line of words has numbers, other than the unit 1."""
    return any(is_numeral(word) and word != "1" for word in words)


def _fits(named: Sequence[TableColumn], block: Block, separator: str) -> bool:
    """Check whether the table has a column for each name.

    The last columns may be empty, or have words alone.
    """
    # There may be more names than columns of numbers: the last may be remarks, or
    # empty.
    if len(named) <= block.width:
        return len(named) == block.width
    has_words = any(any(row.are_words[block.width :]) for row in block.rows)
    has_units_apart = any(
        is_spelt_as_unit(column.name) and not column.is_known for column in named
    )
    return has_words or not (is_blank(separator) or has_units_apart)


def _check_nearest(
    texts: Sequence[tuple[Line, list[str]]],
    block: Block,
    separator: str,
    refuse: Refuse,
) -> None:
    """Refuse a head directly above the rows with too few or too many names."""
    if not texts:
        return
    line, words = texts[-1]
    known = [word for word in words if _is_known([word])]
    # A comment, or words between blanks, may be prose that names a quantity.
    may_be_prose = line.is_comment or is_blank(separator)
    needed = 2 if may_be_prose else 1
    if len(known) >= needed:
        count = f"{len(words)} names for {block.width} columns"
        raise refuse(f"line {line.number} has {count}: give one for each")


def _names_in(line: Line, width: int, separator: str) -> list[str]:
    """Names in a line: its cells, or the text divided into a name for each column.

    In comments, and in lines divided by blanks, a name may have blanks within, or one
    in front of its bracket, and commas may stand between names. A comment may follow.
    """
    cells = list(line.cells)
    divisions = [cells]
    if line.is_comment or is_blank(separator):
        plain = line.text.strip()
        divisions = [
            re.split(r"\s+(?![\[(])", plain),
            re.split(r"\s{2,}|\t", plain),
            re.split(r"\s*[,;\t]\s*", plain),
            cells,
        ]
    short = re.split(r"\s(?:#|//|!)", line.text)[0]
    if short != line.text:
        divisions.append(split_cells(short, separator))
    # The first division that names a quantity wins, else the first that is as wide as
    # the rows.
    fitting = [names for names in divisions if len(names) == width]
    known = [names for names in fitting if _is_known(names)]
    return [*known, *fitting, *divisions][0]


def fitted(block: Block, width: int, separator: str, refuse: Refuse) -> list[list[str]]:
    """Cells of all rows, padded or cut to the number of columns."""
    cells = []
    for row in block.rows:
        # Where blanks divide columns nothing says which cell of a short row lacks.
        if is_blank(separator) and row.width < block.width:
            cells.append([""] * width)
        else:
            cells.append(_cells_of(row, width, refuse))
    return cells


def _cells_of(row: Line, width: int, refuse: Refuse) -> list[str]:
    """Cells of a row, padded or cut to the number of columns."""
    cells = list(row.cells)
    lacking = width - len(cells)
    if lacking >= 0:
        return cells + [""] * lacking
    # Commas of a remark divide it: its parts are one cell again.
    if row.are_words[width - 1]:
        return [*cells[: width - 1], " ".join(cells[width - 1 :])]
    if row.are_words[width]:
        return cells[:width]
    raise refuse(f"line {row.number} has {len(cells)} cells for {width} columns")
