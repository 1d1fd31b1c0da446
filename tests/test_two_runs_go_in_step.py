"""Run A goes in step with the run at work, B: equal iterations, the same numbers as alone."""

from __future__ import annotations

from dataclasses import replace
from html import unescape
from typing import Any

import numpy as np
import pytest
from direct_runs import direct, iterate_number
from shown_pages import ALL, Shown, keys
from test_worker_process import same
from unpacking import unpack

from app.controls.comparing import PRESETS, pair
from app.picture.sampler import Sampler
from app.views.convergence import convergence, error_time
from app.views.interface import friction, tractions
from app.views.load import loop
from app.wire.orders import Pace, Seek, Step, Watch
from app.worker.key_figures import NONE_YET
from solver.files import scene_settings
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

SMALL: dict[str, Any] = {"elements": 20, "instants": 21, "substructures": 4, "method": "paper"}
BRIEF = {**SMALL, "max_iterations": 12}
LONG = BarSettings.checked({**SMALL, "max_iterations": 30, "multiscale": False}).values()
"""Of run A, which the page gives as a whole."""


def rougher(scene: str, values: dict[str, Any]) -> dict[str, Any]:
    return scene_settings(scene).checked({**values, "friction": 0.4}).values()


def paired(pause_after: int | None = None, *, is_quick: bool = False, **options: Any) -> Shown:
    shown = Shown(is_quick=is_quick)
    shown.run(1, "bar", BRIEF, pause_after=pause_after, twin=LONG, **options)
    return shown


def test_both_are_shown_at_equal_iterations_until_each_has_ended() -> None:
    shown = paired(is_quick=True)
    twin = shown.runs._twin
    assert twin is not None
    assert [picture.facts.iteration for picture in shown.pictures][-1] == 30
    assert shown.recording.iteration == 12
    assert twin.recording.iteration == twin.recording.shown == 30
    assert same(shown.recording.history, direct(BRIEF).records)
    assert same(twin.recording.history, direct(LONG).records)
    for picture in shown.pictures[:-1]:
        assert picture.facts.is_over == (picture.facts.iteration == 30)
    shown.obey(Seek(1, 7))
    assert (shown.frame().iteration, twin.recording.shown) == (7, 7)
    shown.obey(Seek(1, 20))
    assert (shown.frame().iteration, twin.recording.shown) == (12, 20)
    assert shown.pictures[-1].facts.iteration == 20


def test_the_ghost_is_run_a_at_the_iteration_that_its_legend_says() -> None:
    shown = paired(pause_after=5)
    iterate = iterate_number(5, LONG)
    expected = Sampler(iterate.problem, BarSettings.checked(LONG), ALL).frame(iterate, ALL)
    ghost = shown.scene().ghost
    assert ghost is not None
    assert np.array_equal(ghost[1].friction, expected.fields.friction)
    for view in (friction.VIEW, loop.VIEW):
        names = keys(view.draw(shown.scene(), None))
        assert {"B", "A, iteration 5"} < set(names)
    assert "A" in keys(convergence.draw(shown.scene(), None))
    assert {"A", "B"} < set(keys(error_time.draw(shown.scene(), None)))


def test_a_step_a_pause_and_another_interface_hold_for_both() -> None:
    shown = paired(pause_after=5)
    twin = shown.runs._twin
    assert twin is not None
    shown.obey(Step(1))
    assert (shown.frame().iteration, twin.recording.shown) == (6, 6)
    shown.obey(Pace(1, None))
    assert twin.recording.shown == 30
    both = Shown()
    values = {"elements": 10, "instants": 11, "max_iterations": 4}
    both.run(1, "strand", values, twin=rougher("strand", values))
    both.obey(Watch(replace(ALL, interface="contact 2-3")))
    scene = both.scene(replace(ALL, interface="contact 2-3"))
    assert scene.ghost is not None
    assert scene.ghost[1].interface == "contact 2-3"


def test_run_a_is_kept_from_one_run_b_to_the_next() -> None:
    shown = paired()
    twin = shown.runs._twin
    shown.run(2, "bar", {**BRIEF, "friction": 0.31}, twin=LONG, pause_after=4)
    assert shown.runs._twin is twin
    assert twin is not None
    assert (shown.frame().iteration, twin.recording.shown) == (4, 4)
    shown.run(3, "bar", BRIEF, twin={**LONG, "friction": 0.31})
    assert shown.runs._twin is not twin
    shown.run(4, "bar", BRIEF)
    assert shown.runs._twin is None
    assert "run before, iteration 12" in keys(friction.VIEW.draw(shown.scene(), None))


def test_figures_stand_at_equal_iteration_and_at_equal_run_time() -> None:
    shown = paired(pause_after=5)
    twin = shown.runs._twin
    assert twin is not None
    # What is measured, put where it is known: A is three times as fast as B.
    for history, pace in ((shown.recording.history, 3.0), (twin.recording.history, 1.0)):
        for iteration in range(1, len(history) + 1):
            history.change(iteration, seconds=pace * iteration)
    shown.obey(Seek(1, 1))
    text = shown.page["figures"]["text"]
    assert "B (multiscale on, " in text
    assert "A (multiscale off, " in text
    assert "3000.0 ms" in text.split("A at B&#x27;s run time")[-1]
    shown.obey(Seek(1, None))
    # B has run for 15 s, A only for 5 s: they are compared as they were then.
    assert "3000.0 ms" in shown.page["figures"]["text"].split("B at A")[-1]
    assert twin.recording.last_within(3.5) == 3
    assert twin.recording.last_within(0.5) == 0


def test_a_run_without_an_iteration_at_equal_run_time_is_said_to_have_none() -> None:
    shown = paired()
    assert NONE_YET not in shown.page["figures"]["text"]
    twin = shown.runs._twin
    assert twin is not None
    for iteration in range(1, len(twin.recording.history) + 1):
        twin.recording.history.change(iteration, seconds=1e3 + iteration)
    shown.obey(Seek(1, 3))
    assert NONE_YET in shown.page["figures"]["text"].split("A at B&#x27;s run time")[-1]


def test_tractions_of_plane_bodies_have_a_ghost_too() -> None:
    shown = Shown()
    values = {"elements": 16, "elements_up": 6, "instants": 13, "max_iterations": 4}
    shown.run(1, "block", values, twin=rougher("block", values))
    assert any(name.startswith("A, ") for name in keys(tractions.draw(shown.scene(), None)))


@pytest.mark.parametrize("choice", list(PRESETS))
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_presets_set_two_runs_of_every_scene(scene: str, choice: str) -> None:
    base = {"elements": 12, "instants": 7, "max_iterations": 5}
    twin, own = pair(choice, CATALOGUE[scene].settings.checked(base))
    assert twin is not None
    shown = Shown()
    shown.run(1, scene, own.values(), twin=twin.values())
    facts = shown.pictures[-1].facts
    assert facts.is_over
    assert not facts.is_broken
    assert shown.scene().ghost is not None
    assert "A (" in shown.page["figures"]["text"]


@pytest.mark.parametrize("hand", [False, True])
def test_a_picture_of_b_comes_before_that_of_a(hand: bool) -> None:
    shown = paired(follows_hand=hand)
    first = unpack(shown.pictures[0].block)
    assert "B (" in first["figures"]["text"]
    assert shown.pictures[-1].facts.is_over


def test_a_run_of_many_changes_is_named_in_whole_for_who_asks() -> None:
    shown = Shown()
    many = BarSettings.checked({**LONG, "friction": 0.4, "young": 3e9}).values()
    shown.run(1, "bar", BRIEF, twin=many)
    text = unescape(shown.page["figures"]["text"])
    whole = text.split('aria-label="A (')[1].split('"')[0]
    assert all(word in whole for word in ("friction 0.4", "young 3000 MPa", "max iterations 30"))
    assert "..." not in whole
    assert f'title="A ({whole}"' in text
