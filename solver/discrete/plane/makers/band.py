"""A band on a rigid rough curve as data: belt on a drum, tendon in a duct."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from solver.arrays import Array, Indices
from solver.discrete.plane.beams import Beam
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body, Held, Load
from solver.discrete.plane.joint import Joint
from solver.discrete.probes import LoopFields, Probe, constant, mean_held, reaction
from solver.discrete.problem import Problem
from solver.discrete.structure import Axes, Loop

GUIDE = "guide"
"""Name of the contact."""
PULL = "pull"
TAIL = "tail"
"""Names of what is given at the last and at the first end."""
LIMP = 1e-3
"""Radius of gyration of the section over the length of an element. Stiffness against
bending keeps free spans in place, and carries next to nothing, though a band that
slides turns on the arc and not on the spans.
"""

MOST_EXPONENT = 100.0
"""Largest exponent mu a that counts: with more, no tension makes a band slide."""


@dataclass(frozen=True)
class GuideCurve:
    """A circular arc, and the line of a band on it with straight spans at both ends.

    Attributes
    ----------
    angle, radius
        Angle of the arc, rad, and its radius, m.
    elements
        Number of equal elements on the arc. Either span beyond it is one more.
    span
        Length of either span, m.
    turned
        Counter-clockwise angle of the last span from the x axis, rad.
    """

    angle: float
    radius: float
    elements: int
    span: float
    turned: float = 0.0

    @property
    def length(self) -> float:
        """Length of the arc, m."""
        return self.angle * self.radius

    @property
    def spacing(self) -> float:
        """Length of an element on the arc, m."""
        return self.length / self.elements

    @cached_property
    def nodes(self) -> Indices:
        """Indices of the nodes on the arc, (elements + 1,), among those of the band."""
        return np.arange(1, self.elements + 2)

    @cached_property
    def angles(self) -> Array:
        """Angles along the arc from its first end, shape (elements + 1,), rad."""
        return np.linspace(0.0, self.angle, self.elements + 1)

    @cached_property
    def along(self) -> Array:
        """Unit tangents at the nodes on the arc, shape (elements + 1, 2)."""
        directions = self.turned + self.angle - self.angles
        return np.stack([np.cos(directions), np.sin(directions)], axis=1)

    @property
    def normals(self) -> Array:
        """Unit normals out of the guide, shape (elements + 1, 2)."""
        return np.stack([-self.along[:, 1], self.along[:, 0]], axis=1)

    @property
    def outwards(self) -> tuple[Array, Array]:
        """Directions of the first and the last span away from the guide, (2,) each."""
        return -self.along[0], self.along[-1]

    @cached_property
    def line(self) -> Array:
        """Nodes of the band, shape (elements + 3, 2), m."""
        arc = self.radius * self.normals
        first, last = self.outwards
        ends = arc[0] + self.span * first, arc[-1] + self.span * last
        return np.concatenate([ends[:1], arc, ends[1:]])

    def body(self, young: float, section: float, substructures: int) -> Body:
        """Band of a modulus, Pa, and a section, m^2, in a number of substructures."""
        gyration = LIMP * self.span
        shape = Beam(self.line, section, section * gyration**2)
        return Body("band", shape, young, substructures=substructures)

    def contact(self, friction: float) -> Joint:
        """Contact of the band with the guide, of a coefficient of friction."""
        return Joint(GUIDE, 0, self.nodes, None, None, self.normals, friction=friction)

    def load(self, name: str, tension: Array) -> Load:
        """Tension of an end over time, (n_instants,), N, by its name."""
        direction, node = self._end(name)
        force = np.multiply.outer(direction, tension)
        return Load(name, 0, np.array([node]), force[None])

    def held(self, name: str, displacement: Array) -> list[Held]:
        """Displacement of an end away from the guide, (n_instants,), m, by its name."""
        direction, node = self._end(name)
        return [
            Held(
                f"{name} {'xy'[axis]}", 0, np.array([node]), axis, share * displacement
            )
            for axis, share in enumerate(direction.tolist())
        ]

    def _end(self, name: str) -> tuple[Array, int]:
        """Direction away from the guide, (2,), and node of an end."""
        first, last = self.outwards
        if name == TAIL:
            return first, 0
        return last, self.elements + 2


@dataclass(frozen=True, eq=False, kw_only=True)
class Band(Bodies):
    """A band on a guide; its loop shows the tension at its last end.

    Attributes
    ----------
    guide
        The guide.
    """

    guide: GuideCurve

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        return ("Displacement of the pulled end", "m"), ("Tension", "N")

    @property
    def _shown(self) -> Held | Load | None:
        """Load on the last end, where that is pulled, also if the first end is held."""
        if self.loads and self.loads[0].name == PULL:
            return self.loads[0]
        return super()._shown

    def loop(self, problem: Problem) -> Loop:
        """Tension at the last end over its displacement away from the guide."""
        if self.loads and self.loads[0].name == PULL:
            (load,) = self.loads[0].force
            tension = constant(self.guide.outwards[1] @ load)
            moved = super().loop(problem).displacement
            return Loop(*self.axes, moved, tension.of)
        return Loop(*self.axes, self._moved(problem), self._reaction(problem))

    def _moved(self, problem: Problem) -> Probe:
        """Displacement of the last end, which is given."""
        x, y = [mean_held(problem, f"{PULL} {name}", axis) for axis, name in _AXES]
        by_x, by_y = self.guide.outwards[1]
        x = x.times(by_x)
        y = y.times(by_y)
        dofs = np.concatenate([x.dofs, y.dofs])
        return Probe(dofs, np.concatenate([x.weights, y.weights]))

    def _reaction(self, problem: Problem) -> Callable[[LoopFields], Array]:
        """Tension that moves the last end, a function that gives (n_instants,), N."""
        x, y = [reaction(problem, f"{PULL} {name}", axis) for axis, name in _AXES]
        by_x, by_y = self.guide.outwards[1]
        x = x.times(by_x)
        y = y.times(by_y)
        return lambda fields: x.of(fields) + y.of(fields)

    def slide(self) -> Array | None:
        """Estimated displacement of the first end along the guide, (n_instants,), m.

        The first end is pulled by a force, and the last one is moved; None for other
        ends. While the band sticks somewhere, its elongation is between those of a band
        that slides as a whole one way, and the other way: so the first end follows the
        last one with play.
        """
        by_name = {load.name: load.force[0] for load in self.loads}
        held = {held.name: held.displacement for held in self.held}
        if TAIL not in by_name or f"{PULL} x" not in held:
            return None
        outwards, along = self.guide.outwards
        tension = outwards @ by_name[TAIL]
        moved = along @ [held[f"{PULL} {name}"] for _, name in _AXES]
        friction = np.max(self.joints[0].friction) * self.friction_law.largest_factor
        exponent = min(float(friction) * self.guide.angle, MOST_EXPONENT)
        return _with_play(
            moved - tension * self._elongation(exponent),
            moved - tension * self._elongation(-exponent),
        )

    def _elongation(self, exponent: float) -> float:
        """Elongation of a sliding band over the tension of its first end, m/N.

        The tension at the last end is exp(exponent) times that of the first.
        """
        guide = self.guide
        body = self.bodies[0]
        assert isinstance(body.shape, Beam)
        spans = guide.span * (1.0 + np.exp(exponent))
        stiffness = body.young * np.mean(body.shape.area)
        around = guide.length * scipy.special.exprel(exponent)
        return float((around + spans) / stiffness)

    def tensions(self, problem: Problem, fields: LoopFields) -> Array:
        """Tension of all elements, including spans, (n_elements, n_instants), N.

        From the first end to the last.
        """
        body = self.bodies[0]
        assert isinstance(body.shape, Beam)
        strains = self.strains(problem, fields.displacement)
        return np.asarray(body.young * body.shape.area * strains)

    def strains(self, problem: Problem, displacement: Array) -> Array:
        """Strain of all elements, including spans, (n_elements, n_instants).

        `displacement` is that of the problem's degrees of freedom, (n_dofs,
        n_instants), m.
        """
        moved = self._moved_nodes(problem, displacement)
        shape = self.bodies[0].shape
        assert isinstance(shape, Beam)
        lengths = shape.lengths[:, None]
        along = np.diff(self.bodies[0].nodes, axis=0) / lengths
        stretch = np.einsum("ea,eat->et", along, np.diff(moved, axis=0))
        return np.asarray(stretch / lengths)

    def lifts(self, problem: Problem, displacement: Array) -> Array:
        """Slope of the elements on the guide against the guide, (elements, n_instants).

        A band that slides along its guide turns with it, which is no such slope.
        """
        moved = self._moved_nodes(problem, displacement)[self.guide.nodes]
        away = np.einsum("na,nat->nt", self.guide.normals, moved)
        return np.asarray(np.diff(away, axis=0) / self.guide.spacing)

    def _moved_nodes(self, problem: Problem, displacement: Array) -> Array:
        """Displacement of all nodes, shape (n_nodes, 2, n_instants), m."""
        assert problem.inside is not None
        return problem.inside.displacement(displacement, slice(None))


_AXES = (0, "x"), (1, "y")


def _with_play(lowest: Array, highest: Array) -> Array:
    """Displacement that moves only when a bound pushes it; all (n_instants,), m."""
    places = [0.0]
    for low, high in zip(lowest.tolist(), highest.tolist(), strict=True):
        places.append(min(max(places[-1], low), high))
    return np.array(places[1:])
