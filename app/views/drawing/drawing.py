"""What views draw, as plain data: curves, marks, images, bodies, on two axes; no browser, no Panel.

A view looks at a `Scene` and gives a `Drawing`. The figure that it is drawn on is made once, by
`app.views.drawing.figures`; only what changed is sent (`app.worker.painter`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from app.views.drawing.handles import Handle
from app.views.drawing.legend import Key
from app.views.scene import Scene
from solver.arrays import Array
from solver.scenes import kind_of
from solver.settings import Settings

POSITION = "Position x"
"""Title of axes along the bodies, m."""
TIME = "Time t"
"""Title of axes over time, s."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One line through points; a NaN interrupts it.

    Attributes
    ----------
    dx, dy
        Pixels that it lies right of and above them, one or one of each point.
    """

    x: ArrayLike
    y: ArrayLike
    color: str
    width: float = 2.5
    dash: str = "solid"
    alpha: float = 1.0
    name: str = ""
    dx: ArrayLike = 0.0
    dy: ArrayLike = 0.0


@dataclass(frozen=True, eq=False)
class Marks:
    """Points of one kind: "circle" (filled), "ring" or "cross"."""

    x: ArrayLike
    y: ArrayLike
    color: str
    kind: str = "circle"


@dataclass(frozen=True)
class Word:
    """A value beside what it belongs to, and how it is aligned there, across and up.

    Attributes
    ----------
    dx, dy
        Pixels that it stands right of and above its place.
    """

    x: float
    y: float
    text: str
    across: str = "left"
    up: str = "middle"
    dx: float = 0.0
    dy: float = 0.0


@dataclass(frozen=True, eq=False)
class Image:
    """Cells of equal size, row by row from below, and the values that colours span."""

    values: NDArray[Any]
    left: float
    low: float
    width: float
    height: float


@dataclass(frozen=True)
class Box:
    """What is to be seen of bodies, to one scale.

    Attributes
    ----------
    left, right, low, high
        Its ends, m.
    room
        Pixels left, right, below and above that are kept free for what has a size of its own.
    lines
        Lines of words below and above these.
    flattest
        Metres up in a pixel, at least, where heights are not to scale; 0 where they are.
    filled
        Share of the height, without words, that bodies are to have where it is not to scale.
    """

    left: float
    right: float
    low: float
    high: float
    room: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    lines: tuple[int, int] = (0, 0)
    flattest: float = 0.0
    filled: float = 0.5


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Quadrilaterals: corners (n_quads, 4), places (n_nodes, 2), values (n_quads,).

    Or other polygons, of as many corners each.

    Attributes
    ----------
    box
        What is to be seen.
    along
        Position of each along the undeformed body, shape (n_quads,), m, where it can be chosen.
    lines
        How opaque the lines around each are.
    """

    corners: NDArray[np.int32]
    places: NDArray[np.float32]
    values: NDArray[np.float32]
    box: Box
    along: NDArray[np.float32] | None = None
    lines: float = 1.0


@dataclass(frozen=True)
class Axis:
    """Its ends, and its label, unit and ticks where they change.

    Attributes
    ----------
    unit
        That of all that stands on it. As a view gives it, it is the SI unit that the page may turn
        into another (`app.views.drawing.in_units`); empty for what stands as it is.
    """

    low: float
    high: float
    label: str | None = None
    ticks: tuple[float, ...] | None = None
    unit: str = ""


@dataclass(frozen=True)
class Colors:
    """Values at both ends of a colour map, and their unit, as that of an axis."""

    low: float
    high: float
    unit: str = ""


@dataclass(frozen=True, eq=False)
class Drawing:
    """One view of one iterate.

    Attributes
    ----------
    keys
        Its legend.
    sentence
        What it shows, for whoever sees it for the first time; stands below its name.
    handles
        What can be dragged.
    contacts
        Interfaces that can be chosen: their names, and where each lies, shape (n, 2), m.
    kept
        What the view wants to be given with the next scene, as limits that it would rather hold.
    """

    x: Axis | None = None
    y: Axis | None = None
    curves: Sequence[Curve] = ()
    marks: Sequence[Marks] = ()
    words: Sequence[Word] = ()
    image: Image | None = None
    bodies: QuadMesh | None = None
    colors: Colors | None = None
    keys: Sequence[Key] = ()
    sentence: str = ""
    handles: Sequence[Handle] = ()
    contacts: Mapping[str, Array] = field(default_factory=dict)
    kept: Any = None


@dataclass(frozen=True)
class Plot:
    """The figure of a view, which is made once.

    Attributes
    ----------
    x_label, y_label
        Titles of the axes, until a drawing has others; without them there are no axes.
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
    words
        Whether values stand in it.
    names
        What the name of a curve is called where one points at it; empty shows none.
    chooses
        What a tap or a drag chooses: with its height "instant" or "substructure", with its place
        along x "time"; or nothing.
    is_touched
        Whether one drags handles in it, which settings follow, and taps on interfaces and places.
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
    words: bool = False
    names: str = ""
    chooses: str = ""
    is_touched: bool = False
    whole: str = ""


def is_plane(settings: Settings) -> bool:
    """Tell whether there are plane bodies, which press on each other as they deform."""
    return kind_of(settings) == "plane"


def has_instants(settings: Settings) -> bool:
    """Tell whether there are several instants: one makes no loop, and has one singular value."""
    return settings.instants > 1


@dataclass(frozen=True)
class View:
    """One plot of the page.

    Attributes
    ----------
    name
        Its name in the choice of views.
    plot
        Its figure.
    draw
        Gives the drawing of a scene, None as long as the scene has not what it needs; also given
        what the drawing before wanted to be kept.
    applies
        Tells whether the view says anything about a run with such settings.
    """

    name: str
    plot: Plot
    draw: Callable[[Scene, Any], Drawing | None]
    applies: Callable[[Settings], bool] = lambda settings: True
    slug: str = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "slug", self.name.lower().replace(" ", "-"))
