"""Bodies in the plane, cut into rectangles: meshes, joints, boundary rows, and what loads them.

Lengths are scaled by the length of a body, stresses by E. Tractions act on the
substructures themselves, and need no interface.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.elements import (
    EDGE_MASS,
    Rectangle,
    SchurComplement,
    elastic_matrix,
    side_basis,
)
from solver.discrete.inside import Part
from solver.discrete.plane.bricks import Brick, Joint, joints_of
from solver.discrete.substructure import Elasticity, substructure_sizes, tributary

if TYPE_CHECKING:
    from solver.discrete.plane.stack import Given, Stack

SIDES = "left", "right", "bottom", "top"


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Where substructures end along a pile, in elements: at the cuts, and where a body ends."""
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


class _Piece(NamedTuple):
    """A substructure: its rectangle, its body, and its name in that of a cut."""

    rectangle: Brick
    body: int
    name: str


def _pieces(stack: Stack) -> Iterator[_Piece]:
    """All substructures, body by body and row by row."""
    spans = [brick.columns for brick in stack.rectangles]
    for body, brick in enumerate(stack.rectangles):
        cuts = stack.substructures
        most = brick.columns
        if stack.is_pile:
            others = spans
        else:
            others = [most]
        ends = ends_along(max(others), cuts[0], others)
        across = [0, *ends[ends <= most].tolist()]
        up = np.cumsum([0, *substructure_sizes(brick.rows, cuts[1])]).tolist()
        if body:
            of_body = f" of {body + 1}"
        else:
            of_body = ""
        for row, (low, high) in enumerate(pairwise(up), start=1):
            for column, (left, right) in enumerate(pairwise(across), start=1):
                own = Brick(brick.x + left, brick.y + low, right - left, high - low)
                yield _Piece(own, body, f"{column}.{row}{of_body}")


class _Trace(NamedTuple):
    """Boundary rows along a side of a substructure, from its first node to before the last.

    Of components 0 along x and 1 along y. Parts share no operator that differ in
    whether macro forces are to balance there.
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


class CutStack:
    """Bodies, cut into rectangles.

    Search direction: E / l_sub per area, with l_sub the geometric mean of a part's
    sides, for cuts, contacts and supports alike (the paper's ES / l_sub). Equal parts
    share their operator.

    All nodes have scaled `positions`, body by body, shape (n_nodes, 2). The `parts`
    come body by body and row by row; boundary rows are numbered part by part and side
    by side. The `pairs` of a joint are their numbers on the grid of all nodes, and the
    scaled length of each.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        columns, rows = stack.grid
        height = stack.height / stack.length
        self._element = 1.0 / stack.elements[0], height / stack.elements[1]
        x = np.linspace(0.0, columns / stack.elements[0], columns + 1)
        y = np.linspace(0.0, rows * height / stack.elements[1], rows + 1)
        nodes = list[Indices]()
        positions = list[Array]()
        first = 0
        for brick in stack.rectangles:
            along, up = brick.nodes()
            everywhere = np.stack(np.meshgrid(x[along], y[up]), axis=-1)
            positions.append(everywhere.reshape(-1, 2))
            count = len(positions[-1])
            nodes.append(np.arange(first, first + count).reshape(everywhere.shape[:2]))
            first += count
        self.positions = np.concatenate(positions)
        self._pieces = list(_pieces(stack))
        joints = joints_of([piece.rectangle for piece in self._pieces])
        joints = [one for one in joints if one.below is not None or stack.support]
        self._touched = {place for joint in joints for place in joint.sides}
        every = ((joint, self._pairs_of(joint)) for joint in joints)
        self.pairs = {joint: pairs for joint, pairs in every if len(pairs[0])}
        self._mesh, self._operator = cache(self._mesh_of), cache(self._operator_of)
        self.parts: list[Part] = []
        n_rows = 0
        for number, traces in enumerate(self._traces()):
            own, body, _ = self._pieces[number]
            modulus = stack.modulus(body)
            mesh = self._mesh(own.columns, own.rows, modulus)
            force = self._force(number, mesh)
            # Members of a group have body forces on all or on none, and see the same
            # macro forces.
            kinds = tuple(traces.values())
            condensed, operator = self._operator(
                mesh, modulus, kinds, force is not None
            )
            numbers: dict[Hashable, Indices] = {}
            for name, trace in traces.items():
                shape = trace.dofs(mesh).shape
                numbers[name] = n_rows + np.arange(shape[0] * shape[1]).reshape(shape)
                n_rows += numbers[name].size
            brick = stack.rectangles[body]
            along, up = own._replace(x=own.x - brick.x, y=own.y - brick.y).nodes()
            self.parts.append(
                Part(
                    mesh,
                    condensed,
                    operator,
                    nodes[body][up, along],
                    body,
                    numbers,
                    force,
                )
            )

    def _mesh_of(self, columns: int, rows: int, modulus: float) -> Rectangle:
        elastic = elastic_matrix(modulus, self.stack.poisson, self.stack.state)
        return Rectangle(columns, rows, *self._element, elastic)

    def _operator_of(
        self, mesh: Rectangle, modulus: float, traces: Sequence[_Trace], has_force: bool
    ) -> tuple[SchurComplement, Elasticity]:
        dofs = np.concatenate([trace.dofs(mesh).ravel() for trace in traces])
        condensed = SchurComplement(mesh.outline, np.unique(dofs))
        density = modulus / np.sqrt(mesh.columns * mesh.width * mesh.rows * mesh.height)
        weights = [mesh.edge_weights(one.side)[one.first : one.last] for one in traces]
        k = [
            w.repeat(len(one.components))
            for w, one in zip(weights, traces, strict=True)
        ]
        trace = np.searchsorted(condensed.kept, dofs)
        return condensed, Elasticity(
            condensed.stiffness, trace, density * np.concatenate(k)
        )

    def _outer(self, number: int) -> Iterator[str]:
        """Sides of a substructure on which nothing is but what is given for such a side."""
        own = self._pieces[number].rectangle
        (columns, _) = self.stack.grid
        is_end = {"left": own.x == 0, "right": own.x + own.columns == columns}
        for side in SIDES:
            if (number, side) not in self._touched and is_end.get(side, True):
                yield side

    def bodies(self, joint: Joint) -> tuple[int, int | None]:
        """Body above, or to the right of, a joint, and the other one; None is the support."""
        if joint.below is None:
            below = None
        else:
            below = self._pieces[joint.below].body
        return self._pieces[joint.above].body, below

    def has_macro(self, joint: Joint) -> bool:
        """Whether macro forces are to balance on a joint: not within a group of bodies."""
        (above, below) = self.bodies(joint)
        groups = self.stack.groups
        if below is None or groups is None or above == below:
            return below is not None
        return bool(groups[above] != groups[below])

    def name(self, joint: Joint) -> str:
        """Name of the interface of which a joint is a part."""
        above, below = self.bodies(joint)
        if joint.below is not None and above == below:
            return f"cut {self._pieces[joint.below].name} to {self._pieces[joint.above].name}"
        if self.stack.is_pile:
            if below is None:
                return "support"
            return f"contact {above}-{above + 1}"
        if below is None:
            other = "support"
        else:
            other = f"brick {below + 1}"
        return f"{other} and brick {above + 1}"

    def basis(self, joint: Joint, which: int) -> Array:
        """Macro basis of one component on a side of a joint, (n_points, n_macro); above is 0."""
        number, side = joint.sides[which]
        part = self.parts[number]
        mesh = part.rectangle
        count = len(part.rows[joint])
        return side_basis(mesh, side, count, self.stack.macro_degree)

    def _is_known(self, joint: Joint) -> bool:
        """Whether it is with a support of known bound."""
        support = self.stack.support
        return joint.below is None and support is not None and support.bound is not None

    def _pairs_of(self, joint: Joint) -> tuple[Indices, Array]:
        before, after = self._left_out(joint)
        count = joint.last - joint.first
        lengths = self._element[joint.is_upright] * tributary(count)
        if joint.is_upright:
            lengths[1] += before * lengths[0]
            lengths[-2] += after * lengths[-1]
        some = slice(int(before), count + 1 - after)
        return np.arange(joint.first, joint.last + 1)[some], lengths[some]

    def _left_out(self, joint: Joint) -> tuple[bool, bool]:
        """Whether the node at the first, and at the last end of a joint has no pair.

        None has at an end where the left or right side prescribes the normal
        displacement: any pressing force would be a solution there, and so would any
        friction up to it. Nor has an upright joint: three contacts would meet in a
        corner, of whose forces only sums are determined, and which of them slips would
        depend on how they share.
        """
        above, below = self.bodies(joint)
        if above == below or self._is_known(joint):
            return False, False
        if joint.is_upright:
            bodies = [
                self.stack.rectangles[self._pieces[one].body] for one, _ in joint.sides
            ]
            first = joint.first == max(brick.y for brick in bodies)
            return first, joint.last == min(brick.y + brick.rows for brick in bodies)
        left, right = (
            self.stack.sides[side].y.prescribed for side in ("left", "right")
        )
        return joint.first == 0 and left, joint.last == self.stack.grid[0] and right

    def _traces(self) -> Iterator[dict[Hashable, _Trace]]:
        """Rows of every substructure, by joint, or by the name of a side: "spring" at a foot.

        All at an interface, or those of prescribed components. A support of known bound
        has the component along it.
        """
        stack = self.stack
        traces: list[list[tuple[Hashable, _Trace]]] = [[] for _ in self._pieces]
        for joint, (nodes, _) in self.pairs.items():
            held: tuple[int, ...] = (0, 1)
            if self._is_known(joint):
                held = (0,)
            for number, side in joint.sides:
                own = self._pieces[number].rectangle
                first = int(nodes[0]) - (own.y if joint.is_upright else own.x)
                trace = _Trace(
                    side, held, first, first + len(nodes), self.has_macro(joint)
                )
                traces[number].append((joint, trace))
        for number, named in enumerate(traces):
            own, body, _ = self._pieces[number]
            for side in self._outer(number):
                given = enumerate(stack.sides[side])
                components = tuple(
                    component for component, one in given if one.prescribed
                )
                if components:
                    named.append((side, _Trace(side, components)))
                elif (
                    side == "right"
                    and stack.spring is not None
                    and (own.y, body) == (0, 0)
                ):
                    named.append(("spring", _Trace(side, (0, 1), 0, 1)))
            yield dict(sorted(named, key=lambda each: SIDES.index(each[1].side)))

    def _force(self, number: int, mesh: Rectangle) -> Array | None:
        """Nodal forces of tractions and weight, (2 n_nodes, n_instants), or None."""
        stack = self.stack
        total = np.zeros((mesh.n_nodes, 2, len(stack.instants)))
        for side in self._outer(number):
            nodes = mesh.edge(side)
            step = mesh.height if side in ("left", "right") else mesh.width
            edges = np.arange(len(nodes) - 1)[:, None] + np.arange(2)
            for component, given in enumerate(stack.sides[side]):
                if given.prescribed or given.is_zero:
                    continue
                traction = self.values(number, side, given) / stack.young
                force = step * np.matmul(EDGE_MASS, traction[edges])
                np.add.at(total[:, component], nodes[edges], force)
        if stack.body_force is not None:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            density = stack.body_force * stack.length / stack.young
            total += areas.reshape(-1, 1, 1) * density
        if total.any():
            return total.reshape(-1, len(stack.instants))
        return None

    def values(self, number: int, side: str, given: Given) -> Array:
        """What is given at the nodes of a substructure on an outer side, (n_nodes, n_instants)."""
        own, body, _ = self._pieces[number]
        first = own.x
        count = own.columns
        whole = self.stack.grid[0]
        if side in ("left", "right"):
            brick = self.stack.rectangles[body]
            first = own.y - brick.y
            count = own.rows
            whole = brick.rows
        nodes = np.arange(first, first + count + 1)[:, None]
        return np.asarray(given.mean + (2.0 * nodes / whole - 1.0) * given.slope)
