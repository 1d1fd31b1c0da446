"""A worker shows every scene: the interface that is looked at, the bodies, the wires, the loop."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.recording import Recording
from app.views.axial import Axial
from app.views.convergence import Convergence
from app.views.deformed import Deformed, fitting
from app.views.drawing import Picture, View, held
from app.views.error_time import ErrorTime
from app.views.friction import FrictionForce
from app.views.loop import Loop
from app.views.modes import SpaceModes, TimeFunctions
from app.views.spectra import Spectra
from app.views.status_map import StatusMap
from app.views.tractions import Tractions
from app.words import status_line
from app.worker.meshes import MOST_QUADS, Thinned
from app.worker.orders import Look, Run, Watch
from app.worker.reports import (
    Begun,
    Frame,
    Progress,
    Reference,
    Report,
    Unrivalled,
    Waiting,
)
from app.worker.rivals import References
from app.worker.run import WorkerRun
from app.worker.shown import STATUS_OPEN, Mesh, has_reference
from solver.discrete import discretise
from solver.latin import Iterate
from solver.scenes import CATALOGUE
from solver.scenes.plane import PlaneSettings

SIZES: dict[str, dict[str, Any]] = {
    "bar": {},
    "strand": {"elements": 20, "instants": 21},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 3, "instants": 13},
}
ALL = frozenset({"mesh", "axial", "spectra", "modes"})


class Told:
    """A run that is done at once, with all that it says."""

    def __init__(self, scene: str, changes: dict[str, Any] | None = None, **options: Any) -> None:
        values = {**SIZES[scene], "max_iterations": 8, **(changes or {})}
        self.reports: list[Report] = []
        order = Run(1, scene, values, **{"watch": ALL, **options})
        self.run = WorkerRun(order, self.reports.append, lambda: False, References())
        self.go_on()

    def go_on(self) -> None:
        while self.run.rest() is not None:
            self.run.advance()

    def all(self, kind: type) -> list[Any]:
        return [report for report in self.reports if isinstance(report, kind)]

    @property
    def frame(self) -> Frame:
        frame: Frame = self.all(Frame)[-1]
        return frame

    @property
    def begun(self) -> Begun:
        begun: Begun = self.all(Begun)[-1]
        return begun

    @property
    def iterate(self) -> Iterate:
        assert self.run.last is not None
        return self.run.last


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_scene_runs_with_a_reference_or_without(scene: str) -> None:
    told = Told(scene)
    settings = CATALOGUE[scene].settings.checked(SIZES[scene])
    kinds = [type(report) for report in told.reports]
    rival = Reference if has_reference(settings) else Unrivalled
    assert kinds[:5] == [Begun, Frame, Begun, rival, Progress]
    errors = [entry.error_force for part in told.all(Progress) for entry in part.records]
    assert np.isnan(errors).all() == (rival is Unrivalled)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_fields_are_those_of_the_interface_that_is_looked_at(scene: str) -> None:
    told = Told(scene)
    for name in told.begun.interfaces:
        told.run.obey(Watch(1, ALL, look=Look(interface=name)))
        frame, begun, law = told.frame, told.begun, told.iterate.problem.rubbing[name]
        fields = told.iterate.contact(name)
        lengths = law.by_point(law.weights)[:, None]
        assert frame.interface == begun.interface == name
        assert begun.positions == pytest.approx(law.positions, rel=1e-6)
        assert frame.friction * lengths == pytest.approx(fields.tangential_force, rel=1e-5)
        assert np.array_equal(frame.status, fields.status)
        if fields.normal_force is None:
            assert frame.pressure is None
        else:
            assert frame.pressure * lengths == pytest.approx(fields.normal_force, rel=1e-5)


def test_another_interface_comes_with_what_it_stands_on_first() -> None:
    told = Told("layers")
    count = len(told.reports)
    told.run.obey(Watch(1, ALL, look=Look(interface="contact 2-3")))
    assert [type(report) for report in told.reports[count:]] == [Begun, Reference, Frame]
    told.run.obey(Watch(1, ALL, look=Look(interface="contact 2-3", phase=0.1)))
    assert isinstance(told.reports[-1], Frame)
    assert len(told.reports) == count + 4


def test_a_name_that_no_interface_has_shows_the_first() -> None:
    assert Told("strand", look=Look(interface="support")).frame.interface == "contact 1-2"


def test_a_block_that_lifts_off_is_open_there() -> None:
    status = Told("block", {"max_iterations": 40}).frame.status
    assert (status[[0, -1]] == STATUS_OPEN).all()
    assert (status != STATUS_OPEN).any()


@pytest.mark.parametrize("scene", ["bar", "strand", "block", "layers"])
def test_frames_carry_only_what_is_watched(scene: str) -> None:
    bare = Told(scene, watch=frozenset()).frame
    assert bare.mesh is bare.axial is bare.spectra is bare.bases is None
    full = Told(scene).frame
    assert (full.mesh is not None) == (scene in ("block", "layers"))
    assert (full.axial is not None) == (scene == "strand")
    assert (bare.load is None) == (scene in ("bar", "strand"))


def test_mesh_shows_the_chosen_instant_and_stress() -> None:
    told = Told("block")
    problem = told.iterate.problem
    assert problem.inside is not None
    for phase, instant in ((0.0, 0), (0.5, 6), (1.0, 12)):
        told.run.obey(Watch(1, ALL, look=Look(phase=phase, stress="yy")))
        mesh = told.frame.mesh
        assert mesh is not None
        whole = problem.inside.displacement(told.iterate.displacement, [instant])[:, :, 0]
        assert mesh.instant == instant
        assert mesh.component == "yy"
        assert mesh.displacement == pytest.approx(whole, rel=1e-5, abs=1e-12)
        stress = problem.inside.stress(whole)[:, 1]
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
        area(Mesh(inside.nodes.astype(np.float32), inside.elements.astype(np.int32))), rel=1e-4
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
    told = Told("strand", {"load": "ramp", "max_iterations": 150}, look=Look(phase=1.0))
    wires, axial = told.begun.wires, told.frame.axial
    assert wires is not None
    assert wires.exact is not None
    assert wires.exact_positions is not None
    assert axial is not None
    broken = axial.force[wires.numbers.index(2)]
    exact = np.interp(wires.positions, wires.exact_positions, wires.exact[0, :, -1])
    assert broken == pytest.approx(exact, abs=0.03 * 600.0)
    assert told.all(Begun)[0].wires.exact is None


def test_warm_start_is_left_out_where_fields_cannot_be_carried() -> None:
    before = Told("layers").iterate
    for changes in ({"layers": 4}, {"elements": 12}, {"friction": 0.29}):
        said: list[Report] = []
        values = {**SIZES["layers"], **changes, "max_iterations": 3}
        run = WorkerRun(
            Run(1, "layers", values, warm=True), said.append, lambda: False, References(), before
        )
        while run.rest() is not None:
            run.advance()
        begun = said[0]
        assert isinstance(begun, Begun)
        assert (begun.start is not None) == ("friction" in changes)


@pytest.mark.parametrize("scene", list(CATALOGUE))
@pytest.mark.parametrize("stage", ["full", "pgd"])
def test_views_that_apply_draw_every_scene(scene: str, stage: str) -> None:
    told = Told(scene, {"linear_stage": stage})
    recording = Recording(1, told.run._settings, "")
    for report in told.reports:
        if not isinstance(report, Waiting):
            recording.take(report)
    views: list[View] = [
        FrictionForce(),
        Deformed(lambda: None),
        Tractions(),
        Axial(),
        StatusMap(lambda time: None),
        Loop(),
        Convergence(),
        Spectra(),
        ErrorTime(),
        SpaceModes(),
        TimeFunctions(),
    ]
    before = replace(recording)
    picture = Picture(recording, before, (before,), recording.newest, 3)
    applying = [view for view in views if view.applies(recording.settings)]
    for view in applying:
        view.draw(picture)
        view.draw(picture)
    names = {view.name for view in applying}
    assert ("Deformed bodies" in names) == ("Contact tractions" in names)
    assert ("Friction force" in names) != ("Contact tractions" in names)
    assert ("Force in the wires" in names) == (scene == "strand")


def test_a_run_without_a_reference_says_nothing_of_errors() -> None:
    for layers, known in ((3, True), (20, False)):
        told = Told("layers", {"layers": layers, "elements": 48, "max_iterations": 2})
        recording = Recording(1, told.run._settings, "")
        for report in told.reports:
            recording.take(report)
        assert ("error" in status_line(recording, True, None)) == known


def test_a_recording_forgets_the_fields_of_another_interface() -> None:
    told = Told("layers")
    recording = Recording(1, told.run._settings, "")
    for report in told.reports:
        recording.take(report)
    assert recording.newest is not None
    told.run.obey(Watch(1, ALL, look=Look(interface="contact 2-3")))
    recording.take(told.begun)
    assert recording.newest is None
    recording.take(told.frame)
    assert recording.newest is not None


def test_magnification_shows_the_displacement_and_holds_while_it_does() -> None:
    mesh = Mesh(np.array([[0.0, 0.0], [0.5, 0.1]], dtype=np.float32), np.zeros((0, 4), np.int32))
    assert fitting(mesh, 1e-5) == 2000.0
    assert fitting(mesh, 1.3e-5, 2000.0) == 2000.0
    assert fitting(mesh, 1e-2, 2000.0) == 2.0
    assert fitting(mesh, 0.0, 20.0) == 20.0


def test_limits_hold_as_long_as_they_suit() -> None:
    limits = held(None, 0.0, 91.0)
    assert limits == (0.0, 110.0)
    assert held(limits, 0.0, 109.0) == limits
    assert held(limits, 0.0, 111.0) != limits
    assert held(limits, 0.0, 60.0) != limits
    assert held(limits, np.nan, 1.0) == limits
