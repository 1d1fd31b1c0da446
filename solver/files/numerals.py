"""Numbers as people and programs write them.

A numeral is a sign, digits with a decimal point or comma, and an exponent. Its minus
may be one that is printed (U+2212, an en dash); its exponent may be Fortran's:
`1.5D-03`, `1.5-103`. Digits may stand in groups of three: between points, commas,
apostrophes, or blanks (narrow and no-break ones, too). A cell without a number is a
gap: empty, `NaN`, `n/a`, `-`, `****` and the like.
"""

from __future__ import annotations

import math
import re

GAPS = {
    "",
    "-",
    "--",
    "---",
    "–",
    "—",
    "?",
    "nan",
    "+nan",
    "-nan",
    "nan(ind)",
    "-nan(ind)",
    "1.#qnan",
    "1.#ind",
    "-1.#ind",
    "na",
    "n/a",
    "n.a.",
    "#n/a",
    "#na",
    "#nv",
    "#value!",
    "#wert!",
    "#div/0!",
    "#num!",
    "#zahl!",
    "null",
    "none",
}
"""Cells without a number, in small letters, beside the asterisks of an overflow in
Fortran."""
_APART = " \u00a0\u2009\u202f'’"
"""Characters that may stand between groups of digits and are never a decimal sign."""
_DROPPED = str.maketrans("", "", _APART)
_MINUS = str.maketrans("−–", "--")
SIGNS = ".,"
"""Decimal signs."""
LONGEST = 64
"""Largest number of characters of a typed number: each start is tried as one."""


def _pattern(decimal: str, thousands: str) -> re.Pattern[str]:
    """Pattern of numbers with a decimal sign, and another sign between thousands."""
    point = re.escape(decimal)
    digits = rf"(?:\d+{point}?\d*|{point}\d+)"
    # Fortran leaves the letter out before three digits; without a point that is a part
    # number.
    fortran = rf"(?:\d+{point}\d*|{point}\d+)[+-]\d{{3}}"
    # One sign between all groups of a number: the first one is referred to by \1.
    groups = (
        rf"[1-9]\d{{0,2}}([{thousands}{_APART}])\d{{3}}(?:\1\d{{3}})*(?:{point}\d*)?"
    )
    exponent = r"(?:[edq][+-]?\d+)?"
    infinite = "inf(?:inity)?"
    numeral = rf"[+-]?(?:{digits}{exponent}|{fortran}|{groups}|{infinite})"
    return re.compile(numeral, re.IGNORECASE | re.ASCII)


_PLAIN = re.compile(
    r"[+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[+-]?\d+)?", re.IGNORECASE | re.ASCII
)
"""Numerals as almost all are: one decimal sign, no groups."""
_GROUP = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)
"""Numerals whose only sign may be a decimal one, or stand between thousands."""
_PATTERNS = {
    ".": _pattern(".", ","),
    ",": _pattern(",", "."),
}


def is_gap(cell: str) -> bool:
    """Check whether a cell is a gap: empty, or a word for a missing number."""
    return cell.lower() in GAPS or (cell.startswith("*") and not cell.strip("*"))


def decimal_signs(cell: str) -> str:
    """Decimal signs with which a cell is a number: both (`1,234`), one, or none."""
    if _PLAIN.fullmatch(cell):
        # Almost all cells are plain, and spare two larger patterns.
        if not ("." in cell or "," in cell) or _GROUP.fullmatch(cell):
            return SIGNS
        return "." if "." in cell else ","
    plain = cell.translate(_MINUS)
    return "".join(sign for sign in SIGNS if _PATTERNS[sign].fullmatch(plain))


def is_numeral(cell: str) -> bool:
    """Check whether a cell is a number with either decimal sign."""
    return _PLAIN.fullmatch(cell) is not None or bool(decimal_signs(cell))


def number(cell: str, decimal: str) -> float:
    """Value of a cell with a decimal sign; NaN for a gap or a word."""
    thousands = "." if decimal == "," else ","
    # The quick way of almost all cells.
    if thousands not in cell and _PLAIN.fullmatch(cell):
        return float(cell.replace(",", "."))
    plain = cell.translate(_MINUS)
    if not _PATTERNS[decimal].fullmatch(plain):
        return math.nan
    plain = plain.translate(_DROPPED).replace(thousands, "")
    plain = plain.replace(decimal, ".").lower()
    # Exponents of Fortran
    plain = re.sub("[dq]", "e", plain)
    return float(re.sub(r"(?<=[\d.])([+-]\d{3})$", r"e\1", plain))


def leading_number(text: str) -> tuple[float, str]:
    """Number at the start of a typed text, or NaN, and the text after the number.

    A lone sign before three digits is a decimal one, as in `1.234` and `1,234`.
    """
    plain = text.strip()
    # The longest start that is a number: a blank may part thousands, or the unit.
    for end in range(min(len(plain), LONGEST), 0, -1):
        start = plain[:end].rstrip()
        signs = decimal_signs(start)
        if signs:
            decimal = signs
            if len(signs) > 1:
                decimal = "," if "," in start else "."
            return number(start, decimal), plain[end:].strip()
    return math.nan, plain
