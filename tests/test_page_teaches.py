"""Lessons in a browser: offered, opened, answered; sliders move the run, and values follow it."""

from __future__ import annotations

import re

from pages import Visit, press, slider, status
from playwright.sync_api import Locator, Page, expect

from app.lessons.lesson import LESSONS

ERROR = re.compile(r"friction force error ([\d.]+ %)")


def lesson(page: Page) -> Locator:
    return page.get_by_role("region", name="Lesson")


def value(page: Page, title: str) -> Locator:
    return lesson(page).get_by_title(title, exact=True)


def agreed(page: Page) -> str:
    """Wait until the run has ended and the sentence says its error; give it."""
    expect(status(page)).to_contain_text("not converged")
    # There is none before the reference is there.
    expect(status(page)).to_contain_text(ERROR)
    found = ERROR.search(status(page).locator("div").first.text_content() or "")
    assert found
    expect(value(page, "Error of the contact force")).to_have_text(found[1])
    return found[1]


def test_a_lesson_is_predicted_moved_read_reloaded_and_left(open_page: Visit) -> None:
    page = open_page("?lesson=moving-front&max_iterations=20")
    expect(lesson(page)).to_contain_text("How many products of a shape in space")
    expect(page.locator(".card")).to_have_count(0)
    expect(status(page)).not_to_be_visible()
    expect(lesson(page).get_by_role("slider")).to_have_count(0)
    press(page, "3 to 5")
    expect(lesson(page)).to_contain_text("Not “3 to 5”, but: About 10.")
    expect(page.locator(".card")).to_have_count(4)
    expect(page.locator(".figures")).not_to_be_visible()
    before = agreed(page)
    modes = lesson(page).get_by_role("slider", name="Most PGD modes")
    modes.press("End")
    expect(modes).not_to_have_js_property("ariaValueNow", "5")
    expect(status(page)).to_contain_text(re.compile("up to (?!5 )[0-9]+ modes"))
    assert agreed(page) != before
    page.locator(".card").first.focus()
    readout = page.get_by_role("button", name="Whole page")
    expect(readout).to_be_visible()
    # As by a key or a finger, with nothing that moves over the plot.
    page.get_by_role("button", name="Study", exact=True).dispatch_event("click")
    for part in (lesson(page), status(page), page.locator(".card").first, readout):
        expect(part).not_to_be_visible()
    expect(page.get_by_role("button", name="Start", exact=True)).to_be_in_viewport()
    press(page, "Live")
    page.wait_for_url(re.compile("(?=.*lesson=moving-front)(?=.*pgd_modes=)"))
    page.reload()
    expect(lesson(page)).to_contain_text("Not “3 to 5”, but: About 10.")
    expect(modes).not_to_have_js_property("ariaValueNow", "5")
    agreed(page)
    with page.expect_download() as handed_out:
        press(page, "Handout")
    paper = handed_out.value.path().read_text(encoding="utf-8")
    front, overleaf = paper.split('<section class="overleaf">')
    assert "How many products of a shape in space" in front
    assert "Why?" in front
    assert "About 10." in overleaf
    assert "…" not in overleaf
    assert [part.count("</svg>") > 0 for part in (front, overleaf)] == [True, True]
    press(page, "Explore freely")
    expect(slider(page, "Peak load")).to_be_visible()
    expect(page.locator(".figures")).to_be_visible()
    page.wait_for_url(re.compile("^((?!lesson).)*pgd_modes=((?!lesson).)*$"))


def test_lessons_are_offered_until_one_has_seen_them_and_stay_in_the_sidebar(
    open_page: Visit,
) -> None:
    page = open_page("?elements=20&substructures=2&instants=11&plots=Scene&finish=at+once")
    page.get_by_text("New here?").click()
    expect(lesson(page).get_by_role("listitem")).to_have_count(len(LESSONS))
    press(page, "Hide the lessons")
    expect(page.get_by_text("New here?")).to_have_count(0)
    page.reload()
    expect(status(page)).to_contain_text("✓ converged")
    page.get_by_role("combobox", name="Lesson").select_option("broken-wire")
    expect(lesson(page)).to_contain_text("Where is a broken wire whole again?")
    expect(slider(page, "Friction coefficient")).not_to_be_visible()
    expect(value(page, "Length over which a broken wire regains its force")).to_have_text("200 mm")
    expect(page.get_by_text("New here?")).to_have_count(0)
    page.goto(page.url.partition("?")[0] + "?lesson=best-k")
    pad = lesson(page).get_by_role("img", name="over Factor on k")
    pad.hover(position={"x": 110.0, "y": 60.0})
    page.mouse.down()
    pad.hover(position={"x": 260.0, "y": 100.0})
    page.mouse.up()
    press(page, "One in between")
    expect(lesson(page)).to_contain_text("Your curve, and what was measured")
    expect(pad.locator("circle")).to_have_count(5)
    assert len(re.findall("L", pad.locator("path").get_attribute("d") or "")) > 20
