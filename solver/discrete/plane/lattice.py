"""Rectangles of equal quadrilaterals as shapes of bodies.

Displacement is bilinear, with incompatible modes in every element: thin bodies do not
lock. A chain is a sequence of neighbouring nodes along a row or a column.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.checks import POSITIVE, Count, check
from solver.discrete.elements import (
    assembled,
    dofs_of,
    element_stiffness,
    strain_matrix,
)
from solver.discrete.plane.meshes import HALVES, chains_along, normals_out, on_nodes


@dataclass(frozen=True, eq=False)
class Lattice:
    """A rectangle of equal elements, whose lower left corner is at the origin.

    Nodes are numbered row by row from below, as are elements.

    Attributes
    ----------
    columns, rows
        Numbers of elements along and up.
    width, height
        Size of an element, m.

    Raises
    ------
    RefusedError
        For numbers below 1 and sizes that are not above zero.
    """

    columns: int
    rows: int
    width: float
    height: float

    def __post_init__(self) -> None:
        check(
            self,
            columns=Count(1),
            rows=Count(1),
            width=POSITIVE,
            height=POSITIVE,
        )

    @property
    def content(self) -> Hashable:
        """Key of the lattice: equal ones have equal keys."""
        return self.columns, self.rows, self.width, self.height

    def is_rectangle(self, elements: Indices) -> bool:
        """Check whether some elements, (n,), fill a rectangle."""
        columns, rows = self._extent(elements)
        return columns * rows == len(elements)

    def content_of_part(self, elements: Indices) -> Hashable:
        """Key of some elements, ascending, (n,), wherever they lie in the lattice."""
        size = self._extent(elements)
        own: Hashable = size
        if size[0] * size[1] != len(elements):
            rows, columns = np.divmod(elements, self.columns)
            own = (rows - rows.min()).tobytes(), (columns - columns.min()).tobytes()
        return own, self.width, self.height

    def _extent(self, elements: Indices) -> tuple[int, int]:
        """Numbers of columns and rows in which some elements, (n,), lie."""
        rows, columns = np.divmod(elements, self.columns)
        return int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1

    @cached_property
    def grid(self) -> Indices:
        """Index of every node, shape (rows + 1, columns + 1), from below."""
        shape = self.rows + 1, self.columns + 1
        return np.arange(shape[0] * shape[1], dtype=np.intp).reshape(shape)

    @cached_property
    def nodes(self) -> Array:
        """Coordinates of the nodes, shape (n_nodes, 2), m."""
        x = self.width * np.arange(self.columns + 1)
        y = self.height * np.arange(self.rows + 1)
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)

    @cached_property
    def element_nodes(self) -> Indices:
        """Corners of every element, counter-clockwise, shape (n_elements, 4)."""
        grid = self.grid
        corners = [grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]]
        return np.stack([corner.ravel() for corner in corners], axis=1)

    @property
    def element_corners(self) -> Indices:
        """Corners of every element, as `element_nodes`."""
        return self.element_nodes

    @cached_property
    def centres(self) -> Array:
        """Middle of every element, shape (n_elements, 2), m."""
        return np.asarray(self.nodes[self.element_nodes].mean(axis=1))

    @cached_property
    def areas(self) -> Array:
        """Area of every element, shape (n_elements,), m^2."""
        return np.full(self.rows * self.columns, self.width * self.height)

    @property
    def volume(self) -> float:
        """Volume for a metre of thickness, m^3."""
        return self.rows * self.columns * self.width * self.height

    @property
    def size(self) -> float:
        """Side of a square of the same area, m."""
        return float(np.sqrt(self.volume))

    @property
    def flaw(self) -> str:
        """Flaw of the lattice in words: it has none."""
        return ""

    def side(self, name: str) -> Indices:
        """Chain of nodes along a side, from below or from the left, (n,).

        The name is "left", "right", "bottom" or "top".
        """
        sides: dict[str, Indices] = {
            "left": self.grid[:, 0],
            "right": self.grid[:, -1],
            "bottom": self.grid[0],
            "top": self.grid[-1],
        }
        return sides[name]

    def along(self, corners: Sequence[int] | Indices) -> Indices:
        """Chain of nodes, (n,): the corners of elements are all nodes."""
        return np.asarray(corners, dtype=np.intp)

    def edges_of(self, chain: Indices) -> Indices | None:
        """Lower or left node of each edge of a chain, (n_edges,); None if it is none.

        A chain runs straight, along a row or along a column.
        """
        if len(chain) < 2:
            return None
        sizes = np.abs(np.diff(chain))
        rows, columns = self._places(chain)
        is_row = np.all(sizes == 1) and np.all(rows == rows[0])
        is_column = np.all(sizes == self.columns + 1) and np.all(columns == columns[0])
        if not is_row and not is_column:
            return None
        return np.minimum(chain[:-1], chain[1:])

    def chains_of(self, nodes: Indices) -> list[Indices]:
        """Chains, (n,) each, along consecutive nodes; [] if some belong to none."""
        return chains_along(self.edges_of, nodes, 1)

    def _places(self, nodes: Indices) -> tuple[Indices, Indices]:
        """Row and column of nodes, (n,) each."""
        rows, columns = np.divmod(nodes, self.columns + 1)
        return rows, columns

    def _lengths(self, chain: Indices) -> Array:
        """Lengths of the edges of a chain, (n - 1,), m."""
        is_up = np.abs(np.diff(chain)) > 1
        return np.where(is_up, self.height, self.width)

    def steps(self, chain: Indices) -> tuple[Indices, Array]:
        """Steps from node to node of a chain: elements, and lengths of their ends.

        Elements have the shape (n - 1,), lengths that belong to both ends of each step
        (n - 1, 2), m.
        """
        rows, columns = self._places(np.minimum(chain[:-1], chain[1:]))
        # There is no element beyond the upper and the right side.
        rows = np.minimum(rows, self.rows - 1)
        columns = np.minimum(columns, self.columns - 1)
        elements = rows * self.columns + columns
        return elements, np.multiply.outer(self._lengths(chain), HALVES)

    def seams(self, labels: Indices) -> tuple[Indices, Indices, Array]:
        """Edges between elements of different labels, (n_elements,).

        Labels on both sides of each, the smaller first, (n, 2); its nodes, (n, 2); and
        the length that belongs to each of these, (n, 2), m.
        """
        of_elements = labels.reshape(self.rows, self.columns)
        grid = self.grid
        upright = of_elements[:, :-1], of_elements[:, 1:], grid[:-1, 1:-1]
        lying = of_elements[:-1], of_elements[1:], grid[1:-1, :-1]
        both = list[Indices]()
        nodes = list[Indices]()
        lengths = list[Array]()
        directions = (
            (upright, self.columns + 1, self.height),
            (lying, 1, self.width),
        )
        for (before, after, first), step, length in directions:
            is_seam = before != after
            both.append(np.stack([before[is_seam], after[is_seam]], axis=1))
            nodes.append(first[is_seam][:, None] + step * np.arange(2))
            lengths.append(np.full((np.count_nonzero(is_seam), 2), 0.5 * length))
        return (
            np.sort(np.concatenate(both), axis=1),
            np.concatenate(nodes),
            np.concatenate(lengths),
        )

    def shares(self, chain: Indices) -> Array:
        """Length of a chain that belongs to each of its nodes, shape (n,), m."""
        return on_nodes(self._lengths(chain), HALVES)

    def outward(self, chain: Indices) -> Array:
        """Normals out of the elements along a chain, times `shares`, (n, 2), m."""
        elements, _ = self.steps(chain)
        normals = normals_out(self.nodes[chain], self.centres[elements])
        return on_nodes(normals, HALVES)

    def lengths_on_side(self, chain: Indices, nodes: Indices) -> Array:
        """Length of a side of a part that belongs to each node of a chain, (n,), m.

        `nodes` are those of the part, a rectangle, (n_nodes,): the chain may be shorter
        than its side.
        """
        is_upright = self._is_upright(chain)
        length = self.height if is_upright else self.width
        axis = 1 - int(is_upright)
        along = self._places(chain)[axis]
        own = self._places(nodes)[axis]
        is_end = (along == own.min()) | (along == own.max())
        return np.where(is_end, 0.5 * length, length)

    def slenderness(self, chain: Indices, nodes: Indices) -> float:
        """Length of the side of a part that a chain lies on, over the depth behind it.

        `nodes` are those of the part, a rectangle, (n_nodes,).
        """
        rows, columns = self._places(nodes)
        along = self.width * np.ptp(columns)
        up = self.height * np.ptp(rows)
        if self._is_upright(chain):
            return float(up / along)
        return float(along / up)

    @staticmethod
    def _is_upright(chain: Indices) -> bool:
        """Check whether a chain runs along a column of nodes."""
        return bool(abs(chain[1] - chain[0]) > 1)

    def columns_of(self, nodes: Indices) -> int:
        """Number of nodes along of a part, a rectangle of nodes, (n_nodes,)."""
        _, columns = self._places(nodes)
        return int(np.ptp(columns)) + 1

    def stiffness(self, elastic: Array, elements: Indices) -> sparse.csr_array:
        """Stiffness of some elements, (2 n_nodes, 2 n_nodes), per unit of `elastic`.

        `elastic` is an `elastic_matrix`, (3, 3).
        """
        own = element_stiffness(self.width, self.height, elastic)
        dofs = dofs_of(self.element_nodes[elements])
        blocks = np.broadcast_to(own, (len(dofs), *own.shape))
        size = 2 * self.grid.size
        return assembled(blocks, dofs[:, :, None], dofs[:, None], (size, size))

    def outline(self, elements: Indices) -> Indices:
        """Nodes of some elements that are not amid four of them, ascending, (n,)."""
        count = np.bincount(self.element_nodes[elements].ravel())
        return np.flatnonzero((count > 0) & (count < 4))

    def volumes(self, elements: Indices) -> Array:
        """Volume that belongs to each node, of some elements, shape (n_nodes,), m^3."""
        corners = self.element_nodes[elements].ravel()
        count = np.bincount(corners, minlength=self.grid.size)
        return np.asarray(0.25 * self.width * self.height * count)

    def strains(self, elements: Indices) -> sparse.csr_array:
        """Matrix from nodal displacements to strains at the centres of some elements.

        Strains xx, yy, 2 xy of each element in turn, shape (3 n_elements, 2 n_nodes),
        1/m. Incompatible modes have none there.
        """
        own = strain_matrix(0.0, 0.0, self.width, self.height)
        dofs = dofs_of(self.element_nodes[elements])
        rows = np.arange(3 * len(elements)).reshape(-1, 3, 1)
        blocks = np.broadcast_to(own, (len(dofs), *own.shape))
        shape = 3 * len(elements), 2 * self.grid.size
        return assembled(blocks, rows, dofs[:, None], shape)
