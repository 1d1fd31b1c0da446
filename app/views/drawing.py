"""What views draw, as plain data: curves, marks, images, bodies, on two axes; no browser, no Panel.

A view looks at a `Scene` and gives a `Drawing`. The figure that it is drawn on is made once, by
`app.figures`; only what changed is sent (`app.worker.easel`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.views.legend import Key
from app.worker.frames import Frame
from app.worker.recording import Recording
from app.worker.shown import Look
from solver.settings import Settings

BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#8A8A8A"
SKY, VERMILION = "#56B4E9", "#D55E00"
BACKWARD, STICK, FORWARD, OPEN = BLUE, "#D9D9D9", ORANGE, "#4D4D4D"
VIRIDIS = ("#470e61", "#433d84", "#33628d", "#25828e", "#1fa287", "#42be71", "#91d742", "#d8e219")


@dataclass(frozen=True)
class Scene:
    """What is looked at in one moment.

    Attributes
    ----------
    run, before
        The run at work and the last one worth comparing with.
    past
        Finished runs, oldest first.
    frame
        The fields that are shown.
    instant
        Index of the chosen instant.
    look
        Where one looks.
    """

    run: Recording
    before: Recording | None
    past: Sequence[Recording]
    frame: Frame
    instant: int
    look: Look


@dataclass(frozen=True, eq=False)
class Curve:
    """One line through points; a NaN interrupts it."""

    x: ArrayLike
    y: ArrayLike
    color: str
    width: float = 2.5
    dash: str = "solid"
    alpha: float = 1.0
    name: str = ""


@dataclass(frozen=True, eq=False)
class Marks:
    """Points of one kind: "circle" (filled), "ring" or "cross"."""

    x: ArrayLike
    y: ArrayLike
    color: str
    kind: str = "circle"


@dataclass(frozen=True, eq=False)
class Image:
    """Cells of equal size, row by row from below, and the values that colours span."""

    values: NDArray[Any]
    left: float
    low: float
    width: float
    height: float


@dataclass(frozen=True, eq=False)
class Bodies:
    """Quadrilaterals: corners (n_quads, 4), places (n_nodes, 2), values (n_quads,).

    Attributes
    ----------
    box
        Left, right, low and high end of what is to be seen, to one scale.
    """

    corners: NDArray[np.int32]
    places: NDArray[np.float32]
    values: NDArray[np.float32]
    box: tuple[float, float, float, float]


@dataclass(frozen=True)
class Axis:
    """Its ends, and its label and ticks where they change."""

    low: float
    high: float
    label: str | None = None
    ticks: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Colors:
    """Values at both ends of a colour map, the marks beside it, and their unit."""

    low: float
    high: float
    ticks: tuple[float, ...]
    title: str | None = None


@dataclass(frozen=True, eq=False)
class Drawing:
    """One view of one iterate.

    Attributes
    ----------
    keys
        Its legend.
    kept
        What the view wants to be given with the next scene, as limits that it would rather hold.
    """

    x: Axis | None = None
    y: Axis | None = None
    curves: Sequence[Curve] = ()
    marks: Sequence[Marks] = ()
    image: Image | None = None
    bodies: Bodies | None = None
    colors: Colors | None = None
    keys: Sequence[Key] = ()
    kept: Any = None


@dataclass(frozen=True)
class Plot:
    """The figure of a view, which is made once.

    Attributes
    ----------
    x_label, y_label
        Titles of the axes, until a drawing has others.
    logarithmic
        Which axes are: "", "y", "xy".
    palette
        Colours of an image or of bodies.
    scale
        Title of the scale beside them; empty has none.
    marks
        Kinds of marks, each with its colour and without points.
    equal
        Whether both axes have one scale.
    names
        What the name of a curve is called where one points at it; empty shows none.
    chooses
        What a tap or a drag chooses with its height: "instant", "substructure" or nothing.
    whole
        Whether the values across, up, or both are whole numbers: "", "x", "y".
    """

    x_label: str
    y_label: str
    logarithmic: str = ""
    palette: tuple[str, ...] = ()
    scale: str = ""
    marks: tuple[Marks, ...] = ()
    equal: bool = False
    names: str = ""
    chooses: str = ""
    whole: str = ""


@dataclass(frozen=True)
class View:
    """One plot of the page.

    Attributes
    ----------
    name
        Its name in the choice of views.
    plot
        Its figure.
    applies
        Tells whether the view says anything about a run with such settings.
    draw
        Gives the drawing of a scene, None as long as the scene has not what it needs; also given
        what the drawing before wanted to be kept.
    watches
        What a frame must carry beyond the fields, or an empty text.
    """

    name: str
    plot: Plot
    applies: Callable[[Settings], bool]
    draw: Callable[[Scene, Any], Drawing | None]
    watches: str = ""
    slug: str = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "slug", self.name.lower().replace(" ", "-"))


def across(places: Sequence[float], axis: Axis, **style: Any) -> Curve:
    """Give lines over the whole width of a plot at some heights, as one curve."""
    return _rules(places, axis, upright=False, **style)


def upright(places: ArrayLike, axis: Axis, **style: Any) -> Curve:
    """Give lines over the whole height of a plot at some places, as one curve."""
    return _rules(places, axis, upright=True, **style)


def _rules(places: ArrayLike, axis: Axis, *, upright: bool, **style: Any) -> Curve:
    one = np.repeat(np.asarray(places, dtype=np.float64), 3)
    other = np.tile([axis.low, axis.high, np.nan], len(one) // 3)
    return Curve(one, other, **style) if upright else Curve(other, one, **style)


def length_of(settings: Settings) -> float:
    """Give the length of a scene, m, which all axes along it show from end to end."""
    return float(settings.values()["length"])


def spanned(low: float, high: float, **options: Any) -> Axis:
    """Give an axis between two ends, of some length in any case."""
    if not high > low:
        low, high = low - 0.5, high + 0.5
    return Axis(float(low), float(high), **options)


def in_decades(low: float, high: float) -> Axis:
    """Give a logarithmic axis, marked at whole decades: a small plot has room for no more."""
    powers = range(round(np.log10(low)), round(np.log10(high)) + 1)
    ticks = tuple(10.0**power for power in powers)[:: max(1, len(powers) // 5)]
    return Axis(float(low), float(high), ticks=ticks)


def shaded(count: int, palette: Sequence[str] = VIRIDIS) -> list[str]:
    """Give so many colours between those of a palette."""
    anchors = np.array([[int(one[i : i + 2], 16) for i in (1, 3, 5)] for one in palette])
    places = np.linspace(0, len(anchors) - 1, max(count, 2))
    mixed = [np.interp(places, range(len(anchors)), anchors[:, part]) for part in range(3)]
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.array(mixed).T.round().astype(int)]
