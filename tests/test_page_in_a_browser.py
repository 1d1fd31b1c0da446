"""The page in a real browser: it comes up, streams, obeys, and explains what it refuses."""

from __future__ import annotations

import re
from pathlib import Path

from pages import ENDLESS, Visit, bodies_drawn, iteration, open_report, slider, status
from playwright.sync_api import expect


def test_a_run_streams_into_all_views_and_one_can_pause_step_scrub_back_and_reset(
    open_page: Visit,
) -> None:
    page = open_page(f"?{ENDLESS}&pace=20")
    expect(status(page)).to_contain_text("running")
    expect(status(page)).to_contain_text("10 substructures, multiscale")
    expect(page.locator(".card")).to_have_count(8)
    expect(status(page)).to_contain_text(re.compile("friction force error [0-9.]+ %"))
    first = iteration(page)
    expect(status(page)).to_contain_text(re.compile(rf"iteration (?!{first}\b)"))
    expect(status(page)).to_contain_text(re.compile(r"iteration \d\d"))
    page.locator("body").press(" ")
    expect(status(page)).to_contain_text("paused")
    slider(page, "Iteration").fill("7")
    expect(status(page)).to_contain_text("showing iteration 7")
    expect(page.locator(".figures tbody tr").first.locator("td").first).to_have_text("7")
    page.get_by_role("button", name="Start the run again").click()
    expect(status(page)).to_contain_text("paused at iteration 1")
    page.locator("body").press("s")
    expect(status(page)).to_contain_text("paused at iteration 2")
    page.get_by_role("button", name="Run or pause").click()
    expect(status(page)).to_contain_text("running")
    page.get_by_role("checkbox", name="Singular values").click()
    expect(page.locator(".card")).to_have_count(7)


def test_a_run_that_has_converged_stays_beside_the_next_one_which_may_start_from_it(
    open_page: Visit,
) -> None:
    page = open_page("?finish=none")
    expect(status(page)).to_contain_text("✓ converged")
    page.get_by_role("switch", name="Start from the run before").click()
    slider(page, "Peak load").press("ArrowRight")
    expect(status(page)).to_contain_text("Started from the run before:")
    expect(status(page)).to_contain_text("from coarser meshes")
    expect(page.locator(".figures")).to_contain_text("before")
    page.locator("body").press("r")
    expect(status(page)).not_to_contain_text("Started from")
    slider(page, "Substructures").press("ArrowRight")
    expect(status(page)).to_contain_text("11 substructures")


def test_an_address_carries_settings_and_load_points_are_edited_in_a_drawing_and_a_table(
    open_page: Visit,
) -> None:
    page = open_page(f"?substructures=1&load=[[0,0],[0.5,600],[1,0]]&{ENDLESS}")
    expect(status(page)).to_contain_text("one substructure")
    cells = page.locator("table input")
    expect(cells).to_have_count(6)
    expect(page.get_by_text("Multiscale (coarse problem)")).not_to_be_visible()
    expect(slider(page, "Seed")).not_to_be_visible()
    drawn = page.locator("svg.path").first
    box = drawn.locator("circle").nth(1).bounding_box()
    assert box is not None
    x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 30.0, y + 20.0, steps=4)
    page.mouse.up()
    expect(cells.nth(3)).not_to_have_value("600")
    assert 0.5 < float(cells.nth(2).input_value()) < 0.8
    assert 100.0 < float(cells.nth(3).input_value()) < 600.0
    expect(drawn.locator("circle")).to_have_count(3)
    page.mouse.dblclick(x - 40.0, y)
    expect(drawn.locator("circle")).to_have_count(4)
    expect(cells).to_have_count(8)
    again = drawn.locator("circle").nth(1).bounding_box()
    assert again is not None
    page.mouse.dblclick(again["x"] + 5.0, again["y"] + 5.0)
    expect(drawn.locator("circle")).to_have_count(3)
    cells.nth(3).fill("500")
    cells.nth(3).press("Enter")
    page.get_by_title("Add a row below").first.click()
    expect(cells).to_have_count(8)
    assert 240.0 < float(cells.nth(3).input_value()) < 260.0


def test_a_narrow_window_sees_the_run_first_and_has_all_tabs_in_reach(open_page: Visit) -> None:
    page = open_page("?scene=block&method=paper&max_iterations=5", width=390, height=844)
    bodies_drawn(page, "> 1000")
    expect(page.get_by_text("Deformed bodies").first).to_be_visible()
    expect(page.get_by_text("Friction coefficient").first).not_to_be_visible()
    open_report(page, "Stability")
    box = page.get_by_role("button", name="Study", exact=True).bounding_box()
    assert box is not None
    assert 0.0 <= box["x"] <= 390.0 - box["width"]


def test_settings_are_saved_opened_and_brought_back(open_page: Visit, tmp_path: Path) -> None:
    page = open_page(f"?substructures=5&{ENDLESS}")
    expect(status(page)).to_contain_text("5 substructures")
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save", exact=True).click()
    text = saved.value.path().read_text()
    assert "substructures = 5\n" in text
    file = tmp_path / "other.toml"
    file.write_text(text.replace("substructures = 5\n", "substructures = 7\n"))
    page.locator("input[type=file]").set_input_files(file)
    expect(status(page)).to_contain_text("7 substructures")
    page.get_by_role("button", name="Defaults", exact=True).click()
    expect(status(page)).to_contain_text("10 substructures")
    file.write_bytes(b"\xff\xfe\0")
    page.locator("input[type=file]").set_input_files(file)
    expect(page.get_by_text("The file is not text")).to_be_visible()
