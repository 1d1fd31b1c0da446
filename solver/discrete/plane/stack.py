"""Rectangular bodies in the plane: one on a support, several, or a wall."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from solver.arrays import Array, Indices, without_residue
from solver.checks import (
    ANY_NUMBER,
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
from solver.discrete.plane.sides import Given, Side, Spring, Support
from solver.discrete.probes import (
    LoopFields,
    constant,
    end_rotation,
    reaction,
    side_mean,
)
from solver.discrete.problem import Problem
from solver.discrete.structure import (
    OUTWARD,
    Act,
    Axes,
    Description,
    Hold,
    Loop,
    on_side,
)
from solver.laws import FrictionLaw
from solver.refusal import RefusedError

SIDES = "left", "right", "top", "bottom"
MOST_POISSON = 0.4999
"""Largest Poisson's ratio; above it a body keeps its volume up to the rounding of its
strains."""
SETTLED = "settled support"
"""Beginning of the names of contacts with strips of ground that settle."""
DRIVEN = "top", "left", "right"
"""Sides of a body on a support; the first that is loaded or moved drives the body."""


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
        Number of the group of each body, shape (bodies,), or None: bodies of one group
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
        """Check all fields, and make sides free that are not given."""
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
        sides = dict(self.sides)
        for name in SIDES:
            sides.setdefault(name, Side(free, free))
        object.__setattr__(self, "sides", sides)

    def _check_bodies(self) -> None:
        """Refuse substructures without elements, and bodies that overlap."""
        for axis, elements in enumerate(self.elements):
            parts = self.substructures[axis]
            check_value(f"Stack.substructures[{axis}]", parts, Count(1, elements))
        for number, brick in enumerate(self.rectangles):
            check_value(f"Stack.bricks[{number}]", brick[:2], Each(Count(0), 2))
            check_value(f"Stack.bricks[{number}]", brick[2:], Each(Count(1), 2))
        taken = np.zeros(self.grid, dtype=bool)
        for number, (x, y, columns, rows) in enumerate(self.rectangles):
            covered = taken[x : x + columns, y : y + rows]
            if covered.any():
                raise RefusedError(
                    f"Stack.bricks[{number}]",
                    [x, y, columns, rows],
                    "bodies that lie beside each other",
                    "it overlaps one before, move it",
                )
            covered[:] = True

    def _check_fields(self) -> None:
        """Refuse fields that do not fit the numbers of bodies, nodes and instants."""
        instants = len(self.instants)
        bodies = len(self.rectangles)
        nodes = self.grid[0] + 1
        over_time = Numbers(((instants,),))
        joints = (bodies - 1, 1), (bodies - 1, nodes)
        check(
            self,
            friction=Either(NON_NEGATIVE, Numbers(((nodes,), *joints), low=0.0)),
            head_friction=NON_NEGATIVE,
            stiffness=Numbers(((bodies,),), low=0.0, above=True),
            groups=Numbers(((bodies,),), whole=True),
            body_force=Numbers(((2, instants),)),
            tilt=over_time,
        )
        slope = Either(ANY_NUMBER, over_time)
        for side, components in self.sides.items():
            mean = over_time
            if side == "bottom" and self.strips:
                mean = Numbers(((instants,), (self.strips, instants)))
            for component, given in zip("xy", components, strict=True):
                where = f"Stack.sides[{side!r}].{component}"
                check_value(where, given, Part(Given))
                check_value(f"{where}.mean", given.mean, mean)
                check_value(f"{where}.slope", given.slope, slope)
        if self.support is not None:
            self._check_support(self.support, nodes, instants)

    def _check_support(self, support: Support, nodes: int, instants: int) -> None:
        """Refuse fields of the support that do not fit nodes and instants."""
        along = Numbers(((nodes,),))
        friction = Either(NON_NEGATIVE, along)
        check_value("Stack.support.gap", support.gap, along)
        check_value("Stack.support.friction", support.friction, friction)
        strips = Count(0, len(self.rectangles) - 1)
        check_value("Stack.support.strips", support.strips, strips)
        if support.strength is not None:
            strength = Numbers(((nodes, instants),), low=0.0)
            check_value("Stack.support.strength", support.strength, strength)

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
        """Check whether all bodies begin at the left, one on the other."""
        return not self.strips and not any(brick.x for brick in self.rectangles)

    @cached_property
    def grid(self) -> tuple[int, int]:
        """Elements of all bodies together, along and up."""
        columns = max(brick.x + brick.columns for brick in self.rectangles)
        rows = max(brick.y + brick.rows for brick in self.rectangles)
        return columns, rows

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

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        if self._shows_settlement:
            return ("Settlement", "m"), ("Force on the settled ground", "N")
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

    @cached_property
    def settlement(self) -> Array:
        """Settlement of each strip of ground, shape (n_strips, n_instants), m."""
        shape = self.strips, len(self.instants)
        return np.broadcast_to(-self.sides["bottom"].y.mean, shape)

    @property
    def _shows_settlement(self) -> bool:
        """Check whether ground settles, and nothing drives the bodies along it."""
        is_driven = any(not side.x.is_zero for side in self.sides.values())
        return bool(np.any(self.settlement)) and not is_driven

    @property
    def _is_turned(self) -> bool:
        """Check whether a moment acts on the right end, without a transverse force."""
        bent = self.sides["right"].y
        return self.support is None and not bent.prescribed and not np.any(bent.mean)

    @property
    def _shown_side(self) -> str:
        """Side whose displacement the loop shows: of a single body the driven one."""
        if self.support is None:
            return "right"
        if len(self.rectangles) > 1:
            return "top"
        for name in DRIVEN:
            x, y = self.sides[name]
            if not (x.is_zero and y.is_zero):
                return name
        return DRIVEN[0]

    def loop(self, problem: Problem) -> Loop:
        """Loop of the spring force, the shear force, or the load that bends the end.

        Where ground settles and nothing drives the bodies along it, of the force that
        the settled ground still carries.
        """
        if self._shows_settlement:
            settled = np.abs(self.settlement).max(axis=1).argmax()
            names = [name for name in problem.rubbing if is_settled(name)]
            moved = constant(self.settlement[settled])
            return Loop(*self.axes, moved, partial(pressing_force, names))
        if self.tilt is not None and self.spring is not None:
            # The spring's force lags behind on the way back.
            angle = constant(np.degrees(self.tilt))
            return Loop(*self.axes, angle, _spring_force)
        if self._is_turned:
            moment = constant(self._end_moment)
            return Loop(*self.axes, end_rotation(problem), moment.of)
        side = self._shown_side
        component = 1 if self.support is None else 0
        force = self._loop_force(problem, side, component)
        return Loop(*self.axes, side_mean(problem, side, component), force)

    @property
    def _end_moment(self) -> Array:
        """Moment of the traction on the right, shape (n_instants,), N m."""
        size = self.longest * self.height**2
        moment = -size / 6.0 * self.sides["right"].x.slope
        return np.broadcast_to(moment, self.instants.shape)

    def _loop_force(
        self, problem: Problem, side: str, component: int
    ) -> Callable[[LoopFields], Array]:
        """Force of the loop over the mean displacement of a side in a component."""
        rests = self.support is not None
        given = self.sides[side][component]
        if rests and len(self.rectangles) == 1:
            return _shear_force
        holding = [each for each in self.sides.values() if each[component].prescribed]
        if rests and len(holding) > 1 + bool(self.strips):
            # Sides that share a corner share its force, too: the ground tells the sum.
            names = [name for name in problem.rubbing if "support and" in name]
            return partial(_rubbing_force, names)
        if given.prescribed:
            return reaction(problem, side, component).of
        if rests:
            whole = self.size[0]
        else:
            whole = self.longest * self.height
        force = np.broadcast_to(given.mean * whole, self.instants.shape)
        return constant(force).of

    def description(self) -> Description:
        """Description of the bodies for drawings."""
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
        """Loads and prescribed displacements of the sides, and the weight.

        A displacement that is one of several sides is drawn at the first of them.
        """
        drawn: list[tuple[int, Given]] = []
        for name, side in self.sides.items():
            if name == "bottom" and self.support is not None:
                continue
            for component, given in enumerate(side):
                is_same = [
                    across == component and given is other for across, other in drawn
                ]
                if given.prescribed and any(is_same):
                    continue
                drawn.append((component, given))
                yield self._act_on_side(given, name, component)
        if np.any(self.settlement):
            yield self._act_of_ground()
        size = np.hypot(*self.weight)
        towards = self.weight / np.where(size > 0.0, size, 1.0)
        yield Act("body", "W", on_side("body", [0.5]), towards, size, "N")

    def _act_on_side(self, given: Given, side: str, component: int) -> Act:
        """Load or displacement of a side: drawn at both ends if it is uneven."""
        is_normal = OUTWARD[side][component] != 0.0
        along = "xy"[component]
        if given.prescribed:
            symbol = f"u_{along}"
            unit = "m"
        elif is_normal:
            symbol = "σ"
            unit = "Pa"
        else:
            symbol = "τ"
            unit = "Pa"
        # Arrows along a side stand beside those across it.
        shares = [0.15]
        if is_normal:
            shares = [0.7]
        values = given.mean
        if np.any(given.slope):
            shares = [0.0, 1.0]
            values = np.stack([given.mean - given.slope, given.mean + given.slope])
        elif is_normal and not given.prescribed:
            shares = [0.15, 0.5, 0.85]
        return Act(
            where=f"{side} {along}",
            symbol=symbol,
            points=self._on_bodies(side, on_side(side, shares)),
            towards=((1.0, 0.0), (0.0, 1.0))[component],
            values=values,
            unit=unit,
        )

    def _act_of_ground(self) -> Act:
        """Settlement of the ground, in the middle of what settles most."""
        size = np.abs(self.settlement).max(axis=1)
        strips = [
            strip
            for strip, moved in zip(self.rectangles, size.tolist(), strict=False)
            if moved == size.max()
        ]
        first = strips[0].x
        last = strips[-1].x + strips[-1].columns
        middle = 0.5 * (first + last) / self.grid[0]
        return Act(
            where="bottom y",
            symbol="u_y",
            points=on_side("bottom", [middle]),
            towards=(0.0, -1.0),
            values=self.settlement[size.argmax()],
            unit="m",
        )

    def _on_bodies(self, side: str, points: Array) -> Array:
        """Points on a side, moved up or down onto the bodies that are there.

        Shape (n, 2) both, as shares of the length and height of all bodies.
        """
        x, y, columns, rows = np.array(self.rectangles).T
        points = points.copy()
        along, up = self.grid
        for point in points:
            position = point[0] * along
            is_there = (x <= position) & (position <= x + columns)
            low = y[is_there].min() / up
            high = (y + rows)[is_there].max() / up
            if side == "top":
                low = high
            elif side == "bottom":
                high = low
            point[1] = low + point[1] * (high - low)
        return points

    def _holds(self) -> Iterator[Hold]:
        """Support, clamps, rollers and spring."""
        if self.support is not None:
            yield Hold("support", "bottom", gap=self.support.gap)
        for name, side in self.sides.items():
            if name == "bottom" and self.support is not None:
                continue
            is_still = [given.prescribed and given.is_zero for given in side]
            if all(is_still):
                yield Hold("clamp", name)
            elif any(is_still):
                yield Hold("rollers", name)
        if self.spring is not None:
            yield Hold("spring", "right")


def is_settled(name: str) -> bool:
    """Check whether a contact is with ground that settles, by its name."""
    return name.startswith(SETTLED)


def pressing_force(names: Sequence[str], fields: LoopFields) -> Array:
    """Sum of the pressing forces of contacts by name, shape (n_instants,), N."""
    forces = [np.asarray(fields.contact(name).normal_force) for name in names]
    total: Array = np.concatenate(forces).sum(axis=0)
    return total


def _rubbing_force(names: Sequence[str], fields: LoopFields) -> Array:
    """Shear force by the friction of contacts by name, shape (n_instants,), N."""
    forces = [-np.asarray(fields.contact(name).tangential_force) for name in names]
    force = np.concatenate(forces)
    return without_residue(force.sum(axis=0), np.abs(force).sum(axis=0))


def _spring_force(fields: LoopFields) -> Array:
    """Force of the spring at the foot, shape (n_instants,), N."""
    force: Array = np.asarray(fields.contact("spring").normal_force)[0]
    return force


def _shear_force(fields: LoopFields) -> Array:
    """Friction force of the body on its support, shape (n_instants,), N."""
    force = -fields.contact("support").tangential_force
    return without_residue(force.sum(axis=0), np.abs(force).sum(axis=0))
