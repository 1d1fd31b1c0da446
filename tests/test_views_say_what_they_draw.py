"""What a view draws is what its legend names, over all of the axes that it draws it on."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shown_pages import ALL, SMALL, Shown, keys

from app.picture.recording import COLUMNS
from app.picture.units import MM
from app.views.bodies import deformed
from app.views.catalogue import VIEWS, fitting
from app.views.convergence import convergence, error_time
from app.views.drawing.colors import BLUE, GREEN, ORANGE, VERMILION
from app.views.drawing.drawing import POSITION, Curve
from app.views.drawing.in_units import in_units
from app.views.drawing.scales import decades
from app.views.interface import friction
from app.views.load import cycles, load_path, loop
from app.views.reduction import clips
from app.views.scene import Scene
from app.worker.telling import told
from solver.scenes import CATALOGUE


def looked_at(scene: str, *changes: dict[str, Any]) -> Scene:
    """Do a short run for each of the changes, and look at the last."""
    shown = Shown()
    for ticket, change in enumerate(changes or ({},), start=1):
        shown.run(ticket, scene, {**SMALL[scene], "max_iterations": 4, **change})
    return shown.scene()


def test_the_ghost_of_the_loop_is_the_run_before_and_not_its_reference() -> None:
    scene = looked_at("bar", {"method": "paper", "max_iterations": 2}, {})
    drawing = loop.draw(scene, None)
    assert "run before, iteration 2" in keys(drawing)
    before = scene.before
    assert before is not None
    assert before.frame is not None
    assert before.reference is not None
    ghost = np.asarray(drawing.curves[0].x)
    scale = ghost[-1] / before.frame.end_displacement[-1]
    assert ghost == pytest.approx(scale * before.frame.end_displacement, rel=1e-5)
    assert ghost != pytest.approx(scale * before.reference.end_displacement, rel=0.01)


def test_a_loop_of_other_quantities_is_no_ghost() -> None:
    scene = looked_at("layers", {"bending": "moment"}, {})
    assert "run before" not in keys(loop.draw(scene, None))


@pytest.mark.parametrize(
    ("scene", "has_closed_form"), [("bar", True), ("strand", False)], ids=["bar", "strand"]
)
def test_a_legend_names_only_curves_that_are_there(scene: str, has_closed_form: bool) -> None:
    whole = looked_at(scene)
    bare = replace(whole, run=replace(whole.run, reference=None))
    for view in (friction.VIEW, loop.VIEW, error_time.VIEW):
        first, alone = keys(view.draw(bare, None)), keys(view.draw(whole, None))
        assert not {"reference", "incremental", "run before"} & set(first)
        assert {"reference", "incremental"} & set(alone)
        assert ("closed form" in alone) == (has_closed_form and view is not error_time.VIEW)


def test_curves_that_begin_above_ten_are_not_cut_off() -> None:
    scene = looked_at("block")
    scene.run.history._table[COLUMNS.index("behaviour"), 0] = 31.0
    y = convergence.draw(scene, None).y
    assert y is not None
    assert y.high == 100.0


def test_an_estimate_that_is_made_now_and_then_is_a_curve_through_all_of_them() -> None:
    scene = looked_at("bar", {"method": "paper", "max_iterations": 7, "tolerance": 1e-30})
    made = np.array([np.nan, 0.5, np.nan, np.nan, 0.2, np.nan, 0.1])
    scene.run.history._table[COLUMNS.index("estimated_error"), :7] = made
    curves = convergence.draw(scene, None).curves
    estimate = next(curve for curve in curves if curve.color == ORANGE)
    assert list(estimate.x) == [2, 5, 7]
    assert list(estimate.y) == [0.5, 0.2, 0.1]


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ([], (0.1, 1.0)),
        ([np.nan, 0.0], (0.1, 1.0)),
        ([3e-5, 0.2], (1e-5, 1.0)),
        ([7.0], (1.0, 100)),
    ],
)
def test_decades_hold_all_positive_values(values: list[float], ends: tuple[float, float]) -> None:
    assert decades(values, 1e-18) == pytest.approx(ends)


def test_past_runs_differ_in_color_and_keep_theirs() -> None:
    scene = looked_at("bar", {"max_iterations": 2}, {})
    tickets = [1, 3, 7, 13, 19, 20, 26, 32]
    past = [replace(scene.run, ticket=ticket) for ticket in tickets]
    kept: dict[int, str] = {}
    seen: dict[int, str] = {}
    for last in range(1, len(past) + 1):
        six = tuple(past[max(0, last - 6) : last])
        drawing = error_time.draw(replace(scene, past=six), kept)
        kept = drawing.kept
        assert len(set(kept.values())) == len(six)
        assert all(seen.get(ticket, color) == color for ticket, color in kept.items())
        seen.update(kept)


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_all_axes_along_a_scene_run_from_end_to_end(scene: str) -> None:
    looked = looked_at(scene)
    settings = looked.run.settings
    for view in fitting(settings):
        drawing = view.draw(looked, None)
        if view.plot.x_label == POSITION and drawing is not None and drawing.x is not None:
            assert (drawing.x.low, drawing.x.high) == (0.0, settings.values()["length"])


def test_the_same_scene_is_drawn_the_same_again() -> None:
    looked = looked_at("block", {}, {"friction": 0.4})
    for view in fitting(looked.run.settings):
        first = view.draw(looked, None)
        assert first is not None
        again = view.draw(looked, first.kept)
        assert again is not None
        assert (first.x, first.y, first.keys) == (again.x, again.y, again.keys)


def test_views_have_names_of_their_own_and_all_are_looked_at() -> None:
    assert len({view.slug for view in VIEWS}) == len(VIEWS)
    assert set(ALL.views) == {view.name for view in VIEWS}


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_plot_is_told_in_a_sentence_of_numbers(scene: str) -> None:
    whole = looked_at(scene)
    for view in fitting(whole.run.settings):
        drawing = view.draw(whole, None)
        assert drawing is not None
        said = told(view, drawing)
        assert said.endswith("."), view.name
        assert re.search(r"\d", said), said


def test_what_is_told_of_a_plot_is_what_it_shows() -> None:
    whole = looked_at("bar")
    fields, history = whole.frame.fields, whole.run.history
    force = fields.friction[:, whole.instant] / 1e3
    said = {
        view.name: told(view, in_units(drawing, MM))
        for view in fitting(whole.run.settings)
        if (drawing := view.draw(whole, None)) is not None
    }
    assert f"LATIN from {force.min() + 0.0:.3g} to {force.max():.3g};" in said["Friction force"]
    share = 100.0 * np.mean(fields.status == 0)
    assert f"stick {share:.0f} %" in said["Stick and slip"]
    errors = history.column("error_force")
    assert f"force error from {errors[0]:.2g} to {errors[-1]:.2g}." in said["Convergence"]
    assert "F = " in said["Scene"]
    assert said["Scene"].startswith("A steel bar lies on a rough table")


def test_loads_of_one_symbol_say_where_they_act() -> None:
    shown = Shown()
    for ticket, scene in enumerate(("block", "layers"), start=1):
        shown.run(ticket, scene, SMALL[scene])
        names = [text.rpartition(", ")[0] for text in keys(load_path.draw(shown.scene(), None))]
        assert len(set(names)) == len(names) > 1


def test_a_picture_has_one_scale_of_stress_wherever_one_came_from() -> None:
    shown = Shown()
    shown.run(1, "block", SMALL["block"])
    scenes = [shown.scene(replace(ALL, phase=phase)) for phase in np.linspace(0.0, 1.0, 13)]
    afresh = [deformed.draw(scene, None) for scene in scenes]
    for scene, drawing in zip(scenes, afresh, strict=True):
        for before in afresh:
            assert before is not None
            coming = deformed.draw(scene, before.kept)
            assert coming is not None
            assert drawing is not None
            assert coming.colors == drawing.colors


TO_AND_FRO = {"load": "cycles", "instants": 161}


def test_cycles_are_drawn_from_first_to_last_with_the_word_that_they_earn() -> None:
    scene = looked_at("bar", {**TO_AND_FRO, "max_iterations": 100})
    loops, energy = cycles.draw_loops(scene, None), cycles.draw_energy(scene, None)
    assert keys(loops) == keys(energy) == ["cycle 1", "cycle 5"]
    assert energy.sentence == loops.sentence
    assert loops.sentence.startswith("Steady slip: every cycle takes 4")
    bars = [np.asarray(curve.y)[-1] for curve in energy.curves]
    areas = [abs(area(curve)) for curve in loops.curves[1:]]
    assert bars == pytest.approx(areas, rel=2e-2)
    assert len({curve.color for curve in loops.curves}) == 6


def area(curve: Curve) -> float:
    """Integrate force over displacement around a loop, J."""
    x, y = np.asarray(curve.x, dtype=float), np.asarray(curve.y, dtype=float)
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))


def test_the_last_cycle_frets_where_it_slips_most() -> None:
    drawing = cycles.draw_fretting(looked_at("bar", TO_AND_FRO), None)
    assert [name.split(",")[0] for name in keys(drawing)] == ["friction work", "slip"]
    for curve in drawing.curves:
        shares = np.asarray(curve.y)
        assert shares.max() == shares[-1] == 1.0
        assert shares[0] == 0.0


@pytest.mark.parametrize(
    ("scene", "changes", "said"),
    [
        ("bar", {**TO_AND_FRO, "peak": 1.0}, "Nothing slips."),
        ("strand", {"load": "cycle", "instants": 41}, "No three cycles"),
        ("block", {"top_tangential_load": "cycles", "gap": "flat", "instants": 121}, "Elastic"),
    ],
)
def test_what_becomes_of_slip_is_said_only_where_it_is_settled(
    scene: str, changes: dict[str, Any], said: str
) -> None:
    drawing = cycles.draw_loops(looked_at(scene, {**changes, "max_iterations": 100}), None)
    assert drawing.sentence.startswith(said)


def ring(scene: Scene) -> tuple[float, float]:
    """Give where the mark of clips alone stands: numbers, and error."""
    (mark,) = clips.draw(scene, None).marks
    return float(np.asarray(mark.x)[0]), float(np.asarray(mark.y)[0])


def test_numbers_kept_are_those_of_the_iterate_and_fall_below_any_other_once_it_is_solved() -> None:
    paper = {"method": "paper", "max_iterations": 3}
    early, late = looked_at("bar", paper), looked_at("bar", {"max_iterations": 40})
    assert "clips, 3 × 2 vectors: exact" not in keys(clips.draw(early, None))
    assert "clips, 3 × 2 vectors: exact" in keys(clips.draw(late, None))
    kept = 3 * (2 * 21 + 1) + 21 + 21
    assert ring(early)[0] == ring(late)[0] == kept
    found = early.frame.clipped
    assert ring(early)[1] == pytest.approx(found.clips.errors[0])
    assert clips.draw(late, None).sentence == (
        f"For 1 %: table {21 * 21}, SVD {late.frame.clipped.products.within(0.01):.0f}, "
        f"PGD {late.frame.clipped.separated.within(0.01):.0f}, clips {kept} numbers."
    )
    for color, sizes in (
        (BLUE, found.products),
        (GREEN, found.separated),
        (VERMILION, found.clips),
    ):
        curve = next(one for one in clips.draw(early, None).curves if one.color == color)
        errors = dict(zip(sizes.numbers.tolist(), sizes.errors.tolist(), strict=True))
        drawn = zip(np.asarray(curve.x).tolist(), np.asarray(curve.y).tolist(), strict=True)
        assert all(y == pytest.approx(max(errors[x], 1e-6)) for x, y in drawn)


def test_whose_modes_are_counted_is_said() -> None:
    bases = {"linear_stage": "pgd", "pgd_modes": 4}
    assert "PGD of the run" in keys(clips.draw(looked_at("bar", bases), None))
    assert "best PGD in 4 pieces" in keys(clips.draw(looked_at("bar"), None))
    alone = clips.draw(looked_at("bar", {"substructures": 1}), None)
    assert not [name for name in keys(alone) if "PGD" in name]
    assert "PGD" not in alone.sentence


def test_clips_are_of_rods_over_time_and_said_of_nothing_else() -> None:
    settings = {name: entry.settings for name, entry in CATALOGUE.items()}
    assert {name for name, one in settings.items() if clips.VIEW in fitting(one.checked({}))} == {
        "bar",
        "strand",
    }
    for too_few_or_many in ({"instants": 1}, {"elements": 20_000}):
        assert clips.VIEW not in fitting(settings["bar"].checked(too_few_or_many))
