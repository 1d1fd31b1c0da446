"""The decimal sign of a table: point or comma."""

from __future__ import annotations

from collections.abc import Sequence

from solver.files.numerals import SIGNS, decimal_signs
from solver.files.table_lines import Line
from solver.settings.values import Refuse


def notation_of(
    rows: Sequence[Line], separator: str, refuse: Refuse
) -> tuple[str, list[str]]:
    """Decimal sign of a table, and messages on signs between thousands.

    By the rules of `solver.files.tables`.
    """
    # Most tables have points alone: then no cell is matched a second time.
    if not any(map(_has_doubtful_sign, rows)):
        return ".", []
    sure, unsure = _cells_by_sign(rows)
    _check_alike(sure, refuse)
    # Commas before three digits alone, as 1,234: nothing in the table says whether they
    # are decimal.
    if not sure["."] and not sure[","] and unsure[","]:
        # Programs write semicolons between columns where the comma is decimal.
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
    if unsure[other] or any(other in cell for _, cell in sure[decimal]):
        names = {",": "commas", ".": "points"}
        return decimal, [f"thousands with {names[other]}"]
    return decimal, []


def _has_doubtful_sign(row: Line) -> bool:
    """Check whether a cell has a comma, or points that cannot all be decimal."""
    return any("," in cell or cell.count(".") > 1 for cell in row.cells)


CellsBySign = dict[str, list[tuple[int, str]]]
"""Cells with the number of their line, by a decimal sign."""


def _cells_by_sign(rows: Sequence[Line]) -> tuple[CellsBySign, CellsBySign]:
    """Cells that are numbers with only one decimal sign, by sign, and with both."""
    sure: CellsBySign = {sign: [] for sign in SIGNS}
    unsure: CellsBySign = {sign: [] for sign in SIGNS}
    for row in rows:
        for cell in row.cells:
            if "," not in cell and "." not in cell:
                continue
            signs = decimal_signs(cell)
            if len(signs) == 1:
                sure[signs].append((row.number, cell))
            elif signs:
                unsure["," if "," in cell else "."].append((row.number, cell))
    return sure, unsure


def _check_alike(sure: CellsBySign, refuse: Refuse) -> None:
    """Refuse decimal points and commas in one table; name a line of the rarer one."""
    if not sure["."] or not sure[","]:
        return
    # Likely the rarer one is the slip, so its line is named.
    rare = "," if len(sure[","]) <= len(sure["."]) else "."
    line, cell = sure[rare][0]
    names = {",": "comma", ".": "point"}
    common = "." if rare == "," else ","
    raise refuse(
        f"line {line} has {cell!r}, with a decimal {names[rare]} where others have a "
        f"{names[common]}: write all of them alike, and thousands without a sign"
    )
