"""Iterations over k gather beside the curves of Convergence as one tries values of k."""

from __future__ import annotations

from typing import Any

import numpy as np
from shown_pages import SMALL, Shown

from app.views.convergence import convergence
from app.whatif.ready import over_k

SEARCH = {**SMALL["bar"], "finish": "accuracy"}


def tried(*ks: float, **more: Any) -> Shown:
    shown = Shown()
    for ticket, k in enumerate(ks, 1):
        shown.run(ticket, "bar", {**SEARCH, **more, "k_scale": k})
    return shown


def seen(shown: Shown) -> list[Any]:
    found: list[Any] = shown.page["plots"]["bathtub"]
    return found


def test_three_values_of_k_make_a_curve_of_what_the_runs_themselves_counted() -> None:
    shown = tried(10.0, 0.1)
    assert seen(shown) == []
    shown.run(3, "bar", {**SEARCH, "k_scale": 1.0})
    points, now, near = seen(shown)
    runs = [*shown.scene().past, shown.recording]
    counted = {one.settings.k_scale: one.searched for one in runs}
    assert points == [[k, counted[k], True] for k in (0.1, 1.0, 10.0)]
    assert (now, near) == (1.0, "1 %")


def test_another_setting_begins_a_new_curve_and_what_ends_a_run_does_not() -> None:
    shown = tried(10.0, 0.1, 1.0)
    shown.run(4, "bar", {**SEARCH, "finish": "at-once", "k_scale": 3.0})
    assert [k for k, *_ in seen(shown)[0]] == [0.1, 1.0, 10.0]
    shown.run(5, "bar", {**SEARCH, "friction": 0.2, "k_scale": 3.0})
    assert seen(shown) == []


def test_a_run_that_ended_before_it_was_as_near_is_marked() -> None:
    shown = tried(0.01, 1.0, 10.0, method="paper", max_iterations=12, finish="none")
    assert seen(shown)[0][0] == [0.01, 12, False]


def test_no_curve_lies_in_the_room_that_it_takes() -> None:
    scene = tried(0.1, 1.0, 10.0).scene()
    drawing = convergence.draw(scene, None)
    assert drawing.x is not None
    ends = [np.max(one.x, initial=0.0) for one in drawing.curves]
    assert max(ends) <= (1.0 - convergence.ROOM) * drawing.x.high * (1 + 1e-12)


def test_the_whole_curve_can_be_asked_for() -> None:
    settings = tried(1.0).recording.settings
    question = over_k(settings)
    assert question.refusals(settings) == {}
    assert question.of == "iterations_to_force@0.01"
