"""Points that slip lie on the curve of the most that friction holds, others below."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.frame import Frame, Selection
from app.messages import Needs
from app.state import PageState
from app.views.contact_force import ContactForce
from app.worker.sampling import Sampler
from solver.scenes import CATALOGUE
from solver.study.scene_run import finished_run

BLOCK: dict[str, Any] = {
    "gap": "flat",
    "top": "traction",
    "top_normal_traction": -1e7,
    "top_tangential_traction": 2.9e6,
    "body_force_y": -1e7,
    "elements": 12,
    "elements_up": 4,
    "substructures": 1,
    "instants": 9,
}
BOND = {"friction_law": "general", "cohesion": 2e5, "friction": 0.27}
CAP = {"friction_law": "general", "friction_cap": 2.9e6, "top_tangential_traction": 2e6}
SOFTER = {"friction_law": "slip-dependent", "friction_ratio": 0.5, "slip_length": 1e-4}
BAR: dict[str, Any] = {"elements": 20, "instants": 9, "substructures": 2}
HARDER = {"friction_law": "slip-dependent", "friction_ratio": 1.5, "slip_length": 2e-3}


def frame_of(scene: str, **values: Any) -> Frame:
    """The certified answer of a run on the page."""
    settings = CATALOGUE[scene].checked(values)
    run = finished_run(settings, errors=False, indicators=False)
    assert run.solution.is_certified
    sampler = Sampler(run.problem, settings, 1)
    history = run.solution.records
    return sampler.frame(run.iterate, history, run.solution.status, Needs())


@pytest.mark.parametrize(
    ("scene", "values", "title"),
    [
        ("block", BLOCK, "±µp"),
        ("block", BLOCK | BOND, "most friction"),
        ("block", BLOCK | CAP, "most friction"),
        ("block", BLOCK | SOFTER, "most friction"),
        ("bar", BAR, "±µp"),
        ("bar", BAR | SOFTER | {"peak": 500.0}, "most friction"),
        ("bar", BAR | HARDER, "most friction"),
    ],
)
def test_friction_of_points_that_slip_is_on_its_bound(
    scene: str, values: dict[str, Any], title: str
) -> None:
    """The curve was µp, and along rods its largest whatever had slipped."""
    frame = frame_of(scene, **values)
    (fields,) = frame.contact.values()
    view = ContactForce(PageState(frame.run.settings))
    assert view.figure is not None
    count = fields.friction.shape[0]
    slipping = 0
    for column, time in enumerate(frame.run.instants):
        phase = float(time / frame.run.instants[-1])
        view.update(frame, Selection(phase=phase), None)
        bound = np.array(view.sources["bound"].data["y"][:count])
        friction = np.abs(np.array(view.sources["friction"].data["latin"]))
        assert np.all(friction <= bound * (1.0 + 1e-4))
        slips = np.abs(fields.status[:, column]) == 1
        assert friction[slips] == pytest.approx(bound[slips], rel=1e-4)
        slipping += int(slips.sum())
    assert slipping > 0
    legend = {item.label["value"] for item in view.figure.legend[0].items}
    assert title in legend
