"""A run that may start from the one before it says from where it did, on the page and in files."""

from __future__ import annotations

from contextlib import closing
from typing import Any

import pytest
from shown_pages import Shown

from app.picture.recording import Recording
from app.picture.sampler import Sampler
from app.picture.shown import Look
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.session import Session
from app.session.undo import Undo
from app.shell.actions import Actions
from app.wire.reports import Facts
from app.worker.words import start_line
from solver.files import settings_from_toml
from solver.latin.warm import StartChoice
from solver.scenes import discretise
from solver.scenes.bar import BarSettings

NEARER, FARTHER = StartChoice(0.01, 1.0), StartChoice(0.5, 1.0)


def recording(choice: StartChoice | None, **changes: Any) -> Recording:
    settings = BarSettings.checked({"method": "paper", **changes})
    stand = Sampler(discretise(settings), settings, Look()).stand()
    return Recording(1, settings, "peak 910 N", "", stand, is_warm=True, choice=choice)


@pytest.mark.parametrize(
    ("choice", "changes", "words"),
    [
        (
            NEARER,
            {},
            "Started from the run before: after one iteration its k-free indicator is 0.01",
        ),
        (NEARER, {}, "from zero it is 1."),
        (FARTHER, {}, "Started from zero. The run before is not clearly nearer"),
        (FARTHER, {"start": "nested"}, "from a coarser mesh it is 1."),
        (None, {}, "Started from zero, as there was no run before to start from."),
    ],
)
def test_the_status_line_gives_the_start_and_both_indicators(
    choice: StartChoice | None, changes: Any, words: str
) -> None:
    run = recording(choice, **changes)
    assert words in start_line(run)


def test_a_run_that_had_no_choice_says_nothing_of_it() -> None:
    shown = Shown()
    shown.run(1, "bar", {})
    assert "tarted" not in shown.words


def test_a_run_from_the_one_before_is_called_so_where_runs_are_compared() -> None:
    assert recording(NEARER).title == "peak 910 N, from the run before it"
    assert recording(FARTHER).title == "peak 910 N"
    assert recording(None).title == "peak 910 N"


def test_saved_settings_say_that_the_run_did_not_start_as_they_do() -> None:
    settings = BarSettings.checked({"method": "paper", "peak": 910.0})
    with closing(Session(Pages(1), ReportExecutor(), settings)) as session:
        undo = Undo(session, lambda name: None)
        actions = Actions(session, lambda: None, undo, *[lambda: None] * 2)
        actions.hear("save")
        plain, _ = actions.view.file
        session.facts = Facts(was_warm=True)
        actions.hear("save")
        told, _ = actions.view.file
    assert told.endswith(plain)
    assert "started from the solution of the run before it" in told.replace("\n# ", " ")
    assert "started" not in plain
    assert settings_from_toml(told).values() == session.settings.values()
