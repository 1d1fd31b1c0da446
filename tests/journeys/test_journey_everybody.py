"""The page on a phone, on a projector, in the dark, and without sight or mouse."""

from __future__ import annotations

import re

from everybody import COLOURS, all_can_use
from pages import (
    ANSWER,
    Visit,
    button,
    close_dialog,
    comes,
    field,
    figure,
    go,
    is_solved,
    status,
)
from playwright.sync_api import Page, expect

WIDTH = 390
HEIGHT = 844
DARK = "rgb(18, 18, 18)"
DARK_TAB = "rgb(144, 202, 249)"
BACKGROUND = "getComputedStyle(document.body).backgroundColor"
SIZE = """() => {
  const models = Bokeh.documents[0].roots().flatMap((root) => [...root.references()])
  const axis = models.find((model) => model.axis_label == "force, kN/m")
  return axis.major_label_text_font_size
}"""


def test_axe_finds_nothing_that_some_cannot_use_in_light_and_dark(page: Page) -> None:
    go(page, f"?{ANSWER}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    all_can_use(page)
    light = page.evaluate(BACKGROUND)
    button(page, "Toggle theme").click()
    comes(page, f"(light) => {BACKGROUND} !== light", light)
    # Tabs take their colour some frames later.
    expect(page.get_by_text("Contact force", exact=True)).to_have_css("color", DARK_TAB)
    all_can_use(page, COLOURS)
    button(page, "Toggle theme").click()
    comes(page, f"(light) => {BACKGROUND} === light", light)


def test_on_a_phone_in_the_dark_nothing_is_wider_than_the_screen_and_the_scene_is_first(
    visit: Visit,
) -> None:
    page = visit(f"?{ANSWER}&theme=dark", WIDTH, HEIGHT, has_touch=True, is_mobile=True)
    is_solved(page)
    assert page.evaluate(BACKGROUND) == DARK
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    box = figure(page, 0).bounding_box()
    assert box is not None
    assert box["width"] > 0.85 * WIDTH
    assert box["y"] + box["height"] < HEIGHT
    # Nothing lies over it, neither when the controls are opened.
    figure(page, 0).click(trial=True)
    button(page, "Open drawer").click()
    load = field(page, "Peak load")
    # At its foot a number is not its slider.
    load.click(position={"x": 4, "y": 21}, trial=True)
    figure(page, 0).click(trial=True)


def test_keys_open_dialogs_and_the_view_for_a_projector(page: Page) -> None:
    go(page, f"?{ANSWER}")
    expect(field(page, "Peak load")).to_be_visible()
    is_solved(page)
    page.locator(".sentence").click()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_contain_text("Space")
    close_dialog(page)
    for name in ("Lessons", "A class", "Take away"):
        button(page, name).focus()
        page.keyboard.press("Enter")
        expect(page.get_by_role("dialog").locator("visible=true")).to_have_count(1)
        close_dialog(page)
    count = page.locator(".bk-Figure").count()
    page.locator(".sentence").click()
    page.keyboard.press("p")
    expect(page.locator(".bk-Figure")).to_have_count(4)
    expect(page.get_by_role("banner")).to_be_hidden()
    expect(status(page)).to_contain_text("certified")
    expect(page).to_have_url(re.compile("view=present"))
    # 2.6 % of the height, whatever the theme sets.
    comes(page, f"() => ({SIZE})() == '19px'")
    button(page, "Back to the page").click()
    expect(page.get_by_role("banner")).to_be_visible()
    expect(page.locator(".bk-Figure")).to_have_count(count)
