"""Lines of beams as shapes of bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from solver.arrays import Array, Indices
from solver.checks import POSITIVE, Numbers, check
from solver.discrete.plane.meshes import on_nodes

HALVES = np.array([0.5, 0.5])
"""Shares of a uniform force on a beam, at its ends."""


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
    def lengths(self) -> Array:
        """Length of every beam, shape (n_nodes - 1,), m."""
        return np.asarray(np.linalg.norm(np.diff(self.nodes, axis=0), axis=1))

    @cached_property
    def centres(self) -> Array:
        """Middle of every beam, shape (n_nodes - 1, 2), m."""
        return 0.5 * (self.nodes[:-1] + self.nodes[1:])

    @property
    def size(self) -> float:
        """Length of the line, m."""
        return float(self.lengths.sum())

    @property
    def volume(self) -> float:
        """Volume, m^3."""
        return self.area * self.size

    def along(self, corners: Sequence[int] | Indices) -> Indices:
        """Chain of nodes, (n,), which is the nodes themselves."""
        return np.asarray(corners, dtype=np.intp)

    def edges_of(self, chain: Indices) -> Indices | None:
        """Numbers of the beams of a chain, (n_edges,); None if it is no chain."""
        if len(chain) < 2 or np.any(np.abs(np.diff(chain)) != 1):
            return None
        return np.minimum(chain[:-1], chain[1:])

    def elements_at(self, edges: Indices) -> Indices:
        """Beam at each edge, (n,), which is the edge itself."""
        return edges

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

    @cached_property
    def flaw(self) -> str:
        """Flaw of the line in words, or ""."""
        if len(self.nodes) < 2:
            return "a line of one node"
        if not self.lengths.all():
            return f"beam {int(self.lengths.argmin())} of no length"
        return ""
