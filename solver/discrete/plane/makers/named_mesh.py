"""A mesh with named parts, divided into bodies, contacts and sides.

Surfaces are bodies. Edges with a name lie between two bodies, which makes them a
contact, or on the outside of one, which makes them a side. Each body has nodes of its
own, also where it meets another one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy

from solver.arrays import Array, Indices, linked
from solver.checks import Numbers, check_value
from solver.discrete.plane.makers.chains import chains_of
from solver.discrete.plane.meshes import Mesh
from solver.refusal import RefusedError, Words

SAME = 1e-7
"""Largest distance of points of two bodies that are one, over the size of the mesh."""


class ContactLine(NamedTuple):
    """Line along which two bodies touch.

    Attributes
    ----------
    name
        Name of its edges, with a number where these make several lines.
    above, below
        Numbers of both bodies; the normals point from the one below into that above.
    nodes, nodes_below
        Chains of nodes of both, which lie opposite, (n,).
    normals
        Unit normals out of the body below, shape (n, 2).
    """

    name: str
    above: int
    below: int
    nodes: Indices
    nodes_below: Indices
    normals: Array


class OuterLine(NamedTuple):
    """Line on the outside of a body: name of its edges, index of the body, chain."""

    name: str
    body: int
    nodes: Indices


@dataclass(frozen=True, eq=False)
class NamedMesh:
    """Points, and elements and edges by name.

    Attributes
    ----------
    points
        Coordinates, shape (n_points, 2), m.
    surfaces
        Corners of the elements of each body, (n, 3) or (n, 4).
    lines
        Both ends of the edges of each contact and side, (n, 2).

    Raises
    ------
    RefusedError
        If there is no body. What bodies, contacts and sides must be to each other
        `check_named` tells.
    """

    points: Array
    surfaces: Mapping[str, Indices]
    lines: Mapping[str, Indices] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_value("points", self.points, Numbers(((None, 2),)))
        if not self.surfaces:
            raise RefusedError(
                "mesh",
                Words("without bodies"),
                "elements with the name of their body",
                "make a physical group of the surface of each body, with a name",
            )
        last = len(self.points) - 1
        for name, elements in self.surfaces.items():
            kind = Numbers(((None, 3), (None, 4)), low=0, high=last, whole=True)
            check_value(f"body {name!r}", elements, kind)
        for name, edges in self.lines.items():
            kind = Numbers(((None, 2),), low=0, high=last, whole=True)
            check_value(f"line {name!r}", edges, kind)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies."""
        return tuple(self.surfaces)

    @cached_property
    def size(self) -> float:
        """Longer side of a rectangle about the mesh, m."""
        return float(np.ptp(self.points, axis=0).max())

    @cached_property
    def shapes(self) -> list[Mesh]:
        """Shape of every body.

        Raises
        ------
        RefusedError
            For a body whose elements make no shape.
        """
        shapes = []
        for name, used in zip(self.names, self._used, strict=True):
            elements = np.searchsorted(used, self.surfaces[name])
            corners = self.points[used]
            mesh = Mesh(corners, elements)
            # Programs orient a surface as its outline was drawn.
            if mesh.areas.sum() < 0.0:
                mesh = Mesh(corners, elements[:, ::-1].copy())
            if mesh.flaw:
                raise RefusedError(
                    f"body {name!r}",
                    Words(mesh.flaw),
                    "one piece of elements with some area, none of which is inverted",
                    "mesh it again, or name each piece as a body of its own",
                )
            shapes.append(mesh)
        return shapes

    @cached_property
    def _used(self) -> list[Indices]:
        """Indices of the points of every body, ascending, (n_corners,) each."""
        return [np.unique(elements) for elements in self.surfaces.values()]

    @cached_property
    def vertices(self) -> Indices:
        """Index of the vertex at every point, (n_points,).

        Points of one body at the same position, as of a crack, stay apart.
        """
        count = len(self.points)
        owners = np.zeros((count, len(self.names)), dtype=bool)
        for body, used in enumerate(self._used):
            owners[used, body] = True
        tree = scipy.spatial.cKDTree(self.points)
        first, second = tree.query_pairs(SAME * self.size, output_type="ndarray").T
        apart = ~(owners[first] & owners[second]).any(axis=1)
        _, vertices = linked(first[apart], second[apart], count)
        return vertices

    @cached_property
    def edges(self) -> list[Array]:
        """Edges of every body as sorted vertices, (n_edges, 2) each."""
        edges = []
        for shape, used in zip(self.shapes, self._used, strict=True):
            ends = self.vertices[used][shape.grid.facets.T]
            edges.append(np.sort(ends, axis=1))
        return edges

    @cached_property
    def owners(self) -> dict[tuple[int, int], list[int]]:
        """Bodies that have an edge, by its vertices."""
        owners: dict[tuple[int, int], list[int]] = {}
        for body, edges in enumerate(self.edges):
            for low, high in edges.tolist():
                owners.setdefault((low, high), []).append(body)
        return owners

    @cached_property
    def groups(self) -> dict[tuple[str, tuple[int, ...]], Array]:
        """Named edges, (n, 2), by their name and their bodies.

        Where bodies meet an edge has the first of its names: a second contact there
        would rub once more.
        """
        groups: dict[tuple[str, tuple[int, ...]], list[tuple[int, int]]] = {}
        first_names: dict[tuple[int, int], str] = {}
        for name, ends in self.lines.items():
            for low, high in np.sort(self.vertices[ends], axis=1).tolist():
                bodies = tuple(self.owners.get((low, high), ()))
                is_first = first_names.setdefault((low, high), name) == name
                if is_first or len(bodies) < 2:
                    groups.setdefault((name, bodies), []).append((low, high))
        return {key: np.unique(edges, axis=0) for key, edges in groups.items()}

    def scaled(self, factor: float) -> NamedMesh:
        """Mesh with all coordinates times a factor."""
        if factor == 1.0:
            return self
        return NamedMesh(factor * self.points, self.surfaces, self.lines)

    @cached_property
    def contacts(self) -> list[ContactLine]:
        """Lines along which bodies touch."""
        found = list[ContactLine]()
        for (name, bodies), edges in self.groups.items():
            for body, other in combinations(bodies, 2):
                found += self._contacts_of(name, (body, other), edges)
        return _numbered(found)

    def _contacts_of(
        self, name: str, bodies: tuple[int, int], edges: Array
    ) -> Iterator[ContactLine]:
        """Contact lines of edges between two bodies."""
        for line in chains_of(edges, self._position_of):
            chains = [self._along(body, line.inner) for body in bodies]
            # Each vertex of a chain has two nodes up to the next one.
            whole = self._along(bodies[0], line.vertices)
            skipped = 2 * line.overlap
            outward = self.shapes[bodies[0]].outward(whole)
            outward = outward[skipped : len(whole) - skipped]
            # The normal points upwards, of an upright line to the right.
            mean = outward.sum(axis=0)
            is_below = mean[1] > 0.0
            if abs(mean[1]) <= 1e-6 * abs(mean[0]):
                is_below = mean[0] > 0.0
            normals = outward / np.linalg.norm(outward, axis=1, keepdims=True)
            sides = list(zip(bodies, chains, strict=True))
            if is_below:
                sides.reverse()
            else:
                normals = -normals
            (above, nodes), (below, nodes_below) = sides
            yield ContactLine(name, above, below, nodes, nodes_below, normals)

    @cached_property
    def sides(self) -> list[OuterLine]:
        """Lines on the outside of bodies."""
        found = []
        for (name, bodies), edges in self.groups.items():
            if len(bodies) == 1:
                for line in chains_of(edges, self._position_of):
                    chain = self._along(bodies[0], line.inner)
                    found.append(OuterLine(name, bodies[0], chain))
        return found

    @cached_property
    def _position_of(self) -> Array:
        """Coordinates of every vertex, shape (n_vertices, 2), m."""
        positions = np.empty((self.vertices.max() + 1, 2))
        positions[self.vertices] = self.points
        return positions

    def _along(self, body: int, vertices: Sequence[int]) -> Indices:
        """Chain of nodes of a body along vertices in order."""
        own = self.vertices[self._used[body]]
        order = np.argsort(own)
        corners = order[np.searchsorted(own, vertices, sorter=order)]
        return self.shapes[body].along(corners)


def _numbered(lines: Sequence[ContactLine]) -> list[ContactLine]:
    """Contact lines, with numbers appended to a name that several have."""
    names = [line.name for line in lines]
    numbered = []
    for index, line in enumerate(lines):
        name = line.name
        if names.count(name) > 1:
            name = f"{name} {names[: index + 1].count(name)}"
        numbered.append(line._replace(name=name))
    return numbered
