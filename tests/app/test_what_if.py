"""Runs of What if reach the chart as they come; Reports run commands in turn."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from small_scenes import SMALL
from sweeps import TINY, Here

from app.experiments import jobs, reports, whatif
from app.experiments.jobs import Job, Sweep, share_of
from app.experiments.questions import READY, Question, iterations_over_k, question_of
from app.experiments.whatif import WhatIf
from app.lessons.catalogue import CASES
from app.state import PageState, default_settings
from app.widgets import PlainText
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.scene import Settings
from solver.study.page import head_of, line_of

LOADS = Question(("friction=0.2:0.4:3", "peak=600:900:2"), "dissipation")


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    """Runs take place in this process."""
    pool = Here()
    monkeypatch.setattr(jobs, "opened", lambda named, limit: nullcontext(pool))
    return pool


def tiny() -> Settings:
    return default_settings("bar").replace(**TINY)


def asked(question: Question) -> WhatIf:
    """The tab, whose first chart is drawn."""
    made = WhatIf(PageState(tiny(), tab="What if", question=str(question)))
    assert made.sweep is not None
    made.sweep.thread.join()
    made.look()
    return made


@pytest.mark.usefixtures("here")
def test_the_tab_opens_with_its_first_chart_drawn() -> None:
    made = asked(LOADS)
    chart = made.chart()
    assert chart.runs.holds.sum() == 6
    assert "6 of 6 runs: 6 converged" in made.message.object
    rows = [line for line in made.table().splitlines() if line[:1] not in ("#", "r")]
    assert len(rows) == 6


@pytest.mark.usefixtures("here")
def test_why_a_run_has_no_answer_is_told_in_the_words_of_the_page() -> None:
    belt = CATALOGUE["belt"]().replace(**SMALL["belt"])
    made = WhatIf(
        PageState(belt, tab="What if", question="pull=1000:2000:2 dissipation")
    )
    assert made.sweep is not None
    made.sweep.thread.join()
    made.look()
    assert "1 refused" in made.message.object
    refused = "The first refused: Pull above the tail force cannot be 2 kN: lower it"
    assert refused in made.message.object
    assert "Allowed: tensions of both ends" in made.message.object
    # What one points at in the chart says the same.
    (said,) = (said for said in made.chart().runs.said if "refused" in said)
    assert said.endswith(made.message.object.partition("The first refused: ")[2])


@pytest.mark.usefixtures("here")
def test_a_run_that_takes_too_long_is_told_without_options_of_the_command_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(jobs, "LIMIT", 0.0)
    made = asked(Question(("friction=0.2:0.4:3",), "dissipation"))
    assert "3 stuck" in made.message.object
    for text in (made.message.object, *made.chart().runs.said):
        assert "longer than the 60 s" in text
        assert "--limit" not in text


@pytest.mark.usefixtures("here")
def test_another_scene_with_a_setting_of_the_same_name_has_runs_of_its_own() -> None:
    made = asked(Question(("friction=0.2:0.4:3",), "dissipation"))
    strand = CATALOGUE["strand"]().replace(**SMALL["strand"])
    made.state.settings = strand
    assert made.question == Question(("friction=0.2:0.4:3",), "dissipation")
    made.sweep.thread.join()
    assert made.sweep.plan.settings.scene == "strand"


@pytest.mark.usefixtures("here")
def test_rows_come_one_by_one_and_cancel_ends_them() -> None:
    plan = Question(("friction=0.1:0.9:400",), "dissipation").plan(tiny())
    running = Sweep(plan)
    while not running.rows:
        time.sleep(0.01)
    assert not running.is_over
    running.cancel()
    running.thread.join()
    assert running.message == "Cancelled."
    assert 0 < len(running.rows) < plan.size


@pytest.mark.usefixtures("here")
def test_the_chart_is_of_another_question_once_one_goes_back_to_it() -> None:
    made = asked(LOADS)
    made.spans[1].name.value = ""
    assert made.question.vary == LOADS.vary[:1]
    assert made.sweep.plan.size == 6
    peak = tiny().replace(peak=800.0)
    made.state.param.update(settings=peak, question="friction=0.2:0.4:2 dissipation")
    made.sweep.thread.join()
    assert made.sweep.plan.size == len(made.sweep.rows) == 2


@pytest.mark.usefixtures("here")
def test_fields_ask_in_the_units_of_the_controls_and_refuse_in_words() -> None:
    made = asked(LOADS)
    first, second = made.spans
    first.name.value = "length"
    first.values.value = "0.5:2000 mm:3:log"
    assert made.question.vary[0] == "length=0.5:2:3:log"
    first.values.value = "500 mm, 1, 2"
    assert made.question.vary[0] == "length=0.5,1,2"
    first.values.value = "1, long"
    refusal = "Values, m cannot be “1, long”: write a number."
    assert made.message.object == refusal
    for wrong in ("-1, 2", "1:2", "1:2:x"):
        first.values.value = wrong
        assert "cannot be" in made.message.object
        assert made.question.vary[0] == "length=0.5,1,2"
    first.values.value = "1, 2"
    second.name.value = "acceleration"
    assert made.question.vary[1] == "acceleration=none,anderson"
    second.values.value = "anderson"
    assert made.question.vary[1] == "acceleration=anderson"


@pytest.mark.usefixtures("here")
def test_meshes_are_asked_of_only_where_they_decide_the_answer() -> None:
    made = asked(LOADS)
    assert made.mesh.visible
    made.state.question = str(iterations_over_k(made.state.settings))
    assert not made.mesh.visible


@pytest.mark.usefixtures("here")
def test_what_was_found_of_meshes_goes_with_its_question(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    closed = []
    job = SimpleNamespace(
        progress="1 s: 20 elements: 0.4 J",
        is_over=False,
        close=lambda: closed.append("job"),
    )
    monkeypatch.setattr(whatif, "Job", lambda *arguments: job)
    made = asked(LOADS)
    made.mesh.clicks += 1
    assert made.mesh.label == "No more"
    made.state.settings = made.state.settings.replace(pressure=6000.0)
    made.look()
    assert closed == ["job"]
    said = [str(part.object) for part in made.view.select(PlainText)]
    assert not any("0.4 J" in text for text in said)
    assert made.mesh.label == whatif.MESH


@pytest.mark.usefixtures("here")
def test_runs_that_never_get_where_one_asks_are_counted() -> None:
    made = asked(LOADS)
    assert "Without a value" not in made.message.object
    rows = made.sweep.rows
    rows[:2] = [replace(row, values=(math.inf,)) for row in rows[:2]]
    made.state.param.trigger("tab")
    assert "Without a value: 2 of the converged" in made.message.object


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("vary", [LOADS.vary, ("friction=0.2:0.4:3", "peak=600:900:7")])
def test_runs_that_a_logarithmic_scale_does_not_have_are_counted(
    vary: tuple[str, ...],
) -> None:
    made = asked(Question(vary, "dissipation"))
    rows = made.sweep.rows
    rows[:2] = [replace(row, values=(0.0,)) for row in rows[:2]]
    made.state.param.trigger("tab")
    assert "logarithmic scale" not in made.message.object
    made._scale.value = "logarithmic"
    off = "Not on a logarithmic scale: 2 of value 0 or less."
    assert off in made.message.object
    made._scale.value = "linear"
    assert off not in made.message.object


def test_a_question_is_a_text_and_one_that_the_scene_does_not_have_is_energy() -> None:
    settings = tiny()
    assert question_of(str(LOADS), settings) == LOADS
    energy = Question(("peak=240:2400:13:log",), "dissipation")
    for text in (
        "",
        "friction=0:1:3",
        "no=1,2 dissipation",
        "friction=0.1 none",
        "friction=a of",
    ):
        assert question_of(text, settings) == energy


@pytest.mark.usefixtures("here")
def test_the_scale_of_the_values_is_linear_or_logarithmic_as_one_likes() -> None:
    made = asked(LOADS)
    for scale, is_logarithmic in (("logarithmic", True), ("linear", False)):
        made._scale.value = scale
        assert made.chart().y.logarithmic is is_logarithmic


@pytest.mark.parametrize("scene", CATALOGUE)
def test_each_ready_question_can_be_asked_or_is_not_offered(scene: str) -> None:
    settings = default_settings(scene)
    offered = [question for make in READY.values() if (question := make(settings))]
    assert len(offered) >= 3
    for question in offered:
        assert question.refusal(settings) == ""
        assert question_of(str(question), settings) == question


def refused(settings: Settings) -> list[str]:
    """Ready questions some of whose values settings refuse, with the first of these."""
    found = []
    for make in READY.values():
        question = make(settings)
        if question is None:
            continue
        plan = question.plan(settings)
        for number in range(plan.size):
            try:
                plan.settings_at(number)
            except RefusedError as refusal:
                found.append(f"{question}: {refusal}")
                break
    return found


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_scene_takes_all_values_of_its_ready_questions(scene: str) -> None:
    assert refused(default_settings(scene)) == []


@pytest.mark.parametrize("name", CASES)
def test_a_case_takes_all_values_of_its_ready_questions(name: str) -> None:
    assert refused(CASES[name].settings) == []


def test_iterations_are_counted_of_the_search_and_all_else_is_taken_of_the_answer() -> (
    None
):
    settings = tiny()
    assert iterations_over_k(settings).asked(settings).finish == "accuracy"
    assert LOADS.asked(settings).finish == "at-once"


@pytest.mark.parametrize(
    ("executor", "users", "share"),
    [
        ("processes:8", 1, "processes:8"),
        ("processes:8", 3, "processes:2"),
        ("processes:2", 9, "processes:1"),
        ("dask://host:8786", 9, "dask://host:8786"),
        ("processes:x", 2, "processes:x"),
    ],
)
def test_pages_share_the_processes_of_a_server(
    executor: str, users: int, share: str
) -> None:
    assert share_of(executor, users) == share


@pytest.fixture
def no_queue() -> Iterator[None]:
    """No other run waits for its turn, and no process is left running."""
    jobs.executor.cache_clear()
    yield
    jobs.executor().shutdown(cancel_futures=True)
    jobs.executor.cache_clear()


def wait_for(job: Job) -> None:
    while not job.is_over:
        time.sleep(0.05)


@pytest.mark.usefixtures("no_queue")
def test_commands_run_in_turn_to_their_end_and_a_cancelled_one_leaves_nothing() -> None:
    short = ["mesh", "bar", "--of", "dissipation"]
    short += [f"--set={name}={value}" for name, value in TINY.items()]
    first = Job(short)
    second = Job(["proof"])
    wrong = Job(["study", "no"])
    assert second.progress.startswith("Waiting")
    second.cancel()
    wait_for(first)
    wait_for(wrong)
    assert first.failure == ""
    assert any(line.startswith("Elements: ") for line in first.lines)
    assert second.failure == "Cancelled."
    assert "no" in wrong.failure
    folder = first.folder
    for job in (first, second, wrong):
        job.close()
    assert not folder.exists()


class Done:
    """A job that is over."""

    is_over = True
    failure = ""
    progress = ""
    lines: Sequence[str] = ()

    def __init__(self, *arguments: Any) -> None:
        link = f'<a href="{reports.PAGE}?scene=bar">a run</a>'
        self.files = {
            "proof.csv": b"a,b",
            "proof.html": f"<html><style></style>{link}</html>".encode(),
        }

    def close(self) -> None:
        """No process is left."""


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> reports.Reports:
    """The tab, of a server whose commands are over at once."""
    monkeypatch.setattr(reports, "Job", Done)
    return reports.Reports(PageState(tiny(), tab="Reports"))


def test_a_report_is_read_with_its_files_and_its_links_lead_here(
    made: reports.Reports,
) -> None:
    made.kind.value = "Proof"
    assert made.page.object == ""
    made.start()
    assert "a run" in made.page.object
    assert "localhost" not in made.page.object
    assert "color-scheme: light" in made.page.object
    made.state.is_dark = True
    assert "color-scheme: dark" in made.page.object
    assert [file.filename for file in made.files] == ["proof.csv", "proof.html"]


@pytest.mark.parametrize(
    ("kind", "row", "last"),
    [
        (
            "Stability",
            {"passed": "pass", "verdict": "right", "scene": "bar", "case": "soft"},
            "bar, soft, right",
        ),
        (
            "Proof",
            {"holds": "holds", "case": "A rope", "quantity": "moment"},
            "A rope, moment, holds",
        ),
    ],
)
def test_the_progress_of_a_table_is_told_in_words(
    made: reports.Reports, kind: str, row: dict[str, str], last: str
) -> None:
    """Progress was a line of a console, without its head."""
    made.kind.value = kind
    shown, _ = reports.TABLES[kind]
    line = line_of(dict.fromkeys(shown, "0") | row, shown)
    made.job = job = Done()
    job.is_over = False
    job.lines = [head_of(shown), line, line]
    job.progress = f"6 s: {line}"
    made._started = kind
    made.look()
    assert made.progress.object == f"{kind}: 6 s: 2 done. The last one: {last}."


def test_a_study_of_other_settings_says_so(made: reports.Reports) -> None:
    made.kind.value = "Study"
    made.start()
    settings = made.state.settings
    stale = "of other settings"
    assert stale not in made.words
    made.state.settings = settings.replace(friction=0.41)
    assert stale in made.words
    # Others are of no settings of the page.
    made.kind.value = "Proof"
    assert stale not in made.words
    made.kind.value = "Study"
    made.state.settings = settings
    assert stale not in made.words
