"""The page in a real browser: it comes up, streams, obeys, and explains what it refuses."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from pages import (
    ENDLESS,
    bodies_drawn,
    card,
    choose,
    choose_scene,
    comes_true,
    iteration,
    one_page,
    open_sheets,
    press,
    slider,
    status,
)
from playwright.sync_api import Page, expect

from app.session.uploads import saved
from solver.scenes import CATALOGUE

FOREVER: dict[str, Any] = {"method": "paper", "max_iterations": 100_000, "tolerance": 1e-30}
SCENES = [("Parallel wires", 18), ("Block on an inclined", 8)]
"""Title and substructures; each has several interfaces."""
SEEN = """(name) => {
  const range = Bokeh.documents.map((one) => one.get_model_by_name(name)).find((one) => one)
  return [range.start, range.end]
}"""


page = one_page(f"?{ENDLESS}&pace=20", "running")
"""One page; every test begins with settings of its own."""


def take(page: Page, scene: str = "bar", **changes: Any) -> None:
    """Have the page open a file of settings."""
    text = saved(CATALOGUE[scene].settings.checked(changes), was_warm=False)
    file = {"name": "settings.toml", "mimeType": "text/plain", "buffer": text.encode()}
    page.get_by_label("Open settings").set_input_files(file)


def test_a_run_streams_into_all_views_and_one_can_pause_step_scrub_back_and_reset(
    page: Page,
) -> None:
    take(page, **FOREVER)
    expect(status(page)).to_contain_text("running")
    expect(status(page)).to_contain_text("10 substructures, multiscale")
    expect(page.locator(".card")).to_have_count(6)
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
    open_sheets(page)
    for number in (5, 6):
        page.get_by_role("checkbox", name="Singular values").click()
        expect(page.locator(".card")).to_have_count(number)


def test_a_run_that_has_converged_stays_beside_the_next_one_which_may_start_from_it(
    page: Page,
) -> None:
    take(page, finish="none")
    expect(status(page)).to_contain_text("✓ converged")
    warm = page.get_by_role("switch", name="Start from the run before")
    warm.click()
    slider(page, "Peak load").press("ArrowRight")
    expect(status(page)).to_contain_text("Started from the run before:")
    expect(status(page)).to_contain_text("from a coarser mesh")
    expect(page.locator(".figures")).to_contain_text("before")
    page.locator("body").press("r")
    expect(status(page)).not_to_contain_text("Started from")
    slider(page, "Substructures").press("ArrowRight")
    expect(status(page)).to_contain_text("11 substructures")
    warm.click()


def test_load_points_are_edited_in_a_drawing_and_a_table(page: Page) -> None:
    take(page, substructures=1, load=[[0, 0], [0.5, 600], [1, 0]], **FOREVER)
    expect(status(page)).to_contain_text("one substructure")
    cells = page.locator("table input")
    expect(cells).to_have_count(6)
    expect(page.get_by_text("Multiscale (coarse problem)")).not_to_be_visible()
    expect(slider(page, "Seed")).not_to_be_visible()
    drawn = page.locator("svg.path").first
    drawn.locator("circle").nth(1).hover()
    box = drawn.locator("circle").nth(1).bounding_box()
    assert box is not None
    x, y = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
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


def test_settings_are_saved_opened_and_brought_back(page: Page, tmp_path: Path) -> None:
    take(page, substructures=5, **FOREVER)
    expect(status(page)).to_contain_text("5 substructures")
    with page.expect_download() as saved:
        press(page, "Share")
        press(page, "Save settings")
    text = saved.value.path().read_text()
    assert "substructures = 5\n" in text
    page.keyboard.press("Escape")
    # What stands in a browser's store is not always what was put there.
    page.evaluate("localStorage.setItem('slipfront-runs', '[3, null, {\"name\": []}]')")
    press(page, "Runs")
    page.get_by_label("Name", exact=True).fill("mine")
    press(page, "Keep this run")
    expect(page.get_by_role("button", name="Delete mine")).to_be_visible()
    press(page, "Share")
    file = tmp_path / "other.toml"
    file.write_text(text.replace("substructures = 5\n", "substructures = 7\n"))
    page.get_by_label("Open settings").set_input_files(file)
    expect(status(page)).to_contain_text("7 substructures")
    press(page, "Defaults")
    expect(status(page)).to_contain_text("10 substructures")
    press(page, "Runs")
    press(page, "Open mine")
    expect(status(page)).to_contain_text("5 substructures")
    file.write_bytes(b"\xff\xfe\0")
    page.get_by_label("Open settings").set_input_files(file)
    expect(page.get_by_text("The file is not text")).to_be_visible()


def test_a_plot_fills_the_page_says_its_values_and_stays_zoomed_while_the_run_goes_on(
    page: Page,
) -> None:
    take(page, substructures=6, **FOREVER)
    expect(status(page)).to_contain_text(re.compile(r"iteration \d\d .* 6 substructures"))
    plot = card(page, "Friction force")
    plot.hover()
    expect(page.get_by_text(re.compile(r"^[0-9.]+ m, .* [kmµ]?N/m$"))).to_be_visible()
    all_seen = page.evaluate(SEEN, "friction-force.x")
    page.keyboard.press("f")
    box = plot.bounding_box()
    assert box is not None
    assert (box["x"], box["width"], box["height"]) == (0, 1280, 720)
    page.mouse.move(640, 360)
    page.mouse.wheel(0, -100)
    comes_true(page, f"(all) => ({SEEN})('friction-force.x')[1] < all[1]", arg=all_seen)
    zoomed = page.evaluate(SEEN, "friction-force.x")
    shown = status(page).inner_text()
    expect(status(page)).not_to_have_text(shown)
    assert page.evaluate(SEEN, "friction-force.x") == zoomed
    page.keyboard.press("0")
    assert page.evaluate(SEEN, "friction-force.x") == all_seen
    page.keyboard.press("Escape")
    expect(page.locator(".card.alone")).to_have_count(0)


def test_scenes_are_chosen_and_keep_their_settings(page: Page) -> None:
    take(page, substructures=5)
    interface = page.get_by_role("combobox", name="Interface")
    expect(status(page)).to_contain_text("5 substructures")
    expect(slider(page, "Substructures")).to_be_visible()
    for title, parts in SCENES:
        choose_scene(page, title)
        expect(status(page)).to_contain_text(f"{parts} substructures")
        expect(status(page)).to_contain_text("friction force error")
        expect(page.locator(".card")).to_have_count(6)
        expect(page.get_by_text("Friction coefficient").first).to_be_visible()
        expect(interface).to_have_count(1)
    choose_scene(page, "Clamped bar")
    expect(status(page)).to_contain_text("5 substructures")
    expect(page.locator(".figures")).not_to_contain_text("before")


def test_bodies_are_drawn_in_the_browser_and_looked_at_otherwise(page: Page) -> None:
    take(page, "layers", elements=16, method="paper", max_iterations=30)
    field = page.get_by_role("textbox", name=re.compile("^Layers"))
    field.fill("3")
    field.press("Enter")
    bodies_drawn(page, f"=== {3 * 16 * 2}")
    stress = page.get_by_role("combobox", name="Stress")
    expect(stress).to_have_count(0)
    press(page, "Deformed bodies")
    expect(page.get_by_role("button", name="Scene", exact=True)).to_be_focused()
    expect(page.locator(".card")).to_have_count(6)
    expect(page).to_have_url(re.compile("plots=Deformed%20bodies%2C"))
    expect(page.get_by_text("displacement ×").first).to_be_visible()
    slider(page, "Magnification").fill("7")
    expect(page.get_by_text("displacement × 100").first).to_be_visible()
    choose(stress, "stress xx")
    expect(page.locator(".title").filter(has_text="Deformed")).to_contain_text("xx")
    interface = page.get_by_role("combobox", name="Interface")
    choose(interface, "contact 2-3")
    expect(interface).to_contain_text("contact 2-3")
    slider(page, "Instant").fill("20")
    expect(status(page)).to_contain_text(re.compile("iteration|after"))


def test_keys_may_leave_a_plot_at_once_when_what_is_under_the_pointer_moves(page: Page) -> None:
    stumbles: list[str] = []
    page.on("pageerror", lambda error: stumbles.append(str(error)))
    box = page.locator(".bk-Plot canvas").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.evaluate(
        """async ([x, y]) => {
          const frame = () => new Promise(requestAnimationFrame)
          await frame()
          await frame()
          let found = document.elementFromPoint(x, y), inner = found
          while ((inner = found.shadowRoot?.elementFromPoint(x, y)) && inner !== found) {
            found = inner
          }
          found.dispatchEvent(new Event("scroll", {bubbles: true, composed: true}))
          found.dispatchEvent(new FocusEvent("focusin", {bubbles: true, composed: true}))
          await frame()
          await frame()
        }""",
        [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2],
    )
    assert stumbles == []
