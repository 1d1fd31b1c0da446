"""A picture is of one iterate of one run, carries only what changed, and comes when asked for."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
from shown_pages import ALL, SMALL, Shown, run_of
from unpacking import unpack

from app.views.catalogue import fitting
from app.wire.block import Packer, Quads
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
    shown = Shown()
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


def test_what_is_painted_bit_by_bit_is_what_is_painted_afresh() -> None:
    shown = Shown()
    shown.run(1, "bar", PAPER)
    bit_by_bit = shown.page
    shown.obey(Ready(afresh=True))
    afresh = unpack(shown.pictures[-1].block)
    assert set(afresh) == set(bit_by_bit)
    assert all(repr(afresh[name]) == repr(bit_by_bit[name]) for name in afresh)
    assert len(shown.pictures[-2].block) < len(shown.pictures[-1].block)


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


def test_a_block_gives_back_what_was_packed() -> None:
    models: dict[str, dict[str, Any]] = {
        "a": {"xs": [np.arange(3.0), np.arange(5.0)], "color": ["red", "blue"]},
        "b": {"image": np.arange(6, dtype=np.uint8).reshape(2, 3), "x": [0.5]},
        "c": {"quads": Quads(np.arange(8).reshape(2, 4), np.ones((8, 2))), "value": np.ones(2)},
        "d": {"text": "µ"},
    }
    packer = Packer()
    found = unpack(packer.pack(models))
    assert [list(line) for line in found["a"]["xs"]] == [[0, 1, 2], [0, 1, 2, 3, 4]]
    assert np.array_equal(found["b"]["image"], models["b"]["image"])
    assert np.array_equal(found["c"]["quads"][0], [[0, 1, 2, 3], [4, 5, 6, 7]])
    assert found["d"]["text"] == "µ"
    assert unpack(packer.pack(models)) == {}
    models["b"]["x"] = [1.5]
    assert list(unpack(packer.pack(models))) == ["b"]
    packer.forget()
    assert set(unpack(packer.pack(models))) == set(models)


def test_errors_of_a_run_that_follows_a_hand_come_with_its_reference() -> None:
    shown = Shown()
    shown.run(1, "block", {**SMALL["block"], "friction": 0.31}, follows_hand=True)
    errors = shown.recording.history.column("error_force")
    assert len(errors) > 1
    assert np.isfinite(errors).all()
    assert errors[-1] < 1e-8
    assert "force error" in shown.words
