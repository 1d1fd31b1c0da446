"""A lesson is taken, alone and in a class."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from accessibility import all_can_use
from browser import Chrome, Server
from pages import (
    ANSWER,
    Desk,
    Visit,
    button,
    close_dialog,
    comes,
    enter,
    field,
    figure,
    figures,
    go,
    is_solved,
    status,
    visits,
)
from pages_without_browser import crowd
from playwright.sync_api import Page, expect

PRESS = "(pressed, at) => setTimeout(() => pressed.click(), at - Date.now())"
"""Script that presses an element at a time, ms since the epoch."""
MEASURED = """() => {
  const models = [...Bokeh.documents[0].all_models]
  const points = models.find((model) => model.data?.text?.includes("never"))
  return points?.data.x.length
}"""
"""Script that counts the measured points on the figure to draw on."""
QUESTION = "Is a small indicator a small error?"
DRAWN = "Is there a best k?"
"""A lesson whose answer is drawn as a curve."""


def choose(page: Page, lesson: str) -> None:
    """Take a lesson, by a part of its title."""
    button(page, "Lessons").click()
    page.get_by_role("button", name=lesson).click()


def stop(page: Page) -> None:
    """Have the picture rest that the question of a lesson plays.

    All pages of a class would paint it again and again while others open.
    """
    button(page, "Play through time").click()
    expect(page.get_by_text("play_circle", exact=True)).to_be_visible()


def lead(page: Page) -> str:
    """Begin a class, and return its code."""
    button(page, "A class").click()
    page.get_by_role("button", name="Begin a class").click()
    expect(page.locator(".class").first).to_contain_text("0 follow")
    expect(page).to_have_url(re.compile(r"class=\w{4}"))
    match = re.search(r"class=(\w{4})", page.url)
    assert match
    expect(page.get_by_role("dialog")).to_contain_text(match[1])
    close_dialog(page)
    # Its line takes nothing from the time line, the last thing in the window.
    box = figure(page, 1).bounding_box()
    assert box is not None
    assert box["y"] + box["height"] <= 720.0
    return match[1]


def follow(visit: Visit, code: str) -> Page:
    """A page that follows by a link."""
    page = visit(f"?class={code}")
    expect(page.locator(".class").first).to_contain_text(f"You follow class {code}")
    return page


def test_a_lesson_asks_and_after_a_prediction_shows_what_was_measured(
    page: Page,
) -> None:
    choose(page, QUESTION)
    expect(page.get_by_role("heading", name=QUESTION)).to_be_visible()
    expect(page).to_have_url(re.compile("lesson=small-indicator"))
    expect(button(page, "Show me")).to_be_visible()
    expect(page.get_by_role("alert")).to_have_count(0)
    all_can_use(page)
    button(page, "Some 75 %").click()
    expect(page.get_by_role("alert")).to_be_visible()
    expect(status(page)).to_contain_text("75 % wrong")
    expect(button(page, "Handout")).to_be_visible()
    expect(page.get_by_text("{value:")).to_have_count(0)
    expect(figures(page)).to_be_visible()
    # Bokeh's figures would not follow what moves them: longer numbers take no line
    # more.
    before = figures(page).inner_text()
    place = page.locator(".figures").bounding_box()
    figure(page, 1).click(position={"x": 40, "y": 20})
    expect(figures(page)).not_to_have_text(before)
    assert page.locator(".figures").bounding_box() == place
    button(page, "Explore freely").click()
    expect(page.get_by_role("heading", name=QUESTION)).to_have_count(0)
    expect(field(page, "Friction coefficient")).to_be_visible()


def test_an_answer_and_the_next_lesson_begin_with_their_titles_in_sight(
    page: Page,
) -> None:
    page.set_viewport_size({"width": 1280, "height": 480})
    choose(page, DRAWN)
    title = page.get_by_role("heading", name=DRAWN)
    page.locator(".lesson").get_by_role("button").last.scroll_into_view_if_needed()
    expect(title).not_to_be_in_viewport()
    button(page, "Show me").click()
    expect(page.get_by_role("alert")).to_be_visible()
    expect(title).to_be_in_viewport()
    following = button(page, "Next lesson")
    following.scroll_into_view_if_needed()
    expect(title).not_to_be_in_viewport()
    following.click()
    expect(page.get_by_role("heading", name="More substructures")).to_be_in_viewport()
    button(page, "Explore freely").click()
    page.set_viewport_size({"width": 1280, "height": 720})


@dataclass(frozen=True)
class School:
    """A class: its code, and the pages of its leader and of one who follows.

    The leader has changed the load before that one came.
    """

    code: str
    leader: Page
    follower: Page


@pytest.fixture(scope="module")
def school(desk: Desk, chrome: Chrome, server: Server) -> Iterator[School]:
    """A class whose pages are opened once: that takes longer than what they do."""
    with visits(server, chrome) as visit:
        leader = desk.page()
        go(leader, f"?{ANSWER}")
        expect(status(leader)).to_contain_text("answer:")
        is_solved(leader)
        code = lead(leader)
        enter(leader, "Peak load", "1100", over="900")
        yield School(code, leader, follow(visit, code))
        button(leader, "A class").click()
        button(leader, "End the class").click()
        close_dialog(leader)


def test_a_class_sees_what_its_leader_sees(school: School, desk: Desk) -> None:
    leader = school.leader
    page = school.follower
    for each in (leader, page):
        expect(figures(each)).to_contain_text("Force −1.1 kN")
    expect(leader.locator(".class").first).to_contain_text("1 follows")
    leader.reload()
    # Its fields come with their values: nobody types into one that is written over.
    typed = field(leader, "Peak load")
    typed.wait_for()
    assert typed.input_value() == "1100"
    expect(leader.locator(".class").first).to_contain_text("1 follows")
    expect(figures(leader)).to_contain_text("Force −1.1 kN")
    desk.arrive()
    enter(leader, "Peak load", "1000", over="1100")
    expect(figures(page)).to_contain_text("Force −1 kN")

    enter(page, "Peak load", "1200", over="1000")
    expect(figures(page)).to_contain_text("Force −1.2 kN")
    expect(page.locator(".class").first).to_contain_text("You have left class")
    is_solved(page)
    button(page, "Follow").click()
    expect(figures(page)).to_contain_text("Force −1 kN")


def test_a_class_is_joined_in_the_midst_of_an_answer(school: School) -> None:
    leader = school.leader
    page = school.follower
    # Whoever changes anything has left, and joins again by the code.
    enter(page, "Friction coefficient", "0.4", over="0.3")
    expect(page.locator(".class").first).to_contain_text("You have left class")
    is_solved(page)
    choose(leader, DRAWN)
    button(leader, "Go on to the answer").click()
    expect(leader.get_by_role("alert")).to_be_visible()
    button(page, "A class").click()
    page.get_by_role("textbox", name="Code").fill(school.code.lower())
    page.get_by_role("button", name="Join").click()
    expect(page.locator(".class").first).to_contain_text("You follow class")
    expect(page.locator(".class").first).to_contain_text(school.code)
    expect(page.get_by_role("dialog").locator("visible=true")).to_have_count(0)
    expect(page.get_by_role("alert")).to_be_visible()
    for each in (leader, page):
        comes(each, f"() => ({MEASURED})() == 5")
    assert page.locator(".bk-Figure").count() == leader.locator(".bk-Figure").count()


def test_all_ten_of_a_class_who_predict_at_once_are_counted(
    school: School, server: Server
) -> None:
    leader = school.leader
    page = school.follower
    choose(leader, QUESTION)
    expect(button(leader, "Open the counts")).to_be_visible()
    stop(leader)
    # A browser takes a core for each page: the others press their buttons without one.
    with crowd(f"{server.address}?class={school.code}", 9, "Some 1 %") as others:
        others.wait()
        expect(leader.get_by_text("0 of 10 have predicted")).to_be_visible()
        at = time.time() + 1.0
        button(page, "Some 10 %").evaluate(PRESS, 1e3 * at)
        others.press(at)
        expect(leader.get_by_text("10 of 10 have predicted")).to_be_visible()
        button(leader, "Open the counts").click()
        for each in (leader, page):
            expect(each.get_by_text("9 of 10", exact=True)).to_be_visible()
            expect(each.get_by_text("1 of 10", exact=True)).to_be_visible()
        button(leader, "Go on to the answer").click()
        expect(page.get_by_role("alert")).to_contain_text("You chose “Some 10 %”")
    expect(status(page)).to_contain_text("75 % wrong")
