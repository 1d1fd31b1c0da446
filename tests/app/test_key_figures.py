"""Key figures of the page are those of the run, however many instants and points."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from app.frame import Frame, Selection
from app.messages import Needs, Start
from app.state import default_settings
from app.status import ON_ITS_WAY, figures_line
from app.units import percent
from app.worker.geometry import MOST_POINTS
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from app.worker.sampling import MOST_INSTANTS, Sampler
from solver.discrete.rope.wire_forces import wire_stresses
from solver.files.amounts import number
from solver.scenes import CATALOGUE
from solver.study.quantities.finished import FinishedRun, figures_of
from solver.study.scene_run import finished_run


def shown(scene: str, needs: Needs, **values: Any) -> tuple[FinishedRun, Frame]:
    """A run, and its frame on the page."""
    settings = CATALOGUE[scene].checked(values)
    run = finished_run(settings, errors=False, indicators=False)
    sampler = Sampler(run.problem, settings, 1)
    history = run.solution.records
    frame = sampler.frame(run.iterate, history, run.solution.status, needs)
    return run, frame


PEAK = [[0.3, 200.0], [0.3016, 900.0], [0.303, -700.0], [0.31, 0.0]]
NARROW: dict[str, Any] = {"instants": 1001, "load": [[0.0, 0.0], *PEAK, [1.0, 0.0]]}
BETWEEN: dict[str, Any] = {"instants": 701, "friction": 0.0, "body_force": 2000.0}
"""A peak of a load between the instants that are shown by their number alone, and one
of a displacement by two loads, where neither of them turns."""


@pytest.mark.parametrize("values", [NARROW, BETWEEN])
def test_a_peak_between_the_instants_that_are_shown_is_told(
    values: dict[str, Any],
) -> None:
    run, frame = shown("bar", Needs(), elements=6, substructures=1, **values)
    count = len(frame.run.instants)
    assert count < 1.5 * MOST_INSTANTS
    assert count < run.problem.n_instants
    for told, whole in zip(frame.extremes, figures_of(run), strict=True):
        instants = run.problem.instants
        assert told == (whole.largest, instants[whole.instant], whole.last)
    line = figures_line(frame, Selection())
    assert "largest 900 N" in line


def test_the_narrow_peak_of_a_load_is_drawn() -> None:
    run, frame = shown("bar", Needs(), elements=6, substructures=1, **NARROW)
    force = figures_of(run)[1]
    assert frame.loop[1].max() == pytest.approx(force.largest, rel=1e-6)


def test_the_share_that_slips_is_of_all_points_and_not_of_those_that_are_drawn() -> (
    None
):
    run, frame = shown("bar", Needs(), elements=300, substructures=1, instants=11)
    assert len(frame.run.geometry.points) <= MOST_POINTS < run.iterate.status.shape[0]
    slips = np.mean(np.abs(run.iterate.status) == 1, axis=0)
    assert frame.slips == pytest.approx(slips, rel=1e-6)
    line = figures_line(frame, Selection(phase=0.2))
    assert f"Slips <b>{percent(float(slips[2]))}</b>" in line


def test_a_wire_that_stands_for_its_layer_counts_as_often_in_the_share() -> None:
    values = {"construction": "conductor", "bending": "uniform", "load": "ramp"}
    sizes = {"elements": 20, "instants": 7, "substructures": 1}
    run, frame = shown("rope", Needs(), curvature=0.02, tension=3e4, **values, **sizes)
    wires = run.settings.structure().wires
    slips = np.abs(run.iterate.status.reshape(len(wires), -1, 7)) == 1
    shares = slips.mean(axis=1)
    turns = [wire.stands_for / wire.along[-1] for wire in wires]
    assert np.ptp(shares[:, 3]) > 0.1
    counted = np.average(shares, axis=0, weights=turns)
    assert frame.slips == pytest.approx(counted, rel=1e-6)


def test_the_stress_of_a_bent_wire_is_drawn_where_it_is() -> None:
    """Stress was drawn half an element too near to the clamp, that there nowhere."""
    needs = Needs(extras=frozenset({"stress"}))
    sizes = {"elements": 6, "instants": 5, "substructures": 1, "layers": 1}
    run, frame = shown("rope", needs, length=0.15, tension=4e4, **sizes)
    rope = run.settings.structure()
    stress = wire_stresses(rope, run.iterate.displacement, slice(None))
    geometry = frame.run.geometry
    middles = geometry.nodes[geometry.cells, 0].mean(axis=1)
    elements = np.floor(middles / (0.15 / 6)).astype(int)
    assert set(elements) == set(range(6))
    _, _, drawn = frame.extras["stress"]
    assert drawn == pytest.approx(stress[geometry.parts, elements], rel=1e-5)


def test_an_iterate_on_its_way_says_why_a_moved_side_is_elsewhere() -> None:
    """Beside u = -41.6 um in its picture an arch had a movement of -66.5 um."""
    for scene, is_moved in (("block", True), ("bar", False)):
        start = Start(1, default_settings(scene), math.inf)
        runner = Runner(start, ReferenceCache(), lambda: False)
        runner.advance()
        line = figures_line(runner.frame(Needs()), Selection())
        assert (ON_ITS_WAY in line) is is_moved
    _, frame = shown("block", Needs(), instants=9, elements=6, substructures=1)
    assert ON_ITS_WAY not in figures_line(frame, Selection())


def test_energy_dissipated_is_that_up_to_the_instant_of_its_figures() -> None:
    run, frame = shown("bar", Needs(), instants=9)
    heat = np.cumsum(run.dissipated)
    assert 0.0 == heat[0] < heat[2] < heat[-1]
    assert frame.energy == pytest.approx(heat, rel=1e-6)
    for phase, energy in ((0.0, 0.0), (0.25, heat[2]), (1.0, heat[-1])):
        line = figures_line(frame, Selection(phase=phase))
        assert f"Energy dissipated <b>{number(1e3 * energy)} mJ</b>" in line
        assert f"At the end: {number(1e3 * heat[-1])} mJ." in line


def test_the_widest_line_of_thrust_is_the_largest_force_of_any_instant() -> None:
    arch = {"voussoirs": 5, "elements": 2, "live": 3000.0}
    moves: dict[str, Any] = {
        "place_load": [[0, 0], [1, 1]],
        "live_load": [[0, 1], [1, 1]],
        "instants": 451,
    }
    needs = Needs(extras=frozenset({"thrust"}))
    run, frame = shown("arch", needs, **arch, **moves)
    assert len(frame.run.instants) < run.problem.n_instants
    thrust = frame.extras["thrust"]
    sizes = []
    for name in run.problem.contacts:
        fields = run.iterate.contact(name)
        assert fields.normal_force is not None
        along = fields.tangential_force.sum(axis=0)
        sizes.append(np.hypot(fields.normal_force.sum(axis=0), along))
    assert thrust["largest"] == pytest.approx(np.max(sizes), rel=1e-9)
    assert thrust["largest"] >= thrust["forces"].max() * (1.0 - 1e-6)
