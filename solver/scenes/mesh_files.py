"""Meshes with names in files, which meshio reads, and as texts in settings.

A text has all of a mesh that the scene needs, so that saved settings, links and other
processes need no file.
"""

from __future__ import annotations

import base64
import binascii
import contextlib
import io
import struct
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.plane.makers.named_mesh import NamedMesh
from solver.refusal import RefusedError, Words
from solver.scenes.abaqus import NUMBER, for_meshio

SURFACES = {
    "triangle": 3,
    "triangle6": 3,
    "triangle7": 3,
    "quad": 4,
    "quad8": 4,
    "quad9": 4,
}
"""Corners of elements of meshio, which come before its other nodes."""
LINES = {
    "line": 2,
    "line3": 2,
}
"""Ends of edges of meshio, which come before its other nodes."""
PASSED_OVER = {"vertex"}
"""Cells of meshio that say nothing on a mesh in the plane."""
FLAT = 1e-9
"""Largest distance of points from a plane, over the size of the mesh."""
GMSH = ".msh"
ABAQUS = ".inp"
"""Ends of the names of files of Gmsh, and of Abaqus and CalculiX."""
HEAD = "mesh:"
"""Beginning of the text of a mesh."""
SURFACE = "surface "
LINE = "line "
POINTS = "points"
"""Names of arrays in the text of a mesh."""
LARGEST = 20_000_000
"""Largest number of bytes of the arrays in a text."""
CAN = "a mesh in the plane whose bodies, contacts and sides have names"
ERRORS = (
    AssertionError,
    AttributeError,
    EOFError,
    IndexError,
    KeyError,
    MemoryError,
    OSError,
    RuntimeError,
    StopIteration,
    TypeError,
    UnicodeError,
    ValueError,
    struct.error,
    SystemExit,
)
"""What meshio raises where a file is not as it expects."""


def read_mesh(data: bytes, source: str) -> NamedMesh:
    """Read a mesh from a file of a format that meshio knows by the suffix.

    Raises
    ------
    RefusedError
        For a file that meshio does not read, and a mesh that is no `NamedMesh`.
    """
    # Only runs that read a file pay for the import.
    import meshio

    end = Path(source).suffix.lower()
    if end == ABAQUS:
        data = for_meshio(data)
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"mesh{end}"
        # It prints what it does not like, and then ends the program.
        said = io.StringIO()
        try:
            file.write_bytes(data)
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                if end == GMSH:
                    mesh = meshio.gmsh.read(file)
                else:
                    mesh = meshio.read(file)
            return named(mesh)
        except RefusedError:
            raise
        except ImportError as problem:
            # Files of Salome, Exodus and others are read by packages that few have.
            remedy = (
                f"install what reads such files (pip install {problem.name}), or save "
                "it again as Gmsh's .msh, format 4.1"
            )
            raise RefusedError("mesh", source, CAN, remedy) from None
        except (meshio.ReadError, *ERRORS) as problem:
            found = str(problem)
            if isinstance(problem, SystemExit):
                found = said.getvalue()
            reason = " ".join(found.replace(str(file), source).split())
            remedy = f"save it again as Gmsh's .msh, format 4.1 ({reason or 'unread'})"
            raise RefusedError("mesh", source, CAN, remedy) from None


def read_example(name: str) -> NamedMesh:
    """Read a mesh that comes with the scene, by its name."""
    path = Path(__file__).parent / "meshes" / f"{name}{GMSH}"
    return read_mesh(path.read_bytes(), path.name)


def named(mesh: Any) -> NamedMesh:
    """Named mesh from a mesh of meshio.

    Of quadratic elements the corners are taken. Quadrilaterals of a body that has
    triangles, too, become two of these.

    Raises
    ------
    RefusedError
        For elements of unknown kinds, and elements without a name.
    """
    surfaces = dict[str, list[Indices]]()
    lines = dict[str, list[Indices]]()
    for kind, name, cells in _named_cells(mesh):
        if kind in PASSED_OVER:
            continue
        if kind in LINES and name:
            lines.setdefault(name, []).append(cells[:, : LINES[kind]])
        elif kind in SURFACES and name:
            surfaces.setdefault(name, []).append(cells[:, : SURFACES[kind]])
        elif kind in SURFACES:
            raise RefusedError(
                "mesh",
                Words(f"with {len(cells)} elements without a name"),
                "elements with the name of their body",
                "make a physical group of the surface of each body, with a name",
            )
        elif kind not in LINES:
            raise RefusedError(
                "mesh",
                Words(f"with elements of the kind {kind}"),
                "triangles, quadrilaterals, and edges with names",
                "save the surfaces of a mesh in the plane alone",
            )
    bodies = {name: _of_one_kind(parts) for name, parts in surfaces.items()}
    point_sets = dict(mesh.point_sets)
    for name, (points,) in _groups(mesh, "point_tags", mesh.point_data).items():
        point_sets[name] = points
    for name, edges in _along_named_points(point_sets, bodies):
        lines.setdefault(name, []).append(edges)
    return NamedMesh(
        points=_in_plane(mesh.points),
        surfaces=bodies,
        lines={name: np.concatenate(parts) for name, parts in lines.items()},
    )


def _along_named_points(
    sets: Mapping[str, Indices], bodies: Mapping[str, Indices]
) -> Iterator[tuple[str, Indices]]:
    """Yield names of sets of points, and the outer edges, (n, 2), of bodies in them.

    Programs such as Abaqus name the nodes of a side. A set of all points of a body says
    nothing on its sides.

    Parameters
    ----------
    sets
        Indices of the points of each set, (n,).
    bodies
        Corners of the elements of each body, (n, 3) or (n, 4).
    """
    outer = list[Indices]()
    for elements in bodies.values():
        ends = np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1)
        edges, uses = np.unique(
            np.sort(ends.reshape(-1, 2), axis=1), axis=0, return_counts=True
        )
        outer.append(edges[uses == 1])
    for name, points in sets.items():
        if any(np.isin(elements, points).all() for elements in bodies.values()):
            continue
        found = [edges[np.isin(edges, points).all(axis=1)] for edges in outer]
        if any(map(len, found)):
            yield name, np.concatenate(found)


def _named_cells(mesh: Any) -> Iterator[tuple[str, str, Indices]]:
    """Yield kind, name and points, (n, corners and others), of cells; "" is no name."""
    tags = mesh.cell_data.get("gmsh:physical")
    titles = {
        (int(dimension), int(tag)): name
        for name, (tag, dimension) in mesh.field_data.items()
    }
    sets = _sets_by_size(mesh)
    for number, block in enumerate(mesh.cells):
        points = np.asarray(block.data, dtype=np.intp)
        if tags is not None:
            for tag in np.unique(tags[number]).tolist():
                name = titles.get((block.dim, int(tag)), "")
                yield block.type, name, points[tags[number] == tag]
            continue
        is_free = np.ones(len(points), dtype=bool)
        for name, cells in sets.items():
            found = cells[number]
            if block.type in SURFACES:
                found = found[is_free[found]]
            is_free[found] = False
            if len(found):
                yield block.type, name, points[found]
        if is_free.any():
            yield block.type, "", points[is_free]


def _sets_by_size(mesh: Any) -> dict[str, list[Indices]]:
    """Indices of the cells in each set for each block, (n,); the largest set first.

    An element in several sets is of the body of the first. Sets of all elements come
    last, as they do not distinguish bodies, and those without a name of their own not
    at all: meshio has a colon in these.
    """
    sets = dict[str, list[Indices]]()
    every_set = dict(mesh.cell_sets) | _groups(mesh, "cell_tags", mesh.cell_data)
    for title, cells in every_set.items():
        name = title.partition(NUMBER)[0]
        if not name or ":" in name:
            continue
        of_blocks = sets.setdefault(name, [np.array([], dtype=int)] * len(mesh.cells))
        for number, found in enumerate(cells):
            if found is not None:
                of_blocks[number] = np.union1d(of_blocks[number], found)
    surfaces = [n for n, block in enumerate(mesh.cells) if block.type in SURFACES]
    every = sum(len(mesh.cells[n].data) for n in surfaces)

    def rank(name: str) -> tuple[bool, int]:
        size = sum(len(sets[name][n]) for n in surfaces)
        return size == every, -size

    return {name: sets[name] for name in sorted(sets, key=rank)}


def _groups(mesh: Any, families: str, data: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of the points, or of the cells, in each group of a MED file.

    Salome and code_aster write such files: every point or cell is of a family, by its
    number, which is of several groups. `families` is the attribute of meshio's meshes
    that tells the groups of each family, and the name of their numbers in `data`.
    A group has an array of each block of cells, (n,), or one of points.
    """
    groups_of: Mapping[int, list[str]] = getattr(mesh, families, {})
    numbers = data.get(families)
    if numbers is None:
        return {}
    if families == "point_tags":
        numbers = [numbers]
    families_of = dict[str, list[int]]()
    for family, names in groups_of.items():
        for name in names:
            families_of.setdefault(name, []).append(family)
    found = dict[str, Any]()
    for name, own in families_of.items():
        found[name] = [np.flatnonzero(np.isin(each, own)) for each in numbers]
    return found


def _in_plane(points: Array) -> Array:
    """Coordinates along x and y of points, (n_points, 2)."""
    if points.shape[1] > 2:
        thickness = float(np.ptp(points[:, 2]))
        if thickness > FLAT * float(np.ptp(points, axis=0).max()):
            raise RefusedError(
                "mesh",
                Words(f"that reaches {thickness:.4g} along z"),
                "a mesh in the plane of x and y",
                "save a section of it, turned into that plane",
            )
    return np.asarray(points[:, :2], dtype=float)


def _of_one_kind(parts: list[Indices]) -> Indices:
    """Elements of a body, (n, 3) or (n, 4), joined from those of each kind."""
    if len({elements.shape[1] for elements in parts}) > 1:
        halves = [elements[:, [0, 2, 3]] for elements in parts if elements.shape[1] > 3]
        parts = [elements[:, :3] for elements in parts] + halves
    return np.concatenate(parts)


def as_text(mesh: NamedMesh) -> str:
    """Text of a mesh, which `from_text` reads.

    Raises
    ------
    RefusedError
        For a named line that is on no body.
    """
    used = np.unique(
        np.concatenate([cells.ravel() for cells in mesh.surfaces.values()])
    )
    kind = np.min_scalar_type(len(used))
    arrays = {POINTS: mesh.points[used]}
    for head, named_cells in ((SURFACE, mesh.surfaces), (LINE, mesh.lines)):
        for name, cells in named_cells.items():
            if not np.isin(cells, used).all():
                raise RefusedError(
                    f"line {name!r}",
                    Words("off the bodies"),
                    "edges between two bodies, or on the outside of one",
                    "leave out its name, or name the elements beside it, too",
                )
            arrays[head + name] = np.searchsorted(used, cells).astype(kind)
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    return HEAD + base64.b64encode(file.getvalue()).decode("ascii")


def from_text(text: str) -> NamedMesh:
    """Read a mesh from a text of `as_text`.

    Raises
    ------
    RefusedError
        For a text that `as_text` did not make.
    """
    try:
        data = base64.b64decode(text.removeprefix(HEAD), validate=True)
        found = _arrays_in(data)
        points = found.pop(POINTS)
    except (binascii.Error, zipfile.BadZipFile, ValueError, KeyError) as problem:
        raise RefusedError(
            "mesh", text[:20], CAN, f"give the file again ({problem})"
        ) from None
    surfaces = {}
    lines = {}
    for key, cells in found.items():
        if key.startswith(SURFACE):
            surfaces[key.removeprefix(SURFACE)] = cells.astype(np.intp)
        else:
            lines[key.removeprefix(LINE)] = cells.astype(np.intp)
    return NamedMesh(points, surfaces, lines)


def _arrays_in(data: bytes) -> dict[str, Array]:
    """Arrays of any shape by name in a file of NumPy; refuse too large a file."""
    with zipfile.ZipFile(io.BytesIO(data)) as content:
        size = sum(entry.file_size for entry in content.infolist())
    if size > LARGEST:
        raise ValueError("it is too large")
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        return dict(arrays)
