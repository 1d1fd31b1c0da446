"""Rectangles at places that touch where their sides meet: a wall of bricks.

All bricks lie on one grid of equal elements. Whatever sides face each other are in unilateral
contact with friction, and so are the lowest ones with a rigid, rough support. Each brick is a
substructure, so that nothing is cut: all interfaces are contacts, whose macro forces are the
resultants and moments that a joint passes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy import sparse

from solver.arrays import Array
from solver.discrete.bricks import Brick, Joint, joints_of
from solver.discrete.elements import elastic_matrix
from solver.discrete.plane import Condensed, Rectangle, side_basis
from solver.discrete.plane_parts import Part, Trace, keep, number_rows, problem_of
from solver.discrete.probes import reaction, side_mean
from solver.discrete.problem import Problem, Scales
from solver.discrete.structure import Act, Description, Hold, Loop, LoopFields
from solver.laws import (
    Bodies,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Unilateral,
)


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A wall of bricks, one metre thick.

    Attributes
    ----------
    bricks
        At least one of them at y = 0.
    element
        Width and height of an element, m.
    young, poisson, state
        Of all bricks; "stress" is a thin wall, "strain" a long one.
    friction, friction_law
        mu of all joints, and what else there is of friction.
    weight
        Force per volume, shape (2, n_instants), N/m^3.
    pressure
        On the highest bricks, from above, shape (n_instants,), Pa.
    moved
        Displacement along x of the top of the highest bricks, shape (n_instants,), m; None where
        the top is free.
    shear
        Traction along x there, shape (n_instants,), Pa, where it is free.
    instants, duration
        Shape (n_instants,), and the length of the interval, s.
    macro_degree
        Of the polynomials that the coarse problem balances on a joint.
    tilt
        Angle by which the support is tilted, shape (n_instants,), rad, which the weight already
        has in it; None where it stays level.
    """

    bricks: Sequence[Brick]
    element: tuple[float, float]
    young: float
    poisson: float
    state: Literal["stress", "strain"]
    friction: float
    weight: Array
    pressure: Array
    instants: Array
    duration: float
    moved: Array | None = None
    shear: Array | None = None
    macro_degree: int = 2
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)
    tilt: Array | None = None

    @property
    def length(self) -> float:
        """Of the whole wall, m."""
        return self.element[0] * max(brick.x + brick.columns for brick in self.bricks)

    @property
    def height(self) -> float:
        """Of the whole wall, m."""
        return self.element[1] * self._highest

    @property
    def _highest(self) -> int:
        return max(brick.y + brick.rows for brick in self.bricks)

    def is_on_top(self, brick: Brick) -> bool:
        """Whether a brick is one of the highest."""
        return brick.y + brick.rows == self._highest

    def discretise(self) -> Problem:
        """Discrete problem; lengths are scaled by the longest brick, stresses by E."""
        return _Assembly(self).problem()

    def loop(self, problem: Problem) -> Loop:
        """Shear force that moves the top over the displacement of the top."""
        force: Array | Callable[[LoopFields], Array]
        if self.moved is not None:
            held = reaction(problem, "top")
            force = lambda fields: held(fields.displacement)  # noqa: E731
        else:
            force = np.zeros_like(self.pressure) if self.shear is None else self.shear * self.length
        top = side_mean(problem, "top", 0)
        return Loop(("Displacement of the top", "m"), ("Shear force", "N"), top, force)

    def described(self) -> Description:
        """What there is, for whoever draws it."""
        top = np.array([[0.15, 1.0], [0.5, 1.0], [0.85, 1.0]])
        acts = [Act("top y", "σ", top, (0.0, 1.0), (0.0, 1.0), -self.pressure, "Pa")]
        if self.moved is not None:
            acts.append(Act("top x", "u_x", top[:1], (1.0, 0.0), (0.0, 1.0), self.moved, "m"))
        if self.shear is not None:
            acts.append(Act("top x", "τ", top[:1], (1.0, 0.0), (0.0, 1.0), self.shear, "Pa"))
        size = np.hypot(*self.weight)
        towards = self.weight / np.where(size > 0.0, size, 1.0)
        volume = self.element[0] * self.element[1] * sum(b.columns * b.rows for b in self.bricks)
        acts.append(
            Act("body", "W", np.array([[0.5, 0.5]]), towards, (1.0, 0.0), size * volume, "N")
        )
        return Description(
            bodies=len({brick.y for brick in self.bricks}),
            length=self.length,
            height=self.height,
            instants=self.instants,
            acts=acts,
            holds=(Hold("support", "bottom"),),
            tilt=self.tilt,
        )


class _Assembly:
    """Bricks and joints of a wall on their way to a problem."""

    def __init__(self, wall: Wall) -> None:
        self.wall = wall
        self.scale = wall.element[0] * max(brick.columns for brick in wall.bricks)
        self.element = wall.element[0] / self.scale, wall.element[1] / self.scale
        self.joints = joints_of(wall.bricks)
        self.traces: list[dict[str, Trace]] = [{} for _ in wall.bricks]
        for joint in self.joints:
            for number, side in self._sides(joint):
                self.traces[number][joint.name] = self._trace(joint, number, side)
        for number, brick in enumerate(wall.bricks):
            if wall.moved is not None and wall.is_on_top(brick):
                self.traces[number]["top"] = Trace("top", (0,))
        self.parts = list(self._parts())
        self.skeleton = number_rows(self.parts)

    def _sides(self, joint: Joint) -> Iterator[tuple[int, str]]:
        """Bricks of a joint, the one above or to the right first, and their sides there."""
        yield joint.above, "left" if joint.is_upright else "bottom"
        if joint.below is not None:
            yield joint.below, "right" if joint.is_upright else "top"

    def _trace(self, joint: Joint, number: int, side: str) -> Trace:
        brick = self.wall.bricks[number]
        origin, size = (brick.y, brick.rows) if joint.is_upright else (brick.x, brick.columns)
        first, after = joint.first - origin, joint.last - origin + 1
        last = after if after <= size else None
        return Trace(side, (0, 1), first, last, has_macro=joint.below is not None)

    def _parts(self) -> Iterator[Part]:
        wall, first = self.wall, 0
        elastic = elastic_matrix(1.0, wall.poisson, wall.state)
        whole: dict[tuple[int, int], Condensed] = {}
        kept: dict[tuple[object, ...], Condensed] = {}
        forces: dict[tuple[object, ...], Array] = {}
        for number, brick in enumerate(wall.bricks):
            size = brick.columns, brick.rows
            if size not in whole:
                whole[size] = Condensed(Rectangle(*size, *self.element, elastic))
            traces = self.traces[number]
            key = size, *traces.values()
            if key not in kept:
                kept[key] = keep(whole[size], traces.values())
            load = size, wall.is_on_top(brick)
            if load not in forces:
                forces[load] = self._force(whole[size].rectangle, is_on_top=load[1])
            shape = brick.rows + 1, brick.columns + 1
            nodes = first + np.arange(shape[0] * shape[1]).reshape(shape)
            first += nodes.size
            yield Part(kept[key], nodes, number, traces, force=forces[load])

    def _force(self, mesh: Rectangle, *, is_on_top: bool) -> Array:
        """Nodal forces of weight, and of what acts on a brick's top, (2 n_nodes, n_instants)."""
        wall = self.wall
        areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom")).reshape(-1, 1, 1)
        total = areas * (wall.weight * self.scale / wall.young)
        if is_on_top:
            widths, nodes = mesh.edge_weights("top")[:, None], mesh.edge("top")
            total[nodes, 1] -= widths * wall.pressure / wall.young
            if wall.shear is not None:
                total[nodes, 0] += widths * wall.shear / wall.young
        return np.asarray(total.reshape(-1, len(wall.instants)))

    def problem(self) -> Problem:
        wall, parts, skeleton = self.wall, self.parts, self.skeleton
        places = np.concatenate(
            [
                self.element
                * np.stack(
                    np.meshgrid(x + np.arange(c + 1), y + np.arange(r + 1)), axis=-1
                ).reshape(-1, 2)
                for x, y, c, r in wall.bricks
            ]
        )
        return problem_of(
            parts,
            skeleton,
            places,
            dict(self._interfaces()),
            scales=Scales(self.scale, wall.young * self.scale, wall.duration),
            instants=wall.instants,
        )

    def _interfaces(self) -> Iterator[tuple[str, Interface]]:
        wall = self.wall
        for joint in self.joints:
            yield joint.name, self._contact(joint)
        top = [part.rows["top"].ravel() for part in self.parts if "top" in part.rows]
        if wall.moved is not None:
            rows = np.concatenate(top)
            yield "top", Dirichlet(rows, np.tile(wall.moved / self.scale, (len(rows), 1)))

    def _contact(self, joint: Joint) -> Contact:
        wall, (across, along) = self.wall, (0, 1) if joint.is_upright else (1, 0)
        upper = self.parts[joint.above]
        rows, lower = upper.rows[joint.name], None
        if joint.below is not None:
            lower = self.parts[joint.below].rows[joint.name]
        places = np.arange(joint.first, joint.last + 1.0)
        step = self.element[1 if joint.is_upright else 0]
        weights = np.full(len(places), step)
        if joint.is_upright:
            weights[[0, -1]] += 0.5 * step * np.array([1, 1] if len(places) > 1 else 2)
        else:
            weights[[0, -1]] *= 0.5
        areas = weights * self.scale
        scales = self.scale, wall.young * self.scale
        components = [
            Component(rows[:, axis], None if lower is None else lower[:, axis])
            for axis in (across, along)
        ]
        law, mu = wall.friction_law, np.full(len(places), wall.friction)
        side = "left" if joint.is_upright else "bottom"
        basis = side_basis(upper.rectangle, side, len(places), wall.macro_degree)
        softness = law.softness_across(areas, scales)
        return Contact(
            normal=Unilateral(component=components[0], gap=np.zeros_like(mu), softness=softness),
            tangential=law.at(components[1], areas, scales, friction=mu),
            points=np.arange(len(places)),
            positions=places * step * self.scale,
            weights=areas,
            around=Bodies(
                moduli=(1.0, np.inf if lower is None else 1.0),
                depth=upper.rectangle.rows * wall.element[1],
            ),
            macro=None if lower is None else sparse.csr_array(basis),
        )
