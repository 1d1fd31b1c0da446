"""Reactions of ends, sides, springs and supports are those of closed forms."""

from __future__ import annotations

from itertools import islice
from typing import Any

import numpy as np
import pytest
from friction_laws import LAWS, law_of
from small_scenes import SMALL

from app.frame import Selection
from app.messages import Needs
from app.status import figures_line
from app.units import percent
from app.worker.sampling import Sampler
from solver.discrete.probes import reaction
from solver.latin import iterations
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.fit import fit
from solver.study.measured_loop import MeasuredLoop
from solver.study.quantities import reading
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

MOVED_END = {
    "left_end": "free",
    "right_end": "held",
    "right_displacement": 1e-4,
    "friction": 0.3,
}
PUSHED = {
    "left": "pushed",
    "left_normal_displacement": -1e-4,
    "top": "traction",
    "top_normal_traction": -1e7,
    "gap": "flat",
    "elements": 10,
    "elements_up": 4,
    "instants": 5,
}
ON_SPRING = {
    "length": 0.4,
    "height": 0.2,
    "top": "free",
    "gap": "flat",
    "body_force_y": -1837.5,
    "body_force_x": -3400.0,
    "friction": 0.9,
    "spring": 3e5,
    "elements": 12,
    "elements_up": 6,
    "instants": 5,
}


def run_of(scene: str, **values: Any) -> FinishedRun:
    return finished_run(
        CATALOGUE[scene].checked(values), errors=False, indicators=False
    )


def largest(name: str, run: FinishedRun) -> float:
    return reading(name)(run)


@pytest.mark.parametrize("elements", [10, 25, 60])
def test_the_force_of_an_end_is_that_of_its_closed_form_on_every_mesh(
    elements: int,
) -> None:
    """900 N move the end of Table 1's bar by 0.409 mm, and the other way round."""
    path = [[0.0, 0.0], [1.0, 900.0**2 / (2.0 * 659_400.0 * 1500.0)]]
    held = {
        "right_end": "held",
        "right_load": path,
        "instants": 5,
        "elements": elements,
    }
    assert largest("right_force", run_of("bar", **held)) == pytest.approx(
        900.0, rel=1e-12
    )


def test_a_moved_end_needs_what_a_stiff_spring_that_moves_it_carries() -> None:
    moved = run_of("bar", **MOVED_END, instants=5)
    stiff = {**MOVED_END, "right_end": "spring", "right_spring": 1e12}
    sprung = run_of("bar", **stiff, instants=5)
    assert largest("right_force", moved) == pytest.approx(444.7696, rel=1e-4)
    assert largest("right_force", moved) == pytest.approx(
        largest("right_force", sprung), rel=1e-5
    )
    np.testing.assert_allclose(moved.force, sprung.force, rtol=1e-5)


def test_the_largest_axial_force_of_a_bar_is_what_pulls_its_end() -> None:
    """The last element has lost half an element of friction in its middle."""
    assert (
        largest("axial_force", run_of("bar", load=[[0, 0], [1, 900]], instants=3))
        == 900.0
    )
    moved = largest("axial_force", run_of("bar", **MOVED_END, instants=5))
    assert moved == pytest.approx(444.7696, rel=1e-4)


def test_a_pushed_side_carries_all_friction() -> None:
    run = run_of("block", **PUSHED)
    assert largest("left_force", run) == pytest.approx(3e5, rel=1e-9)
    # What slides, the support carries.
    assert np.abs(run.force).max() == pytest.approx(3e5, rel=1e-9)


@pytest.mark.parametrize("elements", [10, 50])
def test_a_clamp_carries_what_friction_leaves_of_a_pull_on_every_mesh(
    elements: int,
) -> None:
    """1800 N pull Table 1's bar, of which friction holds 1500 N up to the clamp."""
    pulled = {"load": [[0.0, 0.0], [1.0, 1800.0]], "instants": 5, "elements": elements}
    run = run_of("bar", **pulled)
    assert largest("left_force", run) == pytest.approx(-300.0, rel=1e-9)
    assert largest("peak_friction", run) == pytest.approx(1500.0, rel=1e-9)


@pytest.mark.parametrize("law", [*LAWS, "general"])
def test_the_force_of_an_end_stays_while_it_stands_still(law: str) -> None:
    path = [[0.0, 0.0], [0.4, 3e-4], [1.0, 3e-4]]
    held = {**MOVED_END, "right_load": path, "instants": 11, "elements": 10}
    run = run_of("bar", **held, **law_of("rod", law))
    np.testing.assert_allclose(run.force[4:], run.force[4], rtol=1e-9)


DRIVEN: dict[str, tuple[str, dict[str, Any]]] = {
    "an end that is moved to and fro": ("bar", MOVED_END | {"right_load": "cycle"}),
    "an end that is moved and stands": ("bar", MOVED_END | {"right_load": "hold"}),
    "an end that is held": ("bar", {"peak": 1700.0, "substructures": 5}),
    "an end whose support settles": ("bar", {"settlement": 1e-4, "right_end": "free"}),
    "a pushed side": ("block", PUSHED | {"left_normal_load": "hold"}),
    "rollers": ("block", PUSHED | {"left": "roller", "top_tangential_traction": 1e6}),
}


@pytest.mark.parametrize("name", DRIVEN)
def test_an_iterate_shares_friction_and_reaction_as_the_reference(name: str) -> None:
    scene, values = DRIVEN[name]
    settings = CATALOGUE[scene].checked(
        {"elements": 10, "instants": 9, **values, "finish": "none"}
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    iterate = next(islice(iterations(problem, method_of(settings)), 200, None))
    size = np.abs(reference.contact_force).max()
    np.testing.assert_allclose(
        iterate.contact_force, reference.contact_force, atol=1e-5 * size
    )
    assert kkt_residual(iterate, problem) < 1e-4
    held = [*problem.held_dofs]
    found = [reaction(problem, side).of(iterate) for side in held]
    known = [reaction(problem, side).of(reference) for side in held]
    np.testing.assert_allclose(found, known, atol=1e-5 * size)


SPRUNG: dict[str, tuple[str, dict[str, Any]]] = {
    "block": ("block", ON_SPRING),
    "incline": ("incline", SMALL["incline"]),
}


def test_a_spring_carries_what_friction_leaves() -> None:
    run = run_of("block", **ON_SPRING)
    weight = 1837.5 * 0.08
    push = 3400.0 * 0.08
    assert largest("spring_force", run) == pytest.approx(push - 0.9 * weight, rel=1e-6)
    assert largest("peak_friction", run) == pytest.approx(0.9 * weight, rel=1e-6)


@pytest.mark.parametrize(("name", "weight"), [("block", 147.0), ("incline", 1000.0)])
def test_a_spring_presses_on_no_surface_and_its_point_does_not_slip(
    name: str, weight: float
) -> None:
    scene, values = SPRUNG[name]
    run = run_of(scene, **values)
    assert largest("peak_pressing", run) == pytest.approx(weight, rel=1e-9)
    slips = np.abs(run.iterate.contact("support").status) == 1
    assert largest("slipped_share", run) == slips.any(axis=1).mean()
    foot = np.abs(run.iterate.contact("support").slip).max()
    assert largest("peak_slip", run) <= foot


def test_key_figures_of_the_page_leave_the_point_of_a_spring_out() -> None:
    run = run_of("incline", **SMALL["incline"])
    sampler = Sampler(run.problem, run.settings, 1)
    frame = sampler.frame(
        run.iterate, run.solution.records, run.solution.status, Needs()
    )
    slips = np.abs(run.iterate.contact("support").status[:, 6]) == 1
    assert f"Slips <b>{percent(slips.mean())}</b>" in figures_line(
        frame, Selection(phase=0.5)
    )


def test_friction_fitted_to_the_closed_form_of_a_moved_end_is_that_of_the_form() -> (
    None
):
    """On a coarse mesh half an element of friction was taken for 6 % of mu."""
    moved = np.linspace(0.0, 3e-4, 21)
    needed = np.sqrt(2.0 * 659_400.0 * 0.1 * 5000.0 * moved)
    measured = MeasuredLoop(moved, needed, None, ("m", "N"), "closed form", "")
    path = [[0.0, 0.0], [1.0, 3e-4]]
    settings = CATALOGUE["bar"].checked(
        {
            "right_end": "held",
            "right_load": path,
            "elements": 25,
            "instants": 21,
            "friction": 0.2,
        }
    )
    found = fit(settings, measured, ["friction"])
    assert found.nearest.values[0] == pytest.approx(0.1, rel=2e-3)
