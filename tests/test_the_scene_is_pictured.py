"""The picture of a scene shows what holds it, what acts on it now, and where it slips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shown_pages import ALL, SMALL, Shown
from test_views_say_what_they_draw import looked_at

from app.views.bodies import picture
from app.views.bodies.acting import ARROW
from app.views.drawing import sketch
from app.views.drawing.colors import BACKWARD, FORCE, FORWARD, GIVEN
from app.views.drawing.drawing import Curve, Drawing
from app.views.load import load_path
from app.views.scene import Scene
from solver.scenes import CATALOGUE, structure_of
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings

LENGTH = BarSettings.checked({}).length


def pictured(scene: Scene) -> Drawing:
    return picture.draw(scene, None)


def of_color(drawing: Drawing, color: str) -> list[Curve]:
    return [curve for curve in drawing.curves if curve.color == color]


def says(drawing: Drawing) -> dict[str, str]:
    """Give the values that stand in a picture, by what they are called."""
    return dict(word.text.split(" = ") for word in drawing.words)


@pytest.mark.parametrize("scene", ["bar", "block"])
def test_slip_is_drawn_below_the_body_that_slips(scene: str) -> None:
    drawing = pictured(looked_at(scene))
    bands = of_color(drawing, BACKWARD) + of_color(drawing, FORWARD)
    assert np.isfinite(np.concatenate([np.asarray(one.x) for one in bands])).any()
    assert all(float(np.max(one.dy)) < -0.5 * one.width for one in bands)


def test_slip_of_wires_is_drawn_between_them() -> None:
    drawing = pictured(looked_at("strand"))
    assert drawing.bodies is not None
    heights = np.unique(drawing.bodies.places[:, 1])
    bands = of_color(drawing, BACKWARD) + of_color(drawing, FORWARD)
    found = np.concatenate([np.asarray(one.y) for one in bands])
    found = found[np.isfinite(found)]
    assert len(found)
    assert np.all(np.searchsorted(heights, found) % 2 == 0)


def test_a_picture_keeps_its_scale_while_a_slider_is_dragged() -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    first = pictured(shown.scene())
    shown.run(2, "bar", {**SMALL["bar"], "peak": 90.0}, follows_hand=True)
    dragged = picture.draw(shown.scene(replace(ALL, is_held=True)), first.kept)
    shown.run(3, "bar", {**SMALL["bar"], "peak": 90.0})
    let_go = picture.draw(shown.scene(), dragged.kept)
    assert dragged.kept == first.kept
    assert dragged.bodies is not None
    assert first.bodies is not None
    assert dragged.bodies.box == first.bodies.box
    assert let_go.kept.factor > 2.0 * first.kept.factor


def test_a_hand_that_pulls_farther_than_there_is_room_has_more() -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    first = pictured(shown.scene())
    shown.run(2, "bar", {**SMALL["bar"], "peak": 9000.0}, follows_hand=True)
    drawing = picture.draw(shown.scene(replace(ALL, is_held=True)), first.kept)
    assert drawing.kept.factor == first.kept.factor
    assert drawing.kept.reach > first.kept.reach


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_substructure_has_a_colour_of_its_own(scene: str) -> None:
    shown = looked_at(scene)
    drawing = pictured(shown)
    assert drawing.bodies is not None
    if shown.run.stand.strand is not None:
        # Wires are seen from outside, and coloured by what slips.
        assert not any(float(value).is_integer() for value in set(drawing.bodies.values))
        return
    assert set(drawing.bodies.values) == set(range(shown.run.settings.n_substructures))


@pytest.mark.parametrize("instant", [5, 15])
def test_the_load_arrow_follows_the_load_and_says_its_value(instant: int) -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    scene = shown.scene(instant=instant)
    load = float(scene.run.stand.portrait.described.acts[0].values[instant])
    drawing = pictured(scene)
    assert abs(load) == pytest.approx(900.0)
    assert says(drawing)["F"] == f"{load:.3g} N".replace("-", "−")
    arrow = of_color(drawing, FORCE)[0]
    tail, head = np.asarray(arrow.dx)[:2]
    assert head - tail == pytest.approx(ARROW * load / 900.0, rel=1e-6)
    assert np.asarray(arrow.x)[0] > 0.9 * LENGTH
    assert min(tail, head) >= 0.0


def test_an_unloaded_instant_has_no_arrow_but_its_value() -> None:
    shown = Shown()
    shown.run(1, "bar", {**SMALL["bar"], "pressure": 0.0})
    drawing = pictured(shown.scene(instant=0))
    assert says(drawing) == {"F": "0 N"}
    assert np.isnan(np.asarray(of_color(drawing, FORCE)[0].x)).all()


def test_slip_is_marked_where_the_status_says_so() -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    scene = shown.scene(instant=3)
    status = scene.frame.iterate.status[:, scene.frame.sampler._column(ALL)]
    assert set(status) == {-1, 0}
    drawing = pictured(scene)
    (slips,) = of_color(drawing, BACKWARD)
    slipping = scene.run.stand.positions[status == -1]
    assert np.nanmin(slips.x) == pytest.approx(slipping[0], abs=0.6 * LENGTH / 20)
    assert np.isnan(np.asarray(of_color(drawing, FORWARD)[0].x)).all()


def test_a_gap_in_the_support_is_seen() -> None:
    whole, gap = (
        len(np.asarray(pictured(looked_at("bar", {"pressure_profile": profile})).curves[2].x))
        for profile in ("uniform", "gap")
    )
    assert gap < whole


def test_a_slope_is_drawn_as_steep_as_it_is_and_the_weight_points_down() -> None:
    scene = looked_at("incline")
    tilt = scene.run.stand.portrait.described.tilt
    assert tilt is not None
    angle = float(tilt[scene.instant])
    assert angle > 0.1
    drawing = pictured(scene)
    assert drawing.bodies is not None
    mesh = scene.run.stand.portrait.mesh
    first, last = drawing.bodies.places[[0, np.argmax(mesh.nodes @ [1.0, -10.0])]]
    assert np.arctan2(*(last - first)[::-1]) == pytest.approx(angle, abs=0.02)
    arrow = of_color(drawing, FORCE)[0]
    assert np.asarray(arrow.dx)[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert np.asarray(arrow.dy)[:2] == pytest.approx([0.0, -ARROW])
    assert says(drawing) == {"W": "1 kN"}


def test_displacements_are_magnified_as_one_chooses() -> None:
    scene = looked_at("bar")
    fitted, chosen = (
        pictured(Scene(**{**vars(scene), "look": look}))
        for look in (ALL, type(ALL)(views=ALL.views, magnification=1000.0))
    )
    mesh = scene.run.stand.portrait.mesh
    assert fitted.bodies is not None
    assert chosen.bodies is not None
    moved = [drawing.bodies.places[:, 0] - mesh.nodes[:, 0] for drawing in (fitted, chosen)]
    assert moved[1] == pytest.approx(moved[0] * 1000.0 / fitted.kept.factor, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(
    ("values", "unit", "symbols"),
    [
        ({"top": "displacement"}, {"m"}, {"u_x", "u_y"}),
        ({"top": "traction", "top_normal_traction": -1e6}, {"Pa"}, {"σ"}),
        ({"left": "clamped", "body_force_y": -1e4, "top": "free"}, {"N"}, {"W"}),
    ],
)
def test_what_acts_has_its_unit_and_its_symbol(
    values: dict[str, Any], unit: set[str], symbols: set[str]
) -> None:
    settings = BlockSettings.checked({**SMALL["block"], "gap": "flat", **values})
    acts = structure_of(settings).described().acts
    assert {act.unit for act in acts} == unit
    assert {act.symbol for act in acts} == symbols


@pytest.mark.parametrize(
    ("kind", "how"),
    [("clamped", {"clamp"}), ("roller", {"rollers"}), ("free", set()), ("traction", set())],
)
def test_sides_are_held_as_they_say(kind: str, how: set[str]) -> None:
    settings = BlockSettings.checked({**SMALL["block"], "left": kind})
    holds = structure_of(settings).described().holds
    assert {hold.kind for hold in holds if hold.side == "left"} == how


def test_a_hatch_lies_behind_its_edge() -> None:
    edge = sketch.line([(0.0, 0.0), (1.0, 0.0)])
    below, above = (sketch.hatched(edge, 5, behind) for behind in (-1.0, 1.0))
    assert np.nanmin(below[:, 3]) == pytest.approx(-sketch.DEPTH)
    assert np.nanmax(below[:, 3]) == 0.0
    assert np.nanmax(above[:, 3]) == pytest.approx(sketch.DEPTH)


def marks(drawing: Drawing | None) -> Sequence[Any]:
    assert drawing is not None
    return drawing.marks


def test_the_load_path_shows_the_chosen_instant_on_the_load() -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    scene = shown.scene(instant=5)
    drawing = load_path.draw(scene, None)
    assert drawing is not None
    (mark,) = marks(drawing)
    assert list(mark.x) == pytest.approx([0.25])
    assert list(mark.y) == pytest.approx([900.0])
    assert [key.text for key in drawing.keys] == ["F, 900 N"] or [
        key.text for key in drawing.keys
    ] == ["F, 900 N"]


def test_loads_of_several_units_are_drawn_as_shares_of_their_largest_values() -> None:
    drawing = load_path.draw(looked_at("bar", {"support_displacement": 1e-4}), None)
    assert drawing is not None
    assert {key.text.split(",")[0] for key in drawing.keys} == {"F", "u"}
    assert drawing.y is not None
    assert drawing.y.label == "Load (of peak)"
    assert drawing.y.high < 1.5
    assert of_color(drawing, GIVEN) == []
