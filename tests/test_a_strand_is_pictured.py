"""A strand that is bent is seen from the side and in its cross-section, as its wires are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shown_pages import SMALL, Shown

from app.picture.helices import HelixGeometry
from app.views.bodies import axial, picture, section
from app.views.catalogue import fitting
from app.views.drawing.drawing import Drawing
from app.views.interface import unrolled
from app.views.load import loop
from app.views.scene import Scene
from app.worker.key_figures import thing
from app.worker.telling import told
from solver.discrete.rope.forces import WireForces, cut_at
from solver.discrete.rope.rope import Rope
from solver.scenes import CATALOGUE, structure_of

WAYS = [
    {},
    {"bending": "uniform"},
    {"layers": 2, "length": 0.3, "curvature": 0.2},
    {"bending": "uniform", "layers": 2},
    {"bending": "uniform", "construction": "conductor", "tension": 3e4},
]


def looked_at(**changes: Any) -> Scene:
    shown = Shown()
    shown.run(1, "rope", {**SMALL["rope"], "substructures": 1, "finish": "at-once", **changes})
    return shown.scene(instant=3)


def strand_of(scene: Scene) -> Rope:
    found = structure_of(scene.run.settings)
    assert isinstance(found, Rope)
    return found


def drawn(scene: Scene, view: Any) -> Drawing:
    found = view(scene, None)
    assert isinstance(found, Drawing)
    return found


def status_of(scene: Scene) -> Any:
    rope = strand_of(scene)
    column = scene.frame.sampler._column(scene.look)
    return scene.frame.iterate.status[:, column].reshape(len(rope.wires), -1)


@pytest.mark.parametrize("changes", WAYS)
def test_wires_in_front_cover_the_strand_once(changes: dict[str, Any]) -> None:
    settings = CATALOGUE["rope"].settings.checked({**SMALL["rope"], **changes})
    rope = structure_of(settings)
    assert isinstance(rope, Rope)
    mesh = HelixGeometry(rope).portrait.mesh
    x, y = np.moveaxis(mesh.nodes[mesh.quads].astype(float), -1, 0)
    around = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    area = 0.5 * np.abs(around.sum(axis=1)).sum()
    assert area == pytest.approx(rope.seen_length * rope.section.diameter, rel=1e-3)
    assert (mesh.nodes[:, 1].min(), mesh.nodes[:, 1].max()) == pytest.approx(
        (0.0, rope.section.diameter)
    )


def test_the_strand_is_drawn_as_its_curvature_bends_it() -> None:
    scene = looked_at(elements=200)
    rope, settings = strand_of(scene), scene.run.settings
    nodes, pose = scene.run.stand.portrait.mesh.nodes, scene.frame.pose
    far, length = settings.falls_off(), rope.seen_length
    column = scene.frame.sampler._column(scene.look)
    up = rope.curvature[column] * far * (length - far * (1.0 - np.exp(-length / far)))
    at_end = np.abs(nodes[:, 0] - length) < 1e-6
    assert pose.displacement[at_end, 1] == pytest.approx(up, rel=5e-3)
    assert not pose.displacement[nodes[:, 0] == 0.0].any()


def test_bent_alike_all_along_it_is_part_of_a_circle() -> None:
    scene = looked_at(bending="uniform")
    rope, pose = strand_of(scene), scene.frame.pose
    x = scene.run.stand.portrait.mesh.nodes[:, 0] - 0.5 * rope.seen_length
    curvature = rope.curvature[scene.frame.sampler._column(scene.look)]
    assert pose.displacement[:, 1] == pytest.approx(0.5 * curvature * x**2, abs=2e-3 * pose.largest)


@pytest.mark.parametrize("changes", WAYS)
def test_what_slips_in_front_has_the_colour_of_its_way(changes: dict[str, Any]) -> None:
    scene = looked_at(**changes)
    colors, rope = scene.frame.pose.colors, strand_of(scene)
    assert colors is not None
    outer = max(wire.layer for wire in rope.wires)
    own = [wire.layer == outer for wire in rope.wires]
    status = status_of(scene)[own]
    assert set(np.abs(colors)) <= set(np.abs(status).ravel())
    assert bool(colors.any()) == bool(status.any())
    values = drawn(scene, picture.draw).bodies
    assert values is not None
    assert np.array_equal(values.values - 65.5, colors)


@pytest.mark.parametrize("place", [None, 0.04])
@pytest.mark.parametrize("changes", WAYS)
def test_a_section_shows_its_wires_as_the_engine_cuts_them(
    changes: dict[str, Any], place: float | None
) -> None:
    scene = looked_at(elements=60, **changes)
    frame = replace(scene.frame, look=replace(scene.look, place=place))
    rope, iterate = strand_of(scene), frame.iterate
    column = scene.frame.sampler._column(scene.look)
    cut = cut_at(rope, place or 0.0)
    force = WireForces(rope)(iterate.displacement, slice(column, column + 1))
    shown = frame.strand
    assert shown is not None
    assert np.array_equal(shown.layers, cut.layer)
    stress = WireForces(rope).stress_at(cut, force)[:, 0]
    assert shown.stress == pytest.approx(stress, rel=1e-6)
    # The outermost fibre is drawn below.
    assert shown.centres == pytest.approx(cut.centres * (1.0, -1.0), rel=1e-6, abs=1e-9)


def test_a_section_rings_what_slips_and_takes_taps() -> None:
    scene = looked_at()
    field, drawing = scene.frame.strand, drawn(scene, section.draw)
    assert field is not None
    assert drawing.bodies is not None
    assert len(drawing.bodies.values) == len(field.wires) + 1 == 7
    for status, color, _ in section.WAYS:
        rings = next(one for one in drawing.curves if one.color == color)
        count = np.count_nonzero(np.isnan(np.asarray(rings.x)))
        assert count == np.count_nonzero(field.slips == status)
    assert list(drawing.contacts) == list(scene.run.stand.interfaces)


@pytest.mark.parametrize("changes", WAYS)
def test_all_wires_are_seen_side_by_side(changes: dict[str, Any]) -> None:
    scene = looked_at(**changes)
    drawing = drawn(scene, unrolled.draw)
    assert drawing.image is not None
    assert np.array_equal(drawing.image.values, status_of(scene) + 1)
    number = scene.run.stand.interfaces.index(scene.run.stand.interface)
    shown = scene.frame.fields.status[:, scene.frame.sampler._column(scene.look)]
    assert np.array_equal(drawing.image.values[number], shown + 1)


@pytest.mark.parametrize("bending", ["uniform", "clamp"])
def test_the_closed_form_stands_where_it_is_known(bending: str) -> None:
    scene = looked_at(bending=bending, elements=40)
    drawing = drawn(scene, loop.draw)
    exact = scene.run.stand.known("loop")
    texts = [key.text for key in drawing.keys]
    assert ("closed form" in texts) == (bending == "uniform") == bool(exact)
    assert {"all stick", "all slip"} <= set(texts)
    moment = scene.frame.fields.load
    assert moment is not None
    for one in exact:
        assert one.up == pytest.approx(moment, abs=0.01 * float(np.abs(moment).max()))


def test_slip_keeps_the_force_of_a_wire_from_what_it_would_be() -> None:
    scene = looked_at(bending="uniform", curvature=0.3)
    drawing = drawn(scene, axial.draw)
    stuck, real = (np.asarray(one.y) for one in drawing.curves)
    assert np.ptp(real) < 0.8 * np.ptp(stuck)
    still = drawn(looked_at(bending="uniform", curvature=1e-3), axial.draw)
    stuck, real = (np.asarray(one.y) for one in still.curves)
    assert real == pytest.approx(stuck, rel=1e-5)


def test_key_figures_say_how_stiff_it_is() -> None:
    stuck = looked_at(bending="uniform", curvature=1e-3)
    assert float(thing(stuck.run, stuck.frame)["Bending stiffness"].split()[0]) > 97.0
    bent = looked_at(bending="uniform", curvature=0.3)
    said = thing(bent.run, bent.frame)
    assert float(said["Bending stiffness"].split()[0]) < 50.0
    assert said["Stress range"].endswith("MPa")


@pytest.mark.parametrize("changes", [*WAYS, {"curvature": 0.0}, {"layers": 5, "elements": 6}])
def test_every_plot_says_what_it_shows(changes: dict[str, Any]) -> None:
    scene = looked_at(**changes)
    for view in fitting(scene.run.settings):
        drawing = view.draw(scene, None)
        if drawing is not None and view.name != "Modes":
            assert str(told(view, drawing)), view.name
