"""Structures: what they are to be solved and drawn, and the hysteresis loop that they show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array
from solver.discrete.contacts import ContactFields
from solver.discrete.probes import Probe
from solver.discrete.problem import Problem

OUTWARD = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "bottom": (0.0, -1.0),
    "top": (0.0, 1.0),
}
"""Sides of all bodies together, and the normal of each."""
Way = tuple[float, float]


def on_side(side: str, shares: ArrayLike) -> Array:
    """Places on a side from its lower or left end on, (n, 2), as shares of length and height.

    `shares` of the side, shape (n,); on no side ("body") they are along the middle.
    """
    along = np.asarray(shares, dtype=float)
    x = {"left": 0.0, "right": 1.0}.get(side, along)
    y = {"bottom": 0.0, "top": 1.0, "body": 0.5}.get(side, along)
    return np.stack(
        [np.broadcast_to(x, along.shape), np.broadcast_to(y, along.shape)], axis=1
    )


@dataclass(frozen=True, eq=False)
class Act:
    """A force, or a displacement, that is given.

    Attributes
    ----------
    where
        "right x": along a side; or "body": throughout.
    places
        Where on the undeformed bodies, shape (n, 2), as shares of their length and
        height.
    towards
        Direction of positive values, a unit vector, or one of each instant, (2,
        n_instants).
    values
        Over time, shape (n_instants,) or, of each place, (n, n_instants).
    """

    where: str
    symbol: str
    places: Array
    towards: Way | Array
    values: Array
    unit: str

    @property
    def away(self) -> Way:
        """Direction in which there is room for an arrow, a unit vector."""
        return OUTWARD.get(self.where.partition(" ")[0], OUTWARD["right"])


@dataclass(frozen=True, eq=False)
class Hold:
    """What holds bodies at a side.

    Attributes
    ----------
    kind
        A support is rigid and rough; below an image the bodies go on, turned by half a
        turn; a spring pulls along x, at the foot of its side.
    side
        Of all bodies together.
    stretch
        Ends of the part that is held, as shares of the side.
    moved
        Displacement of a clamp along x, shape (n_instants,), m, where it has one.
    gap
        Opening of a support that goes on beyond the bodies, at nodes along it, shape
        (n_nodes,), m.
    """

    kind: Literal["clamp", "rollers", "support", "image", "spring"]
    side: str
    stretch: tuple[float, float] = (0.0, 1.0)
    moved: Array | None = None
    gap: Array | None = None


@dataclass(frozen=True, eq=False)
class Description:
    """A structure in words: all that a picture of it shows before anything is solved.

    Attributes
    ----------
    bodies
        Number of equal bodies above each other.
    length, height
        Of all of them, m; rods have no height.
    acts
        All that acts; what is zero throughout is left out.
    tilt
        Angle over time by which the x axis rises, shape (n_instants,), rad, where it
        does.
    broken
        Number of the broken body, from 0, and where it is broken, m; where one is.
    """

    bodies: int
    length: float
    height: float | None
    instants: Array
    acts: Sequence[Act]
    holds: Sequence[Hold]
    tilt: Array | None = None
    broken: tuple[int, float] | None = None

    def __post_init__(self) -> None:
        """Leave out what is zero throughout."""
        acts = tuple(act for act in self.acts if np.any(act.values))
        object.__setattr__(self, "acts", acts)


class LoopFields(Protocol):
    """What a loop is taken from: an iterate, or a reference; SI, shape (n, n_instants)."""

    @property
    def displacement(self) -> Array:
        """Displacement of the problem's degrees of freedom, m."""

    def contact(self, name: str) -> ContactFields:
        """Fields of one interface with friction."""


Axes = tuple[tuple[str, str], tuple[str, str]]
"""Titles and units of a loop's displacement and force."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A force over the displacement that it works on; what is inside the loop is dissipated.

    Or over whatever drives it: then the loop shows how it lags behind. Both have a
    title and a unit; the force is found in N, shape (n_instants,).
    """

    across: tuple[str, str]
    up: tuple[str, str]
    displacement: Probe
    force: Callable[[LoopFields], Array]

    @property
    def axes(self) -> Axes:
        """Titles and units of displacement and force."""
        return self.across, self.up

    def along(self, fields: LoopFields) -> tuple[Array, Array]:
        """Displacement and force of an iterate, or of a reference, each (n_instants,)."""
        return self.displacement.of(fields), self.force(fields)

    def finds_force(self, problem: Problem) -> bool:
        """Whether its displacement is given in a problem, so that its force is found."""
        return bool(np.isin(self.displacement.dofs, problem.prescribed[0]).all())


class Structure(Protocol):
    """Bodies, how they are held and what acts on them, as plain data: `Rods`, `Rope`, `Stack`."""

    def discretise(self) -> Problem:
        """Make the discrete problem."""

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop, which are known without a problem."""

    def loop(self, problem: Problem) -> Loop:
        """The hysteresis loop that it shows; forces in the plane for a metre of thickness."""

    def described(self) -> Description:
        """The structure in words, for whoever draws it."""
