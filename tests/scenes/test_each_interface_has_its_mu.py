"""Interfaces of one structure may each have a coefficient of friction of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import assert_names, refusal
from ropes import exact_of, moment_of, settings_of, solved

from solver.files.saved import settings_from_command
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise

LAYERS: dict[str, Any] = {"elements": 16, "instants": 17, "layers": 4}


def layers_of(**changes: Any) -> Any:
    return reference_of(discretise(CATALOGUE["layers"].checked(LAYERS | changes)))


def test_equal_factors_are_another_mu() -> None:
    table = [[1, 0.5], [2, 0.5], [3, 0.5]]
    factors = layers_of(friction_factors=table)
    half = layers_of(friction=0.15)
    np.testing.assert_array_equal(factors.status, half.status)
    np.testing.assert_allclose(
        factors.displacement, half.displacement, rtol=1e-9, atol=1e-12
    )


def test_friction_between_layers_is_at_most_mu_of_their_interface() -> None:
    mu = dict(
        zip(
            ("contact 1-2", "contact 2-3", "contact 3-4"), (0.03, 0.0, 0.3), strict=True
        )
    )
    found = layers_of(friction_factors=[[1, 0.1], [2, 0], [3, 1]])
    for name, coefficient in mu.items():
        contact = found.contact(name)
        bound = coefficient * contact.normal_force
        assert np.all(
            np.abs(contact.tangential_force) <= bound + 1e-6 * bound.max() + 1e-9
        )
        assert contact.status.any() or coefficient == 0.3


def test_layers_of_a_rope_that_rub_unequally_meet_the_closed_form() -> None:
    changes = {"friction_factors": [[1, 0.4], [2, 1.5], [3, 0.8]], "load": "ramp"}
    settings = settings_of(curvature=0.3, **changes)
    scene, found = solved(settings)
    exact = exact_of(settings).moment(scene.curvature)
    assert np.abs(moment_of(scene, found) - exact).max() < 0.005 * exact[-1]
    same = exact_of(settings_of(curvature=0.3)).moment(scene.curvature)
    assert np.abs(exact - same).max() > 0.05 * exact[-1]


def test_a_broken_wire_regains_its_force_over_the_friction_of_both_its_sides() -> None:
    """The force grows by mu p of both sides per length: 0.6 and 1.4 are 2."""
    kind = CATALOGUE["strand"]
    changes: dict[str, Any] = {"load": "ramp", "instants": 11}
    uneven = kind.checked({**changes, "friction_factors": [[1, 0.6], [2, 1.4]]})
    runs = [reference_of(discretise(one)) for one in (kind.checked(changes), uneven)]
    for run, factors in zip(runs, ((1.0, 1.0), (0.6, 1.4)), strict=True):
        for name, factor in zip(("contact 1-2", "contact 2-3"), factors, strict=True):
            law = run.problem.contacts[name]
            contact = run.contact(name)
            slips = contact.status[:, -1] != 0
            bound = law.by_point(law.weights) * factor * 0.3 * 5000.0
            force = np.abs(contact.tangential_force[:, -1])
            assert slips.any()
            np.testing.assert_allclose(force[slips], bound[slips], rtol=1e-9)
    # It holds less where one side has no friction at all.
    few = {"peak": 1000.0, "friction_factors": [[1, 1.0], [2, 0.0]]}
    assert "below 750 N" in refusal(lambda: kind.checked(changes | few))


@pytest.mark.parametrize(
    "table", [[[1, 0.5]], [[1, 1.0], [2, 1.0], [4, 1.0]], [[0.5, 1.0]]]
)
def test_a_table_that_lacks_an_interface_is_refused_with_their_number(
    table: Any,
) -> None:
    for scene, count in (("layers", 3), ("rope", 3), ("strand", 2)):
        kind = CATALOGUE[scene]
        text = refusal(lambda kind=kind: kind.checked({"friction_factors": table}))
        assert_names(
            text, "friction_factors", f"there are {len(table)}", f"{count} pairs"
        )


def test_factors_come_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "mu.csv"
    path.write_text("interface;factor\n1;0,5\n2;1,0\n3;0,25\n")
    settings, messages = settings_from_command("layers", [f"friction_factors={path}"])
    assert settings.values()["friction_factors"] == (
        (1.0, 0.5),
        (2.0, 1.0),
        (3.0, 0.25),
    )
    assert messages["friction_factors"] == "interface, factor, 3 points, from 0.25 to 1"
