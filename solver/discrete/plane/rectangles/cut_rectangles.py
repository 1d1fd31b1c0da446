"""Rectangles into which a stack is cut: their joints and their free sides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.plane.joint_laws import JointPiece
from solver.discrete.plane.rectangles.bricks import Brick, BrickJoint, joints_of
from solver.discrete.plane.rectangles.sides import SETTLED
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.substructure import substructure_sizes, tributary

SIDES = "left", "right", "bottom", "top"


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Ends of substructures along a pile, in elements, (n_ends,), ascending.

    0 is left out. Substructures end at the cuts of the longest body, and where any body
    ends.
    """
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


class Span(NamedTuple):
    """Part of a side of a substructure on which no other body lies.

    `first` and `last` are its ends, in elements from the beginning of the side.
    """

    side: str
    first: int
    last: int


class CutRectangle(NamedTuple):
    """A substructure: its rectangle, the index of its body, its name in cuts."""

    rectangle: Brick
    body: int
    name: str


class CutRectangles:
    """Rectangles into which a stack is cut, and their joints.

    Attributes
    ----------
    stack
        The stack.
    element
        Width and height of an element, over the length of a body.
    each
        All rectangles, body by body and row by row.
    joint_names
        Names of the contacts of bodies, with each other and with the support.
    joints, pieces
        Pieces of these contacts: where rectangles touch, and their pairs. Places of
        nodes are those along the grid of all elements.
    cuts
        Joints of rectangles of one body, by the rectangle below, upright ones before
        lying ones.
    outer
        What lies open of each rectangle.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        height = stack.height / stack.length
        self.element = (1.0 / stack.elements[0], height / stack.elements[1])
        self.each = list(_cut(stack))
        joints = self._joints()
        covered = self._covered_by(joints)
        numbers = range(len(self.each))
        self.outer = [list(self._outer_of(number, covered)) for number in numbers]
        self.cuts = [joint for joint in joints if self.is_within_body(joint)]
        self.cuts.sort(key=lambda joint: (joint.sides[1][0], not joint.is_upright))
        self._pairs = cache(self._pairs_of)
        contacts = self._contacts_of(joints)
        self.joint_names = list(contacts)
        self.joints = list(chain.from_iterable(contacts.values()))
        self.pieces = list(self._pieces_of(contacts))

    def _joints(self) -> list[BrickJoint]:
        """Joints of rectangles; those with a support only where there is one."""
        joints = joints_of([piece.rectangle for piece in self.each])
        if self.stack.support is not None and not self.stack.strips:
            return joints
        return [joint for joint in joints if joint.below is not None]

    def _covered_by(self, joints: Sequence[BrickJoint]) -> dict[tuple[int, str], Flags]:
        """Masks of elements under joints, (elements,), by rectangle and side."""
        covered = dict[tuple[int, str], Flags]()
        for joint in joints:
            for number, side in joint.sides:
                count, corner = self.extent(number, side)
                none = np.zeros(count, dtype=bool)
                elements = covered.setdefault((number, side), none)
                elements[joint.first - corner : joint.last - corner] = True
        return covered

    def _outer_of(
        self, number: int, covered: Mapping[tuple[int, str], Flags]
    ) -> Iterator[Span]:
        """Outer sides of a rectangle: free, loaded or prescribed.

        Of the top and the bottom those parts that no body covers, of sides by their
        `covered` elements. On the left and right only those of bodies that reach
        farthest. A traction acts on all of them, as a fluid would; a displacement is
        that of what lies farthest out, as a press or the ground would touch.
        """
        rectangle = self.each[number].rectangle
        columns, _ = self.stack.grid
        is_end = {
            "left": rectangle.x == 0,
            "right": rectangle.x + rectangle.columns == columns,
        }
        for side in SIDES:
            if not is_end.get(side, True):
                continue
            elements = covered.get((number, side))
            if elements is None:
                yield Span(side, 0, self.extent(number, side)[0])
            elif not elements.all():
                # Spans lie between covered elements; beyond the ends a side is covered.
                changes = np.diff(elements, prepend=True, append=True)
                ends = np.flatnonzero(changes).reshape(-1, 2)
                for first, last in ends.tolist():
                    yield Span(side, first, last)

    def extent(self, number: int, side: str) -> tuple[int, int]:
        """Number of elements along a side of a rectangle, and its start on the grid."""
        rectangle = self.each[number].rectangle
        if side in ("left", "right"):
            return rectangle.rows, rectangle.y
        return rectangle.columns, rectangle.x

    def _contacts_of(self, joints: Sequence[BrickJoint]) -> dict[str, list[BrickJoint]]:
        """Joints of each contact by name, without joints that have no pairs."""
        contacts = dict[str, list[BrickJoint]]()
        for joint in joints:
            if not self.is_within_body(joint) and len(self._pairs(joint)[0]):
                contacts.setdefault(self._name(joint), []).append(joint)
        return contacts

    def _pieces_of(
        self, contacts: Mapping[str, Sequence[BrickJoint]]
    ) -> Iterator[JointPiece]:
        """Pieces of contacts by name, contact by contact."""
        for number, joints in enumerate(contacts.values()):
            for joint in joints:
                nodes, weights = self._pairs(joint)
                parts = tuple(part for part, _ in joint.sides)
                yield JointPiece(number, parts, nodes, weights, int(joint.is_upright))

    def _pairs_of(self, joint: BrickJoint) -> tuple[Indices, Array]:
        """Nodes of a contact on the grid, and their lengths, m, (n_pairs,) both."""
        before, after = self._left_out(joint)
        count = joint.last - joint.first
        lengths = self.element[joint.is_upright] * tributary(count)
        if joint.is_upright:
            # The length of a node that is left out goes to its neighbour.
            lengths[1] += before * lengths[0]
            lengths[-2] += after * lengths[-1]
        paired = slice(int(before), count + 1 - after)
        nodes = np.arange(joint.first, joint.last + 1)
        return nodes[paired], self.stack.length * lengths[paired]

    def _left_out(self, joint: BrickJoint) -> tuple[bool, bool]:
        """Check whether the first, and whether the last, node of a joint has no pair.

        A lying joint has no pair at an end where the left or right side prescribes the
        normal displacement: any pressing force would be a solution there, and so would
        any friction up to it. An upright joint has no pair at the ends of its bodies:
        three contacts would meet in a corner, of whose forces only sums are determined,
        and which of them slips would depend on how they share.
        """
        if self.is_known(joint):
            return False, False
        if joint.is_upright:
            numbers = [self.each[piece].body for piece, _ in joint.sides]
            bodies = [self.stack.rectangles[number] for number in numbers]
            lowest = max(brick.y for brick in bodies)
            highest = min(brick.y + brick.rows for brick in bodies)
            return joint.first == lowest, joint.last == highest
        sides = self.stack.sides
        at_left = joint.first == 0
        at_right = joint.last == self.stack.grid[0]
        return (
            at_left and sides["left"].y.prescribed,
            at_right and sides["right"].y.prescribed,
        )

    def body_of(self, number: int) -> int:
        """Index of the body of a rectangle."""
        return self.each[number].body

    def bodies(self, joint: BrickJoint) -> tuple[int, int | None]:
        """Body above or to the right of a joint, and the other one (None: support)."""
        above = self.each[joint.above].body
        if joint.below is None:
            return above, None
        return above, self.each[joint.below].body

    def is_within_body(self, joint: BrickJoint) -> bool:
        """Check whether a joint is a glued cut inside one body."""
        above, below = self.bodies(joint)
        return above == below

    def is_known(self, joint: BrickJoint) -> bool:
        """Check whether a joint is with a support of known strength."""
        support = self.stack.support
        return (
            joint.below is None and support is not None and support.strength is not None
        )

    def has_macro(self, joint: BrickJoint) -> bool:
        """Check whether macro forces balance on a joint.

        They do on cuts and between bodies of different groups, not on the support.
        """
        above, below = self.bodies(joint)
        groups = self.stack.groups
        if below is None or groups is None or above == below:
            return below is not None
        return bool(groups[above] != groups[below])

    def cut_name(self, joint: BrickJoint) -> str:
        """Name of a cut between rectangles of one body."""
        assert joint.below is not None
        first = self.each[joint.below].name
        second = self.each[joint.above].name
        return f"cut {first} to {second}"

    def _name(self, joint: BrickJoint) -> str:
        """Name of the contact to which a joint of bodies belongs."""
        above, below = self.bodies(joint)
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

    def is_outermost(self, number: int, span: Span) -> bool:
        """Check whether no span of an outer side lies farther out than this one."""
        rectangle = self.each[number].rectangle
        if span.side == "bottom":
            return rectangle.y == 0
        if span.side == "top":
            return rectangle.y + rectangle.rows == self.stack.grid[1]
        return True


def _cut(stack: Stack) -> Iterator[CutRectangle]:
    """All substructures, body by body and row by row."""
    for body, brick in enumerate(stack.rectangles):
        ends_across = _ends_across(stack, brick)
        sizes_up = substructure_sizes(brick.rows, stack.substructures[1])
        ends_up = np.cumsum([0, *sizes_up]).tolist()
        of_body = ""
        if body:
            of_body = f" of {body + 1}"
        for row, (low, high) in enumerate(pairwise(ends_up), start=1):
            for column, (left, right) in enumerate(pairwise(ends_across), start=1):
                rectangle = Brick(
                    x=brick.x + left,
                    y=brick.y + low,
                    columns=right - left,
                    rows=high - low,
                )
                yield CutRectangle(rectangle, body, f"{column}.{row}{of_body}")


def _ends_across(stack: Stack, brick: Brick) -> list[int]:
    """Ends of the substructures of a body along x, in elements from its left side."""
    spans = [brick.columns]
    if stack.is_pile:
        spans = [each.columns for each in stack.rectangles]
    ends = ends_along(max(spans), stack.substructures[0], spans)
    return [0, *ends[ends <= brick.columns].tolist()]
