"""A person finds a case like theirs, brings a loop, and leaves with parameters."""

from __future__ import annotations

import re
from pathlib import Path

from pages import ANSWER, button, close_dialog, field, figure, figures, go, is_solved
from playwright.sync_api import Page, expect

from app.state import default_settings
from solver.study.scene_run import finished_run

SIZES = {"elements": 20, "instants": 21, "substructures": 1}
QUERY = "&".join([f"{name}={number}" for name, number in SIZES.items()])
LAST = 5
"""Number of the figure of the last of four cards."""
BUSY = "() => { window.idle = requestIdleCallback; requestIdleCallback = () => {} }"
IDLE = "() => { requestIdleCallback = window.idle }"
"""Scripts that have a browser never be idle, and be as it was."""


def measured() -> str:
    """The loop of a bar whose friction is 0.25, in kN and mm."""
    made = default_settings("bar").replace(load="cycle", friction=0.25, **SIZES)
    run = finished_run(made, errors=False, indicators=False)
    rows = zip(
        run.problem.instants, 1e3 * run.displacement, 1e-3 * run.force, strict=True
    )
    lines = [",".join(map(str, row)) for row in rows]
    return "\n".join(["time [s],displacement [mm],force [kN]", *lines])


def test_a_case_is_opened_by_its_picture_and_left_by_back(page: Page) -> None:
    go(page, f"?{ANSWER}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    button(page, "Cases").click()
    # Its picture stands upright, so that the page is laid out anew with other data.
    page.get_by_role("button", name="Pile in settling soil").click()
    heading = page.get_by_role("heading", name="Pile in settling soil")
    expect(heading).to_be_visible()
    expect(page.get_by_text("% off")).to_be_visible()
    expect(page).to_have_url(re.compile("case="))
    expect(field(page, "Peak load")).to_have_count(0)
    is_solved(page)
    # In a high window the last of four cards stands above the time line.
    page.set_viewport_size({"width": 1280, "height": 900})
    expect(figure(page, LAST)).to_be_visible()
    card = figure(page, LAST).bounding_box()
    times = figure(page, 1).bounding_box()
    assert card["y"] + card["height"] < times["y"] + 1.0
    page.set_viewport_size({"width": 1280, "height": 720})
    page.go_back()
    expect(heading).to_have_count(0)
    expect(field(page, "Peak load")).to_have_value("900")
    expect(field(page, "Peak load")).to_be_in_viewport()
    button(page, "Method").click()
    expect(field(page, "Relaxation")).to_be_visible()
    is_solved(page)


def test_a_measured_loop_is_compared_and_fitted_and_the_fit_is_run(
    page: Page, tmp_path: Path
) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(measured(), encoding="utf-8")
    go(page, f"?{QUERY}&{ANSWER}&load=cycle&friction=0.4")
    expect(field(page, "Friction coefficient")).to_have_value("0.4")
    is_solved(page)
    # What has just come is used before the browser is idle.
    page.evaluate(BUSY)
    button(page, "Reports").click()
    button(page, "Proof").click()
    button(page, "Fit").click()
    with page.expect_file_chooser() as chooser:
        page.locator("label, button").filter(
            has=page.locator("input[type=file]")
        ).first.click()
    chooser.value.set_files(path)
    expect(page.get_by_role("dialog").get_by_text("Columns and units")).to_be_visible()
    page.evaluate(IDLE)
    close_dialog(page)
    page.get_by_role("checkbox", name="Friction coefficient").check()
    button(page, "Start").click()
    with page.expect_download() as event:
        button(page, "fit.html").click()
    assert "Friction" in event.value.path().read_text(encoding="utf-8").title()
    button(page, "Use these settings").click()
    is_solved(page)
    expect(field(page, "Friction coefficient")).to_have_value("0.25")
    expect(figures(page)).to_contain_text("Distance to rig.csv")
    button(page, "Files").click()
    button(page, "Remove rig.csv").click()
    expect(figures(page)).not_to_contain_text("Distance to")
    button(page, "Files").click()
