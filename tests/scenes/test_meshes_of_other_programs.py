"""Names in meshes of programs other than Gmsh are bodies, contacts and sides."""

import pytest

from solver.discrete.plane.makers.named_mesh_refused import check_named
from solver.files.meshes import text_of_mesh
from solver.scenes import CATALOGUE
from solver.scenes.mesh_files import as_text, read_mesh
from solver.scenes.named_sides import deeds_of, taken_apart
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


def test_an_unknown_kind_of_element_is_told_by_its_name() -> None:
    data = ABAQUS.replace("CPS4", "CPE4").encode()
    with pytest.raises(SettingError, match="not available: CPE4"):
        text_of_mesh(data, "squares.inp")


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
    deeds = deeds_of(list(mesh.lines), "")
    assert deeds["bottom_held"] == ("held",)
    assert deeds["lid_moved_x"] == ("moved x",)
    assert taken_apart("bottom_held")[0] == "bottom"
    # A word within another is none.
    assert taken_apart("withheld") == ("withheld", ())
    settings = MESH.checked({"mesh": as_text(mesh)})
    assert "bottom held and lid moved x" in settings.sentence()


@pytest.mark.parametrize(
    "line", ["*INCLUDE, INPUT=/etc/passwd", "* Include,input=other.inp", "*ELEMENT"]
)
def test_a_file_of_abaqus_that_is_not_whole_is_refused(line: str) -> None:
    with pytest.raises(SettingError, match=r"squares\.inp"):
        text_of_mesh(f"{ABAQUS}{line}\n".encode(), "squares.inp")
