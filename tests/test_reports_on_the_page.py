"""Reports on the page are those of the command line, and are named by what differs."""

from __future__ import annotations

import csv
import pickle
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from app.picture.glossary import explained
from app.picture.usual import usual_settings
from app.reports.reports import EVERY, WRONG, StabilityReport, StudyReport, company, title_of
from app.session.report_folder import SECTIONS, ReportFolder, files, said
from app.session.report_job import Found, ReportJob
from app.session.session import Session
from app.session.studies import proof_of, stability_of, study_of
from app.session.turns import Turns
from solver.scenes.bar import BarSettings
from solver.scenes.layers import LayersSettings
from solver.study.audit.audit import Audited, Verdict, audit
from solver.study.audit.cases import Case
from solver.study.audit.stability import stability_report
from solver.study.page import PlotSection, Section
from solver.study.proof.report import cases

TINY = {"elements": 4, "substructures": 2, "instants": 5}


def test_a_study_gives_the_files_of_the_command_line(tmp_path: Path) -> None:
    study_of("bar", TINY, 1, False, tmp_path)
    found, sections = files(tmp_path), pickle.loads(said(tmp_path, SECTIONS))
    assert set(found) == {"curves.csv", "levels.csv", "map.csv", "study.html"}
    rows = list(csv.DictReader(found["curves.csv"].decode().splitlines()))
    assert {"incremental solver", "LATIN PGD"} <= {row["method"] for row in rows}
    assert sum(isinstance(section, PlotSection) for section in sections) == 2
    page = found["study.html"].decode()
    for section in sections:
        assert isinstance(section, PlotSection) or section in page
    assert "Scene: bar (" in page
    assert all(f"{name} = {value}" in page for name, value in TINY.items())
    assert page.count("BLAS threads: 1;") == 1


def test_stability_is_shown_as_it_grows_and_then_whole(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    few = [Case("size", "tiny", TINY), Case("size", "small", {**TINY, "elements": 10})]
    monkeypatch.setattr("app.session.studies.cases_of", lambda quick: few)
    monkeypatch.setattr("app.session.studies.SHOWN_EVERY", 0.0)
    rows: list[int] = []
    shares: list[float] = []
    tell = ReportFolder.tell
    monkeypatch.setattr(
        ReportFolder,
        "show",
        lambda growing, sections: rows.append("".join(sections).count('"verdict')),
    )
    monkeypatch.setattr(
        ReportFolder,
        "tell",
        lambda growing, doing, share: shares.append(share) or tell(growing, doing, share),
    )
    stability_of(False, tmp_path)
    assert rows == [1, 2, 3, 4, 4]
    assert list(files(tmp_path)) == ["stability.csv", "stability.html"]
    assert shares == sorted(shares)
    assert (
        "In other units the bar has the same iterates" in (tmp_path / "stability.html").read_text()
    )


def test_the_proof_is_shown_case_by_case_with_links_that_stay_on_the_page(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    two = list(cases())[:2]
    monkeypatch.setattr("app.session.studies.cases", lambda: iter(two))
    grown: list[int] = []
    show = ReportFolder.show

    def count(growing: ReportFolder, sections: Sequence[Section]) -> None:
        grown.append("".join(map(str, sections)).count('<td class="verdict'))
        show(growing, sections)

    monkeypatch.setattr(ReportFolder, "show", count)
    proof_of(tmp_path)
    assert grown == [1, 2]
    assert set(files(tmp_path)) == {"proof.csv", "proof.html"}
    shown = "".join(pickle.loads(said(tmp_path, SECTIONS)))
    assert re.findall('<a class="run" href="([^"]*)"', shown) == [
        escape(case.address) for case in two
    ]


def row(**changes: Any) -> Audited:
    (found,) = audit([Case("size", "tiny", {**TINY, **changes}).trial("paper")])
    return found


def test_the_matrix_says_each_verdict_in_a_word_by_which_a_row_is_hidden(job: ReportJob) -> None:
    rows = [row(), row(k_scale=1e-6, max_iterations=20)]
    assert [one.verdict for one in rows] == [Verdict.RIGHT, Verdict.UNSOLVED]
    sections = stability_report(rows, {}).sections()
    page = "".join(sections)
    assert re.findall(r'<td class="verdict (\w+)"[^>]*>(\w+)</td>', page) == [
        ("right", "right"),
        ("unsolved", "unsolved"),
    ]
    assert "1 of 2 runs pass" in page
    assert rows[1].outcome.advice.split(".")[0] in page
    report = StabilityReport(job)
    report.open()
    report._put(Found("any", sections))
    assert [pane.object for pane in report._sheet] == list(map(explained, sections))
    report._filter(WRONG)
    assert all(pane.css_classes == ["report", "wrong"] for pane in report._sheet)
    report._put(Found("another", sections))
    assert all(pane.css_classes == ["report", "wrong"] for pane in report._sheet)
    report._filter(EVERY)
    assert all(pane.css_classes == ["report"] for pane in report._sheet)


def test_a_study_is_named_by_what_is_changed_and_says_who_else_was_at_work() -> None:
    assert title_of(usual_settings(BarSettings)) == "defaults"
    assert title_of(usual_settings(BarSettings).replace(friction=0.4)) == "friction 0.4"
    assert title_of(BarSettings.checked({"method": "paper"})) == "method paper"
    assert "nothing else was at work" in company(0)
    assert "a run or a chart was" in company(1)
    assert "3 runs or charts were" in company(3)


def test_a_study_is_not_offered_where_the_reference_would_take_too_long(job: ReportJob) -> None:
    for layers, refused in ((3, False), (20, True)):
        settings = LayersSettings.checked({"layers": layers, "instants": 11})
        asked = SimpleNamespace(study=job)
        page = SimpleNamespace(asked=asked, wanted=settings, crowd=0, turns=Turns())
        report = StudyReport(cast(Session, page))
        report.open()
        assert report._start.disabled == refused
        assert ("would take too long here" in report._progress.object) == refused
