"""A picture is of one iterate of one run, carries only what changed, and comes when asked for."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from shown_pages import ALL, SMALL, Shown, run_of
from unpacking import Unpacker, unpack

from app.views.catalogue import fitting
from app.wire.block import Packer, Places, Quads
from app.wire.orders import Pace, Ready, Run, Seek, Step, Watch
from app.wire.reports import Picture
from app.worker.page_runs import PageRuns
from solver.scenes import CATALOGUE

PAPER = {**SMALL["bar"], "method": "paper", "max_iterations": 12}


@pytest.mark.parametrize("stage", ["full", "pgd"])
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_view_that_applies_is_painted_of_the_iterate_that_the_words_name(
    scene: str, stage: str
) -> None:
    shown = Shown(is_quick=True)
    for ticket in (1, 2):
        values = {**SMALL[scene], "linear_stage": stage, "max_iterations": 6}
        shown.run(ticket, scene, {**values, "friction": 0.3 + 0.01 * ticket})
    for picture, page in zip(shown.pictures, shown.models, strict=True):
        words = page["status"]["text"]
        assert re.search(rf"(iteration|after) {picture.facts.done}\b", words)
        assert page["iteration"]["text"] == f"{picture.facts.iteration} of {picture.facts.done}"
        assert page["instant"]["shown"] == picture.facts.instant
        curves = page["convergence.curves"]
        if picture.facts.done == len(curves["xs"][-2]):
            assert curves["xs"][-1][0] == picture.facts.iteration
    for view in fitting(shown.recording.settings):
        assert f"{view.slug}.title" in shown.page


@pytest.mark.parametrize("scene", ["bar", "block", "rope"])
def test_what_is_painted_bit_by_bit_is_what_is_painted_afresh_and_much_less(scene: str) -> None:
    shown = Shown(is_quick=True)
    shown.run(1, scene, {**SMALL[scene], "method": "paper", "max_iterations": 12})
    for phase in (0.3, 0.4, 0.8):
        shown.obey(Watch(replace(ALL, phase=phase)))
    bit_by_bit = shown.page
    shown.obey(Ready(afresh=True))
    afresh = unpack(shown.pictures[-1].block)
    np.testing.assert_equal(afresh, bit_by_bit)
    assert len(shown.pictures[-2].block) < 0.5 * len(shown.pictures[-1].block)


def test_no_picture_is_made_that_the_page_is_not_ready_for() -> None:
    sent: list[Picture] = []
    runs = PageRuns(sent.append, lambda: False)
    runs.obey(Watch(ALL))
    runs.obey(Ready())
    runs.obey(run_of(1, "bar", PAPER))
    while runs.rest() is not None:
        if not runs.paint():
            runs.go_on()
    assert [picture.facts.iteration for picture in sent] == [1]
    runs.obey(Ready())
    assert runs.paint()
    assert [picture.facts.iteration for picture in sent] == [1, 12]
    runs.obey(Ready())
    assert runs.rest() is None


def test_a_run_that_follows_a_hand_is_shown_at_its_end_and_is_no_run_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("app.worker.run.IN_A_HURRY", 60.0)
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    count = len(shown.pictures)
    shown.run(2, "bar", {**SMALL["bar"], "friction": 0.31}, follows_hand=True)
    first = shown.pictures[count]
    assert first.facts.is_over
    assert "converged" in shown.models[count]["status"]["text"]
    shown.run(3, "bar", {**SMALL["bar"], "friction": 0.31}, label="friction 0.31")
    assert shown.runs._before is not None
    assert shown.runs._before.ticket == 1


def test_a_paused_run_steps_is_sought_in_and_followed() -> None:
    shown = Shown()
    shown.run(1, "bar", PAPER, pause_after=5)
    assert "paused" in shown.words
    shown.obey(Step(1), Step(1))
    assert shown.pictures[-1].facts.done == 7
    shown.obey(Seek(1, 3))
    assert shown.pictures[-1].facts.iteration == 3
    assert "showing iteration 3" in shown.words
    shown.obey(Watch(replace(ALL, phase=0.1)))
    assert shown.pictures[-1].facts.iteration == 3
    shown.obey(Pace(1, 0.0, is_held=True))
    assert "for the study to be timed" in shown.words
    shown.obey(Seek(1, None), Pace(1, None))
    assert shown.pictures[-1].facts.is_over
    assert shown.pictures[-1].facts.iteration == 12


def test_orders_about_another_run_are_ignored() -> None:
    shown = Shown()
    shown.run(7, "bar", PAPER, pause_after=2)
    shown.obey(Pace(6, None), Step(6), Seek(6, 1))
    assert shown.pictures[-1].facts.done == shown.pictures[-1].facts.iteration == 2


def test_another_scene_has_no_run_before() -> None:
    shown = Shown()
    shown.run(1, "bar", SMALL["bar"])
    shown.run(2, "bar", {**SMALL["bar"], "friction": 0.31})
    assert "before" in shown.page["figures"]["text"]
    shown.run(3, "block", SMALL["block"])
    assert "before" not in shown.page["figures"]["text"]


def test_a_run_that_breaks_is_told_and_the_next_one_runs() -> None:
    shown, nothing = Shown(), cast(Any, None)
    shown.obey(Run(1, nothing))
    assert shown.pictures[-1].facts.is_broken
    assert "The run broke (AttributeError" in shown.words
    shown.run(2, "bar", SMALL["bar"])
    assert shown.pictures[-1].facts.is_over


X, Y = Places([np.arange(8.0)], 0.0, 7.0), Places([[5.0] * 7 + [np.nan]], 0.0, 1.0)


def test_a_block_gives_back_what_was_packed() -> None:
    models: dict[str, dict[str, Any]] = {
        "a": {"xs": [np.arange(3.0), np.arange(5.0)], "color": ["red", "blue"]},
        "b": {"image": np.arange(6, dtype=np.uint8).reshape(2, 3), "x": [0.5]},
        "c": {"quads": Quads(np.arange(8).reshape(2, 4), X, Y), "value": np.ones(2)},
        "d": {"text": "µ"},
    }
    packer, unpack = Packer(), Unpacker()
    found = unpack(packer.pack(models))
    assert [list(line) for line in found["a"]["xs"]] == [[0, 1, 2], [0, 1, 2, 3, 4]]
    assert np.array_equal(found["b"]["image"], models["b"]["image"])
    assert np.array_equal(found["c"]["quads"][0], [[0, 1, 2, 3], [4, 5, 6, 7]])
    x, y = found["c"]["quads"][1].T
    np.testing.assert_allclose(x, np.arange(8.0), atol=1e-4)
    np.testing.assert_allclose(y, [5.0] * 7 + [np.nan])
    assert found["d"]["text"] == "µ"
    assert unpack(packer.pack(models)) == {}
    models["b"]["x"] = [1.5]
    assert list(unpack(packer.pack(models))) == ["b"]
    packer.forget()
    assert set(unpack(packer.pack(models))) == set(models)


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 300])
def test_numbers_are_whole_however_many_there_were_before(count: int) -> None:
    rng, packer, unpack, page = np.random.default_rng(count), Packer(), Unpacker(), {}
    for length in (70, count, count, 40):
        values = rng.normal(size=length).astype(np.float32)
        values[::3] = np.nan
        for change in (0.0, 1.0):
            values[: length // 2] += change
            page |= unpack(packer.pack({"a": {"x": values, "color": "red"}}))
            np.testing.assert_equal(page, {"a": {"x": values, "color": "red"}})


def test_of_numbers_only_those_come_that_are_new() -> None:
    values, packer = np.arange(1000.0), Packer()
    whole = len(packer.pack({"a": {"x": values}}))
    values[500:510] = 0.0
    assert len(packer.pack({"a": {"x": values}})) < 0.1 * whole


@pytest.mark.parametrize("low", [-3.0, 0.0])
def test_places_are_told_to_less_than_a_pixel_wherever_they_are(low: float) -> None:
    line = np.array([0.5, np.nan, -2.0, 8.0, np.inf])
    block = Packer().pack({"a": {"xs": Places([line, []], low, 5.0)}})
    found, nothing = unpack(block)["a"]["xs"]
    np.testing.assert_allclose(found[[0, 2, 3]], [0.5, -2.0, 8.0], atol=11.0 / 60_000)
    assert np.isnan(found[[1, 4]]).all()
    assert not nothing.size


def test_errors_of_a_run_that_follows_a_hand_come_with_its_reference() -> None:
    shown = Shown()
    shown.run(1, "block", {**SMALL["block"], "friction": 0.31}, follows_hand=True)
    errors = shown.recording.history.column("error_force")
    assert len(errors) > 1
    assert np.isfinite(errors).all()
    assert errors[-1] < 1e-8
    assert "force error" in shown.words
