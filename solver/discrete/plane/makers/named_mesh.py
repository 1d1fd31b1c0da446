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

CONTACT = "contact"
"""Beginning of the names of edges that must lie between two bodies."""
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


def check_named(mesh: NamedMesh) -> None:
    """Refuse edges that are neither contact nor side, and bodies glued or apart.

    Raises
    ------
    RefusedError
        For elements without area; for edges with a name that follow no element or run
        through a body; where bodies have common edges without a name, touch with nodes
        that do not match, or do not touch at all.
    """
    named: set[tuple[int, int]] = set()
    for (name, bodies), edges in mesh.groups.items():
        _check_line(mesh, name, bodies, edges)
        named.update(map(tuple, edges.tolist()))
    for edge, owners in mesh.owners.items():
        if len(owners) > 1 and edge not in named:
            names = " and ".join(repr(mesh.names[body]) for body in owners)
            raise RefusedError(
                f"bodies {names}",
                Words(f"with a common edge at {_at(mesh, np.array([edge]))}"),
                "edges with a name where bodies meet, which makes them a contact",
                "name the line between them, or give both the same name if they "
                "are one body",
            )
    for first, second in combinations(range(len(mesh.names)), 2):
        _check_overlap(mesh, first, second)
    if not mesh.contacts:
        names = ", ".join(mesh.names)
        raise RefusedError(
            "mesh",
            Words(f"without a contact, of: {names}"),
            "two bodies or more, and a line with a name where they touch",
            "give each body a name of its own, and name the line between them",
        )


def _check_line(
    mesh: NamedMesh, name: str, bodies: tuple[int, ...], edges: Array
) -> None:
    """Refuse edges of one name that are neither a contact nor a side."""
    allowed = "edges between two bodies, or on the outside of one"
    if not bodies:
        raise RefusedError(
            f"line {name!r}",
            Words(f"off the bodies at {_at(mesh, edges)}"),
            allowed,
            "leave out its name, or name the elements beside it, too",
        )
    if len(bodies) > 1:
        return
    # An edge inside a body lies between two of its elements.
    shape = mesh.shapes[bodies[0]]
    inner = mesh.edges[bodies[0]][shape.grid.f2t[1] >= 0]
    if set(map(tuple, inner.tolist())) & set(map(tuple, edges.tolist())):
        raise RefusedError(
            f"line {name!r}",
            Words(f"inside body {mesh.names[bodies[0]]!r}"),
            allowed,
            "leave out its name",
        )
    if name.lower().startswith(CONTACT):
        raise RefusedError(
            f"line {name!r}",
            Words(f"on body {mesh.names[bodies[0]]!r} alone, {_at(mesh, edges)}"),
            "a contact, along which two bodies have nodes at the same positions",
            "mesh both bodies alike there, or give another name to a side",
        )


def _check_overlap(mesh: NamedMesh, first: int, second: int) -> None:
    """Refuse outer edges of two bodies that coincide in part, without common nodes."""
    for one, other in ((first, second), (second, first)):
        starts, ends = _outer(mesh, other, ())
        from_ends = _outer(mesh, one, (one, other))
        if not len(from_ends[0]) or not len(starts):
            continue
        middles = 0.5 * (from_ends[0] + from_ends[1])
        along = ends - starts
        beyond = middles[:, None] - starts
        lengths = np.square(along).sum(axis=1)
        share = np.clip(np.einsum("mea,ea->me", beyond, along) / lengths, 0.0, 1.0)
        apart = np.linalg.norm(beyond - share[..., None] * along, axis=2).min(axis=1)
        if apart.min() <= SAME * mesh.size:
            x, y = middles[apart.argmin()]
            raise RefusedError(
                f"bodies {mesh.names[one]!r} and {mesh.names[other]!r}",
                Words(f"that touch at ({x:.4g}, {y:.4g})"),
                "bodies that have nodes at the same positions where they touch",
                "mesh both alike there",
            )


def _outer(mesh: NamedMesh, body: int, without: tuple[int, ...]) -> tuple[Array, Array]:
    """Ends of the outer edges of a body, (n, 2) each, m.

    Those that both bodies of `without` have are left out.
    """
    shape = mesh.shapes[body]
    is_outer = shape.grid.f2t[1] < 0
    if without:
        edges = mesh.edges[body].tolist()
        shared = [mesh.owners[low, high] == sorted(without) for low, high in edges]
        is_outer &= ~np.array(shared)
    first, last = shape.corners[shape.grid.facets[:, is_outer]]
    return first, last


def _at(mesh: NamedMesh, edges: Array) -> str:
    """Text of the middle of the first of some edges, (n, 2)."""
    first = [int((mesh.vertices == vertex).argmax()) for vertex in edges[0]]
    x, y = mesh.points[first].mean(axis=0)
    return f"({x:.4g}, {y:.4g})"
