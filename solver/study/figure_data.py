"""What a figure of a report is: curves, the claim that it tests, and the numbers that decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from solver.arrays import Array

HUES = (
    *("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9"),
    *("#7B5CE0", "#999933", "#8C564B", "#B3003C", "#1F9AA0"),
)
"""Of curves, from hue 1 on: Okabe and Ito's palette, told apart by the colour-blind, and five more
for panels of more curves, which have marks besides."""
Line = Literal["solid", "dashed", "dotted", "points"]


@dataclass(frozen=True, eq=False)
class PanelAxis:
    """A quantity, its unit (empty for a pure number), and whether decades are evenly spaced.

    Attributes
    ----------
    limits
        What is shown; all of the curves without it.
    whole
        Whether only whole numbers have a meaning.
    """

    quantity: str
    unit: str = ""
    logarithmic: bool = False
    limits: tuple[float, float] | None = None
    whole: bool = False

    @property
    def label(self) -> str:
        """Quantity and unit."""
        return f"{self.quantity} ({self.unit})" if self.unit else self.quantity

    @property
    def scale(self) -> Literal["log", "linear"]:
        """How it is divided."""
        return "log" if self.logarithmic else "linear"


@dataclass(frozen=True, eq=False)
class PanelCurve:
    """One line of a panel.

    Attributes
    ----------
    label
        Entry of the legend.
    x, y
        Shape (n,), in the units of the axes.
    hue
        Curves of one hue belong together; 0 is the neutral one, of references.
    line
        How it is drawn; "points" are joined by a thin line.
    """

    label: str
    x: Array
    y: Array
    hue: int
    line: Line = "solid"


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes with its curves."""

    title: str
    x: PanelAxis
    y: PanelAxis
    curves: tuple[PanelCurve, ...]


@dataclass(frozen=True)
class Finding:
    """A measured answer to a claim, or to a part of it.

    Attributes
    ----------
    text
        One sentence with the numbers in it.
    values
        The same numbers by name.
    holds
        Whether they bear out the claim.
    """

    text: str
    values: Mapping[str, float]
    holds: bool


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, drawn again.

    Attributes
    ----------
    number
        Its number in the paper.
    claim
        What the paper says that it shows, in one sentence.
    caption
        What is drawn, and the choices that the paper leaves.
    """

    number: int
    title: str
    panels: tuple[Panel, ...]
    claim: str
    findings: tuple[Finding, ...]
    caption: str

    @property
    def values(self) -> dict[str, float]:
        """All numbers of the findings, by name."""
        return {name: value for found in self.findings for name, value in found.values.items()}

    @property
    def verdict(self) -> str:
        """Whether the claim holds: "holds", "holds in part" or "does not hold"."""
        held = [found.holds for found in self.findings]
        return "holds" if all(held) else "holds in part" if any(held) else "does not hold"
