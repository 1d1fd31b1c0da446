"""Lines of a file that has a table: what divides its columns, which are its rows, and its head."""

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
"""What divides columns that stand at least two blanks apart."""
SEPARATORS = ("\t", ";", ",", " ", BLANKS)
"""What may divide columns, in the order in which they are preferred."""
SAMPLE = 200
LAST = 20
"""Lines of which it is judged what divides columns: all over a file, and at its end."""
FARTHEST = 100
"""Lines of text above rows among which a head is sought."""
_MARK = re.compile(r"#|%|//|!|;")
_WORD = re.compile(r"\s*[^\W\d]")
_RULE = re.compile(r"[\s;,|+]*([-=_*~.])\1{2,}[-=_*~.\s;,|+]*")


class Line(NamedTuple):
    """A line by its number, from 1, its text, and its cells, without empty ones at its end.

    Some cells are numbers, others words, which are neither numbers nor gaps.
    """

    number: int
    text: str
    cells: tuple[str, ...]
    are_numbers: tuple[bool, ...]
    are_words: tuple[bool, ...]
    is_comment: bool = False

    @property
    def n_numbers(self) -> int:
        """Number of numbers."""
        return self.are_numbers.count(True)

    @property
    def has_words(self) -> bool:
        """Return whether a cell is neither a number nor a gap."""
        return True in self.are_words

    @property
    def width(self) -> int:
        """Cells up to the last one that is a number or a gap."""
        if not self.has_words:
            return len(self.cells)
        return max(
            (place for place, word in enumerate(self.are_words, 1) if not word),
            default=0,
        )

    @property
    def is_text(self) -> bool:
        """Return whether it may be a head, units, as in `s;1;kN`, or a title: words without numbers."""
        if not self.has_words:
            return False
        pairs = list(zip(self.cells, self.are_numbers, strict=True))
        words = [cell for cell, is_number in pairs if not is_number]
        numbers = {cell for cell, is_number in pairs if is_number}
        # Labels of rows are no units: N1.
        has_digits = any(char.isdigit() for word in words for char in word)
        return not numbers or (numbers == {"1"} and not has_digits and are_units(words))


def line_of(
    number: int, text: str, cells: Sequence[str], *, is_comment: bool = False
) -> Line:
    """A line with its cells, which are told apart."""
    are_numbers = tuple(map(is_numeral, cells))
    if False in are_numbers:
        pairs = zip(cells, are_numbers, strict=True)
        are_words = tuple(
            not is_number and not is_gap(cell) for cell, is_number in pairs
        )
    else:
        are_words = (False,) * len(cells)
    return Line(number, text, tuple(cells), are_numbers, are_words, is_comment)


@dataclass(eq=False)
class Block:
    """Rows that no other head parts, with what stands above and between them.

    Attributes
    ----------
    above
        Lines from the rows of the table before on.
    passed
        Lines between rows that are neither rows nor words of the head.
    repeats
        How often the head stands there again.
    """

    above: list[Line]
    rows: list[Line]
    passed: list[Line] = field(default_factory=list)
    repeats: int = 0

    @property
    def size(self) -> int:
        """Rows that have two numbers or more."""
        return sum(row.n_numbers > 1 for row in self.rows)

    @cached_property
    def width(self) -> int:
        """Columns that most rows have, without words at their end."""
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
    """Text of a file; what is none is refused."""
    if isinstance(data, str):
        text = data
    else:
        is_wide = (
            data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) or data[1:2] == b"\0"
        )
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
    """What divides the columns of a file, and its lines that are neither empty nor rules."""
    texts = re.split(r"\r\n|\n|\r", text_of(data, refuse))
    filled = [
        (number, text) for number, text in enumerate(texts, start=1) if text.strip()
    ]
    try:
        separator = _separator_of([text for _, text in filled])
        lines = [_line(number, text, separator) for number, text in filled]
    except csv.Error as problem:
        raise refuse(str(problem)) from None
    return separator, [
        line for line in lines if line.cells and not _RULE.fullmatch(line.text)
    ]


def _separator_of(texts: Sequence[str]) -> str:
    """What divides columns: most cells of most lines are numbers, and widths are alike."""
    sample = [*texts[:: max(1, len(texts) // SAMPLE)], *texts[-LAST:]]

    def score(separator: str) -> tuple[float, float]:
        lines = [_line(0, text, separator) for text in sample]
        filled = [(line, len(line.cells) - line.cells.count("")) for line in lines]
        shares = [
            (count - sum(line.are_words)) / count
            for line, count in filled
            if _has_two(line)
        ]
        widths = Counter(line.width for line in lines if _has_two(line))
        return round(sum(shares), 9), max(widths.values(), default=0)

    return max(SEPARATORS, key=score)


def _has_two(line: Line) -> bool:
    """Return whether two cells of a line are numbers, or one and a gap that is written."""
    gaps = sum(bool(cell) and is_gap(cell) for cell in line.cells)
    return not line.is_comment and line.n_numbers > 0 and line.n_numbers + gaps > 1


def _line(number: int, text: str, separator: str) -> Line:
    """Split a line; a comment keeps its words, which may be a head, and loses its mark."""
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
    """Return whether a text begins with the mark of a comment; `#N/A` is a gap, and % alone a unit."""
    mark = _MARK.match(text)
    if mark is None or mark[0] == separator or is_gap(first):
        return False
    return (
        first != mark[0] or _is_blank(separator) or (separator == "\t" and first != "%")
    )


def _without_comment(text: str, separator: str) -> list[str]:
    """Cells before a comment that stands behind two numbers; none where there is no such."""
    for mark in _MARK.finditer(text):
        before = text[mark.start() - 1 : mark.start()]
        stands_apart = before.isspace() or before == separator
        # Behind a number % is its unit, unless words follow.
        is_unit = mark[0] == "%" and not _WORD.match(text, mark.end())
        if mark[0] != separator and stands_apart and not is_unit:
            cells = _split(text[: mark.start()], separator)
            if sum(map(is_numeral, cells)) > 1:
                return cells
            return []
    return []


def _split(text: str, separator: str) -> list[str]:
    """Cells of a text, without empty ones at its end."""
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
    """The table that has most rows, and words on others; of equals both are refused."""
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
    """Yield tables: rows up to lines of words that are a head, and not the same one again."""
    block: Block | None = None
    between: list[Line] = []
    for line in lines:
        if line.is_comment or line.is_text:
            between.append(line)
            continue
        heads = [
            other
            for other in between[-FARTHEST:]
            if _is_head_of(other, line, separator)
        ]
        if block is not None and block.is_known:
            # Words that name no quantity may tell what happens, as in
            # `phase;unloading`.
            heads = [
                other for other in heads if _is_known(other.cells) or other.is_comment
            ]
        begins = block is None or bool(heads)
        if begins:
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
            block.repeats += bool(heads)
            block.passed += [o for o in between if o.cells not in block.texts_above]
        block.rows.append(line)
        between = []
    if block is not None:
        block.passed += [line for line in between if not line.is_comment]
        yield block


def _is_head_of(line: Line, row: Line, separator: str) -> bool:
    """Return whether a line of words may be the head of rows: a name for each column.

    Between blanks, and in comments, there is prose, too: there two names are known.
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
    """Return whether a line may be the first row: `N1,0,7` below a head, but not `Range,0,100`."""
    if not line.has_words:
        return len(line.cells) > 1
    is_below_head = bool(between) and between[-1].is_text and len(between[-1].cells) > 1
    return line.n_numbers > 1 and (is_below_head or not line.are_words[0])


def _is_next(line: Line, block: Block | None, separator: str) -> bool:
    """Return whether a line may be a further row; one that begins with a word is often of the text."""
    if block is None or not line.n_numbers:
        return not line.has_words
    first = block.rows[0]
    if not line.are_words[0] or first.are_words[0]:
        return True
    return len(line.cells) == len(first.cells) and not _is_blank(separator)


def _broken_rows(between: Sequence[Line], row: Line) -> list[Line]:
    """A line right above the first row, as wide as that, with a word where a number should be."""
    above = [line for line in between[-1:] if line.number == row.number - 1]
    return [
        line
        for line in above
        if line.n_numbers
        and not (line.is_text or line.is_comment)
        and len(line.cells) == len(row.cells)
    ]


def _leave_summary(block: Block) -> None:
    """Pass over numbers right above the rows that are of another width, where there is no head."""
    if any(line.is_text for line in block.above[-1:]):
        return
    first = next(
        place for place, row in enumerate(block.rows) if row.width == block.width
    )
    block.passed += block.rows[:first]
    del block.rows[:first]


def _is_blank(separator: str) -> bool:
    return separator in (" ", BLANKS)


def headed(block: Block, separator: str, refuse: Refuse) -> list[TableColumn]:
    """Columns as the lowest line says that has a name for each, and the line of units by it."""
    width = block.width
    names: list[TableColumn] = []
    units: tuple[int, list[str]] = (0, [])
    near = [line for line in block.above if line.is_text][-FARTHEST:]
    texts = [(line, _names_in(line, width, separator)) for line in near]
    texts = [
        (line, words)
        for line, words in texts
        if len(words) > 1 and not _has_numbers(words)
    ]
    for line, words in reversed(texts):
        if are_units(words):
            is_prose = (line.is_comment or _is_blank(separator)) and len(words) != width
            if not (units[1] or is_prose) and (not names or len(words) == len(names)):
                units = line.number, words
            if any(column.is_known for column in names):
                break
            continue
        if any(column.is_known for column in names):
            break
        named = [
            column_of(place, line.number, text) for place, text in enumerate(words)
        ]
        is_known = any(column.quantities[0] for column in named)
        if _fits(named, block, separator) and (is_known or not names):
            names = named
    if not names and not units[1]:
        _check_nearest(texts, block, separator, refuse)
    columns = names or [
        TableColumn(place) for place in range(max(width, len(units[1])))
    ]
    return [column.with_units(*units, refuse) for column in columns]


def _has_numbers(words: Sequence[str]) -> bool:
    """Return whether a line of words has numbers, other than the unit 1."""
    return any(is_numeral(word) and word != "1" for word in words)


def _fits(named: Sequence[TableColumn], block: Block, separator: str) -> bool:
    """Return whether there is a column for each name; the last ones may be empty, or have words alone."""
    if len(named) <= block.width:
        return len(named) == block.width
    has_words = any(any(row.are_words[block.width :]) for row in block.rows)
    has_units_apart = any(is_spelt_as_unit(c.name) and not c.is_known for c in named)
    return has_words or not (_is_blank(separator) or has_units_apart)


def _check_nearest(
    texts: Sequence[tuple[Line, list[str]]],
    block: Block,
    separator: str,
    refuse: Refuse,
) -> None:
    """Refuse a head right above the rows that has too few names, or too many."""
    for line, words in texts[-1:]:
        known = [column_of(0, 0, text).is_known for text in words]
        # A comment, or words between blanks, may be prose that names a quantity.
        may_be_prose = line.is_comment or _is_blank(separator)
        if sum(known) > may_be_prose:
            count = f"{len(words)} names for {block.width} columns"
            raise refuse(f"line {line.number} has {count}: give one for each")


def _names_in(line: Line, width: int, separator: str) -> list[str]:
    """Names in a line: as cells are divided, or as comments and lines between blanks may have it.

    There a name may have blanks within, or one in front of its bracket, and commas may
    stand between; a comment may follow.
    """
    own = list(line.cells)
    ways = [own]
    if line.is_comment or _is_blank(separator):
        plain = line.text.strip()
        ways = [
            re.split(r"\s+(?![\[(])", plain),
            re.split(r"\s{2,}|\t", plain),
            re.split(r"\s*[,;\t]\s*", plain),
            own,
        ]
    short = re.split(r"\s(?:#|//|!)", line.text)[0]
    if short != line.text:
        ways.append(_split(short, separator))
    fitting = [names for names in ways if len(names) == width]
    known = [names for names in fitting if _is_known(names)]
    return next(iter([*known, *fitting, *ways]))


def fitted(block: Block, width: int, separator: str, refuse: Refuse) -> list[list[str]]:
    """Cells of rows, as many as there are columns; words behind the last one are remarks."""
    cells = []
    for row in block.rows:
        # Between blanks nothing says which cell lacks.
        is_gap_row = _is_blank(separator) and row.width < block.width
        cells.append([""] * width if is_gap_row else _cells_of(row, width, refuse))
    return cells


def _cells_of(row: Line, width: int, refuse: Refuse) -> list[str]:
    cells = list(row.cells)
    lacking = width - len(cells)
    if lacking >= 0:
        return cells + [""] * lacking
    if row.are_words[width - 1]:
        return [*cells[: width - 1], " ".join(cells[width - 1 :])]
    if row.are_words[width]:
        return cells[:width]
    raise refuse(f"line {row.number} has {len(cells)} cells for {width} columns")
