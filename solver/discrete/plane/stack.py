"""Rectangular bodies in the plane: one on a support, several on each other, a wall of bricks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices, without_residue
from solver.checks import (
    ANY_NUMBER,
    FLAG,
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    Choice,
    Count,
    Each,
    Either,
    Named,
    Number,
    Numbers,
    Part,
    check,
    check_value,
)
from solver.discrete.plane.bricks import Brick
from solver.discrete.plane.stack_problem import problem_of
from solver.discrete.probes import constant, end_rotation, reaction, side_mean
from solver.discrete.problem import Problem
from solver.discrete.structure import (
    OUTWARD,
    Act,
    Axes,
    Description,
    Hold,
    Loop,
    LoopFields,
    on_side,
)
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

SIDES = "left", "right", "top", "bottom"
MOST_POISSON = 0.4999
"""Poisson's ratio from which on a body keeps its volume to the digits of its
strains."""
DRIVEN = "top", "left", "right"
"""Sides of a body on a support, in the order in which one looks for what drives it."""


@dataclass(frozen=True, eq=False)
class Given:
    """What is given for one component along a side: mean + slope (2 s / length - 1).

    Attributes
    ----------
    prescribed
        Whether it is a displacement, m; else it is a traction, Pa.
    mean, slope
        Over time, shape (n_instants,); no slope is 0. On the left and the right s runs
        over each body anew.
    """

    prescribed: bool
    mean: Array
    slope: Array | float = 0.0

    def __post_init__(self) -> None:
        over_time = Numbers(((None,),))
        check(
            self, prescribed=FLAG, mean=over_time, slope=Either(ANY_NUMBER, over_time)
        )

    @property
    def is_zero(self) -> bool:
        """Whether it is zero throughout."""
        return not np.any(self.mean) and not np.any(self.slope)


class Side(NamedTuple):
    """What is given along a side of the stack, for the components along x and y."""

    x: Given
    y: Given


@dataclass(frozen=True, eq=False)
class Support:
    """A rigid rough support below the stack, or its image.

    Attributes
    ----------
    gap, friction
        Opening at the nodes of the lowest side, m, shape (nodes along,), and
        coefficient mu there, or of all.
    bound
        Largest friction force per area where it is known, shape (nodes along,
        n_instants), Pa; the support then presses as much as that takes, and adds no
        pressure of its own. None where contact decides, and may open.
    is_image
        Whether below lies the image of the stack, turned by half a turn, which moves
        along as much the other way: slip is between both, twice what the stack moves,
        and so is that of the friction law. The bound has to be known.
    """

    gap: Array
    friction: float | Array
    bound: Array | None = None
    is_image: bool = False

    def __post_init__(self) -> None:
        along = Numbers(((None,),))
        friction = Either(NON_NEGATIVE, Numbers(along.shapes, low=0.0))
        check(
            self, gap=along, friction=friction, bound=Numbers(((None, None),), low=0.0)
        )
        if self.is_image and self.bound is None:
            raise RefusedError(
                "Support.bound",
                None,
                "the largest friction force of an image",
                "give it, as slip changes nothing across a plane of symmetry",
            )


@dataclass(frozen=True)
class Spring:
    """A spring along x at the foot of the right side of the lowest body, slack at first.

    Before it is pulled back, the foot may move to the left by the slack, m; stiffness
    in N/m.
    """

    slack: float
    stiffness: float

    def __post_init__(self) -> None:
        check(self, slack=NON_NEGATIVE, stiffness=POSITIVE)


@dataclass(frozen=True, eq=False)
class Stack:
    """Rectangular bodies that lie on each other, or stand beside each other; one metre thick.

    They are in contact wherever sides meet, and where they stand at y = 0 with the
    support.

    They have one friction law, also on the support; times are in s.

    Attributes
    ----------
    length, height
        Of one body, m.
    bricks
        Where bodies are and how large, on the grid of the elements of one; None is a
        single one. What is given on the left and the right holds for those which reach
        farthest, and on top and bottom for all that lies open there.
    groups
        Number of the group of each body, shape (bodies,), or None: bodies of one group
        pass no macro forces to each other.
    elements, substructures
        Of one body, along and up. Bodies on each other that all begin at the left are
        also cut where any of them ends.
    macro_degree
        Of the macro basis on each side of a substructure; long sides get more in
        proportion.
    young, poisson, state
        Elasticity, Pa; `state` is "strain" or "stress".
    stiffness
        Young's modulus of every body over `young`, shape (bodies,), where they differ.
    friction
        Coefficient mu between the bodies, that of the nodes along them, shape (nodes
        along,), or that of each interface, shape (bodies - 1, 1) or (bodies - 1, nodes
        along).
    support
        Below the lowest body, or None.
    sides
        What is given along the outer sides, by "left", "right", "top", "bottom"; others
        are free. A support replaces "bottom". `left` and `right` run over the sides of
        all bodies.
    body_force
        Force per volume along x and y, shape (2, n_instants), N/m^3, or None.
    spring
        At the right side, of which nothing is prescribed then; or None.
    tilt
        Angle over time by which the x axis rises, shape (n_instants,), rad, for whoever
        draws it: `body_force` has turned the other way already. None where it does not.

    Raises
    ------
    RefusedError
        For a number that is not above zero or none, a field of another shape, instants
        that do not increase, bodies that overlap, or a side that there is not.
    """

    length: float
    height: float
    elements: tuple[int, int]
    substructures: tuple[int, int]
    young: float
    poisson: float
    instants: Array
    duration: float
    macro_degree: int = 1
    state: str = "strain"
    stiffness: Array | None = None
    friction: float | Array = 0.0
    support: Support | None = None
    sides: Mapping[str, Side] = field(default_factory=dict)
    body_force: Array | None = None
    spring: Spring | None = None
    tilt: Array | None = None
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)
    bricks: Sequence[Brick] | None = None
    groups: Indices | None = None

    def __post_init__(self) -> None:
        """Check all that is given, and leave free what is not."""
        check(
            self,
            length=POSITIVE,
            height=POSITIVE,
            elements=Each(Count(1), 2),
            substructures=Each(Count(1), 2),
            young=POSITIVE,
            state=Choice(("strain", "stress")),
            poisson=Number(-1.0, MOST_POISSON, above=True),
            macro_degree=Count(0),
            instants=INSTANTS,
            duration=POSITIVE,
            support=Part(Support),
            sides=Named(Part(Side), SIDES),
            spring=Part(Spring),
            friction_law=Part(FrictionLaw),
            bricks=Each(Part(Brick)),
        )
        self._check_bodies()
        self._check_fields()
        free = Given(False, np.zeros_like(self.instants))
        others = dict.fromkeys(
            [side for side in SIDES if side not in self.sides], Side(free, free)
        )
        object.__setattr__(self, "sides", {**self.sides, **others})

    def _check_bodies(self) -> None:
        """Refuse parts without elements, and bodies that overlap or lie beside the grid."""
        for axis, elements in enumerate(self.elements):
            parts = self.substructures[axis]
            check_value(f"Stack.substructures[{axis}]", parts, Count(1, elements))
        for number, brick in enumerate(self.rectangles):
            check_value(f"Stack.bricks[{number}]", brick[:2], Each(Count(0), 2))
            check_value(f"Stack.bricks[{number}]", brick[2:], Each(Count(1), 2))
        taken = np.zeros(self.grid, dtype=bool)
        for number, (x, y, columns, rows) in enumerate(self.rectangles):
            own = taken[x : x + columns, y : y + rows]
            if own.any():
                raise RefusedError(
                    f"Stack.bricks[{number}]",
                    [x, y, columns, rows],
                    "bodies that lie beside each other",
                    "it overlaps one before, move it",
                )
            own[:] = True

    def _check_fields(self) -> None:
        """Refuse what does not fit the numbers of bodies, nodes and instants."""
        instants = len(self.instants)
        bodies = len(self.rectangles)
        nodes = self.grid[0] + 1
        over_time = Numbers(((instants,),))
        along = Numbers(((nodes,),))
        joints = (bodies - 1, 1), (bodies - 1, nodes)
        check(
            self,
            friction=Either(NON_NEGATIVE, Numbers(((nodes,), *joints), low=0.0)),
            stiffness=Numbers(((bodies,),), low=0.0, above=True),
            groups=Numbers(((bodies,),), whole=True),
            body_force=Numbers(((2, instants),)),
            tilt=over_time,
        )
        for side, components in self.sides.items():
            for component, given in zip("xy", components, strict=True):
                where = f"Stack.sides[{side!r}].{component}"
                check_value(where, given, Part(Given))
                check_value(f"{where}.mean", given.mean, over_time)
                check_value(
                    f"{where}.slope", given.slope, Either(ANY_NUMBER, over_time)
                )
        support = self.support
        if support is not None:
            check_value("Stack.support.gap", support.gap, along)
            check_value(
                "Stack.support.friction", support.friction, Either(NON_NEGATIVE, along)
            )
            if support.bound is not None:
                by_time = Numbers(((nodes, instants),), low=0.0)
                check_value("Stack.support.bound", support.bound, by_time)

    @cached_property
    def rectangles(self) -> Sequence[Brick]:
        """Every body on the grid of elements."""
        if self.bricks is None:
            return [Brick(0, 0, *self.elements)]
        return self.bricks

    @cached_property
    def is_pile(self) -> bool:
        """Whether all bodies begin at the left, one on the other."""
        return not any(brick.x for brick in self.rectangles)

    @cached_property
    def grid(self) -> tuple[int, int]:
        """Elements of all bodies together, along and up."""
        ends = [
            (brick.x + brick.columns, brick.y + brick.rows) for brick in self.rectangles
        ]
        return max(end for end, _ in ends), max(end for _, end in ends)

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of all bodies together, m."""
        (along, up) = self.elements
        (columns, rows) = self.grid
        return columns / along * self.length, rows / up * self.height

    @property
    def weight(self) -> Array:
        """Resultant of the body force, shape (2, n_instants), N."""
        elements = sum(brick.columns * brick.rows for brick in self.rectangles)
        area = (
            elements / (self.elements[0] * self.elements[1]) * self.length * self.height
        )
        if self.body_force is None:
            return np.zeros((2, len(self.instants)))
        return np.asarray(self.body_force * area)

    @property
    def reach(self) -> Array:
        """Length of every body over that of the longest, shape (bodies,)."""
        columns = np.array([brick.columns for brick in self.rectangles])
        return np.asarray(columns / columns.max())

    @property
    def longest(self) -> int:
        """Number of bodies that reach the right side."""
        return int(np.count_nonzero(self.reach == 1.0))

    @property
    def end_force(self) -> Array:
        """Transverse force of what is given on the right as a traction, (n_instants,), N."""
        return np.asarray(self.sides["right"].y.mean * self.longest * self.height)

    def modulus(self, body: int) -> float:
        """Young's modulus of a body over `young`."""
        if self.stiffness is None:
            return 1.0
        return float(self.stiffness[body])

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return problem_of(self)

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        if self.tilt is not None and self.spring is not None:
            return ("Angle of the slope", "°"), ("Spring force", "N")
        if self.support is not None:
            return (f"Displacement of the {self._shown_side}", "m"), (
                "Shear force",
                "N",
            )
        if self._is_turned:
            return ("Rotation of the end", "rad"), ("Moment", "N·m")
        return ("Deflection of the end", "m"), ("Transverse force", "N")

    @property
    def _is_turned(self) -> bool:
        """Whether a moment acts on the end, which nothing else bends."""
        bent = self.sides["right"].y
        return self.support is None and not bent.prescribed and not np.any(bent.mean)

    @property
    def _shown_side(self) -> str:
        """Side whose displacement the loop is over: of a single body the one that is driven."""
        if self.support is None:
            return "right"
        if len(self.rectangles) > 1:
            return "top"
        driven = (
            name for name in DRIVEN if not all(one.is_zero for one in self.sides[name])
        )
        return next(driven, DRIVEN[0])

    def loop(self, problem: Problem) -> Loop:
        """Spring force on a slope, shear force on a support, or what bends the end."""
        if self.tilt is not None and self.spring is not None:
            # The spring's force lags behind on the way back.
            return Loop(
                *self.axes,
                constant(np.degrees(self.tilt)),
                lambda fields: np.asarray(fields.contact("spring").normal_force)[0],
            )
        rests = self.support is not None
        if self._is_turned:
            size = self.longest * self.height**2
            moment = np.broadcast_to(
                -size / 6.0 * self.sides["right"].x.slope, self.instants.shape
            )
            rotation = end_rotation(problem)
            force = constant(moment).of
            return Loop(*self.axes, rotation, force)
        side = self._shown_side
        component = 0 if rests else 1
        given = self.sides[side][component]
        if rests and len(self.rectangles) == 1:
            force = _shear_force
        elif given.prescribed:
            force = reaction(problem, side, component).of
        else:
            if rests:
                whole = self.size[0]
            else:
                whole = self.longest * self.height
            force = constant(
                np.broadcast_to(given.mean * whole, self.instants.shape)
            ).of
        return Loop(*self.axes, side_mean(problem, side, component), force)

    def described(self) -> Description:
        """The bodies in words, for whoever draws them."""
        length, height = self.size
        return Description(
            bodies=len({brick.y for brick in self.rectangles}),
            length=length,
            height=height,
            instants=self.instants,
            acts=tuple(self._acts()),
            holds=tuple(self._holds()),
            tilt=self.tilt,
        )

    def _acts(self) -> Iterator[Act]:
        for name, side in self.sides.items():
            if name == "bottom" and self.support is not None:
                continue
            for component, given in enumerate(side):
                yield self._given(given, name, component)
        size = np.hypot(*self.weight)
        towards = self.weight / np.where(size > 0.0, size, 1.0)
        yield Act("body", "W", on_side("body", [0.5]), towards, size, "N")

    def _given(self, given: Given, side: str, component: int) -> Act:
        """What is given along a side: evenly in the middle, unevenly at both ends."""
        towards = ((1.0, 0.0), (0.0, 1.0))[component]
        along = "xy"[component]
        unit = "m" if given.prescribed else "Pa"
        is_normal = OUTWARD[side][component] != 0.0
        if given.prescribed:
            symbol = f"u_{along}"
        elif is_normal:
            symbol = "σ"
        else:
            symbol = "τ"
        shares = [0.7 if is_normal else 0.15]
        values = given.mean
        if np.any(given.slope):
            shares = [0.0, 1.0]
            values = np.stack([given.mean - given.slope, given.mean + given.slope])
        elif is_normal and not given.prescribed:
            shares = [0.15, 0.5, 0.85]
        places = self._open(side, on_side(side, shares))
        return Act(f"{side} {along}", symbol, places, towards, values, unit)

    def _open(self, side: str, places: Array) -> Array:
        """Places on a side of all bodies, brought to those bodies that are there."""
        x, y, columns, rows = np.array(self.rectangles).T
        places = places.copy()
        (along, up) = self.grid
        for place in places:
            is_there = (x <= place[0] * along) & (place[0] * along <= x + columns)
            low = y[is_there].min() / up
            high = (y + rows)[is_there].max() / up
            ends = {"top": (high, high), "bottom": (low, low)}.get(side, (low, high))
            place[1] = ends[0] + place[1] * (ends[1] - ends[0])
        return places

    def _holds(self) -> Iterator[Hold]:
        if self.support is not None:
            yield Hold("support", "bottom", gap=self.support.gap)
        for name, side in self.sides.items():
            is_still = [given.prescribed and given.is_zero for given in side]
            if all(is_still):
                yield Hold("clamp", name)
            elif any(is_still):
                yield Hold("rollers", name)
        if self.spring is not None:
            yield Hold("spring", "right")


def _shear_force(fields: LoopFields) -> Array:
    force = -fields.contact("support").tangential_force
    return without_residue(force.sum(axis=0), np.abs(force).sum(axis=0))
