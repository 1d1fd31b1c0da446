"""Words in the picture of a scene are whole, and cover neither bodies nor arrows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from pictures import PHASES, boxes_of_words, frame_of, meet, shown, small

from app.frame import Frame, Selection
from app.lessons.catalogue import LESSONS
from app.state import default_settings
from app.views.picture import Picture
from app.views.scene import HEIGHT, WIDTH, Scene
from app.views.type_size import TEXT


def picture_of(view: Scene) -> Picture:
    """Picture that a scene shows."""
    assert view.picture is not None
    return view.picture


def words_on_bodies(view: Scene, frame: Frame, letter: float, half: float) -> list[str]:
    """Words that lie on bodies, with letters and half a row of these sizes, px."""
    picture = picture_of(view)
    corners = picture.page(picture.nodes[frame.run.geometry.cells])
    low = corners.min(axis=1)
    high = corners.max(axis=1)
    boxes = boxes_of_words(view, letter=letter, half=half)
    return [text for text, box in boxes if meet(box, low, high)]


def shafts(picture: Picture) -> np.ndarray:
    """Places along all arrows, and lines over their tails, (n, 2), px."""
    shares = np.linspace(0.0, 1.0, 9)[:, None]
    places = [np.zeros((0, 2))]
    for arrows in picture.arrows:
        for first, *_, last in (*arrows.lines, *pairwise(arrows.spread)):
            places.append(picture.page(first + shares * (last - first)))
    return np.concatenate(places)


def test_words_beside_a_body_have_room_on_a_projector() -> None:
    frame = frame_of(small("bar"))
    view = shown(frame, 0.25)
    view.magnify("22px")
    view.update(frame, Selection(0.25), None)
    words = view.sources["words"].data
    (x,) = (
        x for x, text in zip(words["x"], words["text"], strict=True) if text[0] == "F"
    )
    picture = picture_of(view)
    assert x > picture.page(picture.nodes)[:, 0].max()


def test_on_a_projector_a_pressure_is_named_beside_its_own_arrows() -> None:
    """In a low picture the force's word had its place, and it stood at the force."""
    frame = frame_of(small("bar"))
    view = shown(frame, 0.75)
    view.magnify("22px")
    view.lay_out(816.0, 155.0)
    view.update(frame, Selection(0.75), None)
    picture = picture_of(view)
    words = view.sources["words"].data
    heights = dict(zip((text[0] for text in words["text"]), words["y"], strict=True))
    (force,) = (each for each in picture.arrows if each.act.symbol == "F")
    assert heights["p"] > heights["F"] > picture.page(force.handle)[1]


def test_words_of_large_type_lie_on_no_arrow(frame: Frame, scene: Scene) -> None:
    scene.magnify("28px")
    scene.lay_out(560.0, 400.0)
    for phase in PHASES:
        scene.update(frame, Selection(phase), None)
        places = shafts(picture_of(scene))
        for text, box in boxes_of_words(scene, letter=14.0, half=10.0):
            assert not meet(box, places, places), (phase, text)


@pytest.mark.parametrize(
    ("name", "text"),
    [("layers", "p = 2 MPa"), ("wall", "p = 1 MPa"), ("mesh", "p = 50 MPa each")],
)
def test_a_pressure_is_named_in_the_picture_as_its_control_has_it(
    name: str, text: str
) -> None:
    view = shown(frame_of(small(name)))
    assert text in view.sources["words"].data["text"]
    # It pushes on the side: heads of its arrows are nearer to the bodies than tails.
    for arrows in picture_of(view).arrows:
        if arrows.act.symbol == "p":
            away = np.array(arrows.act.away)
            assert np.all((arrows.lines[:, -1] - arrows.lines[:, 0]) @ away < 0.0)


@pytest.mark.parametrize("width", [390.0, 560.0])
def test_words_of_a_pressure_have_a_row_of_their_own_where_no_load_leaves_room_beside(
    width: float,
) -> None:
    view = shown(frame_of(small("strand").replace(peak=0.0)))
    view.lay_out(width, 0.25 * width + 50.0)
    view.update(view.state.frame, Selection(0.75), None)
    (pressure,) = boxes_of_words(view)
    places = shafts(picture_of(view))
    assert not meet(pressure[1], places, places)
    assert pressure[1][1, 1] < view.picture.layout.canvas.height + 3.0  # type: ignore[union-attr]


def test_words_stand_above_bodies_that_they_would_leave_no_room_beside() -> None:
    """Three turns on a bollard, both ends named, in a picture on a small projector."""
    view = shown(frame_of(LESSONS["turns-on-a-bollard"].settings), 1.0)
    view.magnify("19px")
    view.lay_out(370.0, 230.0)
    view.update(*view._shown)  # type: ignore[misc]
    picture = picture_of(view)
    assert np.ptp(picture.page(picture.nodes)[:, 0]) > 70.0


@pytest.mark.parametrize("width", [WIDTH, 374.0], ids=["wide", "narrow"])
@pytest.mark.parametrize("size", [TEXT, "36px"], ids=["page", "projector"])
def test_words_are_whole(frame: Frame, scene: Scene, size: str, width: float) -> None:
    scene.magnify(size)
    scene.lay_out(width, HEIGHT)
    scene.update(frame, Selection(0.3), None)
    letter = 0.5 * float(scene.words.removesuffix("px"))
    for text, box in boxes_of_words(scene, letter):
        assert box[0, 0] >= -1.0, text
        assert box[1, 0] <= width, text


@pytest.mark.parametrize("name", ["block", "fault", "incline"])
def test_words_leave_handles_free_in_a_picture_beside_plots(name: str) -> None:
    frame = frame_of(small(name))
    view = shown(frame)
    view.figure.trigger("inner_width", WIDTH, 270.0)
    view.figure.trigger("inner_height", HEIGHT, 420.0)
    for phase in PHASES:
        view.update(frame, Selection(phase), None)
        marks = view.sources["marks"].data
        handles = np.stack([marks["x"], marks["y"]], axis=1)
        half = np.array([5.0, 0.0])
        for text, box in boxes_of_words(view, letter=6.0, half=12.0):
            assert not meet(box, handles - half, handles + half), (phase, text)


@pytest.mark.parametrize("width", [WIDTH, 374.0], ids=["wide", "narrow"])
def test_words_lie_beside_the_bodies(frame: Frame, scene: Scene, width: float) -> None:
    scene.lay_out(width, HEIGHT)
    for phase in PHASES:
        scene.update(frame, Selection(phase), None)
        assert not words_on_bodies(scene, frame, letter=6.0, half=4.0), phase


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.4, 0.8, 0.96875])
@pytest.mark.parametrize("size", [(910.0, 560.0), (390.0, 338.0)])
def test_words_meet_no_arrow_at_the_end_of_a_body(
    size: tuple[float, float], phase: float
) -> None:
    frame = frame_of(LESSONS["two-points"].settings)
    view = shown(frame, phase)
    view.lay_out(*size)
    view.update(frame, Selection(phase), None)
    heads = view.sources["heads"].data
    x, y = (np.concatenate(heads[name]) for name in ("xs", "ys"))
    corners = np.stack([x, y], axis=1)
    for text, box in boxes_of_words(view, letter=7.0, half=7.0):
        assert not meet(box, corners, corners), text


def test_words_lie_on_no_band_that_goes_on_beyond_its_end() -> None:
    """Both ends of three turns on a bollard stand on top, one beside the other."""
    frame = frame_of(LESSONS["turns-on-a-bollard"].settings)
    view = shown(frame)
    view.magnify("28px")
    view.lay_out(1220.0, 760.0)
    for phase in (0.0, *PHASES):
        view.update(frame, Selection(phase), None)
        assert not words_on_bodies(view, frame, letter=14.0, half=10.0), phase


@pytest.mark.parametrize(("name", "height"), [("incline", 330.0), ("wall", 215.0)])
def test_a_line_leads_from_the_words_of_a_weight_to_its_arrow(
    name: str, height: float
) -> None:
    view = shown(frame_of(small(name)))
    view.lay_out(950.0, height)
    view.update(*view._shown)  # type: ignore[misc]
    picture = picture_of(view)
    (weight,) = [arrows for arrows in picture.arrows if arrows.act.symbol == "W"]
    leaders = view.sources["leaders"].data
    ((begin, end),) = np.stack([leaders["xs"], leaders["ys"]], axis=-1)
    np.testing.assert_allclose(end, picture.page(weight.lines[0, 0]))
    boxes = dict(boxes_of_words(view, letter=9.0, half=12.0))
    (box,) = [box for text, box in boxes.items() if text.startswith("W = ")]
    assert meet(box + np.array([[-1.0], [1.0]]), begin, begin)


def test_no_line_leads_from_words_that_stand_at_their_arrow() -> None:
    view = shown(frame_of(small("arch")))
    view.lay_out(430.0, 330.0)
    view.update(*view._shown)  # type: ignore[misc]
    assert view.sources["leaders"].data["xs"] == []


@pytest.mark.parametrize("slope", [-29.0, 29.0])
def test_the_slope_stands_beside_a_wall_whichever_way_it_tilts(slope: float) -> None:
    settings = default_settings("wall").replace(slope=slope, slope_load="ramp")
    frame = frame_of(settings)
    view = shown(frame)
    view.magnify("28px")
    view.lay_out(840.0, 640.0)
    for phase in (0.25, 0.5, 1.0):
        view.update(frame, Selection(phase), None)
        picture = picture_of(view)
        corners = picture.page(picture.nodes[frame.run.geometry.cells])
        lowest = corners.min(axis=1)
        highest = corners.max(axis=1)
        for text, box in boxes_of_words(view, letter=14.0, half=10.0):
            if text.startswith("slope"):
                assert not meet(box, lowest, highest), phase
        # The horizontal, which is drawn last of what holds the wall, lies below it.
        strokes = view.sources["strokes"].data["ys"]
        level = strokes[1][-2:]
        assert level[0] == pytest.approx(level[1])
        assert level[0] < lowest[:, 1].min()


@pytest.mark.parametrize("slope", [-29.0, 29.0])
@pytest.mark.parametrize("size", [(390.0, 300.0), (640.0, 755.0)])
def test_words_lie_on_no_line_over_the_arrows_of_a_wall_that_tilts(
    size: tuple[float, float], slope: float
) -> None:
    frame = frame_of(default_settings("wall").replace(slope=slope, slope_load="ramp"))
    view = shown(frame)
    view.lay_out(*size)
    for phase in PHASES:
        view.update(frame, Selection(phase), None)
        places = shafts(picture_of(view))
        for text, box in boxes_of_words(view, letter=6.0, half=4.0):
            assert not meet(box, places, places), (phase, text)
