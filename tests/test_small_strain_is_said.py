"""An answer beyond small strain is said to be none of this model."""

from __future__ import annotations

import json

import numpy as np
import pytest

from solver.cli import main
from solver.discrete.small_strain import beyond_small_strain, largest_strain
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise, structure_of

SMALL = {
    "bar": {},
    "strand": {},
    "block": {"elements": 12, "elements_up": 6, "substructures": 2, "instants": 17},
    "fault": {"elements": 12, "elements_up": 6, "substructures": 2, "instants": 11},
    "incline": {"elements": 12, "elements_up": 6, "substructures": 2, "instants": 11},
    "layers": {"elements": 16, "layers": 2, "substructures": 2, "instants": 17},
    "rope": {"elements": 12, "layers": 1, "substructures": 2},
}
SOFT = {
    "bar": {"young": 2.1e6},
    "strand": {"young": 2.1e6},
    "block": {"top_normal_displacement": -1e-2},
    "fault": {"young": 6e7},
    "incline": {"young": 1e5, "weight": 1e4},
    "layers": {"deflection": 0.2},
    "rope": {"curvature": 30.0},
}


def said(scene: str, changes: dict[str, object]) -> str | None:
    settings = CATALOGUE[scene].settings.checked({**SMALL[scene], **changes})
    problem = discretise(settings)
    displacement = reference_of(problem).displacement
    return beyond_small_strain(structure_of(settings), problem, displacement)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_scenes_by_default_are_within_small_strain_and_soft_ones_beyond(scene):
    assert said(scene, {}) is None
    message = said(scene, SOFT[scene])
    assert message is not None
    assert message.startswith("this model does not hold: strains or slopes reach")


def test_the_strain_of_a_bar_is_force_over_stiffness():
    values = {"friction": 0.0, "load": "ramp", "peak": 900.0}
    settings = CATALOGUE["bar"].settings.checked(values)
    problem = discretise(settings)
    found = largest_strain(structure_of(settings), problem, reference_of(problem).displacement)
    assert found == pytest.approx(900.0 / (210e9 * 3.14e-6))


def test_the_slope_of_a_sheared_body_is_its_shear_and_sliding_is_none():
    settings = CATALOGUE["block"].settings.checked(SMALL["block"])
    structure, problem = structure_of(settings), discretise(settings)
    along = np.where(problem.inside.components == 0, 1.0, 0.0)[:, None]
    ones = np.ones((1, problem.n_instants))
    assert largest_strain(structure, problem, along * ones) < 1e-12
    settings = CATALOGUE["fault"].settings.checked({**SMALL["fault"], "friction": 10.0})
    problem = discretise(settings)
    strain = largest_strain(structure_of(settings), problem, reference_of(problem).displacement)
    assert strain == pytest.approx(3.6e6 / (6e10 / 2.5), rel=1e-6)


def test_the_command_says_that_a_hundred_giganewtons_are_no_small_strain(capsys):
    command = ["run", "bar", "--set", "peak=1e11", "--set", "max_iterations=20", "--no-reference"]
    main([*command, "--json"])
    (remark,) = json.loads(capsys.readouterr().out)["remarks"]
    assert "does not hold" in remark
    main(command)
    assert f"remarks              {remark}" in capsys.readouterr().out
