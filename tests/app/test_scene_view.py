"""The living scene: what is drawn is there, is inside, and follows the hand."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bokeh.models import ColorBar
from pictures import PHASES, coarse, frame_of, shown, small
from views import frames_of

from app.frame import Frame, Selection
from app.messages import Needs, Start
from app.state import PageState, answer, default_settings
from app.status import status_line
from app.views.colors import HALO
from app.views.contact_force import ContactForce
from app.views.inside import WIDEST, Stress, Thrust
from app.views.picture import bands
from app.views.rope import WireSection
from app.views.scene import HEIGHT, WIDTH, Scene
from app.views.status_map import StatusMap
from app.views.timeline import Timeline, paths_of
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.scenes import CATALOGUE
from solver.settings.scene import Settings

SCENES = tuple(CATALOGUE)


def flat(values: object) -> np.ndarray:
    lists = [np.ravel(one) for one in values]  # type: ignore[attr-defined]
    if lists:
        return np.concatenate(lists)
    return np.zeros(0)


def test_everything_lies_inside_the_figure_at_every_instant(
    frame: Frame, scene: Scene
) -> None:
    for phase in PHASES:
        scene.update(frame, Selection(phase), None)
        for name, source in scene.sources.items():
            if "xs" in source.data:
                across = "xs"
                up = "ys"
            else:
                across = "x"
                up = "y"
            for values, end in (
                (source.data[across], WIDTH),
                (source.data[up], HEIGHT),
            ):
                known = flat(values).astype(float)
                known = known[np.isfinite(known)]
                assert np.all((known > -3.0) & (known < end + 3.0)), name


def test_bodies_in_the_plane_have_equal_axes(frame: Frame, scene: Scene) -> None:
    layout = scene.picture.layout  # type: ignore[union-attr]
    if frame.run.geometry.description.height is not None:
        assert layout.scale[0] == layout.scale[1]


@pytest.mark.parametrize("name", SCENES)
def test_what_is_seen_first_of_a_scene_slips(name: str) -> None:
    # A run that follows a slider has its answer without a reference beside it.
    order = Start(1, answer(coarse(name)), math.inf, is_dragged=True)
    runner = Runner(order, ReferenceCache(), lambda: False)
    while runner.status is None:
        runner.advance()
    frame = runner.frame(Needs(frozenset({"axial force"})))
    interface = frame.run.interface(Selection().interface)
    assert frame.contact[interface].status.any()
    if name == "rope":
        assert list(frame.extras["axial force"]["names"]) == [interface]


def test_an_instant_sends_only_what_moves(frame: Frame, scene: Scene) -> None:
    scene.update(frame, Selection(0.5), None)
    before = {name: source.data for name, source in scene.sources.items()}
    scene.update(frame, Selection(0.5), None)
    assert all(scene.sources[name].data is before[name] for name in before)


def test_an_arrow_has_the_length_of_its_value() -> None:
    frame = frame_of(small("bar"))
    lengths = []
    for phase in (0.75, 0.5 + math.asin(0.5) / (2.0 * math.pi)):
        picture = shown(frame, phase).picture
        assert picture is not None
        arrows = next(each for each in picture.arrows if each.act.symbol == "F")
        (line,) = arrows.lines
        value = arrows.act.values[round(phase * 20)]
        lengths.append((np.hypot(*(line[-1] - line[0])), value))
    (full, peak), (part, value) = lengths
    assert part / full == pytest.approx(value / peak, rel=1e-6)


def test_of_equal_arrows_the_middle_one_has_the_handle_at_every_instant() -> None:
    frame = frame_of(wall())
    for phase in PHASES[1:]:
        picture = shown(frame, phase).picture
        assert picture is not None
        (pressure,) = (each for each in picture.arrows if len(each.spread))
        middle = pressure.handles[len(pressure.handles) // 2]
        assert np.array_equal(pressure.handle, middle)


def test_dragging_an_arrow_sets_what_is_behind_it() -> None:
    frame = frame_of(small("bar"))
    state = PageState(frame.run.settings)
    view = Scene(state)
    _ = view.figure
    view.update(frame, Selection(0.75), None)
    sent: list[object] = []
    state.send = sent.append
    picture = view.picture
    assert picture is not None
    arrows = next(each for each in picture.draggable if each.setting == "peak")
    half = picture.page(0.5 * (arrows.base[0] + arrows.handles[0]))
    start = picture.page(arrows.handle)
    view._hold(SimpleNamespace(x=start[0], y=start[1]))
    view._drag(SimpleNamespace(x=half[0], y=half[1]))
    assert isinstance(sent[-1], Start)
    assert sent[-1].is_dragged
    # Where the browser breaks off a touch, its end has no place.
    view._let_go(SimpleNamespace(x=0.0, y=0.0))
    assert state.settings.peak == pytest.approx(0.5 * frame.run.settings.peak, rel=1e-2)


def test_the_magnification_holds_while_motion_is_seen() -> None:
    layout = shown(frame_of(small("block"))).picture.layout  # type: ignore[union-attr]
    factor = layout.fitting((1e-5, 2e-5), None)
    assert layout.fitting((0.5e-5, 1e-5), factor) == factor
    assert layout.fitting((1e-7, 2e-7), factor) > factor


def test_a_run_is_drawn_alike_whatever_was_shown_of_it_before() -> None:
    first, on_the_way, last = frames_of("bar")

    def factor_after(*frames: Frame) -> float:
        scene = Scene(PageState(last.run.settings))
        for number, frame in enumerate(frames, 1):
            # A frame that is gone back to is not the newest.
            scene.state.newest = max(frames[:number], key=lambda each: each.iteration)
            _ = scene.figure
            scene.update(frame, Selection(), None)
        picture = scene.picture
        assert picture is not None
        return picture.factor

    alone = factor_after(last)
    # At its first iterate nobody knows how far the bodies of a run move.
    assert factor_after(first) != alone
    assert factor_after(first, on_the_way, last) == alone
    assert factor_after(last, first) == alone


def test_bands_meet_between_points_of_different_status() -> None:
    points = np.stack([np.arange(4.0), np.zeros(4)], axis=1)
    lines = bands(
        points, np.zeros(4, dtype=np.intp), np.array([0, 0, 1, 1], dtype=np.int8)
    )
    assert np.allclose(lines[0][:3, 0], [0.0, 1.0, 1.5])
    assert np.allclose(lines[1][:3, 0], [1.5, 2.0, 3.0])
    assert all(np.isnan(line[3:]).all() for line in lines.values())


def test_bands_end_where_a_wire_goes_behind() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, np.nan], [3.0, 0.0], [4.0, 0.0]])
    lines = bands(points, np.zeros(5, dtype=np.intp), np.zeros(5, dtype=np.int8))
    assert np.array_equal(lines[0][:5], points, equal_nan=True)


def test_other_views_show_every_instant(frame: Frame) -> None:
    state = PageState(frame.run.settings)
    for kind in (Stress, Timeline, WireSection):
        if kind.applies(frame.run.settings):
            view = kind(state)
            _ = view.figure
            for phase in (0.0, 0.6):
                view.update(frame, Selection(phase), None)
    assert all(np.isfinite(values).all() for _, values in paths_of(frame.run))
    _, _, values = frame.extras["stress"]
    assert values.shape == (len(frame.run.geometry.cells), len(frame.run.instants))


@pytest.mark.parametrize("kind", [Stress, Thrust])
def test_before_its_extra_is_there_a_picture_has_nothing_of_the_scene_before(
    kind: type[Stress | Thrust],
) -> None:
    """Stress had the colour bar of wires of a rope under a wall of bricks."""
    view = shown(frame_of(small("wall")), 1.0, kind)
    frame = frame_of(small("bundle"))
    view.update(replace(frame, extras={}), Selection(1.0), None)
    bars = [each for each in view.figure.right if isinstance(each, ColorBar)]
    assert len(bars) == (kind is Stress)
    assert not any(bar.visible for bar in bars)
    for name in ("stress", "thrust", "hinges"):
        if name in view.sources:
            assert not any(map(len, view.sources[name].data.values()))
    view.update(frame, Selection(1.0), None)
    assert all(bar.visible for bar in bars)


@pytest.mark.parametrize(("name", "kind"), [("fault", Stress), ("bundle", Thrust)])
def test_a_bare_picture_on_a_phone_is_in_the_middle_above_its_only_key(
    name: str, kind: type[Scene]
) -> None:
    view = shown(frame_of(small(name)), kind=kind)
    view.lay_out(330.0, 210.0)
    view.update(*view._shown)  # type: ignore[misc]
    assert view.picture is not None
    assert view.picture.layout.key_rows == 1
    assert abs(view.picture.layout.origin[0] - 165.0) < 12.0
    (legend,) = view.figure.legend
    assert "column" not in legend.css_classes


def test_wires_in_front_fill_the_strand_from_edge_to_edge() -> None:
    # What goes behind within a step is cut off straight, which takes less than 1 %.
    geometry = frame_of(small("rope")).run.geometry
    corners = geometry.nodes[geometry.cells].astype(float)
    x = corners[:, :, 0]
    y = corners[:, :, 1]
    areas = 0.5 * np.abs(
        np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)
    )
    description = geometry.description
    assert areas.sum() == pytest.approx(
        description.length * description.height, rel=1e-2
    )


def test_a_tap_selects_the_substructure_that_is_there() -> None:
    view = shown(frame_of(small("bar")))
    geometry = view.picture.frame.run.geometry  # type: ignore[union-attr]
    quad = int(np.flatnonzero(geometry.parts == 2)[0])
    middle = view.picture.nodes[geometry.cells[quad]].mean(axis=0)  # type: ignore[union-attr]
    x, y = view.picture.page(middle)  # type: ignore[union-attr]
    view._select(SimpleNamespace(x=x, y=y))
    assert view.state.selection.substructure == 2


def wall(**changes: object) -> Settings:
    small_wall = {
        "bricks": 3,
        "courses": 3,
        "elements": 4,
        "elements_up": 2,
        "instants": 21,
    }
    return default_settings("wall").replace(**small_wall, **changes)


def test_lines_of_thrust_bring_what_presses_on_a_wall_to_the_ground() -> None:
    settings = wall(displacement=0.0, unit_weight=0.0)
    frame = frame_of(settings, ends=True)
    shown_lines = frame.extras["thrust"]
    lines = shown_lines["lines"][..., -1]
    forces = shown_lines["forces"][:, -1]
    on_ground = np.all(lines[:, 1] == lines[:, 2], axis=1)
    assert on_ground.sum() == 3
    assert forces[on_ground].sum() == pytest.approx(1e6 * 3 * 0.25, rel=0.01)
    assert np.all(lines[on_ground, 0, 1] > lines[on_ground, 1, 1])
    view = shown(frame, 1.0, Thrust)
    widths = view.sources["thrust"].data["line_width"]
    assert 3 < len(widths) <= len(forces)
    assert max(widths) == pytest.approx(WIDEST, rel=1e-3)


def test_a_wall_that_collapses_says_its_limit_and_shows_by_which_mechanism() -> None:
    frame = frame_of(wall(top="pulled", traction=2e6, unit_weight=0.0), ends=True)
    assert frame.status is not None
    assert re.search(
        r"no equilibrium beyond traction = \d+ Pa \(0\.\d+ times", frame.status.advice
    )
    state = PageState(frame.run.settings)
    state.frame = state.newest = frame
    assert re.search(r"beyond Traction [\d.]+ [kM]Pa", status_line(state))
    assert 0.25 < frame.run.collapses_at < 1.0
    assert frame.run.mechanism is not None
    assert float(np.abs(frame.run.mechanism).max()) > 0.0
    assert len(shown(frame, 1.0).sources["ghost"].data["x"]) > 10
    assert not len(shown(frame, 0.1).sources["ghost"].data["x"])


def test_the_selected_contact_has_a_halo_and_its_name_in_the_titles_of_its_plots() -> (
    None
):
    frame = frame_of(small("layers"))
    state = PageState(frame.run.settings, frame=frame)
    views = [Scene(state), ContactForce(state), StatusMap(state)]
    shown_at = []
    for _ in range(2):
        state.turn(1)
        for view in views:
            _ = view.figure
            view.update(frame, state.selection, None)
        strokes = views[0].sources["strokes"].data
        halo = strokes["line_color"].index(HALO)
        shown_at.append(float(np.mean(strokes["ys"][halo])))
        for view in views[1:]:
            title = view.figure.title.text
            assert title.startswith(f"{state.selection.interface}: x, ")
    assert state.selection.interface == "contact 3-4"
    assert abs(shown_at[1] - shown_at[0]) > 10.0
    state.turn(1)
    assert state.selection.interface == "contact 1-2"


def test_a_single_contact_needs_neither_halo_nor_name() -> None:
    frame = frame_of(small("incline"))
    strokes = shown(frame).sources["strokes"].data
    halo = strokes["line_color"].index(HALO)
    assert not len(strokes["xs"][halo])
    assert frame.run.x_title("support") == "x"


def test_a_force_that_is_dragged_to_zero_keeps_its_handle() -> None:
    settings = small("bar")
    state = PageState(settings)
    view = Scene(state)
    _ = view.figure
    view.update(frame_of(settings), Selection(0.25), None)
    assert view.picture is not None
    (arrows,) = (each for each in view.picture.draggable if each.setting == "peak")
    full = view.picture.page(arrows.handle)
    base = view.picture.page(arrows.base[0])
    drag(view, full, base + np.array([2.0, 0.0]))
    assert state.settings.peak == 0.0
    view.update(frame_of(state.settings), Selection(0.25), None)
    (rest,) = (each for each in view.picture.draggable if each.setting == "peak")
    at_rest = view.picture.page(rest.handle)
    assert np.hypot(*(at_rest - base)) < 20.0
    drag(view, at_rest, at_rest + 1e-4)
    assert state.settings.peak == 0.0
    drag(view, at_rest, at_rest + full - base)
    assert state.settings.peak == pytest.approx(settings.peak, rel=1e-2)


def drag(view: Scene, start: np.ndarray, end: np.ndarray) -> None:
    place = SimpleNamespace(x=end[0], y=end[1])
    view._hold(SimpleNamespace(x=start[0], y=start[1]))
    view._drag(place)
    view._let_go(place)


def test_marks_of_a_first_visit_stay_until_somebody_does_something() -> None:
    frame = frame_of(default_settings("bar"))
    view = Scene(PageState(frame.run.settings, is_new=True))
    _ = view.figure
    view.update(frame, Selection(0.25), None)
    x, y, texts, _ = view.sources["hints"].data.values()
    assert len(texts) == 3
    (pulled,) = (n for n, text in enumerate(texts) if "pulled" in text)
    (rubs,) = (n for n, text in enumerate(texts) if text.endswith("rubs here"))
    assert x[pulled] > 0.9 * np.nanmax(view.sources["bodies"].data["x"])
    assert y[rubs] < np.nanmin(view.sources["bodies"].data["y"])
    view.state.is_new = False
    view.update(frame, Selection(0.25), None)
    assert not len(view.sources["hints"].data["text"])


def test_marks_of_a_first_visit_take_the_place_of_the_keys_in_a_small_picture() -> None:
    frame = frame_of(default_settings("bar"))
    view = Scene(PageState(frame.run.settings, is_new=True))
    (keys,) = view.figure.legend
    # The second one is that of a phone that lies on its side.
    sizes = [(900.0, 230.0, True), (844.0, 150.0, False), (390.0, 150.0, False)]
    for width, height, is_seen in sizes:
        view.lay_out(width, height)
        view.update(frame, Selection(0.25), None)
        assert keys.visible == is_seen
    marks = view.sources["hints"].data
    pulled = marks["text"].index("↖ pulled to and fro")
    layout = view.picture.layout  # type: ignore[union-attr]
    length = layout.letter * len(marks["text"][pulled])
    assert marks["x"][pulled] + length + 10.0 <= width
    # Marks lie below each other; the first one has two lines.
    assert marks["y"][0] - marks["y"][pulled] >= 1.5 * layout.row + 10.0
    view.state.is_new = False
    view.update(frame, Selection(0.25), None)
    assert keys.visible


def test_a_path_that_is_gone_has_no_name_before_the_reference_comes() -> None:
    before = frame_of(small("bar"))
    frame = frame_of(small("bar").replace(peak=0.0))
    state = PageState(frame.run.settings)
    view = Timeline(state)
    _ = view.figure
    for number, shown_frame in enumerate((before, frame), start=1):
        run = replace(shown_frame.run, number=number, is_compared=False)
        state.newest = state.frame = replace(shown_frame, run=run)
        state.ghost = before
        view.update(state.frame, Selection(), state.ghost)
    (legend,) = view.figure.legend
    names = [item.label.value for item in legend.items if item.visible]
    assert names == ["p = 5 kN/m", "t in s"]


@pytest.mark.parametrize("phase", [0.75, 1.0])
def test_handles_at_the_ends_of_a_bar_are_within_reach_on_a_phone(phase: float) -> None:
    moved = {"right_displacement": 2e-4, "support_displacement": 1e-4}
    frame = frame_of(small("bar").replace(right_end="held", **moved))
    view = Scene(PageState(frame.run.settings))
    _ = view.figure
    view.lay_out(390.0, 150.0)
    view.update(frame, Selection(phase), None)
    handles = view.sources["marks"].data
    assert len(handles["x"]) >= 2
    assert min(handles["x"]) > 0.0
    assert max(handles["x"]) < 390.0


@pytest.mark.parametrize("share", [1.14, 1.2, 1.45])
def test_the_handle_of_a_pressure_that_has_grown_stays_in_the_picture(
    share: float,
) -> None:
    settings = small("strand")
    view = shown(frame_of(settings))
    frame = frame_of(settings.replace(pressure=share * settings.pressure))
    view.update(frame, Selection(0.75), None)
    assert max(view.sources["marks"].data["y"]) < HEIGHT - 3.0
