"""The page on a phone, on a projector, in the dark, and without sight or mouse."""

from __future__ import annotations

import re
from typing import Any

from axe_playwright_python.sync_playwright import Axe
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

OF_THE_WIDGETS = ("aria-prohibited-attr", "aria-progressbar-name", "button-name")
"""What panel-material-ui's own descriptions, bars and number fields break."""


RULES = {
    "type": "tag",
    "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"],
}
"""Rules of WCAG of level A and AA, and of good practice."""
COLOURS = {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}
"""Those of them that ask for colours, which are all that differs between themes."""


def violations(page: Page, rules: dict[str, Any]) -> list[str]:
    """Violations of some rules."""
    options = {
        # What passes would come with all its elements, half a megabyte.
        "resultTypes": ["violations"],
        "runOnly": rules,
    }
    response = Axe().run(page, options=options).response
    found = []
    for rule in response["violations"]:
        if rule["id"] not in OF_THE_WIDGETS:
            found += [f"{rule['id']}: {node['html'][:160]}" for node in rule["nodes"]]
    return found


def test_axe_finds_nothing_that_some_cannot_use_in_light_and_dark(page: Page) -> None:
    def is_clean(rules: dict[str, Any] = RULES) -> None:
        # No tooltip is on its way.
        page.mouse.move(640.0, 5.0)
        expect(page.get_by_role("tooltip")).to_have_count(0)
        assert not (found := violations(page, rules)), "\n".join(found)

    go(page, f"?{ANSWER}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    is_clean()
    light = page.evaluate(BACKGROUND)
    button(page, "Toggle theme").click()
    comes(page, f"(light) => {BACKGROUND} !== light", light)
    # Tabs take their colour some frames later.
    expect(page.get_by_text("Contact force", exact=True)).to_have_css("color", DARK_TAB)
    is_clean(COLOURS)
    button(page, "What if").click()
    expect(page.get_by_role("combobox", name="See what happens to")).to_be_visible()
    is_clean()
    button(page, "Live").click()
    button(page, "Lessons").click()
    page.get_by_role("button", name="Is a small indicator a small error?").click()
    expect(button(page, "Show me")).to_be_visible()
    is_clean()
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
