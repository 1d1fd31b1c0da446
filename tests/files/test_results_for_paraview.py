"""Series of files for ParaView hold the fields of a run in the plane."""

import json
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from solver.commands.cli import main
from solver.files.paraview import write_series
from solver.latin import Iterate, solve
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

PLANE = [name for name, kind in CATALOGUE.items() if kind.kind == "plane"]


def written(scene: str, folder: Path) -> tuple[Iterate, list[meshio.Mesh]]:
    """A small run, and the meshes of its last instant: bodies and contacts."""
    kind = CATALOGUE[scene]
    settings = kind.checked({**kind.SMALL, "instants": 3})
    iterate = solve(discretise(settings), method_of(settings)).iterate
    path = folder / "run.pvd"
    write_series(path, iterate)
    listed = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    instants = iterate.problem.instants
    assert len(listed) == 2 * len(instants)
    assert float(listed[-1].attrib["timestep"]) == instants[-1]
    files = [folder / each.attrib["file"] for each in listed[-2:]]
    return iterate, [meshio.read(file) for file in files]


@pytest.mark.parametrize("scene", PLANE)
def test_files_of_every_scene_in_the_plane_have_its_fields(
    scene: str, tmp_path: Path
) -> None:
    iterate, (bodies, contacts) = written(scene, tmp_path)
    problem = iterate.problem
    inside = problem.inside
    assert inside is not None
    moved = inside.displacement(iterate.displacement, [-1])[:, :, 0]
    used = np.unique(inside.elements)
    assert np.array_equal(bodies.points[:, :2], inside.nodes[used])
    found = bodies.point_data["displacement"][:, :2]
    assert found == pytest.approx(moved[used], abs=1e-9 * np.abs(moved).max())
    # Elements of a scene here are of one kind, and stand in their order.
    known = inside.stress(moved)
    stress = np.concatenate(bodies.cell_data["stress"])
    assert stress == pytest.approx(known, abs=1e-6 * np.abs(known).max())
    assert len(contacts.points) == problem.contacts.n_points
    if problem.opens:
        pressing = [iterate.contact(name).normal_force for name in problem.contacts]
        total = sum(force[:, -1].sum() for force in pressing if force is not None)
        assert contacts.point_data["normal_force"].sum() == pytest.approx(total)


def test_pressure_times_length_is_the_pressing_force(tmp_path: Path) -> None:
    path = tmp_path / "run.pvd"
    changes = ["displacement=0", "instants=2"]
    command = ["run", "mesh", "--no-reference", "--out", str(path)]
    for change in changes:
        command += ["--set", change]
    assert main(command) == 0
    contacts = meshio.read(tmp_path / "run" / "contacts_0001.vtu")
    data = contacts.point_data
    areas = data["normal_force"] / np.where(data["pressure"], data["pressure"], np.inf)
    is_pressed = data["pressure"] > 0.0
    ends = contacts.points[is_pressed, 0]
    assert is_pressed.any()
    assert areas[is_pressed].min() > 0.0
    assert areas.sum() <= 2.0 * 0.1 * (1.0 + 1e-9)
    assert (ends >= 0.0).all()


@pytest.mark.parametrize("scene", PLANE)
def test_a_run_is_no_distance_from_its_own_files(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kind = CATALOGUE[scene]
    small = [f"--set={name}={value}" for name, value in kind.SMALL.items()]
    command = [scene, *small, "--set=instants=5"]
    path = tmp_path / "run.pvd"
    main(["run", *command, "--no-reference", "--out", str(path)])
    capsys.readouterr()
    main(["compare", *command, "--with", str(path), "--json"])
    figures = json.loads(capsys.readouterr().out)
    assert figures["distance"] == pytest.approx(0.0, abs=1e-12)
    assert figures["rows_compared"] > 4


def test_any_interface_of_a_series_is_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kind = CATALOGUE["wall"]
    *_, last = discretise(kind.checked(kind.SMALL)).contacts
    small = [f"--set={name}={value}" for name, value in kind.SMALL.items()]
    command = ["wall", *small]
    path = tmp_path / "run.pvd"
    main(["run", *command, "--no-reference", "--out", str(path)])
    capsys.readouterr()
    compared = ["--with", str(path), "--interface", last, "--json"]
    main(["compare", *command, *compared])
    figures = json.loads(capsys.readouterr().out)
    assert figures["interface"] == last
    assert figures["distance"] == pytest.approx(0.0, abs=1e-12)


def test_a_contact_of_one_point_is_read_again_as_that_point(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    held = [f"--set={side}=clamped" for side in ("left", "right")]
    mesh = ["--set=elements=2", "--set=elements_up=2", "--set=substructures=1"]
    load = ["--set=top_normal_load=sine", "--set=instants=5", "--set=gap=flat"]
    command = ["block", *held, *mesh, *load]
    path = tmp_path / "run.pvd"
    main(["run", *command, "--no-reference", "--out", str(path)])
    (cells,) = meshio.read(tmp_path / "run" / "contacts_0004.vtu").cells
    assert cells.type == "vertex"
    assert cells.data.tolist() == [[0]]
    capsys.readouterr()
    main(["compare", *command, "--with", str(path), "--json"])
    figures = json.loads(capsys.readouterr().out)
    assert figures["distance"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("nothing", "give a series"),
        ("<VTKFile><Collection/></VTKFile>", "give a series"),
        (
            '<VTKFile><Collection interfaces="[]"><DataSet timestep="0" '
            'file="contacts_0000.vtu"/></Collection></VTKFile>',
            "give all of them",
        ),
    ],
)
def test_files_without_a_series_are_refused(
    content: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "other.pvd"
    path.write_text(content, encoding="utf-8")
    assert main(["compare", "mesh", "--with", str(path)]) == 2
    assert said in capsys.readouterr().err


def test_rods_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.pvd"
    assert main(["run", "bar", "--out", str(path)]) == 2
    assert "FILE.npz" in capsys.readouterr().err
    assert not path.exists()
