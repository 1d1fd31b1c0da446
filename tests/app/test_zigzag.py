"""A point goes to and fro between its law and balance, along lines of slope k."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from small_scenes import SMALL

from app.frame import LINEAR, LOCAL, Selection
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.views.colors import REFERENCE
from app.views.zigzag import Zigzag
from app.worker.past_iterates import ENDS, PastIterates
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.latin import Answer

PLAIN = {"acceleration": "none", "relaxation": 1.0}
"""Settings of a search that is nothing but both stages in turn."""
SHEAR = 0.75
"""Share of the interval at which the bar is pushed most."""


@cache
def run_of(scene: str, iterations: int, **changes: Any) -> Runner:
    """A run after some iterations, with its reference."""
    values = {"finish": "none", **changes, "max_iterations": iterations}
    settings = default_settings(scene).replace(**values)
    runner = Runner(Start(1, settings, math.inf), ReferenceCache(), lambda: False)
    while runner.rest() is not None:
        runner.advance()
    return runner


def way_of(scene: str, iterations: int, **changes: Any) -> Any:
    needs = Needs(frozenset({"zigzag"}))
    return run_of(scene, iterations, **changes).frame(needs).extras["zigzag"]


def walked(k_scale: float) -> tuple[np.ndarray, float]:
    """Displacements of the point in balance in 12 iterations, and that of the solution.

    At the instant of the largest push, (13,), m; the first is that of the guess.
    """
    way = way_of("bar", 12, elements=50, k_scale=k_scale, **PLAIN)
    column = round(SHEAR * (way["star"].shape[1] - 1))
    return way["linear"][:, 0, column], float(way["star"][0, column])


@pytest.mark.parametrize(
    "scene", ["bar", "block", "fault", "incline", "layers", "strand"]
)
def test_the_local_stage_lies_on_the_graph_of_the_law_at_each_instant(
    scene: str,
) -> None:
    way = way_of(scene, 6, **SMALL[scene])
    slip, force = way["local"][-1]
    bound = way["bound"]
    size = max(float(bound.max()), float(np.abs(force).max()))
    assert np.all(np.abs(force) <= bound + 1e-5 * size)
    # Below its bound the point stands where the instant before has left it.
    sticks = np.abs(force) < bound - 1e-4 * size
    stands = way["slider"] - way["soft"] * force
    assert np.abs(slip - stands)[sticks].max(initial=0.0) <= 1e-5 * np.abs(slip).max()


def test_without_mixtures_each_way_goes_along_k() -> None:
    way = way_of("bar", 12, elements=50, **PLAIN)
    assert way["iterations"] == list(range(13))
    assert way["straight"][1:].all()
    to_law = way["local"][1:] - way["linear"][:-1]
    to_balance = way["linear"][1:] - way["local"][1:]
    size = np.abs(way["linear"][:, 1]).max()
    for step, slope in ((to_law, way["k"]), (to_balance, -way["k"])):
        off = np.abs(step[:, 1] - slope * step[:, 0])
        assert off.max() <= 1e-5 * size


def test_mixtures_move_a_point_off_the_way_to_balance_and_never_to_the_law() -> None:
    way = way_of("bar", 12, elements=50)
    assert way["straight"][1:, 0].all()
    column = round(SHEAR * (way["star"].shape[1] - 1))
    assert not way["straight"][3:, 1, column].any()


@pytest.mark.parametrize(("changes", "is_mixed"), [({}, True), (PLAIN, False)])
def test_a_way_that_mixtures_moved_is_dashed(
    changes: dict[str, Any], is_mixed: bool
) -> None:
    frame = run_of("bar", 12, elements=50, **changes).frame(
        Needs(frozenset({"zigzag"}))
    )
    state = PageState(frame.run.settings)
    state.newest = state.frame = frame
    view = Zigzag(state)
    dashes = {
        renderer.name: renderer.glyph.line_dash
        for renderer in view.figure.renderers
        if renderer.name in ("along", "mixed")
    }
    assert dashes == {"along": "solid", "mixed": "dashed"}
    view.update(frame, Selection(phase=SHEAR), None)
    mixed = view.sources["mixed"].data
    assert bool(len(mixed["x0"])) == is_mixed
    # Only the ways to balance: those to the law all go along k.
    assert len(mixed["x0"]) <= 12
    assert len(view.sources["along"].data["x0"]) >= 12


def test_the_line_of_balance_is_as_steep_as_the_bar_is_stiff_up_to_the_point() -> None:
    way = way_of("bar", 3, elements=50)
    settings = default_settings("bar")
    stiffness = settings.young * settings.section / way["position"]
    assert way["balance"] * settings.length / 50 == pytest.approx(stiffness, rel=1e-6)


def test_contact_alone_gives_a_level_line_of_balance() -> None:
    way = way_of("incline", 3)
    assert 0.0 <= way["balance"] <= 1e-6 * way["k"]


def test_a_tenth_of_k_circles_round_the_solution_and_ten_times_k_hardly_moves() -> None:
    small, star = walked(0.1)
    usual, _ = walked(1.0)
    large, _ = walked(10.0)
    steps = [np.abs(np.diff(each)).mean() / abs(star) for each in (small, usual, large)]
    assert steps[0] > 0.1
    assert 0.01 < steps[1] < 0.06
    assert steps[2] < 1e-3
    # It goes beyond the solution, and comes back.
    turns = np.diff(np.sign(np.diff(small)))
    assert (small / star).max() > 1.5
    assert np.count_nonzero(turns) >= 4
    assert 0.3 < (usual / star).max() < 0.6


def test_the_point_ends_at_the_star() -> None:
    way = way_of("bar", 300, elements=50, tolerance=1e-12)
    for stage in (LOCAL, LINEAR):
        off = np.abs(way[stage][-1] - way["star"]).max(axis=1)
        assert np.all(off <= 1e-2 * np.abs(way["star"]).max(axis=1))


def test_an_answer_is_the_star_and_no_iterate() -> None:
    runner = run_of("bar", 300, elements=50, finish="at-once")
    way = runner.frame(Needs(frozenset({"zigzag"}))).extras["zigzag"]
    assert isinstance(runner.iterate, Answer)
    assert runner.iterate.number not in way["iterations"][1:-1]
    assert way["star"] is not None


def test_a_selected_place_chooses_the_nearest_point() -> None:
    runner = run_of("bar", 6, elements=50)
    needs = Needs(frozenset({"zigzag"}), position=0.313)
    way = runner.frame(needs).extras["zigzag"]
    assert way["position"] == pytest.approx(0.32)
    nearest = np.abs(way["x"] - 0.32).argmin()
    for row, stage in enumerate((LOCAL, LINEAR)):
        field = way["fields"][row][nearest]
        assert np.allclose(field, way[stage][-1, 1], rtol=1e-5, atol=1e-3)


def test_past_iterates_are_thinned_between_the_first_and_the_newest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    iterate = run_of("bar", 3, elements=50).iterate
    assert iterate is not None
    past = PastIterates()
    for number in range(1, 301):
        past.keep(replace(iterate, number=number))
        few = [each.number for each in past.few()]
        assert len(few) <= 3 * ENDS
        assert few[:ENDS] == list(range(1, number + 1))[:ENDS]
        assert few[-ENDS:] == list(range(1, number + 1))[-ENDS:]
    monkeypatch.setattr("app.worker.past_iterates.LIMIT", 12 * iterate.outgoing.nbytes)
    past.keep(replace(iterate, number=301))
    for number in range(302, 312):
        past.keep(replace(iterate, number=number))
    assert [each.number for each in past.all][::2] == [1, 311]
    assert past.numbered(1) is past.all[0]
    assert past.numbered(2) is None


def test_after_the_local_stage_the_way_ends_on_the_law() -> None:
    frame = run_of("bar", 6, elements=50).frame(Needs(frozenset({"zigzag"})))
    view = Zigzag(PageState(frame.run.settings))
    assert view.figure
    counts = {}
    for stage in (LOCAL, LINEAR):
        view.update(frame, Selection(stage=stage), None)
        counts[stage] = len(view.sources[LINEAR].data["x"])
        shown = view.sources["newest"].data
        assert shown["x"] == view.sources[stage].data["x"][-1:]
    assert counts[LINEAR] == counts[LOCAL] + 1
    view.update(frame, Selection(stage=LOCAL), None)
    assert len(view.sources["linear field"].data["x"]) == 0


def test_both_figures_have_one_scale_of_forces_and_a_tap_on_the_field_selects() -> None:
    frame = run_of("bar", 6, elements=50).frame(Needs(frozenset({"zigzag"})))
    state = PageState(frame.run.settings)
    view = Zigzag(state)
    plots = [child for child, *_ in view.layout.children]
    assert plots == [view.figure, view.beside]
    assert plots[0].y_range is plots[1].y_range
    view.magnify("20px")
    assert {plot.xaxis.axis_label_text_font_size for plot in plots} == {"20px"}
    view.update(frame, Selection(), None)
    # The circle on the field marks the place and the force of the newest stage.
    marked = view.sources["marked"].data
    assert marked["y"] == pytest.approx(view.sources["newest"].data["y"], rel=1e-4)
    view._select(SimpleNamespace(x=0.3))
    assert state.selection.position == pytest.approx(0.3)


def test_the_legend_tells_ways_along_k_from_others() -> None:
    frame = run_of("bar", 6, elements=50).frame(Needs(frozenset({"zigzag"})))
    view = Zigzag(PageState(frame.run.settings))
    (legend,) = view.figure.legend
    view.update(frame, Selection(), None)
    named = {item.label.value: item for item in legend.items}
    looks = {}
    for name in ("slope ±k", "coarse problem, too"):
        assert named[name].visible == bool(len(view.sources[NAMED[name]].data["x0"]))
        glyph = named[name].renderers[0].glyph
        assert glyph.line_color == REFERENCE
        looks[name] = glyph.line_dash
    assert looks == {"slope ±k": [], "coarse problem, too": [6]}


NAMED = {"slope ±k": "along", "coarse problem, too": "mixed"}
"""Names of the ways of a point by their titles in the legend."""
