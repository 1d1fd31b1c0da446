"""Checks of a mesh with named parts."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.makers.named_mesh import SAME, NamedMesh
from solver.refusal import RefusedError, Words

CONTACT = "contact"
"""Beginning of the names of edges that must lie between two bodies."""


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
