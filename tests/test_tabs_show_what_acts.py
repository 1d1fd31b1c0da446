"""A tab shows the settings that do something on it, and says which results are of other ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from lone_link import LoneLink

from app.controls.items import NOTE, SCENE
from app.controls.sidebar import Sidebar
from app.reports.proof import ProofReport
from app.reports.report import Report
from app.reports.reports import PaperFigures, StabilityReport, StudyReport
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.report_job import Found
from app.session.session import Session
from solver.scenes.bar import BarSettings
from solver.settings import Settings
from solver.study.speed.error_against_time import PLAIN, acting, forms_of

BAR = BarSettings.checked({"elements": 8, "substructures": 2, "instants": 5})


@pytest.fixture
def session() -> Iterator[Session]:
    with ReportExecutor() as executor:
        yield Session(Pages(1), executor, BAR, LoneLink().hire)


@pytest.fixture
def sidebar(session: Session) -> Sidebar:
    return Sidebar(session, lambda name: None)


def shown_for(sidebar: Sidebar, report: Report | None) -> dict[str, Any]:
    sidebar.show_for(report)
    found: dict[str, Any] = sidebar.view.shown
    return found


def test_a_report_that_no_setting_changes_shows_none_and_the_live_run_has_all_again(
    session: Session, sidebar: Sidebar
) -> None:
    live = shown_for(sidebar, None)
    reports = (
        PaperFigures(session.asked.figures),
        StabilityReport(session.asked.stability),
        ProofReport(session, lambda address: None),
    )
    for report in reports:
        assert set(shown_for(sidebar, report)) == {NOTE, ""}
    assert shown_for(sidebar, None) == live


def test_a_study_shows_the_settings_that_change_it_also_those_of_its_form_with_modes(
    session: Session, sidebar: Sidebar
) -> None:
    shown = shown_for(sidebar, StudyReport(session))
    assert {SCENE, "friction", "elements", "k_scale", "pgd_modes"} <= set(shown)
    assert not {"method", "multiscale", "acceleration", "the-views"} & set(shown)


@pytest.mark.parametrize("name", PLAIN)
def test_a_setting_that_a_study_does_not_show_changes_none_of_its_methods(name: str) -> None:
    now = BAR.values()[name]
    others = [False, True] if isinstance(now, bool) else BAR.definitions()[name].objects
    forms = [forms_of(BAR.replace(**{name: other})) for other in others]
    assert name not in acting(BAR)
    assert len(forms) > 1
    assert all(_values(one) == _values(forms[0]) for one in forms)


def _values(forms: dict[str, Settings]) -> dict[str, dict[str, Any]]:
    return {method: form.values() for method, form in forms.items()}


def test_results_of_other_settings_are_marked_until_these_are_back(session: Session) -> None:
    report, found = StudyReport(session), Found("a study", ["<p>results</p>"])
    session.asked.study.found.append(found)
    report._settings[found] = BAR
    report.open()

    def marked(**changes: Any) -> str:
        session.wanted = BAR.replace(**changes)
        report._refresh()
        words: str = report._older.object
        assert report._again.visible == ("other settings" in words)
        return words

    assert not report._again.visible
    assert "friction 0.3. At present: friction 0.5." in marked(friction=0.5)
    assert "other settings" not in marked(method="paper", acceleration="anderson", tolerance=1e-3)
    marked(friction=0.5)
    assert "other settings" not in marked()
