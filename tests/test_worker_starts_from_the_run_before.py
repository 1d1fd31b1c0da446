"""A run starts from the one before it where it is told to."""

from __future__ import annotations

from itertools import islice

import numpy as np
from direct_runs import direct
from shown_pages import ALL, Shown, run_of
from test_worker_process import same
from worker_line import STALLING

from app.picture.sampler import Sampler
from app.wire.orders import Seek
from solver.latin import Iterate, Record, StopRules, record
from solver.latin.warm import choose_start
from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

NEAR = {**STALLING, "friction": 0.3001}


def warm_iterates(number: int) -> list[Iterate]:
    """Give the iterates of NEAR, started from the end of STALLING, without the worker."""
    settings = BarSettings.checked(NEAR)
    start, run = choose_start(discretise(settings), method_of(settings), direct(STALLING).iterate)
    assert start.choice.is_previous
    return list(islice(run, number))


def warm_records(number: int) -> list[Record]:
    settings, iterates = BarSettings.checked(NEAR), warm_iterates(number)
    problem = iterates[0].problem
    distance, rules = distance_to(incremental(problem), problem), StopRules(method_of(settings))
    return [record(iterate, rules.judge(iterate), distance) for iterate in iterates]


def after_the_first() -> Shown:
    shown = Shown()
    shown.run(1, "bar", STALLING)
    return shown


def test_warm_run_starts_from_the_run_that_it_takes_the_place_of() -> None:
    shown = after_the_first()
    shown.run(2, "bar", NEAR, warm=True, pause_after=30)
    assert same(shown.recording.history, warm_records(30))
    assert shown.pictures[-1].facts.was_warm
    iterates = warm_iterates(17)
    for number in (1, 17):
        shown.obey(Seek(2, number))
        iterate = iterates[number - 1]
        expected = Sampler(iterate.problem, BarSettings.checked(NEAR), ALL)
        other = expected.frame(iterate, ALL)
        assert np.array_equal(shown.frame().fields.friction, other.fields.friction)


def test_warm_run_that_is_replaced_at_once_hands_on_what_it_was_given() -> None:
    shown = after_the_first()
    shown.runs.obey(run_of(2, "bar", {**NEAR, "peak": 901.0}, warm=True))
    shown.run(3, "bar", NEAR, warm=True, pause_after=5)
    assert shown.pictures[-1].facts.was_warm


def test_the_replay_of_what_followed_a_hand_starts_from_the_run_before_that() -> None:
    shown = after_the_first()
    shown.run(2, "bar", NEAR, warm=True, follows_hand=True)
    shown.run(3, "bar", NEAR, warm=True, pause_after=5)
    assert same(shown.recording.history, warm_records(5))


def test_a_run_starts_as_its_settings_say_otherwise() -> None:
    shown = after_the_first()
    shown.run(2, "bar", NEAR)
    assert same(shown.recording.history, direct(NEAR).records)
    assert not shown.pictures[-1].facts.was_warm
    first = Shown()
    first.run(1, "bar", NEAR, warm=True, pause_after=3)
    assert not first.pictures[-1].facts.was_warm
    assert "as there was no" in first.words


def test_full_stage_beside_a_warm_run_starts_where_that_does() -> None:
    shown = after_the_first()
    shown.run(2, "bar", {**NEAR, "linear_stage": "pgd"}, warm=True, pause_after=5)
    assert same(shown.recording.beside, warm_records(5))
