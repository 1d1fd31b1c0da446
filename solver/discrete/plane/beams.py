"""Lines of beams as shapes of bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.cache import content_of
from solver.checks import POSITIVE, Numbers, check
from solver.discrete.elements import assembled
from solver.discrete.plane.meshes import HALVES, on_nodes

ALONG = np.array([0, 3])
ACROSS = np.array([1, 2, 4, 5])
"""Degrees of freedom of a beam along its axis, and across and turning."""
STRETCH = np.array([[1.0, -1.0], [-1.0, 1.0]])
BENDING = np.array(
    [
        [12.0, 6.0, -12.0, 6.0],
        [6.0, 4.0, -6.0, 2.0],
        [-12.0, -6.0, 12.0, -6.0],
        [6.0, 2.0, -6.0, 4.0],
    ]
)
"""Stiffness of a beam of length 1 along its axis, over E A, and across, over E I."""


@dataclass(frozen=True, eq=False)
class Beam:
    """A line of Bernoulli's beams: stretched, and bent in the plane.

    Attributes
    ----------
    nodes
        Coordinates in the axes of the shape, (n_nodes, 2), m.
    area, second_moment
        Area, m^2, and second moment of area, m^4, of the cross-section.

    Raises
    ------
    RefusedError
        For fields of another shape, and values that are not above zero.
    """

    nodes: Array
    area: float
    second_moment: float

    def __post_init__(self) -> None:
        check(
            self,
            nodes=Numbers(((None, 2),)),
            area=POSITIVE,
            second_moment=POSITIVE,
        )

    @cached_property
    def content(self) -> bytes:
        """Digest of nodes and cross-section."""
        return content_of(self.nodes, np.array([self.area, self.second_moment]))

    @cached_property
    def lengths(self) -> Array:
        """Length of every beam, shape (n_nodes - 1,), m."""
        return np.asarray(np.linalg.norm(np.diff(self.nodes, axis=0), axis=1))

    @cached_property
    def centres(self) -> Array:
        """Middle of every beam, shape (n_nodes - 1, 2), m."""
        return 0.5 * (self.nodes[:-1] + self.nodes[1:])

    @cached_property
    def laid_out(self) -> Array:
        """Middle of every beam if the line were straight, (n_nodes - 1, 2), m."""
        along = np.cumsum(self.lengths) - 0.5 * self.lengths
        return np.stack([along, np.zeros_like(along)], axis=1)

    @property
    def size(self) -> float:
        """Length of the line, m."""
        return float(self.lengths.sum())

    @property
    def volume(self) -> float:
        """Volume, m^3."""
        return self.area * self.size

    def along(self, corners: Sequence[int] | Indices) -> Indices:
        """Chain of nodes, (n,): the corners of a line are its nodes."""
        return np.asarray(corners, dtype=np.intp)

    def edges_of(self, chain: Indices) -> Indices | None:
        """Indices of the beams of a chain, (n_edges,); None if it is no chain."""
        if len(chain) < 2 or np.any(np.abs(np.diff(chain)) != 1):
            return None
        return np.minimum(chain[:-1], chain[1:])

    @cached_property
    def element_nodes(self) -> Indices:
        """Nodes of every beam, shape (n_nodes - 1, 2)."""
        first = np.arange(len(self.nodes) - 1)
        return np.stack([first, first + 1], axis=1)

    @property
    def element_corners(self) -> Indices:
        """Ends of every beam as corners a, b, b, a, shape (n_nodes - 1, 4)."""
        return self.element_nodes[:, [0, 1, 1, 0]]

    def steps(self, chain: Indices) -> tuple[Indices, Array]:
        """Steps from node to node of a chain: beams, and lengths of their ends.

        Beams have the shape (n - 1,), lengths that belong to both ends of each step
        (n - 1, 2), m.
        """
        beams = np.minimum(chain[:-1], chain[1:])
        return beams, np.multiply.outer(self.lengths[beams], HALVES)

    def seams(self, labels: Indices) -> tuple[Indices, Indices, Array]:
        """Nodes between beams of different labels, (n_nodes - 1,).

        Labels on both sides of each, the smaller first, (n, 2); the node, (n, 1); and
        the length of a beam there, (n, 1), m.
        """
        before = np.flatnonzero(labels[:-1] != labels[1:])
        both = np.sort([labels[before], labels[before + 1]], axis=0).T
        return both, before[:, None] + 1, self.lengths[before][:, None]

    def shares(self, chain: Indices) -> Array:
        """Length of a chain that belongs to each of its nodes, shape (n,), m."""
        lengths = np.linalg.norm(np.diff(self.nodes[chain], axis=0), axis=1)
        return on_nodes(lengths, HALVES)

    def outward(self, chain: Indices) -> Array:
        """Normals to the left of the line times `shares`, shape (n, 2), m."""
        edges = self.edges_of(chain)
        assert edges is not None
        along = np.diff(self.nodes, axis=0)[edges]
        return on_nodes(np.stack([-along[:, 1], along[:, 0]], axis=1), HALVES)

    def stiffness(self, young: float, elements: Indices) -> sparse.csr_array:
        """Stiffness of some beams, shape (3 n_nodes, 3 n_nodes), in N/m.

        Degrees of freedom are x, y and turn of every node (Przemieniecki, Theory of
        Matrix Structural Analysis, 1968, ch. 5).
        """
        length = self.lengths[elements][:, None, None]
        own = np.zeros((len(elements), 6, 6))
        own[:, ALONG[:, None], ALONG] = young * self.area / length * STRETCH
        # Turns times the length of the beam go with displacements across.
        levers = np.concatenate([np.ones_like(length), length], axis=1)
        levers = np.tile(levers, (1, 2, 1))
        bent = young * self.second_moment / length**3 * BENDING
        own[:, ACROSS[:, None], ACROSS] = levers * bent * levers.swapaxes(1, 2)
        turned = np.zeros_like(own)
        along = np.diff(self.nodes, axis=0)[elements] / length[:, 0]
        for first in (0, 3):
            turned[:, first, first : first + 2] = along
            turned[:, first + 1, first] = -along[:, 1]
            turned[:, first + 1, first + 1] = along[:, 0]
            turned[:, first + 2, first + 2] = 1.0
        blocks = turned.swapaxes(1, 2) @ own @ turned
        dofs = 3 * elements[:, None] + np.arange(6)
        size = 3 * len(self.nodes)
        return assembled(blocks, dofs[:, :, None], dofs[:, None], (size, size))

    def volumes(self, elements: Indices) -> Array:
        """Volume that belongs to each node, of some beams, shape (n_nodes,), m^3."""
        volumes = np.zeros(len(self.nodes))
        np.add.at(volumes, elements, 0.5 * self.area * self.lengths[elements])
        np.add.at(volumes, elements + 1, 0.5 * self.area * self.lengths[elements])
        return volumes

    def strains(self, elements: Indices) -> sparse.csr_array:
        """Matrix from nodal displacements to axial strains of some beams.

        Strains xx, yy, 2 xy of each beam in turn, shape (3 n_elements, 2 n_nodes), 1/m.
        """
        along = np.diff(self.nodes, axis=0)[elements]
        x, y = along.T
        squares = x**2 + y**2
        stretch = np.concatenate([-along, along], axis=1) / squares[:, None]
        turned = np.stack([x**2, y**2, 2.0 * x * y], axis=1) / squares[:, None]
        strains = turned[:, :, None] * stretch[:, None]
        rows = np.arange(3 * len(elements)).reshape(-1, 3, 1)
        columns = (2 * elements[:, None] + np.arange(4))[:, None]
        shape = 3 * len(elements), 2 * len(self.nodes)
        return assembled(strains, rows, columns, shape)

    @cached_property
    def flaw(self) -> str:
        """Flaw of the line in words, or ""."""
        if len(self.nodes) < 2:
            return "a line of one node"
        if not self.lengths.all():
            return f"beam {int(self.lengths.argmin())} of no length"
        return ""
