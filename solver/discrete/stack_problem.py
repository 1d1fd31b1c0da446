"""Bodies in the plane as a discrete problem: rectangles that are cut, and touch where sides meet.

Substructures of one body are glued where they meet; other bodies, and the support, are in contact.
Lengths are scaled by the length of a body, stresses by E. Tractions act on the substructures
themselves, and need no interface. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.bricks import Brick, Joint, joints_of
from solver.discrete.cut_rods import substructure_sizes
from solver.discrete.elements import edge_mass, elastic_matrix
from solver.discrete.plane import Condensed, Rectangle, edge_lengths, side_basis
from solver.discrete.plane_parts import Part, Trace, lined_up, number_rows, problem_of
from solver.discrete.problem import Problem, Scales
from solver.discrete.rigid_stack import rigid_rest, rigid_slide
from solver.laws import (
    Bodies,
    Component,
    Contact,
    Dirichlet,
    FrictionLaw,
    Interface,
    Perfect,
    Unilateral,
)

if TYPE_CHECKING:
    from solver.discrete.stack import Given, Side, Spring, Stack

SIDES = "left", "right", "bottom", "top"


def discretise_stack(stack: Stack) -> Problem:
    """Cut the bodies into rectangles and write the laws of their interfaces."""
    cut = _Cut(stack)
    skeleton = number_rows(cut.parts)
    return problem_of(
        cut.parts,
        skeleton,
        cut.positions,
        dict(cut.interfaces()),
        scales=Scales(stack.length, stack.young * stack.length, stack.duration),
        instants=stack.instants,
        rest=_rest(stack, cut.positions[skeleton // 2], skeleton % 2),
    )


def _rest(stack: Stack, positions: Array, components: Indices) -> Array | None:
    """Displacement of degrees of freedom where the body rests, (n_dofs, n_instants), scaled."""
    rigid = rigid_rest(stack)
    if rigid is None:
        return None
    x, y = positions.T
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    rest = np.asarray(modes @ (rigid / np.array([[stack.length], [1.0]])))
    if stack.spring is not None:
        rest += np.outer(components == 0, rigid_slide(stack, stack.spring) / stack.length)
    return rest


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Where substructures end along a pile, in elements: at the cuts, and where a body ends."""
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


class _Piece(NamedTuple):
    """A substructure: its rectangle, column and row in its body, and the body."""

    rectangle: Brick
    column: int
    row: int
    body: int

    @property
    def name(self) -> str:
        """Its name in that of a cut."""
        return f"{self.column + 1}.{self.row + 1}" + (f" of {self.body + 1}" if self.body else "")


def _pieces(stack: Stack) -> Iterator[_Piece]:
    """All substructures, body by body and row by row."""
    spans = [brick.columns for brick in stack.rectangles]
    for body, brick in enumerate(stack.rectangles):
        cuts, most = stack.substructures, brick.columns
        others = spans if stack.is_pile else [most]
        ends = ends_along(max(others), cuts[0], others)
        across = [0, *ends[ends <= most].tolist()]
        up = np.cumsum([0, *substructure_sizes(brick.rows, cuts[1])]).tolist()
        for row, (low, high) in enumerate(pairwise(up)):
            for column, (left, right) in enumerate(pairwise(across)):
                own = Brick(brick.x + left, brick.y + low, right - left, high - low)
                yield _Piece(own, column, row, body)


class _Cut:
    """The bodies, cut into substructures.

    Attributes
    ----------
    positions
        Of all nodes, shape (n_nodes, 2), in lengths of a body.
    parts
        All substructures. Equal ones share what is condensed; their rows are still to be numbered.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        order, (columns, rows) = stack.order, stack.grid
        height = stack.height / stack.length
        self._element = 1.0 / stack.elements[0], height / stack.elements[1]
        x = np.linspace(0.0, columns / stack.elements[0], order * columns + 1)
        y = np.linspace(0.0, rows * height / stack.elements[1], order * rows + 1)
        self._nodes: list[Indices] = []
        positions, first = [], 0
        for brick in stack.rectangles:
            along, up = brick.nodes(order)
            everywhere = np.stack(np.meshgrid(x[along], y[up]), axis=-1)
            positions.append(everywhere.reshape(-1, 2))
            count = len(positions[-1])
            self._nodes.append(np.arange(first, first + count).reshape(everywhere.shape[:2]))
            first += count
        self.positions = np.concatenate(positions)
        self._pieces = list(_pieces(stack))
        joints = joints_of([piece.rectangle for piece in self._pieces])
        joints = [one for one in joints if one.below is not None or stack.support]
        self._touched = {place for joint in joints for place in joint.sides}
        # An upright joint of one element has no nodes but its ends.
        self._joints = [
            one for one in joints if order * (one.last - one.first) + 1 > sum(self._left_out(one))
        ]
        self._outlines: dict[tuple[int, int, float], Condensed] = {}
        self._kept: dict[tuple[object, ...], Condensed] = {}
        traces = self._traces()
        self.parts = [self._part(number, own) for number, own in enumerate(traces)]

    def _outer(self, number: int) -> Iterator[str]:
        """Sides of a substructure on which nothing is but what is given for such a side."""
        own, (columns, _) = self._pieces[number].rectangle, self.stack.grid
        is_end = {"left": own.x == 0, "right": own.x + own.columns == columns}
        for side in SIDES:
            if (number, side) not in self._touched and is_end.get(side, True):
                yield side

    def _is_cut(self, joint: Joint) -> bool:
        """Whether both sides are of one body."""
        above, below = self._pieces[joint.above], joint.below
        return below is not None and self._pieces[below].body == above.body

    def _has_macro(self, joint: Joint) -> bool:
        """Whether macro forces are to balance on a joint: not within a group of bodies."""
        groups = self.stack.groups
        if joint.below is None or groups is None or self._is_cut(joint):
            return joint.below is not None
        above, below = (self._pieces[number].body for number, _ in joint.sides)
        return bool(groups[above] != groups[below])

    def _name(self, joint: Joint) -> str:
        above = self._pieces[joint.above]
        below = None if joint.below is None else self._pieces[joint.below]
        if below is not None and below.body == above.body:
            return f"cut {below.name} to {above.name}"
        if self.stack.is_pile:
            return "support" if below is None else f"contact {above.body}-{above.body + 1}"
        other = "support" if below is None else f"brick {below.body + 1}"
        return f"{other} and brick {above.body + 1}"

    def _left_out(self, joint: Joint) -> tuple[int, int]:
        """Nodes that have no pair, at the first and at the last end of a joint.

        None has at an end where the left or right side prescribes the normal displacement: any
        pressing force would be a solution there, and so would any friction up to it. Nor has an
        upright joint: three contacts would meet in a corner, of whose forces only sums are
        determined, and which of them slips would depend on how they share.
        """
        support, sides = self.stack.support, self.stack.sides
        if self._is_cut(joint) or (joint.below is None and support and support.bound is not None):
            return 0, 0
        if joint.is_upright:
            bodies = [self.stack.rectangles[self._pieces[one].body] for one, _ in joint.sides]
            first = joint.first == max(brick.y for brick in bodies)
            last = joint.last == min(brick.y + brick.rows for brick in bodies)
            return int(first), int(last)
        first = joint.first == 0 and sides["left"].y.prescribed
        last = joint.last == self.stack.grid[0] and sides["right"].y.prescribed
        return int(first), int(last)

    def _traces(self) -> Iterator[dict[Hashable, Trace]]:
        """Rows of every substructure: all at an interface, or those of prescribed components.

        A support of known bound has the component along it.
        """
        stack, order = self.stack, self.stack.order
        traces: list[list[tuple[Hashable, Trace]]] = [[] for _ in self._pieces]
        for joint in self._joints:
            is_known = joint.below is None and stack.support and stack.support.bound is not None
            before, after = self._left_out(joint)
            for number, side in joint.sides:
                own = self._pieces[number].rectangle
                start, size = (own.y, own.rows) if joint.is_upright else (own.x, own.columns)
                first, last = order * (joint.first - start) + before, order * (joint.last - start)
                end = None if last - after == order * size else last - after + 1
                held = (0,) if is_known else (0, 1)
                trace = Trace(side, held, first, end, has_macro=self._has_macro(joint))
                traces[number].append((joint, trace))
        for number, named in enumerate(traces):
            is_lowest = self._pieces[number][2:] == (0, 0)
            for side in self._outer(number):
                given = enumerate(stack.sides[side])
                components = tuple(component for component, one in given if one.prescribed)
                if components:
                    named.append((side, Trace(side, components)))
                elif side == "right" and stack.spring is not None and is_lowest:
                    named.append(("spring", Trace(side, (0, 1), 0, 1)))
            yield dict(sorted(named, key=lambda each: SIDES.index(each[1].side)))

    def _part(self, number: int, traces: dict[Hashable, Trace]) -> Part:
        stack, (own, *_, body) = self.stack, self._pieces[number]
        shape = own.columns, own.rows, stack.modulus(body)
        if shape not in self._outlines:
            elastic = elastic_matrix(shape[2], stack.poisson, stack.state)
            self._outlines[shape] = Condensed(
                Rectangle(*shape[:2], *self._element, elastic, stack.order)
            )
        kind = shape, *traces.values()
        if kind not in self._kept:
            outline = self._outlines[shape]
            edges = [trace.dofs(outline.rectangle).ravel() for trace in traces.values()]
            self._kept[kind] = outline.keep(np.unique(np.concatenate(edges)))
        brick = stack.rectangles[body]
        along, up = own._replace(x=own.x - brick.x, y=own.y - brick.y).nodes(stack.order)
        return Part(
            condensed=self._kept[kind],
            nodes=self._nodes[body][up, along],
            body=body,
            traces=traces,
            modulus=shape[2],
            force=self._force(number, self._outlines[shape].rectangle),
        )

    def _force(self, number: int, mesh: Rectangle) -> Array | None:
        """Nodal forces of tractions and weight, (2 n_nodes, n_instants), or None."""
        stack, order = self.stack, self.stack.order
        total = np.zeros((mesh.n_nodes, 2, len(stack.instants)))
        for side in self._outer(number):
            nodes = mesh.edge(side)
            step = mesh.height if side in ("left", "right") else mesh.width
            edges = np.arange(0, len(nodes) - 1, order)[:, None] + np.arange(order + 1)
            for component, given in enumerate(stack.sides[side]):
                if given.prescribed or given.is_zero:
                    continue
                along = self._along(self._pieces[number], side, given)
                traction = (given.mean + along * given.slope) / stack.young
                force = step * np.matmul(edge_mass(order), traction[edges])
                np.add.at(total[:, component], nodes[edges], force)
        if stack.body_force is not None:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            density = stack.body_force * stack.length / stack.young
            total += areas.reshape(-1, 1, 1) * density
        return total.reshape(-1, len(stack.instants)) if total.any() else None

    def _along(self, piece: _Piece, side: str, given: Given) -> Array:
        """2 s / length - 1 at the nodes of a substructure on an outer side, (n_nodes, 1)."""
        own, (columns, rows) = piece.rectangle, self.stack.grid
        first, count, whole = own.x, own.columns, columns
        if side in ("left", "right"):
            first, count, whole = own.y, own.rows, rows
            if given.each_body:
                brick = self.stack.rectangles[piece.body]
                first, whole = own.y - brick.y, brick.rows
        order = self.stack.order
        nodes = np.arange(order * first, order * (first + count) + 1)[:, None]
        return np.asarray(2.0 * nodes / (order * whole) - 1.0)

    def interfaces(self) -> Iterator[tuple[str, Interface]]:
        """All interfaces by name: contacts, then cuts, then prescribed sides."""
        stack, contacts = self.stack, dict[str, list[Joint]]()
        for joint in self._joints:
            if not self._is_cut(joint):
                contacts.setdefault(self._name(joint), []).append(joint)
        for name, joints in contacts.items():
            yield name, self._contact(joints)
        if stack.spring is not None:
            yield "spring", self._spring(stack.spring)
        cuts = [one for one in self._joints if self._is_cut(one)]
        for joint in sorted(cuts, key=lambda one: (one.sides[1][0], not one.is_upright)):
            below, side = joint.sides[1]
            part, other = self.parts[below], self.parts[joint.above].rows[joint]
            own = part.rows[joint]
            basis = side_basis(part.rectangle, side, len(own), stack.macro_degree)
            macro = np.asarray(np.kron(basis, np.eye(2)))
            yield self._name(joint), Perfect(own.ravel(), other.ravel(), macro)
        for side, given in stack.sides.items():
            if any(one.prescribed for one in given):
                yield from self._prescribed(side, given)

    def _contact(self, joints: Sequence[Joint]) -> Contact:
        """Law of a body on what is below or to the left of it."""
        stack, is_upright = self.stack, joints[0].is_upright
        upper = [(self.parts[one.above], one) for one in joints]
        rows, macro = lined_up(upper, stack.macro_degree)
        under = [(self.parts[one.below], one) for one in joints if one.below is not None]
        lower = np.concatenate([part.rows[one] for part, one in under]) if under else None
        node, weights = map(np.concatenate, zip(*map(self._points, joints), strict=True))
        touching, points = np.unique(node, return_inverse=True)
        body, axis = self._pieces[joints[0].above].body, 1 if is_upright else 0
        size = (stack.height if is_upright else stack.length) / stack.elements[axis]
        support = None if under else stack.support
        gap = np.zeros(len(node)) if support is None else support.gap[node] / stack.length
        along, *across = (
            Component(rows[:, one], None if lower is None else lower[:, one])
            for one in (axis, 1 - axis)[: rows.shape[1]]
        )
        areas = stack.length * weights
        law, scales = stack.friction_law, (stack.length, stack.young * stack.length)
        if support is not None and support.bound is not None:
            known = support.bound[node] / (stack.young * stack.length) * areas[:, None]
            friction = law.at(along, areas, scales, known=known)
        else:
            mu = np.asarray(stack.friction if support is None else support.friction)
            of_each = mu[body - 1] if mu.ndim == 2 else mu
            mu = np.broadcast_to(of_each[node] if of_each.size > 1 else of_each, node.shape)
            friction = law.at(along, areas, scales, friction=mu)
            # Nothing is bonded across a gap.
            friction = replace(friction, bound=friction.bound * (gap <= 0.0)[:, None])
        normal = None
        if across:
            softness = law.softness_across(areas, scales)
            normal = Unilateral(component=across[0], gap=gap, softness=softness)
        below = stack.modulus(under[0][0].body) if under else np.inf
        depth = stack.height * (stack.rectangles[body].rows / stack.elements[1])
        return Contact(
            normal=normal,
            tangential=friction,
            points=points,
            positions=touching * (size / stack.order),
            weights=areas,
            around=Bodies(moduli=(stack.modulus(body), below), depth=depth),
            macro=macro if self._has_macro(joints[0]) else None,
        )

    def _points(self, joint: Joint) -> tuple[Indices, Array]:
        """Numbers of the pairs of a joint on the grid of all nodes, and the length of each."""
        order, (before, after) = self.stack.order, self._left_out(joint)
        count, step = joint.last - joint.first, self._element[1 if joint.is_upright else 0]
        lengths = edge_lengths(order, count, step)
        if joint.is_upright:
            lengths[1] += before * lengths[0]
            lengths[-2] += after * lengths[-1]
        some = slice(before, order * count + 1 - after)
        return (order * joint.first + np.arange(order * count + 1))[some], lengths[some]

    def _spring(self, spring: Spring) -> Contact:
        """Law of a spring: it pushes to the right, as if from the left."""
        stack = self.stack
        (part,) = (one for one in self.parts if "spring" in one.traces)
        rows = part.rows["spring"]
        return Contact(
            normal=Unilateral(
                component=Component(rows[:, 0]),
                gap=np.array([spring.slack / stack.length]),
                softness=np.array([stack.young / spring.stiffness]),
            ),
            tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
            points=np.zeros(1, dtype=np.intp),
            positions=np.array([stack.length]),
            weights=stack.length * part.traces["spring"].weights(part.rectangle),
            around=Bodies(moduli=(stack.modulus(0), np.inf)),
        )

    def _prescribed(self, side: str, given: Side) -> Iterator[tuple[str, Dirichlet]]:
        rows, values = [], []
        for number, part in enumerate(self.parts):
            if side not in part.traces:
                continue
            for column, component in enumerate(part.traces[side].components):
                one = given[component]
                along = self._along(self._pieces[number], side, one)
                moved = one.mean + along * one.slope
                if side in ("left", "right"):
                    self._settle_corners(number, side, component, moved)
                rows.append(part.rows[side][:, column])
                values.append(moved / self.stack.length)
        if rows:
            yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))

    def _settle_corners(self, number: int, side: str, component: int, moved: Array) -> None:
        """Let a corner have the displacement of the top or bottom, if both sides prescribe one."""
        for level in {"bottom", "top"}.intersection(self._outer(number)):
            other = self.stack.sides[level][component]
            if other.prescribed:
                sign = 1.0 if side == "right" else -1.0
                moved[0 if level == "bottom" else -1] = other.mean + sign * other.slope
