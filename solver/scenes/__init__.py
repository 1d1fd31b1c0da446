"""The catalogue of scenes: a name, its settings, and the function that makes its data."""

from __future__ import annotations

from dataclasses import dataclass

from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings
from solver.scenes.layers import LayersSettings
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
    "block": Entry(
        "Block pressed and sheared",
        "Johnson, Contact Mechanics, 1985, ch. 4 and 7",
        BlockSettings,
    ),
    "layers": Entry(
        "Stack of layers, bent",
        "a leaf spring, or the section of a cable laid flat",
        LayersSettings,
    ),
    "strand": Entry(
        "Parallel wires, one broken",
        "closed form: force regained over T / (mu p)",
        StrandSettings,
    ),
}
