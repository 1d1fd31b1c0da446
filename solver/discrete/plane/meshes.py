"""Meshes of triangles or quadrilaterals as shapes of bodies.

A shape has axes of its own. A chain is a sequence of nodes along edges, with the middle
of each edge of a mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array, Indices, linked
from solver.cache import content_of
from solver.checks import Numbers, check
from solver.refusal import RefusedError, Words

if TYPE_CHECKING:
    import skfem

SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0
"""Shares of a uniform force on an edge, at its ends and its middle between them."""
HALVES = np.array([0.5, 0.5])
"""The same on an edge whose displacement is linear."""
FLAT = 1e-9
"""Smallest area of an element at any of its corners, over that of a square about it."""


FOUND = 9
"""Memory of all that is found from a mesh once it is used, over that of its corners and
elements (measured)."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh of triangles or quadrilaterals, in which displacement is quadratic.

    Attributes
    ----------
    corners
        Coordinates in the axes of the shape, (n_corners, 2), m.
    elements
        Corners of every element, counter-clockwise, (n_elements, 3) or (n_elements, 4).

    Raises
    ------
    RefusedError
        For fields of another shape, and corners that do not exist.
    """

    corners: Array
    elements: Indices

    def __post_init__(self) -> None:
        last = len(self.corners) - 1
        check(
            self,
            corners=Numbers(((None, 2),)),
            elements=Numbers(((None, 3), (None, 4)), low=0, high=last, whole=True),
        )

    @property
    def nbytes(self) -> int:
        """Memory of the mesh, with what is found from it, B."""
        return (1 + FOUND) * (self.corners.nbytes + self.elements.nbytes)

    @cached_property
    def content(self) -> bytes:
        """Digest of corners and elements."""
        return content_of(self.corners, self.elements)

    @cached_property
    def grid(self) -> skfem.Mesh:
        """The mesh of scikit-fem."""
        # Structures without meshes do not pay for the import.
        import skfem

        kind = skfem.MeshTri
        if self.elements.shape[1] == 4:
            kind = skfem.MeshQuad
        columns = np.ascontiguousarray(self.corners.T), self.elements.T.copy()
        return kind(*columns, sort_t=False)

    @cached_property
    def nodes(self) -> Array:
        """Corners, middles of edges, and of quadrilaterals, shape (n_nodes, 2), m.

        Degrees of freedom of scikit-fem are x and y of each in this order.
        """
        middles = [self.corners, self.corners[self.grid.facets].mean(axis=0)]
        if self.elements.shape[1] == 4:
            middles.append(self.centres)
        return np.concatenate(middles)

    @cached_property
    def centres(self) -> Array:
        """Mean of the corners of every element, shape (n_elements, 2), m."""
        return np.asarray(self.corners[self.elements].mean(axis=1))

    @cached_property
    def areas(self) -> Array:
        """Area of every element, shape (n_elements,), m^2."""
        x, y = np.moveaxis(self.corners[self.elements], -1, 0)
        # The shoelace formula.
        twice = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
        return np.asarray(0.5 * twice.sum(axis=1))

    @cached_property
    def size(self) -> float:
        """Side of a square of the same area, m."""
        return float(np.sqrt(self.areas.sum()))

    @cached_property
    def volume(self) -> float:
        """Volume for a metre of thickness, m^3."""
        return float(self.areas.sum())

    @cached_property
    def _edge_keys(self) -> tuple[Array, Indices]:
        """Sorted keys of the edges by their corners, and their indices, (n_edges,)."""
        low, high = np.sort(self.grid.facets, axis=0)
        keys = low * len(self.corners) + high
        order = np.argsort(keys)
        return keys[order], order

    def _edges_between(self, corners: Indices) -> Indices | None:
        """Indices of the edges between corners in turn, (n - 1,); None without one."""
        low, high = np.sort([corners[:-1], corners[1:]], axis=0)
        keys, numbers = self._edge_keys
        wanted = low * len(self.corners) + high
        places = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        if not np.array_equal(keys[places], wanted):
            return None
        return np.asarray(numbers[places], dtype=np.intp)

    def along(self, corners: Sequence[int] | Indices) -> Indices:
        """Chain of nodes along neighbouring corners, (n,), with middles of edges.

        Raises
        ------
        RefusedError
            If no edge runs from a corner to the next.
        """
        chain = np.asarray(corners, dtype=np.intp)
        edges = self._edges_between(chain)
        if edges is None:
            raise RefusedError(
                "Mesh.along",
                Words(f"of {len(chain)} corners"),
                "corners that follow each other along edges of elements",
                "give every corner on the way, in order",
            )
        nodes = np.empty(2 * len(chain) - 1, dtype=np.intp)
        nodes[::2] = chain
        nodes[1::2] = len(self.corners) + edges
        return nodes

    def edges_of(self, chain: Indices) -> Indices | None:
        """Indices of the edges of a chain, (n_edges,); None if it is no chain."""
        if len(chain) < 3 or len(chain) % 2 == 0 or chain[::2].max() >= self.n_corners:
            return None
        edges = self._edges_between(chain[::2])
        if edges is None or np.any(chain[1::2] != self.n_corners + edges):
            return None
        return edges

    def chains_of(self, nodes: Indices) -> list[Indices]:
        """Chains of edges, (n,) each, along consecutive nodes.

        Both ends of a plate are two chains, say. Nodes make none, [], if some of them
        belong to no chain.
        """
        return chains_along(self.edges_of, nodes, 2)

    @property
    def n_corners(self) -> int:
        """Number of corners."""
        return len(self.corners)

    @cached_property
    def element_nodes(self) -> Indices:
        """Nodes of every element, shape (n_elements, 6) or (n_elements, 9)."""
        nodes = [self.elements, self.n_corners + self.grid.t2f.T]
        if self.elements.shape[1] == 4:
            last = len(self.nodes) - len(self.elements)
            nodes.append(last + np.arange(len(self.elements))[:, None])
        return np.concatenate(nodes, axis=1).astype(np.intp)

    @property
    def element_corners(self) -> Indices:
        """Corners of every element, the last of a triangle twice, (n_elements, 4)."""
        return self.elements[:, [0, 1, 2, -1]]

    def elements_at(self, edges: Indices) -> Indices:
        """Element at each edge, (n,); the first one at an inner edge."""
        return np.asarray(self.grid.f2t[0, edges], dtype=np.intp)

    def steps(self, chain: Indices) -> tuple[Indices, Array]:
        """Steps from node to node of a chain: elements, and lengths of their ends.

        Elements have the shape (n - 1,), lengths that belong to both ends of each step
        (n - 1, 2), m.
        """
        edges = self.edges_of(chain)
        assert edges is not None
        lengths = np.linalg.norm(np.diff(self.nodes[chain[::2]], axis=0), axis=1)
        # The middle has its 4/6 from both halves of an edge.
        halves = np.array([[1.0, 2.0], [2.0, 1.0]]) / 6.0
        shares = np.multiply.outer(lengths, halves).reshape(-1, 2)
        return np.repeat(self.elements_at(edges), 2), shares

    def seams(self, labels: Indices) -> tuple[Indices, Indices, Array]:
        """Edges between elements of different labels, (n_elements,).

        Labels on both sides of each, the smaller first, (n, 2); its nodes, (n, 3); and
        the length that belongs to each of these, (n, 3), m.
        """
        first, second = self.grid.f2t
        both = np.sort([labels[first], labels[second]], axis=0)
        edges = np.flatnonzero((second >= 0) & (both[0] != both[1]))
        ends = self.grid.facets[:, edges]
        nodes = np.stack([ends[0], self.n_corners + edges, ends[1]], axis=1)
        lengths = np.linalg.norm(np.subtract(*self.corners[ends]), axis=1)
        shares = np.multiply.outer(lengths, SIMPSON)
        return both[:, edges].T, nodes.astype(np.intp), shares

    def shares(self, chain: Indices) -> Array:
        """Length of a chain that belongs to each of its nodes, shape (n,), m."""
        lengths = np.linalg.norm(np.diff(self.nodes[chain[::2]], axis=0), axis=1)
        return on_nodes(lengths, SIMPSON)

    def outward(self, chain: Indices) -> Array:
        """Normals out of the elements along a chain, times `shares`, (n, 2), m."""
        edges = self.edges_of(chain)
        assert edges is not None
        centres = self.centres[self.elements_at(edges)]
        normals = normals_out(self.nodes[chain[::2]], centres)
        return on_nodes(normals, SIMPSON)

    @cached_property
    def flaw(self) -> str:
        """Flaw of the mesh in words, or ""."""
        ends = self.corners[self.elements]
        after = np.roll(ends, -1, axis=1) - ends
        before = ends - np.roll(ends, 1, axis=1)
        # At every corner the area between both edges, beside that of a square.
        areas = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
        squares = np.square(np.ptp(ends, axis=1)).sum(axis=1)
        least = areas.min(axis=1)
        is_bad = least <= FLAT * squares
        if is_bad.any():
            return f"element {int(is_bad.argmax())} of no or negative area"
        unused = np.setdiff1d(np.arange(self.n_corners), self.elements)
        if len(unused):
            return f"corner {int(unused[0])} that no element has"
        pieces = 1 + int(self.pieces(np.zeros(len(self.elements), dtype=np.intp)).max())
        if pieces > 1:
            return f"a mesh of {pieces} pieces"
        return ""

    @property
    def neighbours(self) -> Indices:
        """Elements on both sides of each inner edge, (2, n_edges)."""
        return np.asarray(self.grid.f2t[:, self.grid.f2t[1] >= 0], dtype=np.intp)

    def pieces(self, labels: Indices) -> Indices:
        """Index of the piece of every element, (n_elements,).

        Elements of a piece hang together by edges, and have one label, (n_elements,).
        """
        first, second = self.neighbours
        is_one = labels[first] == labels[second]
        _, pieces = linked(first[is_one], second[is_one], len(self.elements))
        return pieces


def chains_along(
    edges_of: Callable[[Indices], Indices | None], nodes: Indices, step: int
) -> list[Indices]:
    """Chains of edges, (n,) each, along consecutive nodes, (n_nodes,).

    `edges_of` tells the edges of a chain, or None; an edge takes `step` nodes further.
    [] if some nodes belong to no chain.
    """
    chains = []
    first = 0
    while first < len(nodes):
        last = first + step + 1
        while last < len(nodes) and edges_of(nodes[first : last + step]) is not None:
            last += step
        if edges_of(nodes[first:last]) is None:
            return []
        chains.append(nodes[first:last])
        first = last
    return chains


def normals_out(ends: Array, centres: Array) -> Array:
    """Normals out of elements, as long as their edges, (n_edges, 2), m.

    Edges run from point to point, (n_edges + 1, 2), m; `centres` are those of the
    elements beside them, (n_edges, 2), m.
    """
    along = np.diff(ends, axis=0)
    inward = centres - ends[:-1]
    is_left = along[:, 0] * inward[:, 1] - along[:, 1] * inward[:, 0] > 0.0
    right = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return np.where(is_left[:, None], right, -right)


def on_nodes(values: Array, shares: Array) -> Array:
    """Bring values of the edges of a chain onto its nodes.

    `values` have the shape (n_edges, ...) and `shares` are those of an edge's nodes,
    (2,) or (3,); the sums have the shape (n_nodes, ...).
    """
    step = len(shares) - 1
    sums = np.zeros((step * len(values) + 1, *values.shape[1:]))
    for place, share in enumerate(shares.tolist()):
        sums[place : place + step * len(values) : step] += share * values
    return sums
