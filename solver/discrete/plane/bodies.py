"""Bodies of any shape in the plane as a structure: checks, loop and description."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.checks import (
    INSTANTS,
    POSITIVE,
    Choice,
    Count,
    InstanceOf,
    Numbers,
    SequenceOf,
    check,
    check_value,
)
from solver.discrete.plane.bodies_drawn import DrawnBodies
from solver.discrete.plane.bodies_refused import (
    check_chains,
    check_held,
    check_joined,
    check_load,
    check_names,
    check_pairs,
    check_spring,
    check_strengths,
    check_weight,
)
from solver.discrete.plane.body import Body, Held, Load, NodeSpring, Shape, turned_by
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.node_pairs import NodePairs, kinds_of
from solver.discrete.probes import constant, mean_held, node_sum, reaction
from solver.discrete.problem import Problem
from solver.discrete.structure import Act, Axes, Description, Loop
from solver.laws import FrictionLaw


@dataclass(frozen=True, eq=False)
class Bodies:
    """Bodies of any shape, joints between them, supports and loads.

    Attributes
    ----------
    bodies, joints, held, loads
        Bodies, by whose numbers the others name them.
    instants, duration
        Times, shape (n_instants,), and the unit of time, s.
    state
        "strain" or "stress", of all meshes.
    friction_law
        Friction law of all joints, beside the coefficients.
    macro_degree
        Degree of the macro basis on every piece of a joint or cut.
    springs
        Springs that pull nodes of bodies.
    groups
        Index of the group of each body, shape (bodies,), or None: bodies of one group
        pass no macro forces to each other.
    shown
        Name of what the loop shows: a Held or a Load; None is the first.

    Raises
    ------
    RefusedError
        For names that occur twice, numbers of bodies and nodes that do not exist, nodes
        of a joint that follow no edges or do not face each other, and normals that
        point into the body below.
    """

    bodies: Sequence[Body]
    joints: Sequence[Joint]
    held: Sequence[Held]
    loads: Sequence[Load]
    instants: Array
    duration: float
    state: str = "strain"
    friction_law: FrictionLaw = field(default_factory=FrictionLaw)
    macro_degree: int = 1
    shown: str | None = None
    springs: Sequence[NodeSpring] = ()
    groups: Indices | None = None

    def __post_init__(self) -> None:
        check(
            self,
            bodies=SequenceOf(InstanceOf(Body)),
            instants=INSTANTS,
            duration=POSITIVE,
            state=Choice(("strain", "stress")),
            friction_law=InstanceOf(FrictionLaw),
            macro_degree=Count(0),
        )
        # Bodies need not be joined, held or loaded: empty sequences are right.
        kinds = {"joints": Joint, "held": Held, "loads": Load, "springs": NodeSpring}
        for name, kind in kinds.items():
            if getattr(self, name):
                check_value(
                    f"Bodies.{name}", getattr(self, name), SequenceOf(InstanceOf(kind))
                )
        check_names(self.bodies)
        # Joints and holds are interfaces of one problem.
        holds = {held.name: held for held in self.held}.values()
        check_names([*self.joints, *self.springs, *holds, *self.loads])
        if self.shown is not None:
            shown = [each.name for each in self._given]
            check_value("Bodies.shown", self.shown, Choice(tuple(shown)))
        instants = len(self.instants)
        # Most bodies have the very same weight.
        by_weight = {id(body.weight): body for body in reversed(self.bodies)}
        for body in by_weight.values():
            check_weight(body, instants)
        check_joined(self.bodies, self.joints)
        check_chains(self.bodies, self.joints, self.joint_kinds)
        if self.joints:
            turns = self.rotations
            check_pairs(
                self.bodies,
                turns,
                self.joints,
                self.joint_kinds,
                self.pairs,
                self.nodes,
            )
        for held in self.held:
            check_held(self.bodies, held, instants)
        for load in self.loads:
            check_load(self.bodies, load, instants)
        for spring in self.springs:
            check_spring(self.bodies, spring)
        check_strengths(self.joints, instants)
        check(self, groups=Numbers(((len(self.bodies),),), whole=True))

    @cached_property
    def first_nodes(self) -> Indices:
        """Index of the first node of each body among those of all, (n_bodies + 1,).

        Nodes of all bodies follow each other; the last number is how many there are.
        """
        sizes = [len(body.shape.nodes) for body in self.bodies]
        return np.cumsum([0, *sizes])

    @cached_property
    def rotations(self) -> Array:
        """Matrices from the axes of shapes to the global ones, (n_bodies, 2, 2)."""
        return turned_by(np.array([body.angle for body in self.bodies]))

    @cached_property
    def nodes(self) -> Array:
        """Coordinates of the nodes of all bodies, shape (n_nodes, 2), m."""
        nodes = np.empty((self.first_nodes[-1], 2))
        by_shape = dict[Shape, list[int]]()
        for number, body in enumerate(self.bodies):
            by_shape.setdefault(body.shape, []).append(number)
        # Bodies of one shape are turned and moved together.
        for shape, numbers in by_shape.items():
            origins = np.array([self.bodies[number].origin for number in numbers])
            own = np.arange(len(shape.nodes))
            rows = np.add.outer(self.first_nodes[numbers], own)
            turned = shape.nodes @ self.rotations[numbers].swapaxes(1, 2)
            nodes[rows] = turned + origins[:, None]
        return nodes

    @cached_property
    def pairs(self) -> NodePairs:
        """Pairs of nodes of all joints."""
        return NodePairs.of(self.joints, self.first_nodes)

    @cached_property
    def joint_kinds(self) -> list[int]:
        """Index of the kind of each joint: as `kinds_of` says, (n_joints,)."""
        return kinds_of(self.bodies, self.joints)

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lower left corner of all bodies, and their size, shape (2,) both, m."""
        # Along rows of memory, which is ten times as quick as across them.
        columns = self.nodes.T.copy()
        lower = columns.min(axis=1)
        return lower, columns.max(axis=1) - lower

    def has_macro(self, joint: Joint) -> bool:
        """Check whether macro forces balance on a joint.

        They do between bodies, but not between those of one group.
        """
        if joint.below is None or self.groups is None:
            return joint.below is not None
        return bool(self.groups[joint.above] != self.groups[joint.below])

    @property
    def _given(self) -> list[Held | Load]:
        """All holds, then all loads."""
        return [*self.held, *self.loads]

    @property
    def _shown(self) -> Held | Load | None:
        """Hold or load of the loop; None where nothing is held or loaded."""
        for each in self._given:
            if self.shown in (None, each.name):
                return each
        return None

    @property
    def axes(self) -> Axes:
        """Titles and units of the loop."""
        shown = self._shown
        if shown is None:
            return ("Mean displacement along y", "m"), ("Weight along y", "N")
        if isinstance(shown, Held) and shown.axis == 2:
            return (f"Rotation of {shown.name}", "rad"), (
                f"Moment on {shown.name}",
                "N·m",
            )
        return (f"Displacement of {shown.name}", "m"), (f"Force on {shown.name}", "N")

    def loop(self, problem: Problem) -> Loop:
        """Hysteresis loop of the shown hold or load: force over mean displacement."""
        shown = self._shown
        if isinstance(shown, Held):
            force = reaction(problem, shown.name, shown.axis).of
            return Loop(*self.axes, mean_held(problem, shown.name, shown.axis), force)
        weights = np.zeros((self.first_nodes[-1], 2))
        if shown is None:
            weights[:, 1] = 1.0 / len(weights)
            return Loop(
                *self.axes, node_sum(problem, weights), constant(self.weights[1]).of
            )
        pattern = shown.pattern
        sizes = np.linalg.norm(pattern, axis=1)
        towards = pattern / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        nodes = self.first_nodes[shown.body] + shown.nodes
        weights[nodes] = pattern / (sizes.sum() or 1.0)
        force = np.einsum("na,nat->t", towards, shown.force)
        return Loop(*self.axes, node_sum(problem, weights), constant(force).of)

    @cached_property
    def weights(self) -> Array:
        """Weight of all bodies together, shape (2, n_instants), N."""
        whole = np.zeros((2, len(self.instants)))
        for body in self.bodies:
            if body.weight is not None:
                whole += body.shape.volume * body.weight
        return whole

    def description(self) -> Description:
        """Description of the bodies for drawings."""
        _, (length, height) = self.box
        return Description(
            bodies=len(self.bodies),
            length=float(length),
            height=float(height),
            instants=self.instants,
            acts=tuple(self._acts()),
            holds=(),
            footings=tuple(self._drawn.footings(self.joints)),
        )

    def _acts(self) -> Iterator[Act]:
        """Loads, prescribed displacements, and the weight."""
        return self._drawn.acts(self.loads, self.weights)

    @property
    def _drawn(self) -> DrawnBodies:
        """The bodies as drawings need them."""
        return DrawnBodies(self.bodies, self.held, self.box)
