"""What a chart is, as plain data: curves on a pair of axes, or a map over two.

The engine says what is to be seen and draws nothing; who does is found by `solver.study.page`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from solver.arrays import Array, Flags, Indices

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
    names
        What stands at 0, 1, ... where these are no numbers.
    """

    quantity: str
    unit: str = ""
    logarithmic: bool = False
    limits: tuple[float, float] | None = None
    whole: bool = False
    names: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Quantity and unit."""
        return f"{self.quantity} ({self.unit})" if self.unit else self.quantity


@dataclass(frozen=True, eq=False)
class PanelCurve:
    """One line of a panel.

    Attributes
    ----------
    label
        Entry of the legend, if any.
    x, y
        Shape (n,), in the units of the axes; nothing is drawn through NaN.
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
class Runs:
    """Points of a chart that each stand for a run, in the order in which they came.

    Attributes
    ----------
    numbers
        Of the runs, shape (n,).
    x, y
        Where they stand, same shape; in a panel y is NaN where a run has no value.
    hues
        Of the curve to which they belong, same shape.
    holds
        Whether that is an answer, same shape.
    said
        What each is and came to, in words, n of them.
    """

    numbers: Indices
    x: Array
    y: Array
    hues: Indices
    holds: Flags
    said: Sequence[str]


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes with its curves, and the runs that these go through, if they do."""

    title: str
    x: PanelAxis
    y: PanelAxis
    curves: tuple[PanelCurve, ...]
    runs: Runs | None = None


@dataclass(frozen=True, eq=False)
class Map:
    """A quantity over two settings, whose values ascend.

    Attributes
    ----------
    scale, z
        Its values, shape (len(y_values), len(x_values)); NaN where there is none.
    is_sampled
        Whether a few runs stand for all, and values between them are of facets.
    """

    title: str
    x: PanelAxis
    y: PanelAxis
    x_values: Array
    y_values: Array
    scale: PanelAxis
    z: Array
    runs: Runs
    is_sampled: bool = False


Chart = Panel | Map
