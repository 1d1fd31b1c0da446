"""The picture of a scene has handles of the settings behind it, and knows what a tap means."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shown_pages import SMALL
from test_views_say_what_they_draw import looked_at

from app.picture.units import BY_SIZE
from app.shell.gallery import gallery
from app.views.bodies import picture
from app.views.catalogue import fitting
from app.views.drawing.colors import FORCE, GIVEN
from app.views.drawing.drawing import POSITION
from app.worker.painter import marked
from solver.definitions import SettingError
from solver.discrete.structure import Act
from solver.scenes import CATALOGUE, behind, structure_of
from solver.scenes.sides import LOADED_SIDES, PRESCRIBED
from solver.settings import Settings

PUSHED = {"left": "traction", "left_normal_traction": -1e6, "left_tangential_traction": 1e5}
CASES: list[tuple[str, dict[str, Any]]] = [
    *((scene, {}) for scene in CATALOGUE),
    ("bar", {"support_displacement": 1e-4, "body_force": 500.0}),
    ("strand", {"grip": "displacement"}),
    ("block", {"gap": "flat", "body_force_y": -1e5, **PUSHED}),
    ("block", {"top": "pushed", "top_tangential_traction": 1e4, "body_force_x": 1e3}),
    ("layers", {"pull": 1e6}),
    ("layers", {"bending": "moment", "pull": 1e6}),
]


def settings_of(scene: str, changes: dict[str, Any]) -> Settings:
    return CATALOGUE[scene].settings.checked({**SMALL[scene], **changes})


def acts_of(settings: Settings) -> list[tuple[Act, str]]:
    """Give what acts, each with the name of the setting behind it, if any."""
    names = behind(settings)
    return [(act, names.get(act.where, "")) for act in structure_of(settings).described().acts]


def larger(settings: Settings, name: str) -> Settings:
    """Give a setting a larger value, or where that is refused a smaller one."""
    value = float(settings.values()[name])
    try:
        return settings.replace(**{name: 1.1 * value})
    except SettingError:
        return settings.replace(**{name: 0.9 * value})


@pytest.mark.parametrize(("scene", "changes"), CASES)
def test_every_act_follows_the_setting_that_it_names(scene: str, changes: dict[str, Any]) -> None:
    settings = settings_of(scene, changes)
    acts = acts_of(settings)
    assert acts
    for number, (act, name) in enumerate(acts):
        assert settings.applies(name)
        again, same = acts_of(larger(settings, name))[number]
        assert (again.symbol, same) == (act.symbol, name)
        assert not np.allclose(again.values, act.values, rtol=1e-3, atol=0.0)


@pytest.mark.parametrize("side", LOADED_SIDES)
@pytest.mark.parametrize("kind", PRESCRIBED)
def test_settings_behind_a_side_are_those_that_apply_there(side: str, kind: str) -> None:
    others = {other: "clamped" for other in LOADED_SIDES if other != side}
    settings = settings_of("block", {**others, side: kind, "gap": "flat"})
    ending = "_traction", "_displacement"
    applying = {
        name
        for name in settings.definitions()
        if name.startswith(side) and name.endswith(ending) and settings.applies(name)
    }
    found = {name for what, name in behind(settings).items() if what.startswith(side)}
    assert found == applying


def test_a_load_that_is_a_table_has_no_handle() -> None:
    table = [[0.0, 0.0], [1.0, 1e5]]
    bar = settings_of("bar", {"load": table})
    assert {act.symbol: name for act, name in acts_of(bar)} == {
        "F": "",
        "p": "pressure",
    }
    layers = settings_of("layers", {"pressure_load": table, "bend_load": [[0.0, 0.0], [1.0, 1e-3]]})
    assert {name for _, name in acts_of(layers)} == {""}


@pytest.mark.parametrize(("scene", "changes"), CASES)
def test_handles_end_at_the_heads_of_arrows_and_grow_along_them(
    scene: str, changes: dict[str, Any]
) -> None:
    shown = looked_at(scene, changes)
    drawing = picture.draw(shown, None)
    settings = {name for _, name in acts_of(shown.run.settings)}
    heads = np.concatenate(
        [
            np.stack([curve.x, curve.y, curve.dx, curve.dy], axis=1)
            for curve in drawing.curves
            if curve.color in (FORCE, GIVEN)
        ]
    )
    handles = [one for one in drawing.handles if one.setting in settings]
    assert {one.setting for one in handles} <= settings
    assert handles
    for one in handles:
        assert one.value == shown.run.settings.values()[one.setting]
        assert one.rate * one.value > 0.0
        assert np.nanmin(np.abs(heads - one.ends[1]).sum(axis=1)) < 1e-12
    others = {one.setting for one in drawing.handles} - settings
    assert others <= {"break_position", "radius"}


def test_the_break_is_where_its_handle_is() -> None:
    shown = looked_at("strand", {"break_position": 0.3})
    (handle,) = [
        one for one in picture.draw(shown, None).handles if one.setting == "break_position"
    ]
    assert handle.ends[:, 0].mean() == pytest.approx(0.3)
    assert handle.value + handle.rate * 0.2 == pytest.approx(0.5)


def test_a_deeper_gap_is_a_smaller_radius() -> None:
    drawing = picture.draw(looked_at("block"), None)
    for handle in (one for one in drawing.handles if one.setting == "radius"):
        assert handle.ends[1, 3] > handle.ends[0, 3]
        assert handle.rate > 0.0


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_only_settings_that_the_page_shows_are_dragged(scene: str) -> None:
    settings = settings_of(scene, {})
    plots = gallery({})
    names = set(behind(settings).values())
    plots.let_drag(settings, names | {"instants"}, BY_SIZE)
    assert set(plots.sliders) == names
    plots.let_drag(settings, (), BY_SIZE)
    assert plots.sliders == {}


def test_a_place_is_marked_where_positions_run_across() -> None:
    scene = looked_at("strand")
    for view in fitting(scene.run.settings):
        drawing = view.draw(scene, None)
        assert drawing is not None
        added = len(marked(view, drawing, 0.3).curves) - len(drawing.curves)
        assert added == (view.plot.x_label == POSITION)
        assert marked(view, drawing, None) is drawing


@pytest.mark.parametrize(
    ("scene", "names"),
    [("bar", ()), ("block", ()), ("layers", ("contact 1-2", "contact 2-3")), ("incline", ())],
)
def test_one_chooses_among_interfaces_where_they_lie(scene: str, names: tuple[str, ...]) -> None:
    changes = {"layers": 3} if scene == "layers" else {}
    shown = looked_at(scene, changes)
    drawing = picture.draw(shown, None)
    assert tuple(drawing.contacts) == names
    length, height = shown.run.stand.portrait.size
    for number, places in enumerate(drawing.contacts.values(), start=1):
        assert np.ptp(places[:, 0]) > 0.8 * length
        assert places[0, 1] == pytest.approx(number * height / changes["layers"], rel=0.05)


def test_every_element_knows_its_place_before_it_moved() -> None:
    scene = looked_at("block")
    bodies = picture.draw(scene, None).bodies
    assert bodies is not None
    assert bodies.along is not None
    length = scene.run.stand.portrait.described.length
    assert len(bodies.along) == len(bodies.values)
    assert bodies.along.min() == pytest.approx(length / 32)
    assert bodies.along.max() == pytest.approx(length * 31 / 32)


def test_the_picture_says_which_place_is_marked() -> None:
    scene = looked_at("bar")
    marked_there = replace(scene, look=replace(scene.look, place=0.25))
    drawn, plain = (picture.draw(one, None) for one in (marked_there, scene))
    assert {key.text for key in drawn.keys} - {key.text for key in plain.keys} == {"x = 250 mm"}
    assert len(drawn.curves) == len(plain.curves) + 1
