"""Where cards stand: the picture of the scene as large as it deserves, all else beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.picture.portrait import size_of
from app.views.bodies import deformed, picture
from app.views.drawing.drawing import View
from solver.scenes import structure_of
from solver.settings import Settings

LONG = 2.5
"""Times its height from which a scene is as long that its picture gets the whole width."""
A_ROW, ROWS = 3, 2
"""Cards beside each other at most, and rows of them that fit the window."""
LEAST = 152
"""Height of a card with two lines of legend, in which the title of an axis is seen, px."""
BESIDE = (
    ("p",),
    ("p a",),
    ("p a", "p b"),
    ("p a", "b c"),
    ("p a b", "p c d"),
    ("p a b", "p c d", "e c d"),
)
"""Where a picture that is not long stands, by the number of the cards beside it."""


@dataclass(frozen=True)
class Layout:
    """A grid of cards, as CSS has it.

    Attributes
    ----------
    template
        Rows with the names of their areas, and columns.
    areas
        Of every card.
    row
        Height of the rows that the window is too low for.
    is_long
        Whether the first card is a picture that has the whole width.
    """

    template: str
    areas: Sequence[str]
    row: str
    is_long: bool


def layout(views: Sequence[View], settings: Settings) -> Layout:
    """Arrange views, of which the first may be a picture of the bodies."""
    has_picture = bool(views) and views[0] in (picture.VIEW, deformed.VIEW)
    is_long = has_picture and _is_long(settings)
    if has_picture and not is_long:
        return _beside(len(views) - 1)
    return _in_rows(len(views) - is_long, has_band=is_long)


def _is_long(settings: Settings) -> bool:
    length, height = size_of(structure_of(settings).described())
    return length >= LONG * height


def _beside(others: int) -> Layout:
    """Put a picture at the left; where five others are beside it, one of them is below it."""
    rows = BESIDE[min(others, len(BESIDE) - 1)]
    heights = (50, 12, 38) if len(rows) == 3 else [100 // len(rows)] * len(rows)
    gap = f"{8 * (len(rows) - 1) / len(rows):g}px"
    drawn = " ".join(
        f'"{names}" calc({high}% - {gap})' for names, high in zip(rows, heights, strict=True)
    )
    columns = len(rows[0].split())
    wide = "minmax(0, 6fr) " + "minmax(0, 5fr) " * (columns - 1)
    # The load path, which is drawn before them, stands below the picture.
    areas = ["p", *("abecd" if others >= 5 else "abcd")[:others], *["auto"] * (others - 5)]
    return Layout(f"{drawn} / {wide}", areas, "max(180px, 50% - 4px)", is_long=False)


def _in_rows(count: int, *, has_band: bool) -> Layout:
    """Put cards in rows, the first of which have more; a band of the whole width comes first."""
    rows = max(-(-count // A_ROW), 1)
    of_rows = [count // rows + (number < count % rows) for number in range(rows)]
    spans = [6 // of_row for of_row in of_rows for _ in range(of_row)]
    band = (32 if rows > 1 else 38) if has_band else 0
    seen = min(rows, ROWS)
    gaps = 8 * (seen - 1 + has_band) / seen
    row = f"max({LEAST}px, {(100 - band) / seen:g}% - {gaps:g}px)"
    first = f"max(110px, {band}%) " if has_band else ""
    areas = [f"auto / span {span}" for span in spans]
    return Layout(
        f"{first}repeat({rows}, {row}) / repeat(6, minmax(0, 1fr))",
        ["1 / 1 / auto / -1", *areas] if has_band else areas,
        row,
        is_long=has_band,
    )
