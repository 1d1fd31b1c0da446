"""Views show what a frame has: an iterate, the answer, a ghost, a reference."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from itertools import chain, product
from typing import Any

import numpy as np
import pytest
from bokeh.core.serialization import Serializer
from bokeh.document import Document
from bokeh.events import Tap
from bokeh.models import DataRange1d, LogScale, SaveTool
from bokeh.settings import settings
from frames import frame_of
from views import MORE, SMALL, VIEWS, frames_of, other_run, settings_of, shown, view_of

from app.frame import Frame, Selection
from app.lessons.catalogue import CASES
from app.live import Card
from app.messages import Needs
from app.state import PageState, default_settings
from app.views.bases import ClipErrors, Spectra
from app.views.catalogue import CARDS
from app.views.contact_force import ContactForce
from app.views.errors import Convergence
from app.views.inside import Stress
from app.views.loops import HysteresisLoop
from app.views.pieces import PiecesView
from app.views.rope import AxialForces, WireSection
from app.views.scene import Scene
from app.views.status_map import StatusMap
from app.views.timeline import Timeline
from app.views.view import View
from solver.study.comparison import DISPLACEMENT, FRICTION, OtherResults


@cache
def untouched(kind: type[View]) -> View:
    """A view that has shown no frame; no test changes it."""
    view = kind(PageState(default_settings("bar")))
    assert view.figure is not None
    return view


def made_of(kind: type[View]) -> str:
    """All that a browser gets of a new view, with its models numbered in order."""
    document = Document()
    document.add_root(kind(PageState(default_settings("bar"))).layout)
    text = json.dumps(document.to_json().content["roots"])
    ids = re.findall(r'"id": "(p\d+)"', text)
    numbers = {name: str(number) for number, name in enumerate(ids)}
    return re.sub(r'"(p\d+)"', lambda found: numbers[found[1]], text)


@pytest.mark.parametrize("kind", VIEWS)
def test_figures_are_the_same_where_bokeh_does_not_check_their_values(
    kind: type[View],
) -> None:
    checked = made_of(kind)
    settings.perform_document_validation = False
    try:
        assert made_of(kind) == checked
    finally:
        settings.perform_document_validation.unset_value()


def test_a_view_of_an_extra_has_none_of_the_scene_before() -> None:
    """Singular values of a bar stood under a block until its own were there."""
    bar = frames_of("bar")[2]
    view = view_of(Spectra, bar)
    assert len(view.sources["values"].data["xs"]) == bar.run.n_substructures
    shown(view, replace(bar, extras={}))
    assert len(view.sources["values"].data["xs"])
    shown(view, replace(frames_of("block")[2], extras={}))
    for source in view.sources.values():
        assert not any(map(len, source.data.values()))


@pytest.mark.parametrize("kind", [Scene, Timeline, *VIEWS])
def test_a_view_shows_each_frame_of_all_that_it_applies_to_with_the_same_models(
    kind: type[View],
) -> None:
    """A colour bar had a new mapper while its figure came to another card.

    The browser draws with the models of a figure that it knows before new ones among
    them are complete, where both come in a message.
    """
    # One view goes from scene to scene, as on the page.
    view = kind(PageState(default_settings("bar")))
    assert view.figure is not None
    models = view.layout.references()
    cases = [case for case in (*SMALL, *MORE) if kind.applies(settings_of(case))]
    assert cases
    for case in cases:
        first, last, answer = frames_of(case)
        view.state.settings = first.run.settings
        # What is there of the case before would count as shown.
        for source in view.sources.values():
            source.data = {name: [] for name in source.data}
        pairs = [
            (first, None),
            (first, answer),
            (last, answer),
            (last, None),
            (answer, last),
        ]
        for frame, ghost in pairs:
            shown(view, frame, ghost and other_run(ghost))
            assert has_wide_axes(view), case
            assert fits_a_logarithmic_axis(view), case
            assert frame is first or draws_something(view), case
            assert view.layout.references() == models, case


def has_wide_axes(view: View) -> bool:
    """Check that the axes of a figure show a range."""
    axes = [view.figure.x_range, view.figure.y_range]
    return all(each.start < each.end for each in axes)


def fits_a_logarithmic_axis(view: View) -> bool:
    """Check that whatever a logarithmic axis shows is positive and finite."""
    if not isinstance(view.figure.y_scale, LogScale):
        return True
    sources = product(view.sources.values(), ("y", "ys"))
    columns = [source.data.get(name, []) for source, name in sources]
    values = [np.ravel(each) for each in chain.from_iterable(columns)]
    together = np.concatenate([*values, np.ones(1)])
    return bool(np.all(np.isfinite(together) & (together > 0.0)))


def draws_something(view: View) -> bool:
    """Check whether a source of a figure has data."""
    columns = [next(iter(source.data.values())) for source in view.sources.values()]
    return any(len(column) for column in columns)


@pytest.mark.parametrize("kind", VIEWS)
def test_ranges_do_not_follow_data(kind: type[View]) -> None:
    """A cross-section was tiny in a card to which it came before it had wires.

    Ranges that follow data keep the limits that a figure brings to another card, and
    without data BokehJS complains of them in the console.
    """
    plot = untouched(kind).figure
    assert not plot.select(DataRange1d)


@pytest.mark.parametrize("room", [(400.0, 200.0), (200.0, 300.0)])
def test_a_cross_section_is_as_wide_as_high_and_whole(
    room: tuple[float, float],
) -> None:
    view = WireSection(PageState(default_settings("rope")))
    assert view.figure is not None
    view.lay_out(*room)
    shown(view, frames_of("rope")[2])
    wires = view.sources["wires"].data
    per_pixel = []
    for side, name, pixels in zip("xy", ("x_range", "y_range"), room, strict=True):
        limits = getattr(view.figure, name)
        assert limits.start < min(np.subtract(wires[side], wires["radius"]))
        assert limits.end > max(np.add(wires[side], wires["radius"]))
        per_pixel.append((limits.end - limits.start) / pixels)
    assert per_pixel[0] == pytest.approx(per_pixel[1])


@pytest.mark.parametrize("case", ["bar", "block", "strand"])
def test_the_shaded_error_is_there_on_the_way_and_vanishes_at_the_answer(
    case: str,
) -> None:
    _, last, answer = frames_of(case)
    sizes = []
    for frame in (last, answer):
        data = view_of(ContactForce, frame).sources["friction"].data
        latin = np.array(data["latin"])
        reference = np.array(data["reference"])
        sizes.append(np.abs(latin - reference).max() / np.abs(reference).max())
    assert sizes[0] > 0.02
    assert sizes[1] < 1e-3


def test_the_contact_force_is_shown_in_the_unit_that_its_axis_says() -> None:
    frame = frames_of("bar")[2]
    view = view_of(ContactForce, frame)
    column = frame.run.column(Selection().phase)
    fields = next(iter(frame.contact.values()))
    assert view.figure.yaxis[0].axis_label == "force, kN/m"
    assert np.allclose(
        view.sources["friction"].data["latin"], 1e-3 * fields.friction[:, column]
    )


def test_the_axis_of_the_contact_force_stays_while_a_run_iterates() -> None:
    _, last, _ = frames_of("bar")
    view = view_of(ContactForce, last)
    ends = view.figure.y_range.start, view.figure.y_range.end
    smaller = {
        n: replace(f, friction=0.1 * f.friction) for n, f in last.contact.items()
    }
    shown(view, replace(last, contact=smaller))
    assert (view.figure.y_range.start, view.figure.y_range.end) == ends


def test_the_reference_moves_neither_axis_nor_legend_of_a_run_like_the_last() -> None:
    first, last, answer = frames_of("bar")
    view = view_of(ContactForce, answer)

    def look() -> tuple[Any, ...]:
        names = [
            item.label.value for item in view.figure.legend[0].items if item.visible
        ]
        return (
            round(view.figure.y_range.start, 9),
            round(view.figure.y_range.end, 9),
            names,
        )

    view.state.ghost = answer
    begun = other_run(first)
    shown(view, begun, answer)
    assert not len(view.sources["reference"].data["x"])
    before = look()
    shown(view, replace(begun, run=replace(last.run, number=begun.run.number)), answer)
    assert len(view.sources["reference"].data["x"])
    assert look() == before
    # No frame follows one that was gone back to.
    view.state.iteration = 1
    shown(view, begun, answer)
    assert "reference" not in look()[-1]


def test_legends_name_only_what_is_drawn() -> None:
    first, last, answer = frames_of("bar")

    def names(view: View) -> set[str]:
        return {i.label.value for i in view.figure.legend[0].items if i.visible}

    view = view_of(ContactForce, first)
    assert names(view) == {"LATIN", "±µp"}
    assert {"reference", "error", "last run"} <= names(
        shown(view, last, other_run(answer))
    )
    assert "pressure" not in names(view)


def test_the_map_is_the_status_and_is_not_sent_again_when_the_instant_changes() -> None:
    frame = frames_of("bar")[1]
    view = view_of(StatusMap, frame)
    status = next(iter(frame.contact.values())).status
    image = view.sources["status"].data["image"][0]
    assert np.array_equal(image, status.T)
    data = view.sources["status"].data
    shown(view, frame, phase=0.3)
    assert view.sources["status"].data is data
    assert view.sources["now"].data["y"] == pytest.approx(
        frame.run.instants[[frame.run.column(0.3)]]
    )


def test_the_map_has_the_status_of_each_instant_at_its_time() -> None:
    """Steps are not even, as there is an instant more where a load turns."""
    turns = [[0.1 + 0.02 * n, 900.0 * (-1) ** n] for n in range(8)]
    path = [[0.0, 0.0], *turns, [1.0, 0.0]]
    settings = default_settings("bar").replace(load=path, elements=20, instants=14)
    frame = frame_of(settings, Needs(), ends=True)
    view = view_of(StatusMap, frame)
    run = frame.run
    steps = np.diff(run.instants)
    assert steps.max() > 3.0 * steps.min()
    data = view.sources["status"].data
    (image,) = data["image"]
    (low,) = data["y"]
    (high,) = data["dh"]
    rows = (run.instants - low) / high * len(image)
    status = frame.contact[run.interface("")].status
    assert np.array_equal(image[np.floor(rows).astype(int)], status.T)


def test_of_curves_only_what_is_new_is_sent_and_not_each_by_itself() -> None:
    frame = frames_of("bar")[0]
    count = frame.run.n_substructures

    def of(second: float) -> Frame:
        return replace(frame, extras={"spectra": count * [np.array([1.0, second])]})

    view = view_of(Spectra, of(0.1))
    document = Document()
    sent = []
    document.add_root(view.figure)
    document.on_change(
        lambda event: sent.append(event) if hasattr(event, "cols") else None
    )
    shown(view, of(0.2))
    (event,) = sent
    assert event.cols == ["ys"]
    serializer = Serializer()
    serializer.encode(event.data)
    assert not serializer.buffers


def test_the_ghosts_boundary_lies_where_its_status_changes() -> None:
    _, last, answer = frames_of("bar")
    view = shown(view_of(StatusMap, last), last, other_run(answer))
    status = next(iter(answer.contact.values())).status
    changes = np.count_nonzero(np.diff(status, axis=0)) + np.count_nonzero(
        np.diff(status, axis=1)
    )
    assert len(view.sources["ghost"].data["x0"]) == changes


def test_a_tap_on_the_map_selects_the_instant_and_the_place() -> None:
    frame = frames_of("bar")[1]
    view = view_of(StatusMap, frame)
    tap = type("Tap", (), {"x": 0.5, "y": 0.25 * float(frame.run.instants[-1])})
    view._select(tap)
    assert view.state.selection.phase == pytest.approx(0.25)
    assert view.state.selection.position == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("scene", "changes", "count"),
    [
        ("wall", {"bricks": 3, "courses": 3, "bond": "stack", "cap": "free"}, 10),
        ("arch", {"voussoirs": 7, "substructures": 2}, 16),
    ],
)
def test_each_substructure_has_its_curve_of_singular_values(
    scene: str, changes: dict[str, Any], count: int
) -> None:
    # A cap is no brick, and abutments are not cut as stones are.
    settings = default_settings(scene).replace(instants=9, **changes)
    frame = frame_of(settings, Needs(extras=frozenset({"spectra"})), ends=False)
    data = view_of(Spectra, frame).sources["values"].data
    assert len(data["xs"]) == len(data["part"]) == count


@pytest.mark.parametrize("kind", VIEWS)
def test_a_plot_is_saved_under_its_name(kind: type[View]) -> None:
    # Without one the browser asks for it, and proposes that of the library.
    plot = untouched(kind).figure
    tools = [tool for tool in plot.tools if isinstance(tool, SaveTool)]
    # Pictures of bodies have no tools.
    assert len(tools) == int(bool(plot.toolbar.tools))
    assert {tool.filename for tool in tools} <= {kind.name}


def pile(kind: type[View]) -> View:
    """A view of a pile, all of which slips at once: one mode and one vector do."""
    settings = CASES["pile"].settings.replace(finish="at-once")
    frame = frame_of(settings, Needs(extras=kind.needs), ends=True)
    return view_of(kind, frame)


def test_a_single_singular_value_is_a_dot() -> None:
    view = pile(Spectra)
    curves = view.sources["values"].data
    dots = view.sources["alone"].data
    assert {*map(len, curves["ys"])} == {1}
    assert [*dots["y"]] == [values[0] for values in curves["ys"]]
    assert [*dots["part"]] == [*curves["part"]]
    assert all(view.figure.x_range.start < x for x in dots["x"])


def test_a_form_of_storage_with_one_point_is_a_dot() -> None:
    view = pile(ClipErrors)
    curve = view.sources["SVD"].data
    dot = view.sources["first SVD"].data
    assert [*dot["x"]] == [*curve["x"]]
    assert len(dot["x"]) == 1
    assert view.figure.y_range.start < dot["y"][0]


def test_singular_values_wait_for_the_worker_to_send_them() -> None:
    last = frames_of("bar")[1]
    view = view_of(Spectra, last)
    count = len(view.sources["values"].data["xs"])
    shown(view, replace(last, extras={}))
    assert count == last.run.n_substructures == len(view.sources["values"].data["xs"])


def test_the_dot_of_the_instant_lies_on_the_loop() -> None:
    frame = frames_of("bar")[1]
    view = view_of(HysteresisLoop, frame)
    column = frame.run.column(Selection().phase)
    now = view.sources["now"].data
    loop = view.sources["LATIN"].data
    assert (now["x"][0], now["y"][0]) == (loop["x"][column], loop["y"][column])


def test_another_programs_results_stand_beside_ours_at_their_nearest_instant() -> None:
    frame = frames_of("bar")[1]
    x, t = (grid.ravel() for grid in np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.7, 1.0]))
    theirs = OtherResults(FRICTION, x, t, 1000.0 * t, "theirs.csv", "bar", "")
    view = view_of(ContactForce, replace(frame, extras={"beside": {"brought": theirs}}))
    assert np.allclose(view.sources["beside"].data["y"], 0.7)
    moved = {"brought": replace(theirs, quantity=DISPLACEMENT)}
    view = view_of(HysteresisLoop, replace(frame, extras={"beside": moved}))
    assert len(view.sources["beside"].data["x"]) == 3


def test_a_card_shows_the_view_that_was_chosen_last_wherever_it_is_offered() -> None:
    state = PageState(default_settings("strand"))
    card = Card([kind(state) for kind in CARDS[0]], state)
    card.fit()
    assert isinstance(card.seen, ContactForce)
    card.tabs.active = 1
    state.settings = default_settings("block")
    card.fit()
    assert isinstance(card.seen, ContactForce)
    state.settings = default_settings("strand")
    card.fit()
    assert isinstance(card.seen, AxialForces)


def test_a_view_that_comes_in_sight_later_has_the_type_of_a_projector() -> None:
    early, late = (HysteresisLoop(PageState(default_settings("bar"))) for _ in range(2))
    assert early.figure is not None
    for view in (early, late):
        view.magnify("20px")
        assert view.figure.legend[0].styles["font-size"] == "20px"
        assert view.figure.xaxis[0].major_label_text_font_size == "20px"


def test_a_view_that_comes_in_sight_shows_the_present_frame_at_once() -> None:
    frame = frames_of("bar")[1]
    state = PageState(frame.run.settings, frame=frame, newest=frame)
    card = Card([ContactForce(state), HysteresisLoop(state)], state)
    card.fit()
    card.tabs.active = 1
    card.fit()
    assert isinstance(card.seen, HysteresisLoop)
    assert len(card.seen.sources["LATIN"].data["x"]) == len(frame.run.instants)


def turned_away_and_back(kind: type[View], case: str) -> tuple[View, Document]:
    """A view that shows a frame on a page, on which another tab was shown meanwhile."""
    frame = frames_of(case)[1]
    state = PageState(frame.run.settings, frame=frame, newest=frame)
    card = Card([kind(state), HysteresisLoop(state)], state)
    card.fit()
    document = Document()
    root = card.view.get_root(document)
    document.add_root(root)
    for number in (1, 0):
        card.tabs.active = number
        card.fit()
    view = card.views[0]
    assert view.figure.document is document
    return view, document


@pytest.mark.parametrize(("kind", "case"), [(Convergence, "bar"), (StatusMap, "block")])
def test_a_tap_is_heard_after_another_tab_was_shown(
    monkeypatch: pytest.MonkeyPatch, kind: type[View], case: str
) -> None:
    view, document = turned_away_and_back(kind, case)
    heard: list[object] = []
    monkeypatch.setattr(view.state, "select", lambda **chosen: heard.append(chosen))
    monkeypatch.setattr(view.state, "seek", heard.append)
    document.callbacks.trigger_event(Tap(view.figure, x=2.0, y=0.5))
    assert len(heard) == 1


@pytest.mark.parametrize("kind", [Stress, PiecesView])
def test_a_picture_follows_its_size_after_another_tab_was_shown(
    kind: type[View],
) -> None:
    view, _ = turned_away_and_back(kind, "block")
    plot = view.figure
    for name, size in (("inner_width", 476), ("inner_height", 410)):
        plot.set_from_json(name, size)
    assert (plot.x_range.end, plot.y_range.end) == (476.0, 410.0)


def test_a_chart_of_few_cycles_says_how_many_tell_how_slip_goes_on() -> None:
    few = default_settings("strand").replace(load="cycle", elements=20, instants=21)
    frame = frame_of(few, Needs(extras=frozenset({"cycles"})), ends=True)
    cycles = frame.extras["cycles"]
    assert len(cycles["energy"]) == 2
    assert cycles["text"] == "how slip goes on is told from 3 cycles on"


@pytest.mark.parametrize("kind", [Scene, Timeline, *VIEWS])
def test_the_edge_of_a_canvas_which_bokeh_does_not_clear_is_left_free(
    kind: type[View],
) -> None:
    figure = untouched(kind).figure
    for side in ("left", "top"):
        border = getattr(figure, f"min_border_{side}")
        if border is None:
            border = figure.min_border
        assert border >= 1


@pytest.mark.parametrize("kind", [Timeline, *VIEWS])
def test_a_legend_above_begins_inside_the_figure(kind: type[View]) -> None:
    # It begins beside the axis, if the figure has one.
    plot = untouched(kind).figure
    for legend in plot.legend:
        if legend in plot.above and not any(axis.visible for axis in plot.yaxis):
            assert "margin-left" not in legend.styles
