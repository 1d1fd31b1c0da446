"""Rectangular bodies stacked on each other, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from solver.arrays import Array
from solver.laws import FrictionLaw

SIDES = "left", "right", "top", "bottom"


@dataclass(frozen=True, eq=False)
class Given:
    """What is given for one component along a side: mean + slope (2 s / length - 1).

    Attributes
    ----------
    prescribed
        Whether it is a displacement, m; else it is a traction, Pa.
    mean, slope
        Over time, shape (n_instants,); no slope is 0.
    each_body
        Whether s runs over each body of the stack anew, on the left and the right.
    """

    prescribed: bool
    mean: Array
    slope: Array | float = 0.0
    each_body: bool = False


@dataclass(frozen=True, eq=False)
class Side:
    """What is given along a side of the stack, for the components along x and y."""

    x: Given
    y: Given


@dataclass(frozen=True, eq=False)
class Support:
    """A rigid rough support below the stack.

    Attributes
    ----------
    gap
        Opening at the nodes of the lowest side, shape (nodes along,), m.
    friction
        Coefficient mu.
    bound
        Largest friction force per area where it is known, shape (nodes along, n_instants), Pa; the
        support then presses as much as that takes, and adds no pressure of its own. None where
        contact decides, and may open.
    """

    gap: Array
    friction: float
    bound: Array | None = None


@dataclass(frozen=True)
class Spring:
    """A spring along x at the foot of the right side of the lowest body, slack at first.

    Attributes
    ----------
    slack
        How far the foot may move to the left before it is pulled back, m.
    stiffness
        N/m.
    """

    slack: float
    stiffness: float


@dataclass(frozen=True, eq=False)
class StackData:
    """Equal rectangular bodies on each other; one metre thick.

    Attributes
    ----------
    length, height
        Of one body, m.
    bodies
        Their number.
    elements, substructures
        Of one body, along and up.
    order
        Of the elements: 1 bilinear, 2 biquadratic.
    macro_degree
        Of the macro basis on each side of a substructure; long sides get more in proportion.
    young, poisson, state
        Elasticity, Pa; `state` is "strain" or "stress".
    stiffness
        Young's modulus of every body over `young`, shape (bodies,), where they differ.
    friction
        Coefficient mu between the bodies.
    support
        Below the lowest body, or None.
    sides
        What is given along the outer sides, by "left", "right", "top", "bottom"; others are free. A
        support replaces "bottom". `left` and `right` run over the sides of all bodies.
    body_force
        Force per volume along x and y, shape (2, n_instants), N/m^3, or None.
    instants, duration
        s.
    spring
        At the right side, of which nothing is prescribed then; or None.
    tilt
        Angle over time by which the x axis rises, shape (n_instants,), rad, for whoever draws it:
        `body_force` has turned the other way already. None where it does not.
    friction_law
        Between the bodies, and on the support.
    """

    length: float
    height: float
    elements: tuple[int, int]
    substructures: tuple[int, int]
    young: float
    poisson: float
    instants: Array
    duration: float
    bodies: int = 1
    order: int = 1
    macro_degree: int = 1
    state: str = "strain"
    stiffness: Array | None = None
    friction: float = 0.0
    support: Support | None = None
    sides: Mapping[str, Side] = field(default_factory=dict)
    body_force: Array | None = None
    spring: Spring | None = None
    tilt: Array | None = None
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)

    def __post_init__(self) -> None:
        """Leave free what is not given."""
        free = Given(False, np.zeros_like(self.instants))
        others = dict.fromkeys([side for side in SIDES if side not in self.sides], Side(free, free))
        object.__setattr__(self, "sides", {**self.sides, **others})

    def modulus(self, body: int) -> float:
        """Give Young's modulus of a body over `young`."""
        return 1.0 if self.stiffness is None else float(self.stiffness[body])
