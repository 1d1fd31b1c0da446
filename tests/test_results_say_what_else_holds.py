"""A result says beside its status what one has to know: a body tips, a contact grows by leaps."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

from solver.cli import main
from solver.remarks import MOST_GROWTH, contact_growth, remarks_on
from solver.scenes import CATALOGUE
from solver.study.quantities.finished import FinishedRun, finished_run

TALL = {
    **{"gap": "flat", "length": 0.05, "height": 0.1, "elements": 6, "elements_up": 12},
    **{"top": "dragged", "top_normal_traction": -1e6, "instants": 21},
    **{"top_tangential_displacement": 1e-4, "top_tangential_load": "ramp"},
}
PRESSED = {
    **{"gap": "parabola", "radius": 30.0, "friction": 0.5, "top_normal_displacement": -2e-5},
    **{"elements": 96, "elements_up": 16},
}


@cache
def _ran(scene: str, given: tuple[tuple[str, Any], ...]) -> FinishedRun:
    settings = CATALOGUE[scene].settings.checked(dict(given))
    return finished_run(settings, errors=False, indicators=False)


def ran(scene: str, **given: Any) -> FinishedRun:
    return _ran(scene, tuple(given.items()))


def remarks(run: FinishedRun) -> list[str]:
    return remarks_on(run.settings, run.iterate)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_nothing_is_remarked_on_a_scene_as_it_stands(scene: str) -> None:
    assert remarks(ran(scene)) == []


def test_a_tall_block_whose_top_is_dragged_tips_at_the_force_of_its_lever_arms() -> None:
    run = ran("block", **TALL, friction=0.9)
    assert run.force[-1] == pytest.approx(1e6 * 0.05 * 0.05 / (2.0 * 0.1), rel=1e-9)
    (remark,) = remarks(run)
    assert "tips" in remark
    assert remarks(ran("block", **TALL, friction=0.2)) == []


def test_a_body_that_is_kept_from_turning_does_not_tip() -> None:
    lifted = {"top": "displacement", "gap": ((0.0, 0.0), (0.1, 1e-3)), "top_normal_slope": 0.0}
    run = ran("block", **lifted, elements=8, elements_up=4, instants=5)
    assert (run.iterate.status[:, -1] != 2).sum() <= 1
    assert remarks(run) == []


def test_a_contact_that_grows_by_leaps_has_friction_in_a_saw_and_says_so() -> None:
    """With steps in which it grows by a point at each end, neighbours rub alike."""
    leaps, saws = [], []
    for instants in (41, 321):
        run = ran("block", **PRESSED, instants=instants)
        contact = run.iterate.contact("support")
        friction = contact.tangential_force[:, (instants - 1) // 5]
        rubbing = friction[np.flatnonzero(friction)[4:-4]]
        saws.append(np.abs(np.diff(rubbing, 2)).max() / np.abs(friction).max())
        leaps.append(contact_growth(run.iterate))
        assert any("raise instants" in one for one in remarks(run)) == (instants == 41)
    assert leaps[0] > MOST_GROWTH >= leaps[1]
    assert saws[0] > 2.0 * saws[1]


def test_the_command_prints_remarks_with_the_result(capsys: pytest.CaptureFixture[str]) -> None:
    changes = [text for name, value in TALL.items() for text in ("--set", f"{name}={value}")]
    command = ["run", "block", *changes, "--set", "friction=0.9", "--no-reference"]
    assert main(command) == 0
    assert "\nremarks              From 0.05 s on the body tips" in capsys.readouterr().out
    assert main([*command, "--json"]) == 0
    assert "tips" in json.loads(capsys.readouterr().out)["remarks"][0]
