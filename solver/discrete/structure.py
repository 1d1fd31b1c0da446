"""The `Structure` protocol; a description for drawings; the hysteresis loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from solver.arrays import Array
from solver.discrete.probes import LoopFields, Probe
from solver.discrete.problem import Problem

OUTWARD = {
    "left": (-1.0, 0.0),
    "right": (1.0, 0.0),
    "bottom": (0.0, -1.0),
    "top": (0.0, 1.0),
}
"""Sides of all bodies together, and the outward normal of each."""
MOVED = "u", "v"
"""Symbols of prescribed displacements along x and y: words in a drawing have no
subscripts."""
Direction = tuple[float, float]


def on_side(side: str, shares: ArrayLike) -> Array:
    """Points on a side, (n, 2), as shares of the length and the height of all bodies.

    `shares` are their distances from the lower or left end of the side over its length,
    shape (n,). On the side "body" the points lie along the middle.
    """
    along = np.asarray(shares, dtype=float)
    # A side fixes one coordinate, and the shares run along the other.
    x = {"left": 0.0, "right": 1.0}.get(side, along)
    y = {"bottom": 0.0, "top": 1.0, "body": 0.5}.get(side, along)
    columns = [np.broadcast_to(x, along.shape), np.broadcast_to(y, along.shape)]
    return np.stack(columns, axis=1)


@dataclass(frozen=True, eq=False)
class Act:
    """An arrow of a load, or of a prescribed displacement, for drawings.

    Attributes
    ----------
    where
        Side and component, as "right x", or "body" for a load on the whole body.
    symbol, unit
        Symbol of the values, and their SI unit.
    points
        Points on the undeformed bodies, shape (n, 2), as shares of their length and
        height; of a load that travels those of each instant, (n, 2, n_instants).
    towards
        Direction of positive values, a unit vector, or one of each instant, (2,
        n_instants).
    values
        Values over time, shape (n_instants,), or those of each place, (n, n_instants).
    outward
        Unit vector out of the body where the load acts; None: that of its side.
    """

    where: str
    symbol: str
    points: Array
    towards: Direction | Array
    values: Array
    unit: str
    outward: Direction | None = None

    @property
    def away(self) -> Direction:
        """Unit vector out of the body, towards free space for an arrow."""
        if self.outward is not None:
            return self.outward
        return OUTWARD.get(self.side, OUTWARD["right"])

    @property
    def side(self) -> str:
        """Side of all bodies: as `where` names, or to which the outward vector points.

        "body" for a load on the whole body.
        """
        if self.outward is None:
            return self.where.partition(" ")[0]
        return max(OUTWARD, key=lambda side: np.dot(OUTWARD[side], self.away))

    def points_at(self, instant: int) -> Array:
        """Points, shape (n, 2), at an instant, as shares of length and height."""
        if self.points.ndim > 2:
            return np.asarray(self.points[:, :, instant])
        return self.points


def directed(force: Array) -> tuple[Array, Array]:
    """Direction, (2, n_instants), and size, (n_instants,), of a force, (2, n_instants).

    Where the force is zero the direction is, too.
    """
    size = np.hypot(*force)
    return force / np.where(size > 0.0, size, 1.0), size


def act_of_weight(weight: Array) -> Act:
    """Arrow of the weight of all bodies, shape (2, n_instants), N, in their middle."""
    return Act("body", "W", on_side("body", [0.5]), *directed(weight), "N")


@dataclass(frozen=True, eq=False)
class Hold:
    """A clamp, support or spring that holds bodies at a side.

    Attributes
    ----------
    kind
        A support is rigid and rough; below an image the bodies continue, turned by half
        a turn; a spring pulls along x, at the foot of its side.
    side
        Side of all bodies together.
    stretch
        Ends of the part that is held, as shares of the side.
    moved
        Displacement of a clamp along x, shape (n_instants,), m, where it moves.
    gap
        Opening of a support that continues beyond the bodies, at nodes along it, shape
        (n_nodes,), m.
    """

    kind: Literal["clamp", "rollers", "support", "image", "spring"]
    side: str
    stretch: tuple[float, float] = (0.0, 1.0)
    moved: Array | None = None
    gap: Array | None = None


@dataclass(frozen=True, eq=False)
class Footing:
    """Line of points along which bodies of any shape are supported or held.

    Attributes
    ----------
    kind
        A support is rigid and rough, and stands still; a clamp moves with the body, as
        do rollers, which hold it along one axis alone.
    points
        Points on the undeformed bodies, shape (n, 2), as shares of their length and
        height.
    outward
        Unit vectors out of the bodies, into what holds them, shape (n, 2).
    gap
        Opening between the points and a support, shape (n,), m; None: there is none.
    """

    kind: Literal["clamp", "rollers", "support"]
    points: Array
    outward: Array
    gap: Array | None = None


@dataclass(frozen=True, eq=False)
class Description:
    """Description of a structure for drawings, before anything is solved.

    Attributes
    ----------
    bodies
        Number of equal bodies above each other, or of bodies of any shape.
    length, height
        Size of all bodies together, m; rods have no height.
    instants
        Times, shape (n_instants,), s.
    acts
        Loads and prescribed displacements; those that are always zero are left out.
    holds
        Clamps, supports and springs.
    tilt
        Angle over time by which the x axis rises, shape (n_instants,), rad; None where
        it does not rise.
    broken
        Number of the broken body, from 0, and position of the break, m; None where no
        body is broken.
    footings
        Supports and held nodes of bodies of any shape, whose sides have no names; None
        of rods and rectangles.
    """

    bodies: int
    length: float
    height: float | None
    instants: Array
    acts: Sequence[Act]
    holds: Sequence[Hold]
    tilt: Array | None = None
    broken: tuple[int, float] | None = None
    footings: Sequence[Footing] | None = None

    def __post_init__(self) -> None:
        """Leave out loads and displacements that are always zero."""
        acts = tuple(act for act in self.acts if np.any(act.values))
        object.__setattr__(self, "acts", acts)


Axes = tuple[tuple[str, str], tuple[str, str]]
"""Titles and units of a loop's displacement and force."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A force over the displacement of its point; the area is dissipated energy.

    Of parallel wires, each pulled by the force, the area is one's share of it. Or a
    force, or a displacement, over the quantity that drives it: then the loop shows how
    it lags behind.

    Attributes
    ----------
    across, up
        Title and unit of the displacement, and of the force.
    displacement
        Displacement, or driving quantity, over time, from the fields.
    force
        Force over time, shape (n_instants,), N, from the fields.
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
        """Displacement and force of an iterate or a reference, (n_instants,) both."""
        return self.displacement.of(fields), self.force(fields)

    def finds_force(self, problem: Problem) -> bool:
        """Check whether the displacement is prescribed, and the force a result."""
        return bool(np.isin(self.displacement.dofs, problem.prescribed[0]).all())


class Structure(Protocol):
    """Bodies, supports and loads as plain data: `Rods`, `Rope`, `Stack`, `Bodies`."""

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop, known without a problem."""

    def loop(self, problem: Problem) -> Loop:
        """Hysteresis loop; forces in the plane are those for a metre of thickness."""

    def description(self) -> Description:
        """Description of the structure for drawings."""
