"""Labels on bodies of any shape: loads, weights; keys of contacts."""

from __future__ import annotations

import numpy as np
import pytest
from frames import arch, ran
from pictures import boxes_of_words, frame_of, meet, shown, small

from app.frame import Frame, Selection
from app.lessons.catalogue import CASES
from app.state import default_settings
from app.views.timeline import paths_of


@pytest.mark.parametrize("name", ["arch", "layers", "mesh", "wall"])
def test_the_selected_contact_is_named_among_the_keys(name: str) -> None:
    frame = frame_of(small(name))
    view = shown(frame)
    for interface in frame.run.surfaces:
        view.update(frame, Selection(0.5, interface), None)
        assert len(view.picture.halo)  # type: ignore[union-attr]
        (legend,) = view.figure.legend
        assert interface in [item.label.value for item in legend.items if item.visible]


def test_the_only_contact_has_no_key() -> None:
    view = shown(frame_of(small("bar")))
    assert not view._items["selected"].visible


CROWDED = {
    "arch": arch(live=2000.0, fill=20e3),
    "bundle": default_settings("bundle").replace(elements=4, instants=9),
    "wall": CASES["settling-ground"].settings,
}


@pytest.fixture(scope="module", params=CROWDED)
def crowded(request: pytest.FixtureRequest) -> Frame:
    return ran(CROWDED[request.param], ends=False)


@pytest.mark.parametrize("size", [(950.0, 190.0), (420.0, 360.0), (380.0, 180.0)])
def test_words_of_many_loads_lie_apart_and_leave_handles_free(
    crowded: Frame, size: tuple[float, float]
) -> None:
    view = shown(crowded, 0.0)
    view.lay_out(*size)
    for phase in (0.0, 0.3, 0.5, 0.75, 1.0):
        view.update(crowded, Selection(phase), None)
        boxes = [box for _, box in boxes_of_words(view)]
        marks = view.sources["marks"].data
        handles = np.stack([marks["x"], marks["y"]], axis=1)
        for index, box in enumerate(boxes):
            for other in boxes[:index]:
                assert not meet(box, other[0], other[1])
            assert not meet(box, handles - 3.0, handles + 3.0)


def test_equal_loads_have_one_word() -> None:
    frame = ran(CROWDED["bundle"], ends=False)
    acts = frame.run.geometry.description.acts
    bands = [act for act in acts if act.where.startswith("band")]
    assert len(bands) > 3
    texts = [text for text, _ in boxes_of_words(shown(frame, 0.5))]
    assert sum(text.endswith(" each") for text in texts) == 1
    assert sum(text.startswith("F = ") for text in texts) == 2
    assert shown(frame, 0.5).picture.layout.equals.count(len(bands)) == 1  # type: ignore[union-attr]
    # Beside the time line they are told apart by their places.
    names = [title.partition(" = ")[0] for title, _ in paths_of(frame.run)]
    assert sorted(names) == ["F (band)", "F (plate)", "u"]


def test_the_weight_of_an_arch_is_read_at_its_arrow() -> None:
    view = shown(ran(arch(), ends=False), 0.5)
    view.lay_out(420.0, 360.0)
    view.update(view._shown[0], Selection(0.5), None)  # type: ignore[index]
    picture = view.picture
    assert picture is not None
    (weight,) = (each for each in picture.arrows if each.act.side == "body")
    (box,) = (box for text, box in boxes_of_words(view) if text[0] == "W")
    tail, head = picture.page(weight.lines[0])
    assert head[0] < box[0, 0] < head[0] + 20.0
    assert head[1] < box[:, 1].mean() < tail[1]


def test_the_weight_of_a_wall_is_read_beside_it_and_not_at_its_pressure() -> None:
    frame = ran(default_settings("wall").replace(instants=9), ends=False)
    view = shown(frame, 0.5)
    view.lay_out(950.0, 220.0)
    view.update(frame, Selection(0.5), None)
    assert view.picture is not None
    corners = view.picture.page(view.picture.nodes)
    (box,) = (box for text, box in boxes_of_words(view) if text[0] == "W")
    assert box[1, 0] < corners[:, 0].min()
    assert corners[:, 1].min() < box[:, 1].mean() < corners[:, 1].max()


def test_the_words_of_a_weight_have_a_line_to_it_on_a_phone() -> None:
    frame = ran(default_settings("wall").replace(instants=9), ends=False)
    view = shown(frame, 0.5)
    view.lay_out(390.0, 240.0)
    for phase in (0.3, 0.5, 0.75, 1.0):
        view.update(frame, Selection(phase), None)
        assert len(view.sources["leaders"].data["xs"]) == 1


@pytest.mark.parametrize("size", [(900.0, 300.0), (374.0, 300.0), (360.0, 256.0)])
def test_the_weight_of_an_arch_is_named_at_its_arrow(
    spread: Frame, size: tuple[float, float]
) -> None:
    view = shown(spread, 1.0)
    view.lay_out(*size)
    view.update(spread, Selection(1.0), None)
    picture = view.picture
    assert picture is not None
    arrows = [each for each in picture.arrows if each.act.where == "body"]
    shaft = picture.page(np.concatenate(arrows[0].lines)).mean(axis=0)
    boxes = dict(boxes_of_words(view))
    (name,) = [text for text in boxes if text.startswith("W")]
    apart = np.maximum(boxes[name][0] - shaft, shaft - boxes[name][1])
    assert apart.max() < 40.0


def test_an_arch_whose_weight_is_told_below_it_is_as_high_as_its_figure(
    spread: Frame,
) -> None:
    view = shown(spread, 1.0)
    view.lay_out(900.0, 300.0)
    view.update(spread, Selection(1.0), None)
    assert view.picture is not None
    layout = view.picture.layout
    assert layout.size[1] * layout.scale[1] > 0.7 * layout.canvas.height
