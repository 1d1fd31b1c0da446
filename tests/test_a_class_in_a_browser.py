"""A lecturer's page and those of a class, as they see them."""

from __future__ import annotations

import re

from pages import ENDLESS, Visit, choose, iteration, open_sheets, press, slider, status
from playwright.sync_api import Page, expect


def code_of(page: Page) -> str:
    banner = page.locator(".class").first
    expect(banner).to_contain_text("Class")
    return banner.locator("b").first.inner_text()


def test_a_page_that_joins_sees_the_leaders_run_and_goes_on_alone_when_it_changes_anything(
    open_page: Visit,
) -> None:
    leader = open_page(f"?friction=0.4&{ENDLESS}&plots=Load+path")
    expect(status(leader)).to_contain_text("iteration")
    press(leader, "Class")
    press(leader, "Start a class")
    code = code_of(leader)
    # A code that there is not is told, with a field for another.
    follower = open_page("?elements=20&substructures=2&instants=11&plots=Load+path")
    press(follower, "Class")
    follower.get_by_label("Code of a class").fill("<b>nope")
    press(follower, "Join")
    expect(follower.get_by_role("heading", name="There is no class <b>nope")).to_be_visible()
    expect(follower.locator(".status")).to_have_count(0)
    follower.get_by_label("Code of the class").fill(code.lower())
    follower.get_by_label("Code of the class").press("Enter")
    expect(follower.locator(".class").first).to_contain_text(f"You follow class {code}")
    expect(status(follower)).to_contain_text("iteration")
    expect(leader.locator(".class").first).to_contain_text("1 follows")
    expect(follower.get_by_role("button", name="Run or pause")).to_have_count(0)
    leader.get_by_role("button", name="Run or pause").click()
    expect(status(leader)).to_contain_text("paused")
    expect(status(follower)).to_contain_text("paused")
    assert iteration(leader) == iteration(follower)
    slider(leader, "Substructures").press("ArrowRight")
    for page in (leader, follower):
        expect(status(page)).to_contain_text("11 substructures")
    assert "class=" in follower.url
    slider(follower, "Substructures").press("ArrowLeft")
    expect(status(follower)).to_contain_text("10 substructures")
    expect(follower.locator(".class").first).to_contain_text(f"You have left class {code}")
    expect(status(leader)).to_contain_text("11 substructures")
    press(follower, "Follow again")
    expect(status(follower)).to_contain_text("11 substructures")
    # A leader who loads the page again leads on.
    leader.reload()
    assert code_of(leader) == code
    expect(leader.locator(".class").first).to_contain_text("1 follows")
    slider(leader, "Substructures").press("ArrowRight")
    for page in (leader, follower):
        expect(status(page)).to_contain_text("12 substructures")
    press(leader, "End the class")
    expect(follower.locator(".class").first).to_contain_text("has ended")


def test_whoever_follows_reads_a_run_in_words_and_units_of_their_own(open_page: Visit) -> None:
    leader = open_page(f"?{ENDLESS}&plots=Load+path")
    press(leader, "Class")
    press(leader, "Start a class")
    follower = open_page(f"?class={code_of(leader)}&lang=de&units=si")
    leader.get_by_role("button", name="Run or pause").click()
    expect(status(follower)).to_contain_text("angehalten bei Iteration")
    expect(status(leader)).to_contain_text("paused at iteration")
    figures = follower.locator(".figures")
    expect(figures).to_contain_text(re.compile(r"\d J"))
    expect(figures).not_to_contain_text("mJ")
    # The one who leads rests: who changes units is given the picture anew.
    open_sheets(follower)
    choose(follower.get_by_role("combobox", name="Einheiten"), "mm, N, MPa")
    expect(figures).to_contain_text(" mJ")
    assert "lang=de" in follower.url
    press(leader, "End the class")


def test_a_class_predicts_before_it_sees_and_its_counts_open_when_the_lecturer_asks(
    open_page: Visit,
) -> None:
    leader = open_page("?lesson=coarse-problem")
    expect(leader.locator(".question")).to_be_visible()
    press(leader, "Class")
    press(leader, "Start a class")
    code = code_of(leader)
    expect(leader.locator(".code")).to_contain_text("Others cannot open localhost")
    expect(leader.locator(".code svg")).to_have_count(0)
    student = open_page(f"?class={code}", width=390, height=844)
    asked, mine = [
        one.get_by_role("group", name="Your prediction").get_by_role("button")
        for one in (leader, student)
    ]
    expect(mine.first).to_have_text(asked.first.inner_text())
    expect(student.locator(".card")).to_have_count(0)
    expect(student.get_by_role("button", name="Show me")).to_have_count(0)
    mine.nth(0).click()
    mine.nth(1).click()
    expect(mine.nth(1)).to_have_attribute("aria-pressed", "true")
    expect(leader.get_by_text("1 of 1 have predicted.")).to_be_visible()
    expect(mine.nth(1)).not_to_contain_text("— 1")
    # A presenter's remote control knows one key.
    press(leader, "Present")
    expect(leader.locator(".strip")).to_be_visible()
    leader.keyboard.press("PageDown")
    for choices in (asked, mine):
        expect(choices.nth(1)).to_contain_text("— 1")
    expect(student.locator(".card")).to_have_count(0)
    leader.keyboard.press("PageDown")
    for page in (leader, student):
        expect(page.locator(".counts .right")).to_have_text("✓ Above all the displacement — 0")
        expect(page.locator(".card").first).to_be_attached()
        expect(page.get_by_role("list", name="What the class predicted")).to_contain_text("— 1")
    expect(status(student)).to_contain_text("iteration")
