"""Names in meshes of programs other than Gmsh are bodies, contacts and sides."""

import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

from solver.discrete.plane.makers.named_mesh_refused import check_named
from solver.files.meshes import text_of_mesh
from solver.scenes import CATALOGUE
from solver.scenes.mesh_files import as_text, named, read_mesh
from solver.scenes.named_sides import conditions_of, split_phrase
from solver.settings.values import SettingError
from tests.helpers.mesh_files import ABAQUS

MESH = CATALOGUE["mesh"]


def test_named_nodes_of_abaqus_are_sides_and_contacts() -> None:
    mesh = read_mesh(ABAQUS.encode(), "squares.inp")
    check_named(mesh)
    assert mesh.names == ("lower", "upper")
    contacts = [(contact.above, contact.below) for contact in mesh.contacts]
    assert contacts == [(1, 0)]
    assert [(side.name, side.body) for side in mesh.sides] == [
        ("bottom", 0),
        ("top", 1),
    ]


@pytest.mark.parametrize("kind", ["CPS4R", "CPE4", "CPE4R", "cpe4i"])
def test_elements_of_abaqus_are_of_either_plane_state(kind: str) -> None:
    mesh = read_mesh(ABAQUS.replace("CPS4", kind).encode(), "squares.inp")
    check_named(mesh)
    assert mesh.names == ("lower", "upper")


BLOCKS = """*NODE, NSET=of lower
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
9, 2, 0, 0
*ELEMENT, TYPE=T2D2
7, 1, 2
*ELEMENT, TYPE=CPE4R, ELSET=lower
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPE3, ELSET=lower
3, 2, 9, 3
*NODE
5, 0, 1, 0
6, 1, 1, 0
7, 1, 2, 0
8, 0, 2, 0
*ELEMENT, ELSET=upper,
TYPE=CPE4R
** a remark
2, 5, 6, 7, 8
*NSET, NSET=contact
5, 6
*NSET, NSET=bottom
1, 2, 9
"""
"""Bodies with nodes and elements in several blocks, of which some have no name."""


def test_blocks_of_abaqus_are_of_one_mesh() -> None:
    mesh = read_mesh(BLOCKS.encode(), "blocks.inp")
    check_named(mesh)
    assert {name: len(found) for name, found in mesh.surfaces.items()} == {
        "lower": 3,
        "upper": 1,
    }
    assert np.ptp(mesh.points, axis=0).tolist() == [2.0, 2.0]
    assert [contact.name for contact in mesh.contacts] == ["contact"]
    assert [side.name for side in mesh.sides] == ["bottom"]


PART = "*PART, NAME={0}\n" + ABAQUS + "*END PART\n*INSTANCE, NAME={0}-1, PART={0}\n{1}"


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (PART.format("A", "0, 1, 0\n*END INSTANCE"), "a part that is moved"),
        (PART.format("A", "*END INSTANCE\n") + "*PART, NAME=B\n", "several parts"),
        (ABAQUS.replace("CPS4", "CAX4"), "not available: CAX4"),
        ("433 810 3 1 0\n1 0 0 0\n2 1 0 0\n", "save it again as Gmsh's"),
    ],
)
def test_files_with_parts_and_of_other_programs_are_refused(
    data: str, why: str
) -> None:
    """Parts lie where their instances say, and other programs name files alike."""
    with pytest.raises(SettingError, match=why):
        text_of_mesh(data.encode(), "squares.inp")


OF_GMSH = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 1, 2, 0
6, 0, 2, 0
7, 2, 0, 0
8, 2, 1, 0
******* E L E M E N T S *************
*ELEMENT, type=T3D2, ELSET=Line1
1, 1, 2
*ELEMENT, type=T3D2, ELSET=Line2
2, 3, 4
*ELEMENT, type=T3D2, ELSET=Line3
3, 5, 6
*ELEMENT, type=CPS4, ELSET=Surface1
4, 1, 2, 3, 4
*ELEMENT, type=CPS4, ELSET=Surface2
5, 4, 3, 5, 6
*ELEMENT, type=CPS4, ELSET=Surface3
6, 2, 7, 8, 3
*ELSET,ELSET=bottom_held
1
*ELSET,ELSET=contact
2
*ELSET,ELSET=lid_moved_x
3
*ELSET,ELSET=lower
4, 6
*ELSET,ELSET=upper
5
*ELSET,ELSET=every
4, 5, 6
*ELSET,ELSET=sets
lower, upper
"""
"""Squares in the groups that Gmsh writes for Abaqus: beside its own, no blanks."""


def test_groups_of_gmsh_in_a_file_of_abaqus_are_bodies_and_sides() -> None:
    mesh = read_mesh(OF_GMSH.encode(), "squares.inp")
    check_named(mesh)
    assert mesh.names == ("lower", "upper")
    assert [len(mesh.surfaces[name]) for name in mesh.names] == [2, 1]
    conditions = conditions_of(list(mesh.lines), "")
    assert conditions["bottom_held"] == ("held",)
    assert conditions["lid_moved_x"] == ("moved x",)
    assert split_phrase("bottom_held")[0] == "bottom"
    # A word within another is none.
    assert split_phrase("withheld") == ("withheld", ())
    settings = MESH.checked({"mesh": as_text(mesh)})
    assert "“bottom” held and “lid” moved along x" in settings.sentence()


@pytest.mark.parametrize("line", ["*INCLUDE, INPUT=a", "*include,input=a", "*ELEMENT"])
def test_a_file_of_abaqus_that_is_not_whole_is_refused(line: str) -> None:
    with pytest.raises(SettingError, match=r"squares\.inp"):
        text_of_mesh(f"{ABAQUS}{line}\n".encode(), "squares.inp")


@pytest.mark.parametrize(
    "line", ["INCLUDE, INPUT={}", " *INCLUDE, INPUT={}", "*IN*CLUDE, INPUT={}"]
)
def test_no_other_file_is_read_for_one_of_abaqus(line: str, tmp_path: Path) -> None:
    other = tmp_path / "other.inp"
    other.write_text("*NODE\na secret\n")
    text = f"*HEADING\n{line.format(other)}\n{ABAQUS}"
    for data in (text, line.format(other)):
        try:
            found = text_of_mesh(data.encode(), "squares.inp")
        except SettingError as refused:
            found = str(refused)
        assert "secret" not in found


def test_groups_of_salome_are_bodies_contacts_and_sides() -> None:
    """Two squares as meshio reads them from a MED file: groups by families."""
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [1, 2], [0, 2]], dtype=float)
    squares = np.array([[0, 1, 2, 3], [3, 2, 4, 5]])
    edges = np.array([[3, 2], [0, 1], [4, 5]])
    tags = [np.array([-6, -7]), np.array([-8, -9, 0])]
    mesh = meshio.Mesh(
        points, [("quad", squares), ("line", edges)], cell_data={"cell_tags": tags}
    )
    mesh.point_data["point_tags"] = np.array([0, 0, 0, 0, 2, 2])
    mesh.cell_tags = {-6: ["lower", "all"], -7: ["upper", "all"], -8: ["contact"]}
    mesh.cell_tags[-9] = ["bottom"]
    mesh.point_tags = {2: ["top"]}
    found = named(mesh)
    check_named(found)
    assert found.names == ("lower", "upper")
    assert [(contact.above, contact.below) for contact in found.contacts] == [(1, 0)]
    sides = [(side.name, side.body) for side in found.sides]
    assert sorted(sides) == [("bottom", 0), ("top", 1)]


def test_a_file_that_takes_another_package_is_refused_with_its_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`run` ended with the error of the import, of MED, XDMF, CGNS and Exodus."""
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(SettingError, match="pip install h5py"):
        text_of_mesh(b"anything", "plate.med")
