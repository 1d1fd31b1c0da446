"""Bodies in the plane as a discrete problem: rectangles that are cut, and touch where sides meet.

Substructures of one body are glued where they meet; other bodies, and the support, are in contact.
Lengths are scaled by the length of a body, stresses by E. Tractions act on the substructures
themselves, and need no interface. Contact forces are lumped at the nodes.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg import block_diag

from solver.arrays import Array, Indices
from solver.discrete.bricks import Brick, Joint, joints_of
from solver.discrete.cut_rods import substructure_sizes
from solver.discrete.elements import edge_mass, elastic_matrix
from solver.discrete.plane import Condensed, Rectangle, edge_lengths, side_basis
from solver.discrete.plane_parts import Inside, Part
from solver.discrete.problem import Problem, Scales
from solver.discrete.rigid_stack import rigid_rest, rigid_slide
from solver.discrete.substructure import Elasticity, Substructure
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
from solver.laws.friction import softness_of

if TYPE_CHECKING:
    from solver.discrete.stack import Given, Side, Spring, Stack

SIDES = "left", "right", "bottom", "top"


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


@dataclass(frozen=True)
class _Trace:
    """Boundary rows along a side of a substructure.

    Attributes
    ----------
    side
        "left", "right", "bottom" or "top".
    components
        Displacements that have rows, 0 along x and 1 along y.
    first, last
        Nodes of the side that have rows, as a slice.
    has_macro
        Whether macro forces are to balance there; parts that differ in it share no operator.
    """

    side: str
    components: tuple[int, ...] = (0, 1)
    first: int = 0
    last: int | None = None
    has_macro: bool = False

    def dofs(self, rectangle: Rectangle) -> Indices:
        """Degrees of freedom of a rectangle under the rows, shape (n_nodes, n_components)."""
        nodes = rectangle.edge(self.side)[self.first : self.last]
        return np.add.outer(2 * nodes, self.components)

    def weights(self, rectangle: Rectangle) -> Array:
        """Length of the whole side that belongs to each node, shape (n_nodes,), scaled."""
        return rectangle.edge_weights(self.side)[self.first : self.last]


class CutStack:
    """Bodies, cut into rectangles, and the laws of their interfaces.

    Search direction: E / l_sub per area, with l_sub the geometric mean of a part's sides, for cuts,
    contacts and supports alike (the paper's ES / l_sub). Equal parts share their operator.
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
        self._positions = np.concatenate(positions)
        self._pieces = list(_pieces(stack))
        joints = joints_of([piece.rectangle for piece in self._pieces])
        joints = [one for one in joints if one.below is not None or stack.support]
        self._touched = {place for joint in joints for place in joint.sides}
        # An upright joint of one element has no nodes but its ends.
        self._joints = [
            one for one in joints if order * (one.last - one.first) + 1 > sum(self._left_out(one))
        ]
        self._mesh, self._operator = cache(self._mesh_of), cache(self._operator_of)
        # Rows are numbered part by part and trace by trace, by the name of a side or the joint.
        self._traces = list(self._all_traces())
        self._parts: list[Part] = []
        self._operators: list[Elasticity] = []
        self._rows: list[dict[Hashable, Indices]] = []
        n_rows = 0
        for (own, *_, body), traces in zip(self._pieces, self._traces, strict=True):
            modulus, number = stack.modulus(body), len(self._parts)
            mesh = self._mesh(own.columns, own.rows, modulus)
            force = self._force(number, mesh)
            # Members of a group have body forces on all or on none, and see the same macro forces.
            condensed, operator = self._operator(
                mesh, modulus, tuple(traces.values()), force is not None
            )
            brick = stack.rectangles[body]
            along, up = own._replace(x=own.x - brick.x, y=own.y - brick.y).nodes(order)
            self._parts.append(Part(condensed, self._nodes[body][up, along], body, force))
            self._operators.append(operator)
            self._rows.append({})
            for name, trace in traces.items():
                dofs = trace.dofs(mesh)
                self._rows[-1][name] = n_rows + np.arange(dofs.size).reshape(dofs.shape)
                n_rows += dofs.size

    def problem(self) -> Problem:
        """The discrete problem."""
        stack = self.stack
        skeleton = np.unique(np.concatenate([part.dofs for part in self._parts]))
        scales = Scales(stack.length, stack.young * stack.length, stack.duration)
        places = self._positions[skeleton // 2]
        return Problem(
            substructures=tuple(
                Substructure(
                    elasticity=operator,
                    dofs=np.searchsorted(skeleton, part.dofs),
                    rows=np.concatenate([own.ravel() for own in rows.values()]),
                    body_force=None if part.force is None else part.condensed.condense(part.force),
                )
                for part, operator, rows in zip(
                    self._parts, self._operators, self._rows, strict=True
                )
            ),
            interfaces=dict(self._interfaces()),
            positions=places * scales.displacement,
            instants=stack.instants,
            scales=scales,
            inside=Inside(self._parts, self._positions, skeleton, scales, len(stack.instants)),
            rest=_rest(stack, places, skeleton % 2),
        )

    def _mesh_of(self, columns: int, rows: int, modulus: float) -> Rectangle:
        elastic = elastic_matrix(modulus, self.stack.poisson, self.stack.state)
        return Rectangle(columns, rows, *self._element, elastic, self.stack.order)

    def _operator_of(
        self, mesh: Rectangle, modulus: float, traces: Sequence[_Trace], has_force: bool
    ) -> tuple[Condensed, Elasticity]:
        dofs = np.concatenate([trace.dofs(mesh).ravel() for trace in traces])
        condensed = Condensed(mesh, np.unique(dofs))
        density = modulus / np.sqrt(mesh.columns * mesh.width * mesh.rows * mesh.height)
        k = [np.repeat(density * one.weights(mesh), len(one.components)) for one in traces]
        trace = np.searchsorted(condensed.dofs, dofs)
        return condensed, Elasticity(condensed.stiffness, trace, np.concatenate(k))

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

    def _all_traces(self) -> Iterator[dict[Hashable, _Trace]]:
        """Rows of every substructure: all at an interface, or those of prescribed components.

        A support of known bound has the component along it.
        """
        stack, order = self.stack, self.stack.order
        traces: list[list[tuple[Hashable, _Trace]]] = [[] for _ in self._pieces]
        for joint in self._joints:
            is_known = joint.below is None and stack.support and stack.support.bound is not None
            before, after = self._left_out(joint)
            for number, side in joint.sides:
                own = self._pieces[number].rectangle
                start = own.y if joint.is_upright else own.x
                first = order * (joint.first - start) + before
                last = order * (joint.last - start) - after + 1
                held = (0,) if is_known else (0, 1)
                trace = _Trace(side, held, first, last, has_macro=self._has_macro(joint))
                traces[number].append((joint, trace))
        for number, named in enumerate(traces):
            is_lowest = self._pieces[number][2:] == (0, 0)
            for side in self._outer(number):
                given = enumerate(stack.sides[side])
                components = tuple(component for component, one in given if one.prescribed)
                if components:
                    named.append((side, _Trace(side, components)))
                elif side == "right" and stack.spring is not None and is_lowest:
                    named.append(("spring", _Trace(side, (0, 1), 0, 1)))
            yield dict(sorted(named, key=lambda each: SIDES.index(each[1].side)))

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
                traction = self._values(number, side, given) / stack.young
                force = step * np.matmul(edge_mass(order), traction[edges])
                np.add.at(total[:, component], nodes[edges], force)
        if stack.body_force is not None:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            density = stack.body_force * stack.length / stack.young
            total += areas.reshape(-1, 1, 1) * density
        return total.reshape(-1, len(stack.instants)) if total.any() else None

    def _values(self, number: int, side: str, given: Given) -> Array:
        """What is given at the nodes of a substructure on an outer side, (n_nodes, n_instants)."""
        (own, *_, body), (columns, rows) = self._pieces[number], self.stack.grid
        first, count, whole = own.x, own.columns, columns
        if side in ("left", "right"):
            first, count, whole = own.y, own.rows, rows
            if given.each_body:
                brick = self.stack.rectangles[body]
                first, whole = own.y - brick.y, brick.rows
        order = self.stack.order
        nodes = np.arange(order * first, order * (first + count) + 1)[:, None]
        return np.asarray(given.mean + (2.0 * nodes / (order * whole) - 1.0) * given.slope)

    def _interfaces(self) -> Iterator[tuple[str, Interface]]:
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
            above, below = self._rows_of([joint])
            macro = np.asarray(np.kron(self._basis(joint, 1), np.eye(2)))
            yield self._name(joint), Perfect(below.ravel(), above.ravel(), macro)
        for side, given in stack.sides.items():
            if any(one.prescribed for one in given):
                yield from self._prescribed(side, given)

    def _contact(self, joints: Sequence[Joint]) -> Contact:
        """Law of a body on what is below or to the left of it."""
        stack, axis, under = self.stack, int(joints[0].is_upright), joints[0].below
        node, weights = map(np.concatenate, zip(*map(self._points, joints), strict=True))
        touching, points = np.unique(node, return_inverse=True)
        body, size = self._pieces[joints[0].above].body, (stack.length, stack.height)[axis]
        support = stack.support if under is None else None
        gap = np.zeros(len(node)) if support is None else support.gap[node] / stack.length
        rows = self._rows_of(joints)
        along, *across = (
            Component(*(own[:, one] for own in rows))
            for one in (axis, 1 - axis)[: rows[0].shape[1]]
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
            softness = softness_of(law.normal_stiffness, areas, scales)
            normal = Unilateral(component=across[0], gap=gap, softness=softness)
        macro = None
        if self._has_macro(joints[0]):
            bases = [self._basis(joint, 0) for joint in joints]
            # Most joints of a wall have one part, and SciPy takes long for one block.
            macro = sparse.csr_array(bases[0] if len(bases) == 1 else block_diag(*bases))
        below = np.inf if under is None else stack.modulus(self._parts[under].body)
        depth = stack.height * (stack.rectangles[body].rows / stack.elements[1])
        return Contact(
            normal=normal,
            tangential=friction,
            points=points,
            positions=touching * (size / stack.elements[axis] / stack.order),
            weights=areas,
            around=Bodies(moduli=(stack.modulus(body), below), depth=depth),
            macro=macro,
        )

    def _rows_of(self, joints: Sequence[Joint]) -> list[Indices]:
        """Rows of each side of joints in a row, the one above first, (n_points, n_components)."""
        return [
            np.concatenate([self._rows[one.sides[which][0]][one] for one in joints])
            for which in range(len(joints[0].sides))
        ]

    def _basis(self, joint: Joint, which: int) -> Array:
        """Macro basis of one component on a side of a joint, (n_points, n_macro); above is 0."""
        number, side = joint.sides[which]
        mesh, count = self._parts[number].condensed.rectangle, len(self._rows[number][joint])
        return side_basis(mesh, side, count, self.stack.macro_degree)

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
        (number,) = (number for number, rows in enumerate(self._rows) if "spring" in rows)
        rows, mesh = self._rows[number]["spring"], self._parts[number].condensed.rectangle
        return Contact(
            normal=Unilateral(
                component=Component(rows[:, 0]),
                gap=np.array([spring.slack / stack.length]),
                softness=np.array([stack.young / spring.stiffness]),
            ),
            tangential=FrictionLaw().at(Component(rows[:, 1]), np.ones(1), (1.0, 1.0)),
            points=np.zeros(1, dtype=np.intp),
            positions=np.array([stack.length]),
            weights=stack.length * self._traces[number]["spring"].weights(mesh),
            around=Bodies(moduli=(stack.modulus(0), np.inf)),
        )

    def _prescribed(self, side: str, given: Side) -> Iterator[tuple[str, Dirichlet]]:
        rows, values = [], []
        for number, traces in enumerate(self._traces):
            if side not in traces:
                continue
            for column, component in enumerate(traces[side].components):
                moved = self._values(number, side, given[component])
                if side in ("left", "right"):
                    self._settle_corners(number, side, component, moved)
                rows.append(self._rows[number][side][:, column])
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
