"""Joints of rectangular bodies, with each other and with their support."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.rectangles.bricks import BrickJoint, joints_of
from solver.discrete.plane.rectangles.sides import SETTLED
from solver.discrete.plane.rectangles.stack import Stack


@dataclass(frozen=True, eq=False)
class StackJoints:
    """Joints of a stack, as data of bodies of any shape.

    Attributes
    ----------
    stack
        The stack.
    shapes
        Lattice of every body; equal bodies have the very same one.
    lines
        Lines along which bodies touch each other, or their support.
    """

    stack: Stack
    shapes: Sequence[Lattice]
    lines: Sequence[BrickJoint]

    @classmethod
    def of(cls, stack: Stack, shapes: Sequence[Lattice]) -> StackJoints:
        """Joints of a stack whose bodies have these shapes."""
        lines = joints_of(stack.rectangles)
        if stack.support is None or stack.strips:
            lines = [line for line in lines if line.below is not None]
        return cls(stack, shapes, lines)

    def all(self) -> list[Joint]:
        """Joints with pairs; those that are alike are made together."""
        alike = dict[Hashable, list[int]]()
        chosen = [line for line in self.lines if self._has_pairs(line)]
        for number, line in enumerate(chosen):
            alike.setdefault(self._key(line), []).append(number)
        names = self._names(chosen)
        found = dict[int, Joint]()
        for numbers in alike.values():
            lines = [chosen[number] for number in numbers]
            first = self._joint(lines[0])
            made = first.placed(
                [names[number] for number in numbers],
                [line.above for line in lines],
                [line.below for line in lines],
                starts=[self._start(line) for line in lines],
            )
            found.update(zip(numbers, made, strict=True))
        return [found[number] for number in range(len(chosen))]

    def _has_pairs(self, line: BrickJoint) -> bool:
        """Check whether any node of a joint has a pair.

        It has none where both sides are held across the joint.
        """
        paired = self._paired(line)
        if line.is_upright:
            return bool(paired is None or paired.any())
        support = self.stack.support
        has_strength = support is not None and support.strength is not None
        if line.below is None and has_strength:
            return True
        sides = self.stack.sides
        held = [
            line.first == 0 and sides["left"].y.prescribed,
            line.last == self.stack.grid[0] and sides["right"].y.prescribed,
        ]
        return line.last - line.first + 1 > sum(held)

    def _paired(self, line: BrickJoint) -> Flags | None:
        """Mask of the nodes of a joint that have a pair, (n,); None: all of them.

        An upright joint has no pair at the ends of its bodies: three contacts would
        meet in a corner, of whose forces only sums are determined, and which of them
        slips would depend on how they share.
        """
        if not line.is_upright:
            return None
        paired = np.ones(line.last - line.first + 1, dtype=bool)
        paired[[0, -1]] = False
        return paired

    def _key(self, line: BrickJoint) -> Hashable:
        """Key of a joint: those with equal keys differ in name, bodies and start."""
        sides = [
            (id(self.shapes[body]), side, line.first - self._corner(body, line))
            for body, side in line.sides
        ]
        mu = self._coefficients(line)
        if isinstance(mu, float):
            values: Hashable = mu
        else:
            values = mu.tobytes()
        if line.below is None:
            # The gap and the strength of a support are those of each of its nodes.
            values = line.first, values
        return tuple(sides), line.last - line.first, values

    def _corner(self, body: int, line: BrickJoint) -> int:
        """Begin of a body along a joint, in elements on the grid."""
        return self.stack.rectangles[body][int(line.is_upright)]

    def _chain(self, body: int, side: str, line: BrickJoint) -> Indices:
        """Nodes of a body along a joint, (n,)."""
        corner = self._corner(body, line)
        chain = self.shapes[body].side(side)
        return chain[line.first - corner : line.last - corner + 1]

    def _joint(self, line: BrickJoint) -> Joint:
        """Joint along a line."""
        chains = [self._chain(body, side, line) for body, side in line.sides]
        nodes_below = None
        if line.below is not None:
            nodes_below = chains[1]
        normal = np.eye(2)[1 - int(line.is_upright)]
        # The tangent of upright joints runs up, as that of lying ones to the right.
        joint = Joint(
            name="joint",
            above=line.above,
            nodes=chains[0],
            below=line.below,
            nodes_below=nodes_below,
            normals=np.tile(normal, (len(chains[0]), 1)),
            friction=self._coefficients(line),
            start=self._start(line),
            is_left_handed=line.is_upright,
            paired=self._paired(line),
        )
        if line.below is None:
            return self._on_support(joint, line)
        return joint

    def _on_support(self, joint: Joint, line: BrickJoint) -> Joint:
        """Joint with the gap and the strength of the support."""
        support = self.stack.support
        assert support is not None
        nodes = slice(line.first, line.last + 1)
        strength = None
        if support.strength is not None:
            strength = support.strength[nodes]
        return replace(
            joint,
            gap=support.gap[nodes],
            strength=strength,
            is_image=support.is_image,
        )

    def _start(self, line: BrickJoint) -> float:
        """Position of the first node of a joint along the grid, m."""
        axis = int(line.is_upright)
        size = self.stack.length, self.stack.height
        return size[axis] / self.stack.elements[axis] * line.first

    def _coefficients(self, line: BrickJoint) -> Array | float:
        """Coefficient of friction of a joint, or those of its nodes, (n,)."""
        stack = self.stack
        if stack.head_friction is not None and line.is_upright:
            return float(stack.head_friction)
        nodes = slice(line.first, line.last + 1)
        support = stack.support
        if support is not None and (line.below is None or line.below < stack.strips):
            of_ground = np.asarray(support.friction)
            if of_ground.ndim:
                return of_ground[nodes]
            return float(of_ground)
        mu = np.asarray(stack.friction)
        if mu.ndim > 1:
            mu = mu[line.above - 1]
        if mu.size > 1:
            return np.asarray(mu[nodes])
        return float(mu.item())

    def _names(self, lines: Sequence[BrickJoint]) -> list[str]:
        """Names of joints; one that comes again has a number."""
        names = list[str]()
        counts = dict[str, int]()
        for line in lines:
            name = self._name(line)
            counts[name] = counts.get(name, 0) + 1
            if counts[name] > 1:
                name = f"{name} ({counts[name]})"
            names.append(name)
        return names

    def _name(self, line: BrickJoint) -> str:
        """Name of the contact of two bodies, or of a body and its support."""
        above = line.above
        below = line.below
        if self.stack.is_pile:
            if below is None:
                return "support"
            return f"contact {above}-{above + 1}"
        strips = self.stack.strips
        brick = f"brick {above + 1 - strips}"
        if below is None:
            return f"support and {brick}"
        if below >= strips:
            return f"brick {below + 1 - strips} and {brick}"
        if self.stack.settlement[below].any():
            return f"{SETTLED} and {brick}"
        return f"support and {brick}"
