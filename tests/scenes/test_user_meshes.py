"""Meshes whose parts have names become bodies, contacts and sides."""

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from runs import errors

from solver.arrays import Array
from solver.discrete.plane.makers.named_mesh import NamedMesh
from solver.discrete.plane.makers.named_mesh_refused import check_named
from solver.files.meshes import text_of_mesh
from solver.files.saved import settings_from_command
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.mesh_files import as_text, from_text, named, read_example
from solver.scenes.named_sides import conditions_of
from solver.settings.values import SettingError
from solver.study.quantities import QUANTITIES
from solver.study.scene_run import finished_run

MESH = CATALOGUE["mesh"]
FIELDS = {
    "lower": [1, 2],
    "upper": [2, 2],
    "contact": [3, 1],
    "bottom": [4, 1],
    "top": [5, 1],
}
"""Tag and dimension of the names of two squares, one above the other."""


def two_squares(**changes: Any) -> meshio.Mesh:
    """Two squares of a metre on each other, of two triangles each, with their names."""
    points = np.array(
        [[0, 0], [1, 0], [1, 1], [0, 1], [1, 2], [0, 2], [0, 1], [1, 1]], dtype=float
    )
    parts: dict[str, Any] = {
        "points": np.pad(points, ((0, 0), (0, 1))),
        "triangles": [[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]],
        "bodies": [1, 1, 2, 2],
        "edges": [[3, 2], [0, 1], [4, 5]],
        "lines": [3, 4, 5],
        "fields": FIELDS,
        "kinds": ("triangle", "line"),
    }
    parts |= changes
    surface, line = parts["kinds"]
    cells = [(surface, np.array(parts["triangles"])), (line, np.array(parts["edges"]))]
    tags = [np.array(parts["bodies"]), np.array(parts["lines"])]
    return meshio.Mesh(
        parts["points"],
        cells,
        cell_data={"gmsh:physical": tags},
        field_data={name: np.array(of) for name, of in parts["fields"].items()},
    )


def text_of(mesh: meshio.Mesh, folder: Path, end: str = ".msh") -> str:
    """Text of a mesh that was written to a file."""
    path = folder / f"mesh{end}"
    if end == ".msh":
        data = {"gmsh:geometrical": mesh.cell_data["gmsh:physical"]}
        mesh.cell_data |= data
        mesh.write(path, file_format="gmsh22")
    else:
        mesh.write(path)
    return text_of_mesh(path.read_bytes(), path.name)


def flat(z: float) -> Array:
    """Points of two squares, (n_points, 3), of which one has another z."""
    points = two_squares().points.copy()
    points[4, 2] = z
    return points


def without(*names: str) -> dict[str, list[int]]:
    """Names of two squares but some."""
    return {name: of for name, of in FIELDS.items() if name not in names}


BROKEN = {
    "no names": (two_squares(fields={}), "elements without a name"),
    "no name of a body": (two_squares(fields=without("upper")), "without a name"),
    "glued": (
        two_squares(edges=[[0, 1], [4, 5]], lines=[4, 5]),
        "bodies 'lower' and 'upper' with a common edge at (0.5, 1)",
    ),
    "out of the plane": (two_squares(points=flat(0.1)), "reaches 0.1 along z"),
    "volumes": (
        two_squares(
            triangles=[[0, 1, 2, 4], [0, 2, 3, 4], [3, 2, 4, 5], [3, 4, 5, 1]],
            kinds=("tetra", "line"),
        ),
        "elements of the kind tetra",
    ),
    "inverted": (
        two_squares(triangles=[[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 5, 4]]),
        "body 'upper' element 1 of no or negative area",
    ),
    "flat": (
        two_squares(triangles=[[0, 1, 2], [0, 2, 0], [3, 2, 4], [3, 4, 5]]),
        "body 'lower' element 1 of no or negative area",
    ),
    "contact outside": (
        two_squares(edges=[[3, 2], [0, 1], [4, 5], [1, 2]], lines=[3, 4, 5, 3]),
        "line 'contact' on body 'lower' alone",
    ),
    "line inside": (
        two_squares(edges=[[3, 2], [0, 1], [4, 5], [0, 2]], lines=[3, 4, 5, 4]),
        "line 'bottom' inside body 'lower'",
    ),
    "line off": (
        two_squares(edges=[[3, 2], [0, 1], [4, 5], [0, 5]], lines=[3, 4, 5, 4]),
        "line 'bottom' off the bodies",
    ),
    "in two pieces": (
        two_squares(bodies=[1, 2, 1, 1], edges=[[0, 1]], lines=[4]),
        "a mesh of 2 pieces",
    ),
    "a single body": (
        two_squares(bodies=[1, 1, 1, 1], edges=[[0, 1], [4, 5]], lines=[4, 5]),
        "without a contact",
    ),
    "does not match": (
        two_squares(
            points=np.array(
                [
                    [0, 0, 0],
                    [1, 0, 0],
                    [1, 1, 0],
                    [0, 1, 0],
                    [0.9, 2, 0],
                    [0, 2, 0],
                    [0, 1, 0],
                    [0.9, 1, 0],
                ],
                dtype=float,
            ),
            triangles=[[0, 1, 2], [0, 2, 3], [6, 7, 4], [6, 4, 5]],
            edges=[[0, 1], [4, 5]],
            lines=[4, 5],
        ),
        "that touch at",
    ),
}
"""Meshes that are refused, and words on them."""


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_mesh_is_refused_with_the_name_of_the_fault(
    kind: str, tmp_path: Path
) -> None:
    mesh, words = BROKEN[kind]
    with pytest.raises(SettingError) as refused:
        text_of(mesh, tmp_path)
    message = str(refused.value.value)
    assert refused.value.name == "mesh"
    assert words in message
    assert message.startswith("mesh.msh")


def test_what_is_wrong_is_said_of_a_file_of_any_name(tmp_path: Path) -> None:
    volumes, words = BROKEN["volumes"]
    path = tmp_path / f"{'a_long_name_' * 15}.msh"
    volumes.cell_data |= {"gmsh:geometrical": volumes.cell_data["gmsh:physical"]}
    volumes.write(path, file_format="gmsh22")
    with pytest.raises(SettingError, match=words):
        text_of_mesh(path.read_bytes(), path.name)


@pytest.mark.parametrize("data", [b"", b"no mesh", b"$MeshFormat\n4.1 0 8\n"])
def test_files_that_are_no_mesh_are_refused(data: bytes) -> None:
    for source in ("a.msh", "a.vtu"):
        with pytest.raises(SettingError, match="save it again") as refused:
            text_of_mesh(data, source)
        # By its name, once.
        assert str(refused.value.value) == source


@pytest.mark.parametrize("text", ["mesh:", "mesh:AAAA", "nothing"])
def test_a_text_that_is_no_mesh_is_refused(text: str) -> None:
    with pytest.raises(SettingError, match="mesh"):
        MESH.checked({"mesh": text})


def test_bodies_contacts_and_sides_are_those_of_the_names() -> None:
    mesh = named(two_squares())
    check_named(mesh)
    assert mesh.names == ("lower", "upper")
    (contact,) = mesh.contacts
    assert (contact.name, contact.above, contact.below) == ("contact", 1, 0)
    assert contact.normals == pytest.approx(np.tile([0.0, 1.0], (3, 1)))
    for body, nodes in ((1, contact.nodes), (0, contact.nodes_below)):
        heights = mesh.shapes[body].nodes[nodes, 1]
        assert heights == pytest.approx(np.ones(3))
    assert [(side.name, side.body) for side in mesh.sides] == [
        ("bottom", 0),
        ("top", 1),
    ]


def test_doubled_nodes_and_turned_elements_make_the_same_contact() -> None:
    doubled = two_squares(
        triangles=[[0, 1, 2], [0, 2, 3], [6, 4, 7], [6, 5, 4]],
    )
    mesh = named(doubled)
    check_named(mesh)
    (contact,) = mesh.contacts
    assert (contact.above, contact.below) == (1, 0)
    assert mesh.shapes[1].areas.sum() == pytest.approx(1.0)


def test_quadratic_elements_give_their_corners(tmp_path: Path) -> None:
    corners = two_squares()
    triangles = corners.cells[0].data
    middles = [[0, 0, 0]] * 4
    quadratic = two_squares(
        triangles=np.hstack([triangles, np.array(middles)[:, :3]]),
        kinds=("triangle6", "line"),
    )
    found = named(quadratic)
    expected = named(corners)
    for name in expected.names:
        assert np.array_equal(found.surfaces[name], expected.surfaces[name])


def test_a_contact_that_is_named_twice_rubs_once() -> None:
    mesh = read_example("bolted")
    named_twice = NamedMesh(
        mesh.points,
        mesh.surfaces,
        {**mesh.lines, "again": mesh.lines["upper faces"]},
    )
    names = [contact.name for contact in mesh.contacts]
    assert [contact.name for contact in named_twice.contacts] == names


def ring(count: int) -> NamedMesh:
    """A round core in a round hole, of a ring of quadrilaterals each."""
    angles = 2.0 * np.pi * np.arange(count) / count
    rings = [
        radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for radius in (0.5, 1.0, 2.0)
    ]
    around = np.arange(count)
    after = (around + 1) % count
    inner = np.stack([around, around + count, after + count, after], axis=1)
    edges = np.stack([around + count, after + count], axis=1)
    return NamedMesh(
        np.concatenate(rings),
        {"core": inner, "plate": inner + count},
        {"contact": edges, "outside": edges + count},
    )


def test_a_round_contact_is_one_of_two_halves_with_normals_of_the_whole() -> None:
    mesh = ring(24)
    check_named(mesh)
    first, second = mesh.contacts
    assert len(first.nodes) == len(second.nodes) == 25
    for contact in (first, second):
        places = mesh.shapes[contact.above].nodes[contact.nodes]
        outward = places / np.linalg.norm(places, axis=1, keepdims=True)
        sign = np.sign(np.einsum("na,na->n", outward, contact.normals)[0])
        assert sign * contact.normals == pytest.approx(outward, abs=1e-9)
    assert {(line.body, line.name) for line in mesh.sides} == {(1, "outside")}


@pytest.mark.parametrize("example", ["bolted", "dovetail"])
def test_a_text_gives_the_same_mesh_again(example: str) -> None:
    mesh = read_example(example)
    again = from_text(as_text(mesh))
    assert again.names == mesh.names
    for first, second in zip(mesh.shapes, again.shapes, strict=True):
        assert np.array_equal(first.nodes, second.nodes)
    assert as_text(again) == as_text(mesh)
    values = {"mesh": as_text(mesh), "instants": 3}
    kept = MESH.checked(values)
    own = MESH.checked({"mesh": example, "instants": 3})
    forces = [reference_of(discretise(each)).contact_force for each in (kept, own)]
    assert np.array_equal(*forces)


def test_a_file_is_read_where_a_command_names_it(tmp_path: Path) -> None:
    path = tmp_path / "squares.msh"
    mesh = two_squares()
    mesh.cell_data |= {"gmsh:geometrical": mesh.cell_data["gmsh:physical"]}
    mesh.write(path, file_format="gmsh22")
    settings, _ = settings_from_command("mesh", [f"mesh={path}"])
    assert settings.parts.names == ("lower", "upper")
    assert settings.sentence() == (
        "2 bodies of a mesh rub on each other; "
        "sides: “bottom” held and “top” moved along y."
    )


def test_sides_do_as_their_names_say_or_as_they_are_told() -> None:
    lines = ["left held", "right pulled", "top", "rim", "foot held x and held y"]
    assert dict(conditions_of(lines, "rim pressed, Right moved x and held y")) == {
        "left held": ("held",),
        "right pulled": ("moved x", "held y"),
        "top": ("moved y",),
        "rim": ("pressed",),
        "foot held x and held y": ("held x", "held y"),
    }
    with pytest.raises(RefusedError, match="there is no side 'roof'"):
        conditions_of(lines, "roof held")
    with pytest.raises(RefusedError, match="rim fixed"):
        conditions_of(lines, "rim fixed")


PULLED = {"sides": "top pulled", "traction": 2e7, "load": "triangle"}


@pytest.mark.parametrize(
    "values", [{}, {"mesh": "dovetail"}, {"mesh": "dovetail"} | PULLED]
)
def test_the_search_reaches_one_percent_on_meshes_with_the_usual_k(
    values: dict[str, Any],
) -> None:
    settings = MESH.checked(values)
    counts = []
    for k_scale in (0.25, 1.0, 4.0):
        wrong = errors(settings.replace(k_scale=k_scale), 60)
        counts.append(int((wrong > 0.01).sum()))
    assert settings.k_scale == 1.0
    assert counts[1] < 50
    assert counts[1] == min(counts)


def test_sides_that_leave_bodies_free_are_refused_with_their_names() -> None:
    settings = MESH.checked({"sides": "left held x, washers free"})
    with pytest.raises(SettingError, match="middle plate, upper cover") as refused:
        discretise(settings)
    assert refused.value.name == "sides"


def test_a_run_says_that_nothing_presses_what_lies_between_bodies() -> None:
    mesh = read_example("bolted")
    lines = {
        name.replace("upper faces", "upper faces pressed"): edges
        for name, edges in mesh.lines.items()
    }
    text = as_text(NamedMesh(mesh.points, mesh.surfaces, lines))
    (sentence,) = MESH.checked({"mesh": text}).left_out()
    assert "“upper faces pressed” is a contact" in sentence
    assert not list(MESH.checked({}).left_out())


def test_a_side_that_two_names_press_is_pressed_once() -> None:
    mesh = read_example("bolted")
    pressed = next(name for name in mesh.lines if name.endswith("pressed"))
    edges = mesh.lines[pressed]
    # The second name has part of what the first has, on both of its bodies.
    lines = {"some pressed": edges[len(edges) // 4 :: 2], **mesh.lines}
    text = as_text(NamedMesh(mesh.points, mesh.surfaces, lines))
    sums = []
    for values in ({}, {"mesh": text}):
        found = np.zeros((3, 2))
        for load in MESH.checked(values).structure().loads:
            found[load.body] += load.force[:, :, -1].sum(axis=0)
        sums.append(found)
    assert np.abs(sums[0][1:]).max(axis=1) == pytest.approx(5e7 * 0.03)
    assert sums[1] == pytest.approx(sums[0], rel=1e-12, abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"sides": "left free, right free"}, "sides"),
        ({"sides": "left pulled"}, "sides"),
        ({"sides": "moon held"}, "sides"),
        ({"materials": [[1, 1e9, 0.3, 0.0]]}, "materials"),
        ({"friction_factors": [[1, 1.0]]}, "friction_factors"),
        ({"substructures": 10_000}, "substructures"),
    ],
)
def test_settings_that_do_not_fit_the_mesh_are_refused(
    changes: dict[str, Any], name: str
) -> None:
    with pytest.raises(SettingError) as refused:
        MESH.checked(changes)
    assert refused.value.name == name
    assert name not in str(refused.value.value)


def test_a_dovetail_rubs_one_way_when_pulled_and_the_other_when_let_go() -> None:
    settings = MESH.checked(
        {"mesh": "dovetail", "load": "triangle", "displacement": 2e-5, "friction": 0.3}
    )
    problem = discretise(settings)
    solution = reference_of(problem)
    for name in problem.contacts:
        fields = solution.contact(name)
        assert fields.normal_force is not None
        normal = fields.normal_force.sum(axis=0)
        ratio = fields.tangential_force.sum(axis=0)[[20, 38]] / normal[[20, 38]]
        assert np.abs(ratio) == pytest.approx([0.3, 0.3], abs=0.003)
        assert ratio[0] * ratio[1] < 0.0


def test_a_bolted_plate_is_held_by_friction_on_both_of_its_faces() -> None:
    pressed = 5e7 * 0.03
    settings = MESH.checked(
        {
            "displacement": 2e-4,
            "load": "triangle",
            "sides": "left held x, right moved x and held y",
        }
    )
    problem = discretise(settings)
    solution = reference_of(problem)
    force = settings.structure().loop(problem).along(solution)[1]
    assert force.max() == pytest.approx(2.0 * 0.3 * pressed, rel=1e-6)


def test_each_body_has_its_material() -> None:
    rows = [[1, 1e11, 0.3, 0.0], [2, 7e10, 0.2, 1e4], [3, 2e11, 0.1, 0.0]]
    bodies = MESH.checked({"materials": rows}).structure().bodies
    assert [body.young for body in bodies] == [1e11, 7e10, 2e11]
    assert bodies[1].weight[1, -1] == -1e4


def test_a_table_of_one_material_says_what_the_settings_say(tmp_path: Path) -> None:
    """Stresses across the plane, and springs of contacts, are of the bodies' own E, ν.

    Both were of the settings that a table replaces: von Mises' stress of a body with
    ν = 0.45 was that of ν = 0.3, and the springs in series with friction were 100 times
    as stiff as steel, whatever the bodies were of.
    """
    mesh = text_of(two_squares(), tmp_path)
    common = {"mesh": mesh, "sides": "bottom held, top moved y"}
    common |= {"load": "ramp", "instants": 5, "displacement": -1e-3}
    common |= {"friction_law": "compliant", "contact_stiffness": 2.0, "friction": 0.5}
    by_settings = MESH.checked(common | {"young": 1e6, "poisson": 0.45})
    rows = [[1, 1e6, 0.45, 0.0], [2, 1e6, 0.45, 0.0]]
    by_table = MESH.checked(common | {"materials": rows})
    runs = [finished_run(each, errors=False) for each in (by_settings, by_table)]
    for name in ("peak_stress", "peak_slip", "peak_friction", "peak_displacement"):
        first, second = [QUANTITIES[name](run) for run in runs]
        assert first > 0.0
        assert second == pytest.approx(first, rel=1e-9)


def test_numbers_of_nodes_and_corners_change_no_quantity() -> None:
    """Halfway the dovetail carries nothing, and rounding presses some points.

    These counted as sliding, and were others for other numbers: 57 to 74 % had slipped.
    The middle of a triangle lay a ninth of its size towards its last corner.
    """
    mesh = read_example("dovetail")
    order = np.random.default_rng(1).permutation(len(mesh.points))
    numbers = np.argsort(order)
    again = NamedMesh(
        mesh.points[order],
        {
            name: np.roll(numbers[corners], 1, axis=1)
            for name, corners in mesh.surfaces.items()
        },
        {name: numbers[edges] for name, edges in mesh.lines.items()},
    )
    names = ("slipped_share", "contact_width", "peak_stress_x", "peak_stress_y")
    found = []
    for each in (mesh, again):
        settings = MESH.checked({"mesh": as_text(each), "instants": 9})
        run = finished_run(settings, errors=False)
        assert run.solution.is_certified
        found.append([QUANTITIES[name](run) for name in names])
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0][0] == pytest.approx(24 / 46)


def test_cuts_and_units_of_the_mesh_change_no_force() -> None:
    values: dict[str, Any] = {"instants": 5}
    settings = MESH.checked(values)
    whole = reference_of(discretise(settings))
    cut = reference_of(discretise(MESH.checked(values | {"substructures": 3})))
    names = settings.structure().joints
    for name in [joint.name for joint in names]:
        one = whole.contact(name).normal_force
        other = cut.contact(name).normal_force
        assert one is not None
        assert other is not None
        assert one.sum(axis=0) == pytest.approx(other.sum(axis=0), rel=1e-9)
    # Twice as large and twice as far moved: the strains are the same.
    larger = MESH.checked(values | {"scale": 2.0, "displacement": 6e-5})
    twice = reference_of(discretise(larger))
    assert twice.contact_force == pytest.approx(2.0 * whole.contact_force, rel=1e-7)
