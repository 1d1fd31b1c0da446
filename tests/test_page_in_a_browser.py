"""The page in a real browser: it comes up, streams, obeys, and leaves nothing behind."""

import re
import time

from browser import Server
from playwright.sync_api import Page, expect

WAIT = 30_000


def status(page: Page):
    return page.locator(".status")


def words(page: Page) -> str:
    return page.locator(".status div").first.inner_text()


def iteration(page: Page) -> int:
    return int(re.search(r"(?:iteration|after) (\d+)", words(page))[1])


def slider(page: Page, name: str):
    return page.get_by_role("slider", name=name)


def test_it_comes_up_running_with_all_views_and_streams(open_page, server):
    page = open_page()
    expect(status(page)).to_contain_text("running", timeout=WAIT)
    expect(status(page)).to_contain_text("10 substructures, multiscale")
    expect(page.locator(".card")).to_have_count(6)
    first = iteration(page)
    expect(status(page)).to_contain_text(re.compile("friction force error [0-9.]+ %"), timeout=WAIT)
    moved = re.compile(rf"(?:iteration|after) (?!{first}\b)")
    expect(status(page)).to_contain_text(moved, timeout=WAIT)
    expect(status(page)).to_contain_text("converged", timeout=WAIT)
    expect(status(page)).to_contain_text("lower the tolerance")
    assert "Traceback" not in server.log


def test_a_slider_starts_a_new_run_and_the_old_one_stays_beside_it(open_page):
    page = open_page()
    expect(status(page)).to_contain_text(re.compile("iteration [2-9][0-9]"), timeout=WAIT)
    slider(page, "Substructures").press("ArrowRight")
    expect(status(page)).to_contain_text("11 substructures", timeout=WAIT)
    expect(page.locator(".figures")).to_contain_text("before")


def test_one_can_scrub_back_to_any_iteration(open_page):
    page = open_page()
    expect(status(page)).to_contain_text(re.compile("iteration [2-9][0-9]"), timeout=WAIT)
    page.get_by_role("button", name="Run or pause").click()
    expect(status(page)).to_contain_text("paused", timeout=WAIT)
    slider(page, "Iteration").fill("7")
    expect(status(page)).to_contain_text("showing iteration 7", timeout=WAIT)
    expect(page.locator(".figures tbody tr").first.locator("td").first).to_have_text("7")


def test_step_reset_and_keys_move_the_run(open_page):
    page = open_page()
    expect(status(page)).to_contain_text("running", timeout=WAIT)
    page.locator("body").press(" ")
    expect(status(page)).to_contain_text("paused", timeout=WAIT)
    page.wait_for_timeout(300)
    before = iteration(page)
    page.locator("body").press("s")
    expect(status(page)).to_contain_text(f"iteration {before + 1}", timeout=WAIT)
    page.get_by_role("button", name="Start the run again").click()
    expect(status(page)).to_contain_text("paused at iteration 1", timeout=WAIT)


def test_an_address_carries_settings_and_a_bad_one_is_explained(open_page):
    page = open_page("?substructures=5&multiscale=false&tolerance=1e-4")
    expect(status(page)).to_contain_text("5 substructures, monoscale", timeout=WAIT)
    bad = open_page("?friction=-3")
    expect(bad.get_by_text("friction = -3 is refused")).to_be_visible(timeout=WAIT)
    expect(status(bad)).to_contain_text("10 substructures", timeout=WAIT)


def test_a_view_that_is_not_wanted_is_not_there(open_page):
    page = open_page()
    expect(page.locator(".card")).to_have_count(6, timeout=WAIT)
    page.get_by_role("checkbox", name="Singular values").click()
    expect(page.locator(".card")).to_have_count(5, timeout=WAIT)
    one = open_page("?instants=1")
    expect(one.locator(".card")).to_have_count(4, timeout=WAIT)


def test_controls_that_do_nothing_are_not_there(open_page):
    page = open_page("?substructures=1")
    expect(status(page)).to_contain_text("one substructure", timeout=WAIT)
    expect(page.get_by_text("Multiscale (coarse problem)")).not_to_be_visible()
    expect(slider(page, "Seed")).not_to_be_visible()


def test_load_points_are_edited_in_a_table(open_page):
    page = open_page("?load=[[0,0],[0.5,600],[1,0]]")
    expect(status(page)).to_contain_text("running", timeout=WAIT)
    cells = page.locator("table input")
    expect(cells).to_have_count(6, timeout=WAIT)
    cells.nth(3).fill("500")
    cells.nth(3).press("Enter")
    page.get_by_title("Add a row below").first.click()
    expect(page.locator("table input")).to_have_count(8, timeout=WAIT)
    assert page.locator("table input").nth(3).input_value() == "250"


def test_a_phone_sees_the_run_first(open_page):
    page = open_page(width=390, height=844)
    expect(status(page)).to_contain_text("running", timeout=WAIT)
    expect(slider(page, "Peak load")).not_to_be_visible(timeout=WAIT)


def test_eight_pages_run_side_by_side(open_page):
    pages = [open_page() for _ in range(8)]
    for page in pages:
        expect(status(page)).to_contain_text(re.compile("iteration|after"), timeout=2 * WAIT)
    for page in pages:
        expect(status(page)).to_contain_text("converged", timeout=4 * WAIT)


def test_closing_a_page_and_stopping_the_server_leaves_no_process(tmp_path, chrome):
    server = Server(tmp_path / "log")
    server.wait()
    page = chrome.new_page()
    page.goto(server.address)
    expect(status(page)).to_contain_text("running", timeout=WAIT)
    page.close()
    server.stop()
    end = time.monotonic() + 10
    while server.processes() and time.monotonic() < end:
        time.sleep(0.1)
    assert server.processes() == []
