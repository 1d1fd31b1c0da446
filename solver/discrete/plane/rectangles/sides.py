"""Sides, supports and springs of rectangular bodies, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.checks import (
    ANY_NUMBER,
    FLAG,
    NON_NEGATIVE,
    POSITIVE,
    AnyOf,
    Count,
    Numbers,
    check,
)
from solver.refusal import RefusedError

SETTLED = "settled support"
"""Beginning of the names of contacts with strips of ground that settle."""


@dataclass(frozen=True, eq=False)
class SideComponent:
    """Prescribed displacement or traction along a side, in one component.

    At the distance s from its lower or left end it is mean + slope (2 s / length - 1).

    Attributes
    ----------
    prescribed
        Whether it is a displacement, m; else it is a traction, Pa.
    mean, slope
        Values over time, shape (n_instants,); the slope may be 0. On the left and the
        right s runs over each body again. Below strips of ground the mean may be that
        of each strip, shape (n_strips, n_instants).
    is_pressure
        Whether drawings name a traction across the side a pressure, which is positive
        into the bodies.
    """

    prescribed: bool
    mean: Array
    slope: Array | float = 0.0
    is_pressure: bool = False

    def __post_init__(self) -> None:
        over_time = Numbers(((None,),))
        mean = Numbers(((None,), (None, None)))
        check(
            self,
            prescribed=FLAG,
            mean=mean,
            slope=AnyOf(ANY_NUMBER, over_time),
            is_pressure=FLAG,
        )

    @property
    def is_zero(self) -> bool:
        """Check whether mean and slope are zero at all instants."""
        return not np.any(self.mean) and not np.any(self.slope)


class Side(NamedTuple):
    """Displacements or tractions along a side of the stack, along x and along y."""

    x: SideComponent
    y: SideComponent

    @property
    def is_zero(self) -> bool:
        """Check whether both components are zero at all instants."""
        return self.x.is_zero and self.y.is_zero

    @property
    def is_moved(self) -> bool:
        """Check whether a displacement of the side is prescribed."""
        return self.x.prescribed or self.y.prescribed


@dataclass(frozen=True, eq=False)
class Support:
    """A rigid rough support below the stack, or the mirror image of the stack.

    Attributes
    ----------
    gap, friction
        Opening at the nodes of the lowest side, m, shape (nodes along,), and
        coefficient mu there, or one for all nodes.
    strength
        Largest friction force per area where it is known, shape (nodes along,
        n_instants), Pa; the support then presses as much as that takes, and adds no
        pressure of its own. None where the contact force decides, and contact may open.
    is_image
        Whether below lies the image of the stack, turned by half a turn, which moves
        along as much the other way: slip is between both, twice the displacement of the
        stack, and the friction law is one of this slip. The strength has to be known.
    strips
        Number of strips of elastic ground: the first bodies of the stack, one element
        high and without weight. The side "bottom" moves their lower sides, and the
        others lie on them; none of these strips touches another. 0: the ground is
        rigid.
    """

    gap: Array
    friction: float | Array
    strength: Array | None = None
    is_image: bool = False
    strips: int = 0

    def __post_init__(self) -> None:
        along = Numbers(((None,),))
        friction = AnyOf(NON_NEGATIVE, Numbers(along.shapes, low=0.0))
        check(
            self,
            gap=along,
            friction=friction,
            strength=Numbers(((None, None),), low=0.0),
            strips=Count(0),
        )
        if self.is_image and self.strength is None:
            raise RefusedError(
                "Support.strength",
                None,
                "the largest friction force of an image",
                "give it, as slip changes nothing across a plane of symmetry",
            )


@dataclass(frozen=True)
class Spring:
    """A spring along x at the foot of the right side of the lowest body.

    The foot may move to the left by the slack, m, before the spring pulls it back; the
    stiffness is in N/m.
    """

    slack: float
    stiffness: float

    def __post_init__(self) -> None:
        check(self, slack=NON_NEGATIVE, stiffness=POSITIVE)
