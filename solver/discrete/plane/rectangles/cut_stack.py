"""Stacks cut into substructures: meshes, operators and boundary rows.

Lengths are scaled by the length of a body, stresses by E. Tractions act on the
substructures themselves, and need no interface.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.cache import CACHE
from solver.discrete.condensed_part import (
    CondensedPart,
    Operator,
    Trace,
    kept_by,
    numbered,
)
from solver.discrete.elements import (
    Rectangle,
    elastic_matrix,
    legendre_basis,
)
from solver.discrete.plane.joint_laws import JOINT_SIDES
from solver.discrete.plane.rectangles.bricks import BrickJoint
from solver.discrete.plane.rectangles.cut_rectangles import SIDES, CutRectangles
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.plane.rectangles.stack_loads import StackLoads
from solver.discrete.scales import Scales
from solver.discrete.schur_complement import SchurComplement


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
    """Indices of the nodes of each body among those of all, (n_rows, n_columns)."""
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
    rectangles
        Where the substructures touch, and what lies open.
    scales
        Units of fields.
    positions
        Coordinates of all nodes, body by body, shape (n_nodes, 2), scaled.
    parts
        Substructures, body by body and row by row; boundary rows are numbered part by
        part and side by side.
    joint_names, pieces
        Names of the contacts of bodies, and their pieces.
    """

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        self.rectangles = CutRectangles(stack)
        self.scales = Scales(stack.length, stack.young * stack.length, stack.duration)
        grids = self._grids()
        self.positions = np.concatenate([grid.reshape(-1, 2) for grid in grids])
        self.joint_names = self.rectangles.joint_names
        self.pieces = self.rectangles.pieces
        # Equal substructures share a mesh and an operator.
        self._mesh = cache(self._mesh_of)
        self._trace = cache(_SideTrace.of)
        self._operator = cache(self._operator_of)
        self._basis = cache(self._basis_of)
        self._loads = StackLoads(self.rectangles)
        self.parts = list(self._parts(_node_numbers(grids)))

    def _grids(self) -> list[Array]:
        """Positions of the nodes of each body, (n_rows, n_columns, 2), scaled."""
        stack = self.stack
        columns, rows = stack.grid
        width = columns / stack.elements[0]
        height = rows * (stack.height / stack.length) / stack.elements[1]
        x = np.linspace(0.0, width, columns + 1)
        y = np.linspace(0.0, height, rows + 1)
        lattice = np.stack(np.meshgrid(x, y), axis=-1)
        grids = list[Array]()
        for brick in stack.rectangles:
            along, up = brick.nodes()
            grids.append(lattice[up, along])
        return grids

    def _parts(self, nodes: Sequence[Indices]) -> Iterator[CondensedPart]:
        """Substructures, by the numbers of each body's nodes, (n_rows, n_columns)."""
        n_rows = 0
        for number, traces in enumerate(self._traces()):
            body = self.rectangles.body_of(number)
            modulus = self.stack.modulus(body)
            mesh = self.mesh(number)
            force = self._loads.of(number, mesh)
            # Members of a group have body forces on all or on none, and see the same
            # macro forces.
            kinds = tuple(traces.values())
            has_force = force is not None
            of_mesh = {
                name: self._trace(trace, mesh, modulus)
                for name, trace in traces.items()
            }
            first_rows, n_rows = numbered(of_mesh, n_rows)
            yield CondensedPart(
                mesh=mesh,
                operator=self._operator(mesh, modulus, kinds, has_force),
                nodes=self._own_nodes(number, nodes[body]),
                body=body,
                traces=of_mesh,
                first_rows=first_rows,
                force=force,
            )

    def _own_nodes(self, number: int, nodes: Indices) -> Indices:
        """Nodes of a substructure, (n_rows, n_columns), from those of its body."""
        rectangle, body, _ = self.rectangles.each[number]
        brick = self.stack.rectangles[body]
        inside = rectangle._replace(x=rectangle.x - brick.x, y=rectangle.y - brick.y)
        along, up = inside.nodes()
        return nodes[up, along]

    def mesh(self, number: int) -> Rectangle:
        """Mesh of a substructure, which equal ones share."""
        rectangle, body, _ = self.rectangles.each[number]
        modulus = self.stack.modulus(body)
        return self._mesh(rectangle.columns, rectangle.rows, modulus)

    def _mesh_of(self, columns: int, rows: int, modulus: float) -> Rectangle:
        elastic = elastic_matrix(modulus, self.stack.poisson, self.stack.state)
        return Rectangle(columns, rows, *self.rectangles.element, elastic)

    def _operator_of(
        self,
        mesh: Rectangle,
        modulus: float,
        traces: tuple[_SideTrace, ...],
        has_force: bool,
    ) -> Operator:
        """Operator of a part, from the cache if an earlier structure had an equal part.

        `has_force` distinguishes operators.
        """
        shape = mesh.columns, mesh.rows, *self.rectangles.element
        material = modulus, self.stack.poisson, self.stack.state
        key = "operator", shape, material, traces, has_force
        of_mesh = [self._trace(trace, mesh, modulus) for trace in traces]
        # The operator is kept between runs, as no load and no friction changes it.
        return CACHE.get(
            key,
            lambda: Operator(SchurComplement(mesh.outline, kept_by(of_mesh)), of_mesh),
        )

    def macro_basis(self, number: int) -> Array:
        """Macro basis of one component on a piece by index, (n_pairs, n_macro).

        Without columns where no macro forces balance. The substructure above gives the
        degree.
        """
        joint = self.rectangles.joints[number]
        count = len(self.pieces[number].places)
        if not self.rectangles.has_macro(joint):
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

    def _traces(self) -> Iterator[dict[Hashable, _SideTrace]]:
        """Traces of every substructure: joints, sides, and the spring.

        By the side and index of a piece, by the cut, by the span of an outer side, or
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
        traces: list[dict[Hashable, _SideTrace]] = [{} for _ in self.rectangles.each]
        for n, (joint, piece) in enumerate(
            zip(self.rectangles.joints, self.pieces, strict=True)
        ):
            components: tuple[int, ...] = (0, 1)
            if self.rectangles.is_known(joint):
                components = (0,)
            has_macro = self.rectangles.has_macro(joint)
            first = int(piece.places[0])
            last = int(piece.places[-1])
            sides = zip(JOINT_SIDES, joint.sides, strict=False)
            for name, (number, side) in sides:
                _, corner = self.rectangles.extent(number, side)
                traces[number][name, n] = _SideTrace(
                    side, components, first - corner, last - corner + 1, has_macro
                )
        for joint in self.rectangles.cuts:
            for number, side in joint.sides:
                # A cut is a whole side.
                count, _ = self.rectangles.extent(number, side)
                traces[number][joint] = _SideTrace(side, last=count + 1, has_macro=True)
        return traces

    def _traces_of_sides(self, number: int) -> dict[Hashable, _SideTrace]:
        """Traces of a substructure on prescribed outer sides, and at a spring."""
        stack = self.stack
        rectangle, body, _ = self.rectangles.each[number]
        is_foot = (rectangle.y, body) == (0, 0)
        traces = dict[Hashable, _SideTrace]()
        for span in self.rectangles.outer[number]:
            components = tuple(
                component
                for component, given in enumerate(stack.sides[span.side])
                if given.prescribed
            )
            if components and self.rectangles.is_outermost(number, span):
                traces[span] = _SideTrace(
                    span.side, components, span.first, span.last + 1
                )
            elif span.side == "right" and stack.spring is not None and is_foot:
                traces["spring"] = _SideTrace(span.side, (0, 1), 0, 1)
        return traces
