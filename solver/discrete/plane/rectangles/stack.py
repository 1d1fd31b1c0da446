"""Rectangular bodies in the plane: one on a support, several, or a wall."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.checks import (
    INSTANTS,
    NON_NEGATIVE,
    POSITIVE,
    AnyOf,
    Choice,
    Count,
    InstanceOf,
    MappingOf,
    Number,
    Numbers,
    SequenceOf,
    check,
    check_value,
)
from solver.discrete.elements import MOST_POISSON
from solver.discrete.plane.rectangles.bricks import Brick, grid_of
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Spring, Support
from solver.discrete.plane.rectangles.stack_drawn import (
    act_of_ground,
    acts_on_sides,
    holds_of,
)
from solver.discrete.plane.rectangles.stack_loops import (
    SettlementLoop,
    SlopeLoop,
    StackLoop,
    loop_of_end,
    loop_on_ground,
)
from solver.discrete.plane.rectangles.stack_refused import (
    check_bricks,
    check_sides,
    check_support,
)
from solver.discrete.problem import Problem
from solver.discrete.structure import Axes, Description, Loop, act_of_weight
from solver.laws import FrictionLaw

SIDES = "left", "right", "top", "bottom"


@dataclass(frozen=True, eq=False)
class Stack:
    """Rectangular bodies that lie on each other or stand side by side, one metre thick.

    Bodies are in contact wherever their sides meet, and with the support where they
    stand at y = 0. All contacts have one friction law; times are in s.

    Attributes
    ----------
    length, height
        Size of one body, m.
    bricks
        Positions and sizes of the bodies, on the grid of the elements of one; None is a
        single body. Sides "left" and "right" are those of the bodies that reach
        farthest. "top" and "bottom" are all that lies open there to a traction, and
        what lies farthest up, or down, to a displacement.
    groups
        Index of the group of each body, shape (bodies,), or None: bodies of one group
        pass no macro forces to each other.
    elements, substructures
        Numbers for one body, along and up. Bodies on each other that all begin at the
        left are also cut where any of them ends.
    macro_degree
        Degree of the macro basis on each side of a substructure; long sides get a
        higher one.
    young, poisson, state
        Elasticity, Pa; `state` is "strain" or "stress".
    stiffness
        Young's modulus of every body over `young`, shape (bodies,), where they differ.
    friction
        Coefficient mu between the bodies, that of the nodes along them, shape (nodes
        along,), or that of each interface, shape (bodies - 1, 1) or (bodies - 1, nodes
        along).
    head_friction
        Coefficient mu of upright joints; None is `friction`.
    support
        Support below the lowest body, or None.
    sides
        Displacements and tractions along the outer sides, by "left", "right", "top",
        "bottom"; others are free. A rigid support replaces "bottom", which moves the
        lower sides of strips of ground where there are any. "left" and "right" run
        over the sides of all bodies.
    body_force
        Force per volume along x and y, shape (2, n_instants), N/m^3, or None.
    spring
        Spring at the right side, where no displacement is prescribed then; or None.
    tilt
        Angle over time by which the x axis rises, shape (n_instants,), rad, for
        drawings: `body_force` has turned the other way already. None where the axis
        does not rise.

    Raises
    ------
    RefusedError
        For a number that is not above zero or not finite, a field of another shape,
        instants that do not increase, bodies that overlap, or an unknown side.
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
    head_friction: float | None = None
    support: Support | None = None
    sides: Mapping[str, Side] = field(default_factory=dict)
    body_force: Array | None = None
    spring: Spring | None = None
    tilt: Array | None = None
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)
    bricks: Sequence[Brick] | None = None
    groups: Indices | None = None

    def __post_init__(self) -> None:
        """Check all fields, and add free sides where none are given."""
        check(
            self,
            length=POSITIVE,
            height=POSITIVE,
            elements=SequenceOf(Count(1), 2),
            substructures=SequenceOf(Count(1), 2),
            young=POSITIVE,
            state=Choice(("strain", "stress")),
            poisson=Number(-1.0, MOST_POISSON, above=True),
            macro_degree=Count(0),
            instants=INSTANTS,
            duration=POSITIVE,
            support=InstanceOf(Support),
            sides=MappingOf(InstanceOf(Side), SIDES),
            spring=InstanceOf(Spring),
            friction_law=InstanceOf(FrictionLaw),
            bricks=SequenceOf(InstanceOf(Brick)),
        )
        self._check_bodies()
        self._check_fields()
        free = SideComponent(False, np.zeros_like(self.instants))
        sides = dict(self.sides)
        for name in SIDES:
            sides.setdefault(name, Side(free, free))
        object.__setattr__(self, "sides", sides)

    def _check_bodies(self) -> None:
        """Refuse substructures without elements, and bodies that overlap."""
        for axis, elements in enumerate(self.elements):
            parts = self.substructures[axis]
            check_value(f"Stack.substructures[{axis}]", parts, Count(1, elements))
        check_bricks(self.rectangles)

    def _check_fields(self) -> None:
        """Refuse fields that do not fit the numbers of bodies, nodes and instants."""
        instants = len(self.instants)
        bodies = len(self.rectangles)
        nodes = self.grid[0] + 1
        joints = (bodies - 1, 1), (bodies - 1, nodes)
        check(
            self,
            friction=AnyOf(NON_NEGATIVE, Numbers(((nodes,), *joints), low=0.0)),
            head_friction=NON_NEGATIVE,
            stiffness=Numbers(((bodies,),), low=0.0, above=True),
            groups=Numbers(((bodies,),), whole=True),
            body_force=Numbers(((2, instants),)),
            tilt=Numbers(((instants,),)),
        )
        check_sides(self.sides, instants, self.strips)
        if self.support is not None:
            check_support(self.support, bodies, nodes, instants)

    @cached_property
    def rectangles(self) -> Sequence[Brick]:
        """Bodies on the grid of elements."""
        if self.bricks is None:
            return [Brick(0, 0, *self.elements)]
        return self.bricks

    @property
    def strips(self) -> int:
        """Number of the first bodies that are strips of ground."""
        if self.support is None:
            return 0
        return self.support.strips

    @cached_property
    def is_pile(self) -> bool:
        """Check whether bodies lie one on the other, aligned at their left ends."""
        return not self.strips and not any(brick.x for brick in self.rectangles)

    @cached_property
    def grid(self) -> tuple[int, int]:
        """Size of all bodies together, in elements along and up."""
        return grid_of(self.rectangles)

    @property
    def size(self) -> tuple[float, float]:
        """Length and height of all bodies together, m."""
        along, up = self.elements
        columns, rows = self.grid
        return columns / along * self.length, rows / up * self.height

    @property
    def weight(self) -> Array:
        """Resultant of the body force, shape (2, n_instants), N."""
        if self.body_force is None:
            return np.zeros((2, len(self.instants)))
        heavy = self.rectangles[self.strips :]
        elements = sum(brick.columns * brick.rows for brick in heavy)
        of_one_body = self.elements[0] * self.elements[1]
        area = elements / of_one_body * self.length * self.height
        return np.asarray(self.body_force * area)

    @property
    def relative_lengths(self) -> Array:
        """Length of every body over that of the longest, shape (bodies,)."""
        columns = np.array([brick.columns for brick in self.rectangles])
        return np.asarray(columns / columns.max())

    @property
    def longest(self) -> int:
        """Number of bodies that reach the right side."""
        return int(np.count_nonzero(self.relative_lengths == 1.0))

    @property
    def end_force(self) -> Array:
        """Transverse force of the traction on the right, shape (n_instants,), N."""
        return np.asarray(self.sides["right"].y.mean * self.longest * self.height)

    def modulus(self, body: int) -> float:
        """Young's modulus of a body over `young`."""
        if self.stiffness is None:
            return 1.0
        return float(self.stiffness[body])

    @cached_property
    def settlement(self) -> Array:
        """Settlement of each strip of ground, shape (n_strips, n_instants), m."""
        shape = self.strips, len(self.instants)
        return np.broadcast_to(-self.sides["bottom"].y.mean, shape)

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        return self._shown.axes

    def loop(self, problem: Problem) -> Loop:
        """Loop of the spring force, the shear force, or the load that bends the end.

        Where ground settles and nothing drives the bodies along it, of the force that
        the settled ground still carries.
        """
        return self._shown.of(problem)

    @property
    def _shown(self) -> StackLoop:
        """Loop of the load or displacement that drives the bodies."""
        is_driven = any(not side.x.is_zero for side in self.sides.values())
        if np.any(self.settlement) and not is_driven:
            return SettlementLoop(self.settlement)
        if self.tilt is not None and self.spring is not None:
            return SlopeLoop(self.tilt)
        if self.support is not None:
            weight: Array | float = 0.0
            if self.tilt is not None:
                weight = self.weight[0]
            return loop_on_ground(
                self.sides, self.size[0], len(self.rectangles), self.strips, weight
            )
        return loop_of_end(self.sides["right"], self.longest, self.height)

    def description(self) -> Description:
        """Description of the bodies for drawings."""
        length, height = self.size
        acts = list(acts_on_sides(self.sides, self.support, self.rectangles))
        if np.any(self.settlement):
            strips = self.rectangles[: self.strips]
            acts.append(act_of_ground(self.settlement, strips, self.grid[0]))
        acts.append(act_of_weight(self.weight))
        return Description(
            bodies=len({brick.y for brick in self.rectangles}),
            length=length,
            height=height,
            instants=self.instants,
            acts=tuple(acts),
            holds=tuple(holds_of(self.sides, self.support, self.spring)),
            tilt=self.tilt,
        )
