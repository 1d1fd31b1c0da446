"""Bodies in the plane, cut into rectangles: meshes, joints, boundary rows and loads.

Lengths are scaled by the length of a body, stresses by E. Tractions act on the
substructures themselves, and need no interface.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Flags, Indices
from solver.discrete.condensed_part import CondensedPart, Operator, Trace, numbered
from solver.discrete.elements import (
    EDGE_MASS,
    Rectangle,
    elastic_matrix,
    legendre_basis,
)
from solver.discrete.plane.bricks import Brick, BrickJoint, joints_of
from solver.discrete.plane.joint_laws import JOINT_SIDES, JointPiece
from solver.discrete.plane.sides import Given
from solver.discrete.plane.stack import SETTLED, Stack
from solver.discrete.scales import Scales
from solver.discrete.substructure import substructure_sizes, tributary
from solver.kept import KEPT

SIDES = "left", "right", "bottom", "top"


def ends_along(elements: int, cuts: int, spans: Sequence[int]) -> Indices:
    """Ends of substructures along a pile, in elements, (n_ends,), ascending.

    0 is left out. Substructures end at the cuts of the longest body, and where any body
    ends.
    """
    return np.union1d(np.cumsum(substructure_sizes(elements, cuts)), spans)


class _Part(NamedTuple):
    """A substructure: its rectangle, the number of its body, and its name in cuts."""

    rectangle: Brick
    body: int
    name: str


def _parts_of(stack: Stack) -> Iterator[_Part]:
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
                yield _Part(rectangle, body, f"{column}.{row}{of_body}")


def _ends_across(stack: Stack, brick: Brick) -> list[int]:
    """Ends of the substructures of a body along x, in elements from its left side."""
    spans = [brick.columns]
    if stack.is_pile:
        spans = [each.columns for each in stack.rectangles]
    ends = ends_along(max(spans), stack.substructures[0], spans)
    return [0, *ends[ends <= brick.columns].tolist()]


class Span(NamedTuple):
    """Part of a side of a substructure on which no other body lies.

    `first` and `last` are its ends, in elements from the beginning of the side.
    """

    side: str
    first: int
    last: int


class _SideTrace(NamedTuple):
    """Boundary rows along a part of a side of a substructure.

    Nodes `first` to `last` of the side (without the last) have rows of the components:
    0 along x and 1 along y. Substructures with the same traces share an operator; so
    `has_macro` says whether macro forces balance there, as the operators then differ.
    """

    side: str
    components: tuple[int, ...] = (0, 1)
    first: int = 0
    last: int | None = None
    has_macro: bool = False

    def of(self, mesh: Rectangle, modulus: float) -> Trace:
        """Rows of a rectangle of a scaled Young's modulus."""
        own = slice(self.first, self.last)
        nodes = mesh.edge(self.side)[own]
        dofs = np.add.outer(2 * nodes, self.components)
        size = np.sqrt(mesh.columns * mesh.width * mesh.rows * mesh.height)
        k = modulus / size * mesh.edge_weights(self.side)[own]
        direction = np.repeat(k[:, None], len(self.components), axis=1)
        return Trace(dofs, direction, self.has_macro)


def _node_numbers(grids: Sequence[Array]) -> list[Indices]:
    """Numbers of the nodes of each body among those of all, (n_rows, n_columns)."""
    numbers = list[Indices]()
    first = 0
    for grid in grids:
        rows, columns, _ = grid.shape
        count = rows * columns
        numbers.append(np.arange(first, first + count).reshape(rows, columns))
        first += count
    return numbers


class CutStack:
    """A stack cut into rectangular substructures.

    Search direction: E / l_sub per area, with l_sub the geometric mean of a part's
    sides, for cuts, contacts and supports alike (the paper's ES / l_sub). Equal parts
    share their operator.

    Attributes
    ----------
    scales
        Units of fields.
    positions
        Coordinates of all nodes, body by body, shape (n_nodes, 2), scaled.
    parts
        Substructures, body by body and row by row; boundary rows are numbered part by
        part and side by side.
    joint_names
        Names of the contacts of bodies, with each other and with the support.
    joints, pieces
        Pieces of these contacts: where substructures touch, and their pairs. Places of
        nodes are those along the grid of all elements.
    cuts
        Joints of substructures of one body, by the substructure below, upright ones
        before lying ones.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        height = stack.height / stack.length
        self.scales = Scales(stack.length, stack.young * stack.length, stack.duration)
        self._element = (1.0 / stack.elements[0], height / stack.elements[1])
        grids = self._grids()
        self.positions = np.concatenate([grid.reshape(-1, 2) for grid in grids])
        self._rectangles = list(_parts_of(stack))
        joints = self._joints()
        covered = self._covered_by(joints)
        self._outer = [
            list(self._outer_of(number, covered))
            for number in range(len(self._rectangles))
        ]
        self.cuts = [joint for joint in joints if self.is_within_body(joint)]
        self.cuts.sort(key=lambda joint: (joint.sides[1][0], not joint.is_upright))
        self._pairs = cache(self._pairs_of)
        contacts = self._contacts_of(joints)
        self.joint_names = list(contacts)
        self.joints = list(chain.from_iterable(contacts.values()))
        self.pieces = list(self._pieces_of(contacts))
        # Equal substructures share a mesh and an operator.
        self._mesh = cache(self._mesh_of)
        self._trace = cache(_SideTrace.of)
        self._operator = cache(self._operator_of)
        self._basis = cache(self._basis_of)
        self.parts = list(self._parts(_node_numbers(grids)))

    def _grids(self) -> list[Array]:
        """Positions of the nodes of each body, (n_rows, n_columns, 2), scaled."""
        stack = self.stack
        columns, rows = stack.grid
        width = columns / stack.elements[0]
        height = rows * (stack.height / stack.length) / stack.elements[1]
        x = np.linspace(0.0, width, columns + 1)
        y = np.linspace(0.0, height, rows + 1)
        grids = list[Array]()
        for brick in stack.rectangles:
            along, up = brick.nodes()
            grids.append(np.stack(np.meshgrid(x[along], y[up]), axis=-1))
        return grids

    def _joints(self) -> list[BrickJoint]:
        """Joints of substructures; those with a support only where there is one."""
        joints = joints_of([piece.rectangle for piece in self._rectangles])
        if self.stack.support is not None and not self.stack.strips:
            return joints
        return [joint for joint in joints if joint.below is not None]

    def _covered_by(self, joints: Sequence[BrickJoint]) -> dict[tuple[int, str], Flags]:
        """Elements of each side of a substructure that joints cover, (elements,)."""
        covered = dict[tuple[int, str], Flags]()
        for joint in joints:
            for number, side in joint.sides:
                count, corner = self._extent(number, side)
                none = np.zeros(count, dtype=bool)
                elements = covered.setdefault((number, side), none)
                elements[joint.first - corner : joint.last - corner] = True
        return covered

    def _extent(self, number: int, side: str) -> tuple[int, int]:
        """Elements along a side of a substructure, and where it begins on the grid."""
        rectangle = self._rectangles[number].rectangle
        if side in ("left", "right"):
            return rectangle.rows, rectangle.y
        return rectangle.columns, rectangle.x

    def _pieces_of(
        self, contacts: Mapping[str, Sequence[BrickJoint]]
    ) -> Iterator[JointPiece]:
        """Pieces of contacts by name, contact by contact."""
        for number, joints in enumerate(contacts.values()):
            for joint in joints:
                nodes, weights = self._pairs(joint)
                parts = tuple(part for part, _ in joint.sides)
                yield JointPiece(number, parts, nodes, weights, int(joint.is_upright))

    def _contacts_of(self, joints: Sequence[BrickJoint]) -> dict[str, list[BrickJoint]]:
        """Joints of each contact by its name; those without pairs are left out."""
        contacts = dict[str, list[BrickJoint]]()
        for joint in joints:
            if not self.is_within_body(joint) and len(self._pairs(joint)[0]):
                contacts.setdefault(self._name(joint), []).append(joint)
        return contacts

    def _parts(self, nodes: Sequence[Indices]) -> Iterator[CondensedPart]:
        """Substructures, by the numbers of each body's nodes, (n_rows, n_columns)."""
        n_rows = 0
        for number, traces in enumerate(self._traces()):
            body = self.body_of(number)
            modulus = self.stack.modulus(body)
            mesh = self.mesh(number)
            force = self._force(number, mesh)
            # Members of a group have body forces on all or on none, and see the same
            # macro forces.
            kinds = tuple(traces.values())
            has_force = force is not None
            of_mesh = {
                name: self._trace(trace, mesh, modulus)
                for name, trace in traces.items()
            }
            rows, n_rows = numbered(of_mesh, n_rows)
            yield CondensedPart(
                mesh=mesh,
                operator=self._operator(mesh, modulus, kinds, has_force),
                nodes=self._own_nodes(number, nodes[body]),
                body=body,
                rows=rows,
                force=force,
            )

    def _own_nodes(self, number: int, nodes: Indices) -> Indices:
        """Nodes of a substructure, (n_rows, n_columns), out of those of its body."""
        rectangle, body, _ = self._rectangles[number]
        brick = self.stack.rectangles[body]
        inside = rectangle._replace(x=rectangle.x - brick.x, y=rectangle.y - brick.y)
        along, up = inside.nodes()
        return nodes[up, along]

    def mesh(self, number: int) -> Rectangle:
        """Mesh of a substructure, which equal ones share."""
        rectangle, body, _ = self._rectangles[number]
        modulus = self.stack.modulus(body)
        return self._mesh(rectangle.columns, rectangle.rows, modulus)

    def _mesh_of(self, columns: int, rows: int, modulus: float) -> Rectangle:
        elastic = elastic_matrix(modulus, self.stack.poisson, self.stack.state)
        return Rectangle(columns, rows, *self._element, elastic)

    def _operator_of(
        self,
        mesh: Rectangle,
        modulus: float,
        traces: tuple[_SideTrace, ...],
        has_force: bool,
    ) -> Operator:
        """Operator of a part, from an earlier structure if it has the same.

        `has_force` tells operators apart.
        """
        shape = mesh.columns, mesh.rows, *self._element
        material = modulus, self.stack.poisson, self.stack.state
        key = "operator", shape, material, traces, has_force
        of_mesh = [self._trace(trace, mesh, modulus) for trace in traces]
        # No load and no friction changes it.
        return KEPT.of(key, lambda: Operator(mesh.outline, of_mesh))

    def _outer_of(
        self, number: int, covered: Mapping[tuple[int, str], Flags]
    ) -> Iterator[Span]:
        """Outer sides of a substructure: free, loaded or prescribed.

        Of the top and the bottom those parts that no body covers, of sides by their
        `covered` elements. On the left and right only those of bodies that reach
        farthest. A traction acts on all of them, as a fluid would; a displacement is
        that of what lies farthest out, as a press or the ground would touch.
        """
        rectangle = self._rectangles[number].rectangle
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
                yield Span(side, 0, self._extent(number, side)[0])
            elif not elements.all():
                # Where it begins and ends to be covered; outside it counts as covered.
                changes = np.diff(elements, prepend=True, append=True)
                ends = np.flatnonzero(changes).reshape(-1, 2)
                for first, last in ends.tolist():
                    yield Span(side, first, last)

    def body_of(self, number: int) -> int:
        """Number of the body of a substructure."""
        return self._rectangles[number].body

    def bodies(self, joint: BrickJoint) -> tuple[int, int | None]:
        """Body above or to the right of a joint, and the other one (None: support)."""
        above = self._rectangles[joint.above].body
        if joint.below is None:
            return above, None
        return above, self._rectangles[joint.below].body

    def is_within_body(self, joint: BrickJoint) -> bool:
        """Check whether both sides of a joint are of one body, which is glued there."""
        above, below = self.bodies(joint)
        return above == below

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
        """Name of a cut between substructures of one body."""
        assert joint.below is not None
        first = self._rectangles[joint.below].name
        second = self._rectangles[joint.above].name
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

    def macro_basis(self, number: int) -> Array:
        """Macro basis of one component on a piece by number, (n_pairs, n_macro).

        Without columns where no macro forces balance. The substructure above gives the
        degree.
        """
        joint = self.joints[number]
        count = len(self.pieces[number].places)
        if not self.has_macro(joint):
            return np.zeros((count, 0))
        part, side = joint.sides[0]
        return self._basis(self.mesh(part), side, count)

    def macro_basis_of_cut(self, joint: BrickJoint) -> Array:
        """Macro basis of one component on a cut, (n_pairs, n_macro).

        The substructure below gives the degree.
        """
        part, side = joint.sides[1]
        return self._basis(self.mesh(part), side, joint.last - joint.first + 1)

    def _basis_of(self, mesh: Rectangle, side: str, count: int) -> Array:
        positions = np.linspace(-1.0, 1.0, count)
        degree = self.stack.macro_degree
        return legendre_basis(positions, mesh.slenderness(side), degree)

    def _is_known(self, joint: BrickJoint) -> bool:
        """Check whether a joint is with a support of known strength."""
        support = self.stack.support
        return (
            joint.below is None and support is not None and support.strength is not None
        )

    def _pairs_of(self, joint: BrickJoint) -> tuple[Indices, Array]:
        """Nodes of a contact on the grid, and their lengths, m, (n_pairs,) both."""
        before, after = self._left_out(joint)
        count = joint.last - joint.first
        lengths = self._element[joint.is_upright] * tributary(count)
        if joint.is_upright:
            # The length of a node that is left out goes to its neighbour.
            lengths[1] += before * lengths[0]
            lengths[-2] += after * lengths[-1]
        paired = slice(int(before), count + 1 - after)
        nodes = np.arange(joint.first, joint.last + 1)
        return nodes[paired], self.stack.length * lengths[paired]

    def _left_out(self, joint: BrickJoint) -> tuple[bool, bool]:
        """Check whether the first, and the last, node of a joint has no pair.

        A lying joint has no pair at an end where the left or right side prescribes the
        normal displacement: any pressing force would be a solution there, and so would
        any friction up to it. An upright joint has no pair at the ends of its bodies:
        three contacts would meet in a corner, of whose forces only sums are determined,
        and which of them slips would depend on how they share.
        """
        if self._is_known(joint):
            return False, False
        if joint.is_upright:
            numbers = [self._rectangles[piece].body for piece, _ in joint.sides]
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

    def _traces(self) -> Iterator[dict[Hashable, _SideTrace]]:
        """Traces of every substructure, side by side.

        By the side and number of a piece, by the cut, by the span of an outer side, or
        by "spring". Contacts have both components, or with a support of known strength
        the one along it; cuts both; an outer side those that are prescribed; the foot
        under a spring both.
        """
        for number, of_joints in enumerate(self._traces_of_joints()):
            traces = of_joints | self._traces_of_sides(number)
            in_order = sorted(
                traces.items(), key=lambda named: SIDES.index(named[1].side)
            )
            yield dict(in_order)

    def _traces_of_joints(self) -> list[dict[Hashable, _SideTrace]]:
        """Traces of every substructure on its contacts and cuts."""
        traces: list[dict[Hashable, _SideTrace]] = [{} for _ in self._rectangles]
        for n, (joint, piece) in enumerate(zip(self.joints, self.pieces, strict=True)):
            components: tuple[int, ...] = (0, 1)
            if self._is_known(joint):
                components = (0,)
            has_macro = self.has_macro(joint)
            first = int(piece.places[0])
            last = int(piece.places[-1])
            sides = zip(JOINT_SIDES, joint.sides, strict=False)
            for name, (number, side) in sides:
                _, corner = self._extent(number, side)
                traces[number][name, n] = _SideTrace(
                    side, components, first - corner, last - corner + 1, has_macro
                )
        for joint in self.cuts:
            for number, side in joint.sides:
                # A cut is a whole side.
                count, _ = self._extent(number, side)
                traces[number][joint] = _SideTrace(side, last=count + 1, has_macro=True)
        return traces

    def _traces_of_sides(self, number: int) -> dict[Hashable, _SideTrace]:
        """Traces of a substructure on prescribed outer sides, and at a spring."""
        stack = self.stack
        rectangle, body, _ = self._rectangles[number]
        is_foot = (rectangle.y, body) == (0, 0)
        traces = dict[Hashable, _SideTrace]()
        for span in self._outer[number]:
            components = tuple(
                component
                for component, given in enumerate(stack.sides[span.side])
                if given.prescribed
            )
            if components and self._is_outermost(number, span):
                traces[span] = _SideTrace(
                    span.side, components, span.first, span.last + 1
                )
            elif span.side == "right" and stack.spring is not None and is_foot:
                traces["spring"] = _SideTrace(span.side, (0, 1), 0, 1)
        return traces

    def _is_outermost(self, number: int, span: Span) -> bool:
        """Check whether a span of an outer side lies as far out as any of that side."""
        rectangle = self._rectangles[number].rectangle
        if span.side == "bottom":
            return rectangle.y == 0
        if span.side == "top":
            return rectangle.y + rectangle.rows == self.stack.grid[1]
        return True

    def _force(self, number: int, mesh: Rectangle) -> Array | None:
        """Nodal forces of tractions and weight, scaled, or None.

        Shape (2 n_nodes, n_instants).
        """
        stack = self.stack
        total = np.zeros((mesh.n_nodes, 2, len(stack.instants)))
        for span in self._outer[number]:
            for component, given in enumerate(stack.sides[span.side]):
                if given.prescribed or given.is_zero:
                    continue
                traction = self.values(number, span, given) / stack.young
                _add_traction(total[:, component], mesh, span, traction)
        if stack.body_force is not None and self.body_of(number) >= stack.strips:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            density = stack.body_force * stack.length / stack.young
            total += areas.reshape(-1, 1, 1) * density
        if total.any():
            return total.reshape(-1, len(stack.instants))
        return None

    def values(self, number: int, span: Span, given: Given) -> Array:
        """Given displacement or traction at the nodes of a span of an outer side.

        Shape (n_nodes, n_instants), m or Pa.
        """
        rectangle, body, _ = self._rectangles[number]
        if span.side in ("left", "right"):
            brick = self.stack.rectangles[body]
            corner = rectangle.y - brick.y
            whole = brick.rows
        else:
            corner = rectangle.x
            whole = self.stack.grid[0]
        mean = given.mean
        if mean.ndim > 1:
            mean = mean[body]
        nodes = corner + np.arange(span.first, span.last + 1)[:, None]
        return np.asarray(mean + (2.0 * nodes / whole - 1.0) * given.slope)


def _add_traction(force: Array, mesh: Rectangle, span: Span, traction: Array) -> None:
    """Add nodal forces of a traction on a span of a side to those of all nodes.

    `force` is (n_nodes, n_instants), `traction` that of the nodes of the span, (nodes
    along, n_instants); both scaled, of one component.
    """
    nodes = mesh.edge(span.side)[span.first : span.last + 1]
    size = mesh.height if span.side in ("left", "right") else mesh.width
    ends = np.arange(len(nodes) - 1)[:, None] + np.arange(2)
    of_edges = size * np.matmul(EDGE_MASS, traction[ends])
    np.add.at(force, nodes[ends], of_edges)
