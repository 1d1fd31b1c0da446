"""A run before, and a run A, are seen as outlines of bodies and of the map, and named."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shown_pages import ALL, SMALL, Shown, keys

from app.picture.portrait import rims
from app.views.bodies import deformed, picture
from app.views.catalogue import fitting
from app.views.convergence import convergence
from app.views.convergence.earlier_runs import THIN
from app.views.drawing.colors import FRONT, GHOST
from app.views.drawing.drawing import Drawing
from app.views.interface import status_map
from app.wire.orders import Seek, Watch
from solver.scenes import CATALOGUE

PLANE = ("block", "layers", "incline")
SHORT = {"method": "paper", "max_iterations": 4}


def outlines(drawing: Drawing | None) -> list[np.ndarray]:
    assert drawing is not None
    ghosts = [one for one in drawing.curves if one.color == GHOST]
    return [np.stack([np.asarray(one.x), np.asarray(one.y)], axis=1) for one in ghosts]


def run_twice(scene: str, *phases: float) -> Shown:
    """Do the same run twice, and look at other instants afterwards."""
    shown = Shown()
    for ticket in (1, 2):
        shown.run(ticket, scene, {**SMALL[scene], **SHORT})
    for phase in phases:
        shown.obey(Watch(replace(ALL, phase=phase)))
    return shown


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_a_line_around_every_body_comes_back_to_where_it_began(scene: str) -> None:
    portrait = run_twice(scene).recording.stand.portrait
    found = rims(portrait)
    assert len(found) == portrait.described.bodies
    for rim in found:
        line = portrait.mesh.nodes[rim]
        length, height = np.ptp(line, axis=0)
        assert line[0] == pytest.approx(line[-1])
        assert np.abs(np.diff(line, axis=0)).sum() == pytest.approx(2 * (length + height), rel=1e-5)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_the_ghost_of_the_same_run_lies_on_the_bodies_at_every_instant(scene: str) -> None:
    shown = run_twice(scene, 0.5)
    for view in (picture, deformed) if scene in PLANE else (picture,):
        looked = shown.scene(shown.runs._look, shown.pictures[-1].facts.instant)
        drawing = view.draw(looked, None)
        assert drawing is not None
        assert drawing.bodies is not None
        own = [drawing.bodies.places[rim] for rim in rims(looked.run.stand.portrait)]
        for ghost, line in zip(outlines(drawing), own, strict=True):
            assert ghost == pytest.approx(line, abs=1e-6)
        assert "run before, iteration 4" in keys(drawing)


def test_the_last_three_runs_stay_in_the_plot_of_convergence_named_by_their_k() -> None:
    shown = Shown()
    ks = (100.0, 0.1, 10.0, 1.0, 0.3)
    for ticket, k in enumerate(ks, 1):
        shown.run(ticket, "bar", {**SMALL["bar"], **SHORT, "k_scale": k})
    drawing = convergence.draw(shown.scene(), None)
    assert [name for name in keys(drawing) if "k ×" in name] == ["k × 0.1", "k × 10", "k × 1"]
    thin = [one for one in drawing.curves if one.width == THIN]
    past = [one.history.column("error_force") for one in shown.scene().past[-3:]]
    assert all(np.array_equal(one.y, own) for one, own in zip(thin, past, strict=True))


def test_a_run_that_is_replayed_is_no_ghost_of_itself() -> None:
    drawing = convergence.draw(run_twice("bar").scene(), None)
    assert all(one.width != THIN for one in drawing.curves)


OTHERS: dict[str, dict[str, Any]] = {
    "bar": {"peak": 4000.0, "friction": 0.6, "length": 1.4, "duration": 2.0},
    "strand": {"peak": 1800.0, "length": 1.4, "duration": 2.0},
    "block": {"top_normal_displacement": -1e-4, "friction": 0.6, "length": 0.13, "duration": 2.0},
    "fault": {"shear_stress": 5e6, "friction": 0.8, "length": 800.0, "duration": 2e5},
    "incline": {"weight": 3000.0, "length": 0.13, "duration": 2.0},
    "rope": {"curvature": 0.2, "friction": 0.6, "length": 0.2, "duration": 2.0},
    "layers": {"pressure": 9e6, "friction": 0.6, "length": 0.6, "duration": 2.0},
}
"""What is larger than usual in every scene: forces, displacements, bodies, time."""


def outside(drawing: Drawing) -> list[str]:
    """Give the colours of all curves and bodies that leave the axes."""
    if drawing.bodies is not None:
        box, (x, y) = drawing.bodies.box, drawing.bodies.places.T
        left, right, low, high = box.left, box.right, box.low, box.high
        places = [("bodies", x, y), *((c.color, c.x, c.y) for c in drawing.curves)]
    else:
        assert drawing.x is not None
        assert drawing.y is not None
        left, right, low, high = drawing.x.low, drawing.x.high, drawing.y.low, drawing.y.high
        places = [(curve.color, curve.x, curve.y) for curve in drawing.curves]
    # Iterates move a little where they are held.
    slack_x, slack_y = 2e-4 * (right - left), 2e-4 * (high - low)
    return [
        name
        for name, x, y in places
        if np.nanmin(x, initial=left) < left - slack_x
        or np.nanmax(x, initial=right) > right + slack_x
        or np.nanmin(y, initial=low) < low - slack_y
        or np.nanmax(y, initial=high) > high + slack_y
    ]


@pytest.mark.parametrize("is_paired", [True, False])
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_what_is_compared_is_inside_the_axes(scene: str, is_paired: bool) -> None:
    shown, values = Shown(), {**SMALL[scene], **SHORT, "max_iterations": 12}
    other = CATALOGUE[scene].settings.checked({**values, **OTHERS[scene]}).values()
    if is_paired:
        shown.run(1, scene, values, twin=other)
    else:
        shown.run(1, scene, other)
        shown.run(2, scene, values)
    kept: dict[str, Any] = {}
    for iteration in (1, 4, 12):
        shown.obey(Seek(shown.recording.ticket, iteration))
        looked = shown.scene()
        for view in fitting(looked.run.settings):
            drawing = view.draw(looked, kept.get(view.name))
            # Of singular values and the modes of a basis there is nothing to compare with.
            if drawing is not None and view.name != "Singular values":
                kept[view.name] = drawing.kept
                assert not outside(drawing), (view.name, iteration)


def test_a_ghost_that_would_make_the_bodies_small_is_left_out() -> None:
    shown = Shown()
    for ticket, peak in enumerate((900.0, 20.0), start=1):
        shown.run(ticket, "bar", {**SMALL["bar"], **SHORT, "peak": peak})
    drawing = picture.draw(shown.scene(), None)
    assert outlines(drawing) == []
    assert not [key for key in keys(drawing) if "before" in key]


def test_run_a_is_outlined_where_it_is_shown_and_called_so() -> None:
    shown = Shown()
    values = {**SMALL["layers"], **SHORT}
    shown.run(1, "layers", values, twin={**values, "friction": 0.1})
    scene = shown.scene()
    assert scene.shadow is not None
    for view in (picture, deformed, status_map):
        assert f"A, iteration {scene.shadow.iteration}" in keys(view.draw(scene, None))


def test_lines_of_the_map_lie_between_points_and_instants_of_other_status() -> None:
    shown = Shown()
    for ticket, friction in enumerate((0.3, 0.1), start=1):
        shown.run(ticket, "bar", {**SMALL["bar"], **SHORT, "friction": friction})
    scene = shown.scene()
    (front,) = [one for one in status_map.draw(scene, None).curves if one.color == FRONT]
    assert scene.before is not None
    assert scene.before.frame is not None
    status = scene.before.frame.status
    changes = np.count_nonzero(np.diff(status, axis=0)) + np.count_nonzero(np.diff(status, axis=1))
    assert changes > 0
    assert np.count_nonzero(np.isnan(front.x)) == changes
    places = scene.before.stand.positions
    half = 0.5001 * (places[1] - places[0])
    assert places[0] - half <= np.nanmin(front.x) <= np.nanmax(front.x) <= places[-1] + half
