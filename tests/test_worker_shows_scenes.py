"""A worker shows every scene: the interface that is looked at, the bodies, the wires, the loop."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from ropes import SMALL_ROPE
from shown_pages import ALL, Shown

from app.picture.frames import DrawnFields
from app.picture.meshes import MOST_QUADS, Thinned
from app.picture.sampler import Sampler
from app.picture.shown import STATUS_OPEN, Look, Mesh, has_reference
from app.views.bodies.deformed import fitting
from app.views.drawing.scales import held
from app.wire.orders import Watch
from solver.scenes import CATALOGUE, discretise, kind_of
from solver.scenes.plane import PlaneSettings

SIZES: dict[str, dict[str, Any]] = {
    "bar": {},
    "strand": {"elements": 20, "instants": 21},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 3, "instants": 13},
    "fault": {"elements": 16, "elements_up": 8, "instants": 13},
    "incline": {"elements": 12, "elements_up": 6, "instants": 13},
    "rope": {**SMALL_ROPE, "elements": 10, "instants": 13},
}


def told(scene: str, changes: dict[str, Any] | None = None, look: Look = ALL) -> Shown:
    """Do a short run of a scene, and show it."""
    shown = Shown(look)
    shown.run(1, scene, {**SIZES[scene], "max_iterations": 8, **(changes or {})})
    return shown


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_scene_runs_with_a_reference_or_without(scene: str) -> None:
    recording = told(scene).recording
    has_one = has_reference(CATALOGUE[scene].settings.checked(SIZES[scene]))
    assert (recording.reference is not None) == has_one
    assert np.isnan(recording.history.column("error_force")).all() != has_one


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_fields_are_those_of_the_interface_that_is_looked_at(scene: str) -> None:
    shown = told(scene)
    iterate = shown.at_work.last
    assert iterate is not None
    for name in shown.recording.stand.interfaces:
        look = replace(ALL, interface=name)
        shown.obey(Watch(look))
        frame, stand = shown.frame(look).fields, shown.recording.stand
        law = iterate.problem.rubbing[name]
        fields = iterate.contact(name)
        lengths = law.by_point(law.weights)[:, None]
        assert frame.interface == stand.interface == shown.pictures[-1].facts.interface == name
        assert stand.positions == pytest.approx(law.positions, rel=1e-6)
        assert frame.friction * lengths == pytest.approx(fields.tangential_force, rel=1e-5)
        assert np.array_equal(frame.status, fields.status)
        if fields.normal_force is None:
            assert frame.pressure is None
        else:
            assert frame.pressure * lengths == pytest.approx(fields.normal_force, rel=1e-5)


def test_a_name_that_no_interface_has_shows_the_first() -> None:
    shown = told("strand", look=replace(ALL, interface="support"))
    assert shown.pictures[-1].facts.interface == "contact 1-2"


def test_a_block_that_lifts_off_is_open_there() -> None:
    status = told("block", {"max_iterations": 40}).frame().fields.status
    assert (status[[0, -1]] == STATUS_OPEN).all()
    assert (status != STATUS_OPEN).any()


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_what_few_views_show_is_computed_when_one_looks(
    scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    frame, asked = told(scene).frame(), []
    assert not {"mesh", "axial", "spectra", "bases"} & set(vars(frame))
    assert (frame.mesh is not None) == (kind_of(CATALOGUE[scene].settings()) == "plane")
    assert (frame.axial is not None) == (scene == "strand")
    assert (frame.fields.load is None) == (scene in ("bar", "strand"))
    monkeypatch.setattr("app.picture.spectra.friction_spectra", asked.append)
    monkeypatch.setattr(Sampler, "axial", lambda *given: asked.append(given))
    monkeypatch.setattr(Sampler, "mesh_field", lambda *given: asked.append(given))
    told(scene, look=Look(views=("Stick and slip", "Convergence")))
    assert asked == []


def test_a_run_before_keeps_its_fields_without_its_problem() -> None:
    shown = told("bar")
    shown.run(2, "bar", SIZES["bar"])
    before = shown.scene().before
    assert before is not None
    assert type(before.frame) is DrawnFields


def test_mesh_shows_the_chosen_instant_and_stress() -> None:
    shown = told("block")
    iterate = shown.at_work.last
    assert iterate is not None
    assert iterate.problem.inside is not None
    last = iterate.problem.n_instants - 1
    for phase, instant in ((0.0, 0), (0.5, round(0.5 * last)), (1.0, last)):
        mesh = shown.frame(replace(ALL, phase=phase, stress="yy")).mesh
        assert mesh is not None
        whole = iterate.problem.inside.displacement(iterate.displacement, [instant])[:, :, 0]
        assert mesh.displacement == pytest.approx(whole, rel=1e-5, abs=1e-12)
        stress = iterate.problem.inside.stress(whole)[:, 1]
        assert np.sort(mesh.stress) == pytest.approx(np.sort(stress), rel=1e-4, abs=1.0)


@pytest.mark.parametrize(("scene", "columns", "rows"), [("block", 90, 50), ("layers", 300, 4)])
def test_thinned_mesh_covers_the_bodies_and_keeps_the_mean_stress(
    scene: str, columns: int, rows: int
) -> None:
    values = {"elements": columns, "elements_up": rows, "instants": 2, "substructures": 10}
    settings = CATALOGUE[scene].settings.checked(values)
    assert isinstance(settings, PlaneSettings)
    inside = discretise(settings).inside
    assert inside is not None
    thin = Thinned(inside, settings)
    assert len(thin.mesh.quads) <= MOST_QUADS
    assert area(thin.mesh) == pytest.approx(
        area(Mesh(inside.nodes.astype(np.float32), inside.elements.astype(np.int32), inside.parts)),
        rel=1e-4,
    )
    assert thin._counts.sum() == len(inside.elements)
    assert thin._counts.min() > 0
    centres = inside.nodes[inside.elements].mean(axis=1)
    corners = thin.mesh.nodes[thin.mesh.quads][thin._quad]
    margin = 1e-6
    assert (corners.min(axis=1) <= centres + margin).all()
    assert (centres <= corners.max(axis=1) + margin).all()


def area(mesh: Mesh) -> float:
    corners = mesh.nodes[mesh.quads].astype(float)
    sides = corners[:, 2] - corners[:, 0]
    return float(np.abs(sides.prod(axis=1)).sum())


def test_broken_wire_is_shown_beside_its_closed_form() -> None:
    look = replace(ALL, phase=1.0)
    shown = told("strand", {"load": "ramp", "max_iterations": 150}, look)
    wires, axial = shown.recording.stand.wires, shown.frame(look).axial
    assert wires is not None
    assert axial is not None
    broken = axial[wires.numbers.index(2)]
    known, _ = shown.recording.stand.known("axial force")
    exact = np.interp(wires.positions, known.across, known.up[:, -1])
    assert broken == pytest.approx(exact, abs=0.03 * 600.0)


@pytest.mark.parametrize(
    ("change", "carried"), [({"layers": 4}, False), ({"elements": 12}, False), ({}, True)]
)
def test_warm_start_is_left_out_where_fields_cannot_be_carried(
    change: dict[str, Any], carried: bool
) -> None:
    shown = told("layers")
    values = {**SIZES["layers"], "friction": 0.29, **change, "max_iterations": 3}
    shown.run(2, "layers", values, warm=True)
    assert (shown.recording.choice is not None) == carried


@pytest.mark.parametrize(("layers", "known"), [(3, True), (20, False)])
def test_a_run_without_a_reference_says_nothing_of_errors(layers: int, known: bool) -> None:
    shown = told("layers", {"layers": layers, "elements": 48, "max_iterations": 2})
    assert ("friction force error" in shown.words) == known


def test_magnification_shows_the_displacement_and_holds_while_it_does() -> None:
    size = 0.5
    assert fitting(size, 1e-5) == 2000.0
    assert fitting(size, 1.3e-5, 2000.0) == 2000.0
    assert fitting(size, 1e-2, 2000.0) == 2.0
    assert fitting(size, 0.0, 20.0) == 20.0


def test_limits_hold_as_long_as_they_suit() -> None:
    limits = held(None, 0.0, 91.0)
    assert limits == (0.0, 110.0)
    assert held(limits, 0.0, 109.0) == limits
    assert held(limits, 0.0, 111.0) != limits
    assert held(limits, 0.0, 60.0) != limits
    assert held(limits, np.nan, 1.0) == limits
