"""Series of files for ParaView hold the fields of a run in the plane."""

from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from solver.commands.cli import main
from solver.files.paraview import write_series
from solver.latin import solve
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

PLANE = [name for name, kind in CATALOGUE.items() if kind.kind == "plane"]


@pytest.mark.parametrize("scene", PLANE)
def test_files_of_every_scene_in_the_plane_have_its_fields(
    scene: str, tmp_path: Path
) -> None:
    kind = CATALOGUE[scene]
    settings = kind.checked({**kind.SMALL, "instants": 3})
    problem = discretise(settings)
    iterate = solve(problem, method_of(settings)).iterate
    path = tmp_path / "run.pvd"
    write_series(path, iterate)
    listed = ElementTree.parse(path).getroot().findall("Collection/DataSet")
    assert len(listed) == 2 * problem.n_instants
    assert float(listed[-1].attrib["timestep"]) == problem.instants[-1]
    bodies, contacts = [
        meshio.read(tmp_path / each.attrib["file"]) for each in listed[-2:]
    ]
    inside = problem.inside
    assert inside is not None
    moved = inside.displacement(iterate.displacement, [-1])[:, :, 0]
    used = np.unique(inside.elements)
    assert np.array_equal(bodies.points[:, :2], inside.nodes[used])
    assert np.array_equal(bodies.point_data["displacement"][:, :2], moved[used])
    stress = np.concatenate(bodies.cell_data["stress"])
    assert len(stress) == len(inside.elements)
    assert np.sort(stress, axis=0) == pytest.approx(
        np.sort(inside.stress(moved), axis=0)
    )
    pressing = [iterate.contact(name).normal_force for name in problem.rubbing]
    total = sum(force[:, -1].sum() for force in pressing if force is not None)
    assert contacts.point_data["normal_force"].sum() == pytest.approx(total)
    assert len(contacts.points) == problem.rubbing.n_points


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


def test_rods_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.pvd"
    assert main(["run", "bar", "--out", str(path)]) == 2
    assert "FILE.npz" in capsys.readouterr().err
    assert not path.exists()
