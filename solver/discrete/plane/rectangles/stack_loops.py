"""Hysteresis loops of rectangular bodies, for each kind of drive."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from solver.arrays import Array, without_residue
from solver.discrete.plane.rectangles.sides import SETTLED, Side, SideComponent
from solver.discrete.probes import (
    LoopFields,
    constant,
    end_rotation,
    reaction,
    side_mean,
)
from solver.discrete.problem import Problem
from solver.discrete.structure import Axes, Loop

DRIVEN = "top", "left", "right"
"""Sides of a body on a support; the first that is loaded or moved drives the body."""


@dataclass(frozen=True, eq=False)
class SettlementLoop:
    """Force that the settled ground still carries, over its settlement.

    Attributes
    ----------
    settlement
        Settlement of each strip of ground, shape (n_strips, n_instants), m.
    """

    settlement: Array

    axes: ClassVar[Axes] = ("Settlement", "m"), ("Force on the settled ground", "N")

    def of(self, problem: Problem) -> Loop:
        """Loop of the strip that settles most, with forces of all settling strips."""
        most = np.abs(self.settlement).max(axis=1).argmax()
        names = [name for name in problem.contacts if name.startswith(SETTLED)]
        force = partial(_pressing_force, names)
        return Loop(*self.axes, constant(self.settlement[most]), force)


@dataclass(frozen=True, eq=False)
class SlopeLoop:
    """Force of the spring at the foot over the angle of the slope.

    The spring's force lags behind on the way back. `tilt` is the angle over time, shape
    (n_instants,), rad.
    """

    tilt: Array

    axes: ClassVar[Axes] = ("Angle of the slope", "°"), ("Spring force", "N")

    def of(self, problem: Problem) -> Loop:
        """Loop of any problem over the angle."""
        return Loop(*self.axes, constant(np.degrees(self.tilt)), _spring_force)


@dataclass(frozen=True, eq=False)
class MomentLoop:
    """Moment on the right end, shape (n_instants,), N m, over the end's rotation."""

    moment: Array

    axes: ClassVar[Axes] = ("Rotation of the end", "rad"), ("Moment", "N·m")

    def of(self, problem: Problem) -> Loop:
        """Loop of the ends of the longest bodies."""
        force = constant(self.moment).of
        return Loop(*self.axes, end_rotation(problem), force)


@dataclass(frozen=True, eq=False)
class DeflectionLoop:
    """Transverse force on the right end over its deflection.

    Attributes
    ----------
    given
        What is given along y on the right side.
    length
        Length of the right-hand sides of the longest bodies together, m.
    """

    given: SideComponent
    length: float

    axes: ClassVar[Axes] = ("Deflection of the end", "m"), ("Transverse force", "N")

    def of(self, problem: Problem) -> Loop:
        """Loop of the right side."""
        force = _force_on(problem, "right", 1, self.given, self.length)
        return Loop(*self.axes, side_mean(problem, "right", 1), force)


@dataclass(frozen=True, eq=False)
class ShearLoop:
    """Shear force on bodies on the ground over the displacement of a side.

    Attributes
    ----------
    side
        Side whose displacement is shown.
    given
        What is given along x on this side; None: the friction of the ground tells the
        force.
    length
        Length of the side, m.
    weight
        Weight of the bodies along a tilted ground, shape (n_instants,), N, which the
        friction of the ground carries, too; or 0.
    """

    side: str
    given: SideComponent | None
    length: float
    weight: Array | float = 0.0

    @property
    def axes(self) -> Axes:
        """Titles and units of displacement and force."""
        return (f"Displacement of the {self.side}", "m"), ("Shear force", "N")

    def of(self, problem: Problem) -> Loop:
        """Loop of the side, whose displacement is the mean along x."""
        if self.given is None:
            names = [name for name in problem.contacts if "support" in name]
            force: Callable[[LoopFields], Array] = partial(
                _rubbing_force, names, self.weight
            )
        else:
            force = _force_on(problem, self.side, 0, self.given, self.length)
        return Loop(*self.axes, side_mean(problem, self.side, 0), force)


StackLoop = SettlementLoop | SlopeLoop | MomentLoop | DeflectionLoop | ShearLoop


def loop_on_ground(
    sides: Mapping[str, Side],
    length: float,
    bodies: int,
    strips: int,
    weight: Array | float,
) -> ShearLoop:
    """Loop of bodies on the ground; of a single body: of the side that moves it.

    `length` is that of all bodies together, m; `bodies` and `strips` are the numbers of
    all bodies and of the strips of ground among them; `weight` is that along a tilted
    ground, (n_instants,), N, or 0.
    """
    side = "top"
    if bodies == 1:
        driven = [name for name in DRIVEN if not sides[name].is_zero]
        side = next(iter(driven), side)
    holding = [each for each in sides.values() if each.x.prescribed]
    # Sides that share a corner share its force, too: the ground gives the sum.
    if bodies == 1 or len(holding) > 1 + bool(strips):
        return ShearLoop(side, None, length, weight)
    return ShearLoop(side, sides[side].x, length)


def loop_of_end(end: Side, count: int, height: float) -> MomentLoop | DeflectionLoop:
    """Loop of the load that bends the right end of the `count` longest bodies.

    `height` is that of one body, m.
    """
    if end.y.prescribed or np.any(end.y.mean):
        return DeflectionLoop(end.y, count * height)
    moment = -count * height**2 / 6.0 * end.x.slope
    return MomentLoop(np.broadcast_to(moment, end.x.mean.shape))


def _force_on(
    problem: Problem, side: str, component: int, given: SideComponent, length: float
) -> Callable[[LoopFields], Array]:
    """Force on a side of a length, m: its reaction, or the resultant of a traction.

    It is over time, shape (n_instants,), N, for a metre of thickness. `given` is what
    is given along the component, 0 along x and 1 along y.
    """
    if given.prescribed:
        return reaction(problem, side, component).of
    return constant(given.mean * length).of


def _pressing_force(names: Sequence[str], fields: LoopFields) -> Array:
    """Sum of the pressing forces of contacts by name, shape (n_instants,), N."""
    forces = [np.asarray(fields.contact(name).normal_force) for name in names]
    total: Array = np.concatenate(forces).sum(axis=0)
    return total


def _rubbing_force(
    names: Sequence[str], weight: Array | float, fields: LoopFields
) -> Array:
    """Shear force by the friction of contacts by name, shape (n_instants,), N.

    The `weight` along them, which they carry, too, is left out.
    """
    forces = [-np.asarray(fields.contact(name).tangential_force) for name in names]
    force = np.concatenate(forces)
    sizes = np.abs(force).sum(axis=0) + np.abs(weight)
    return without_residue(force.sum(axis=0) - weight, sizes)


def _spring_force(fields: LoopFields) -> Array:
    """Force of the spring at the foot, shape (n_instants,), N."""
    force: Array = np.asarray(fields.contact("spring").normal_force)[0]
    return force
