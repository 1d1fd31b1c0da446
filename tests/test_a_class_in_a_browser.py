"""A lecturer's page and those of a class, as they see them."""

from __future__ import annotations

from pages import ENDLESS, Visit, iteration, press, slider, status
from playwright.sync_api import Page, expect


def code_of(page: Page) -> str:
    banner = page.locator(".class").first
    expect(banner).to_contain_text("Class")
    return banner.locator("b").first.inner_text()


def test_a_page_that_joins_sees_the_leaders_run_and_goes_on_alone_when_it_changes_anything(
    open_page: Visit,
) -> None:
    leader = open_page(f"?friction=0.4&{ENDLESS}")
    expect(status(leader)).to_contain_text("iteration")
    press(leader, "Class")
    code = code_of(leader)
    follower = open_page(f"?class={code}")
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
    assert f"class={code}" in follower.url
    slider(follower, "Substructures").press("ArrowLeft")
    expect(status(follower)).to_contain_text("10 substructures")
    expect(follower.locator(".class").first).to_contain_text(f"You have left class {code}")
    expect(status(leader)).to_contain_text("11 substructures")
    press(follower, "Follow again")
    expect(status(follower)).to_contain_text("11 substructures")
    press(leader, "End the class")
    expect(follower.locator(".class").first).to_contain_text("has ended")


def test_a_class_that_is_not_there_is_told(open_page: Visit) -> None:
    page = open_page("?class=NOPE")
    expect(status(page)).to_contain_text("there is no class NOPE")
