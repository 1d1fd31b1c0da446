"""Results in the plane as a series of files that ParaView opens, by meshio.

FILE.pvd lists two files for each instant, in a folder FILE beside it: the bodies, with
displacement and stress, and lines along the contacts, with their fields. Contacts are
read again as a table: for that it also lists the names of the interfaces, which
ParaView passes over.
"""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.inside import Inside
from solver.files.disk import whole_file
from solver.latin import Iterate
from solver.settings.values import Refuse, SettingError

if TYPE_CHECKING:
    import meshio

PARAVIEW = ".pvd"
"""End of the names of these files."""
INTERFACES = "interfaces"
"""Attribute with the names of the interfaces, a list in JSON."""
CONTACTS = "contacts"
"""Beginning of the names of files with the lines along the contacts."""
HEAD = ["x [m]", "t [s]", "friction force [Pa]", "interface"]
"""Head of the table of the contacts."""
KINDS = {
    4: "quad",
    3: "triangle",
    2: "line",
}
"""Names of meshio of elements, by the number of their different corners."""


class _Cells(NamedTuple):
    """Cells of one kind: corners, (n, n_corners), and numbers of the elements, (n,)."""

    kind: str
    corners: Indices
    elements: Indices


def check_plane(inside: Inside | None, path: Path) -> Inside:
    """Return the interior of plane bodies; refuse structures of rods."""
    if inside is None:
        raise SettingError(
            "--out",
            str(path),
            "FILE.npz for rods, wires and ropes",
            f"{PARAVIEW} files are of scenes in the plane",
        )
    return inside


def write_series(path: Path, iterate: Iterate) -> None:
    """Write a series of files; last, completely, the file that lists them.

    Raises
    ------
    SettingError
        For a structure that is not in the plane.
    OSError
        If a file cannot be written.
    """
    inside = check_plane(iterate.problem.inside, path)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    names = list(iterate.problem.contacts)
    listed = ElementTree.SubElement(root, "Collection", {INTERFACES: json.dumps(names)})
    displacement = inside.displacement(iterate.displacement, slice(None))
    parts: dict[str, _Bodies | _Contacts] = {
        "bodies": _Bodies(inside, displacement),
        CONTACTS: _Contacts(iterate),
    }
    for instant, time in enumerate(iterate.problem.instants.tolist()):
        for number, (name, part) in enumerate(parts.items()):
            file = folder / f"{name}_{instant:04}.vtu"
            part.at(instant).write(file, file_format="vtu")
            ElementTree.SubElement(
                listed,
                "DataSet",
                timestep=repr(time),
                part=str(number),
                file=f"{folder.name}/{file.name}",
            )
    with whole_file(path, "wb") as whole:
        ElementTree.ElementTree(root).write(whole, "utf-8", xml_declaration=True)


def contacts_of_series(path: Path, refuse: Refuse, interface: str = "") -> str:
    """Friction along an interface of a series, as the text of a table.

    Its rows are those of all instants and all points, its columns those of `HEAD`.

    Parameters
    ----------
    path
        The file that lists the others, as `write_series` writes it.
    interface
        Name of the interface; of a name that the file has not, and by default, the
        first one.
    refuse
        Makes a refusal from a remedy.

    Raises
    ------
    SettingError
        For what is no such file, or where a file that it lists is none.
    """
    # Only comparisons with such files pay for the import.
    import meshio

    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(HEAD)
    try:
        (listed,) = ElementTree.parse(path).getroot()
        names = json.loads(listed.attrib[INTERFACES])
        number = 0
        if interface in names:
            number = names.index(interface)
        for each in listed:
            if not Path(each.attrib["file"]).name.startswith(CONTACTS):
                continue
            data = meshio.read(path.parent / each.attrib["file"]).point_data
            time = float(each.attrib["timestep"])
            is_on = data["interface"].ravel() == number + 1
            x = data["x"].ravel()[is_on].tolist()
            friction = data["friction"].ravel()[is_on].tolist()
            for place, traction in zip(x, friction, strict=True):
                rows.writerow([repr(place), repr(time), repr(traction), names[number]])
    # meshio ends the program where a file is of no kind that it knows.
    except (OSError, SystemExit, meshio.ReadError):
        raise refuse("a file that it lists cannot be read: give all of them") from None
    except (
        AttributeError,
        IndexError,
        KeyError,
        TypeError,
        ValueError,
        ElementTree.ParseError,
    ):
        raise refuse("give a series that `run --out FILE.pvd` wrote") from None
    return text.getvalue()


class _Bodies:
    """Bodies at any instant: displacement of nodes, stress in elements."""

    def __init__(self, inside: Inside, displacement: Array) -> None:
        self._inside = inside
        self._displacement = displacement
        # Nodes in the middle of edges have no corner.
        self._used = np.unique(inside.elements)
        self._cells = _cells_of(np.searchsorted(self._used, inside.elements))

    def at(self, instant: int) -> meshio.Mesh:
        """Mesh with its fields at an instant."""
        moved = self._displacement[:, :, instant]
        fields = {
            "stress": self._inside.stress(moved),
            "body": self._inside.bodies + 1,
        }
        of_cells = {
            name: [field[cells.elements] for cells in self._cells]
            for name, field in fields.items()
        }
        return _mesh(
            self._inside.nodes[self._used],
            [(cells.kind, cells.corners) for cells in self._cells],
            {"displacement": _in_space(moved[self._used])},
            of_cells,
        )


class _Contacts:
    """Lines along the contacts at any instant, with fields at their points.

    A contact of one point, as a spring, is that point.
    """

    def __init__(self, iterate: Iterate) -> None:
        problem = iterate.problem
        contacts = problem.contacts
        positions = []
        along = []
        areas = []
        for law in contacts.laws.values():
            of_pairs = problem.positions[problem.row_dofs[law.tangent.above]]
            positions.append(law.mean_by_point(of_pairs))
            along.append(law.positions[:, None])
            areas.append(law.by_point(law.weights))
        self._points = contacts.of_points(positions)
        self._places = contacts.of_points(along)[:, 0]
        self._areas = contacts.of_points([area[:, None] for area in areas])[:, 0]
        self._fields = [iterate.contact(name) for name in contacts]
        self._opens = problem.opens
        self._interfaces = np.repeat(np.arange(len(contacts)) + 1, contacts.sizes)
        joined = np.flatnonzero(np.diff(self._interfaces) == 0)
        alone = np.setdiff1d(np.arange(contacts.n_points), [joined, joined + 1])
        cells = {
            "line": np.stack([joined, joined + 1], axis=1),
            "vertex": alone[:, None],
        }
        # No program reads cells of a kind without any.
        self._cells = [
            (kind, corners) for kind, corners in cells.items() if len(corners)
        ]

    def at(self, instant: int) -> meshio.Mesh:
        """Mesh of lines with their fields at an instant."""
        tangential = self._along("tangential_force", instant)
        fields = {
            "friction_force": tangential,
            "friction": tangential / self._areas,
            "slip": self._along("slip", instant),
            "status": self._along("status", instant),
            "interface": self._interfaces,
            "x": self._places,
        }
        # Where the pressure is known beforehand it is no unknown of the run.
        if self._opens:
            normal = self._along("normal_force", instant)
            fields["normal_force"] = normal
            fields["pressure"] = normal / self._areas
            fields["gap"] = self._along("opening", instant)
        return _mesh(self._points, self._cells, fields, {})

    def _along(self, name: str, instant: int) -> Array:
        """Field of all points at an instant, (n_points,)."""
        parts = [getattr(fields, name)[:, instant] for fields in self._fields]
        return np.concatenate([np.zeros(0), *parts])


def _cells_of(elements: Indices) -> list[_Cells]:
    """Cells of each kind, from elements (n, 4), some with a repeated corner."""
    is_new = np.ones(elements.shape, dtype=bool)
    is_new[:, 1:] = elements[:, 1:] != elements[:, :-1]
    counts = is_new.sum(axis=1)
    cells = []
    for count, kind in KINDS.items():
        numbers = np.flatnonzero(counts == count)
        corners = elements[numbers][is_new[numbers]].reshape(-1, count)
        if len(numbers):
            cells.append(_Cells(kind, corners, numbers))
    return cells


def _mesh(
    points: Array,
    cells: list[tuple[str, Indices]],
    of_points: dict[str, Array],
    of_cells: dict[str, Any],
) -> meshio.Mesh:
    """Mesh of meshio in the plane z = 0."""
    # Only runs that write such files pay for the import.
    import meshio

    return meshio.Mesh(
        _in_space(points), cells, point_data=of_points, cell_data=of_cells
    )


def _in_space(vectors: Array) -> Array:
    """Vectors in the plane, (n, 2), with z = 0: (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 1)))
