"""Outer sides of rectangular bodies: where they are held, moved, pulled and pressed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import EDGE_MASS
from solver.discrete.plane.body import Held, Load
from solver.discrete.plane.lattice import Lattice
from solver.discrete.plane.rectangles.bricks import BrickJoint
from solver.discrete.plane.rectangles.sides import SideComponent
from solver.discrete.plane.rectangles.stack import Stack

SIDES = "top", "bottom", "left", "right"
"""Sides, in the order in which they hold: a corner that two prescribe is moved by the
first."""


class Span(NamedTuple):
    """Part of a side of a body on which no other body lies.

    `first` and `last` are its ends, in elements from the beginning of the side.
    """

    body: int
    side: str
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class StackSides:
    """Outer sides of a stack, as holds and loads of bodies of any shape.

    Attributes
    ----------
    stack
        The stack.
    shapes
        Lattice of every body.
    lines
        Lines along which bodies touch each other, or their support.
    ends
        Ends of the parts of every body, along and up, in elements from its lower left
        corner.
    """

    stack: Stack
    shapes: Sequence[Lattice]
    lines: Sequence[BrickJoint]
    ends: Sequence[tuple[Sequence[int], Sequence[int]]]

    @cached_property
    def spans(self) -> list[Span]:
        """Outer sides of all bodies: free, loaded or prescribed.

        Of the top and the bottom those parts that no body covers. On the left and right
        only those of bodies that reach farthest.
        """
        covered = self._covered()
        spans = list[Span]()
        for side, body in product(SIDES, range(len(self.shapes))):
            spans += self._spans_of(body, side, covered.get((body, side), []))
        return spans

    def _covered(self) -> dict[tuple[int, str], list[tuple[int, int]]]:
        """Ends of what lies under joints, in elements, by body and side."""
        covered = dict[tuple[int, str], list[tuple[int, int]]]()
        for line in self.lines:
            for body, side in line.sides:
                corner = self.stack.rectangles[body][int(line.is_upright)]
                ends = line.first - corner, line.last - corner
                covered.setdefault((body, side), []).append(ends)
        return covered

    def _spans_of(
        self, body: int, side: str, covered: Sequence[tuple[int, int]]
    ) -> Iterator[Span]:
        """Parts of a side of a body between those that are covered."""
        brick = self.stack.rectangles[body]
        columns, _ = self.stack.grid
        is_end = {
            "left": brick.x == 0,
            "right": brick.x + brick.columns == columns,
        }
        if not is_end.get(side, True):
            return
        size = brick.columns
        if side in is_end:
            size = brick.rows
        begin = 0
        for first, last in [*sorted(covered), (size, size)]:
            if first > begin:
                yield Span(body, side, begin, first)
            begin = last

    def _is_outermost(self, span: Span) -> bool:
        """Check whether no span of an outer side lies farther out than this one.

        A displacement is that of what lies farthest out, as a press or the ground would
        touch; a traction acts on all, as a fluid would.
        """
        brick = self.stack.rectangles[span.body]
        if span.side == "bottom":
            return brick.y == 0
        if span.side == "top":
            return brick.y + brick.rows == self.stack.grid[1]
        return True

    def _chain(self, span: Span) -> Indices:
        """Nodes of a body along a span, (n,)."""
        return self.shapes[span.body].side(span.side)[span.first : span.last + 1]

    def held(self) -> list[Held]:
        """Holds of prescribed displacements, by the names of the sides."""
        held = []
        for span in self.spans:
            for axis, given in enumerate(self.stack.sides[span.side]):
                if given.prescribed and self._is_outermost(span):
                    moved = self._values(span, given)
                    if span.side in ("left", "right"):
                        self._move_corners(span, axis, moved)
                    chain = self._chain(span)
                    held.append(Held(span.side, span.body, chain, axis, moved))
        return held

    def _values(self, span: Span, given: SideComponent) -> Array:
        """Displacement, m, or traction, Pa, at the nodes of a span, (n, n_instants)."""
        brick = self.stack.rectangles[span.body]
        if span.side in ("left", "right"):
            corner = 0
            whole = brick.rows
        else:
            corner = brick.x
            whole = self.stack.grid[0]
        mean = given.mean
        if mean.ndim > 1:
            mean = mean[span.body]
        nodes = corner + np.arange(span.first, span.last + 1)[:, None]
        return np.asarray(mean + (2.0 * nodes / whole - 1.0) * given.slope)

    def _move_corners(self, span: Span, axis: int, moved: Array) -> None:
        """Overwrite corners of an upright side with displacements of top and bottom.

        Only where top or bottom prescribe the component along the axis; `moved` is the
        displacement of the span's nodes, (n, n_instants), m.
        """
        sign = 1.0 if span.side == "right" else -1.0
        for level, corner in (("bottom", 0), ("top", -1)):
            given = self.stack.sides[level][axis]
            if given.prescribed and self._is_open(span, level):
                moved[corner] = given.mean + sign * given.slope

    def _is_open(self, span: Span, level: str) -> bool:
        """Check whether the corner of an upright side at a level is an outer one."""
        end = 0
        if span.side == "right":
            end = self.shapes[span.body].columns
        return any(
            other.body == span.body
            and other.side == level
            and end in (other.first, other.last)
            and self._is_outermost(other)
            for other in self.spans
        )

    def loads(self) -> list[Load]:
        """Loads of tractions, a load for each part of a body that they act on."""
        loads = list[Load]()
        for span in self.spans:
            traction = self._traction(span)
            if not traction.any():
                continue
            for own in self._of_parts(span):
                name = f"load {len(loads) + 1} on {span.side}"
                along = slice(own.first - span.first, own.last - span.first + 1)
                force = self._force(span.side, traction[along])
                loads.append(Load(name, span.body, self._chain(own), force))
        return loads

    def _traction(self, span: Span) -> Array:
        """Traction along x and y at the nodes of a span, (n, 2, n_instants), Pa."""
        shape = span.last - span.first + 1, 2, len(self.stack.instants)
        traction = np.zeros(shape)
        for axis, given in enumerate(self.stack.sides[span.side]):
            if not given.prescribed and not given.is_zero:
                traction[:, axis] = self._values(span, given)
        return traction

    def _of_parts(self, span: Span) -> Iterator[Span]:
        """Spans of the parts of a body on a span of it."""
        is_upright = span.side in ("left", "right")
        ends = self.ends[span.body][is_upright]
        inside = [end for end in ends if span.first < end < span.last]
        for first, last in pairwise([span.first, *inside, span.last]):
            yield span._replace(first=first, last=last)

    def _force(self, side: str, traction: Array) -> Array:
        """Nodal forces, N, of a traction at nodes along a side, Pa.

        Shape (n, 2, n_instants) both; between nodes the traction is linear.
        """
        size = self.shapes[0].width
        if side in ("left", "right"):
            size = self.shapes[0].height
        ends = np.stack([traction[:-1], traction[1:]])
        of_edges = size * np.einsum("ab,bnct->anct", EDGE_MASS, ends)
        force = np.zeros_like(traction)
        force[:-1] += of_edges[0]
        force[1:] += of_edges[1]
        return force
