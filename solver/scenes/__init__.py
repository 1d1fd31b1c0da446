"""The catalogue of scenes: a name, its settings, and the function that makes its data."""

from __future__ import annotations

from dataclasses import dataclass

from solver.scenes.bar import BarSettings
from solver.scenes.strand import StrandSettings
from solver.settings import Settings


@dataclass(frozen=True)
class Entry:
    """One scene of the catalogue."""

    title: str
    source: str
    settings: type[Settings]


CATALOGUE = {
    "bar": Entry(
        "Clamped bar on a rough support",
        "paper, section 3, Table 1",
        BarSettings,
    ),
    "strand": Entry(
        "Parallel wires that rub on each other, one of them broken",
        "closed form: force regained over T / (mu p)",
        StrandSettings,
    ),
}
