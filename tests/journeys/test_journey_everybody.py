"""The page on a phone, on a projector, in the dark, and without sight or mouse."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from browser import Chrome, Server
from pages import (
    ANSWER,
    MODEL,
    button,
    close_dialog,
    comes,
    field,
    figure,
    figures,
    go,
    is_solved,
    status,
    visits,
)
from playwright.sync_api import Page, expect

WIDTH = 390
HEIGHT = 844
LIGHT_TAB = "rgb(25, 118, 210)"
BACKGROUND = "getComputedStyle(document.body).backgroundColor"
SIZE = """() => {
  const models = Bokeh.documents[0].roots().flatMap((root) => [...root.references()])
  const axis = models.find((model) => model.axis_label == "force, kN/m")
  return axis.major_label_text_font_size
}"""

OF_THE_WIDGETS = ("aria-prohibited-attr", "aria-progressbar-name", "button-name")
"""What panel-material-ui's own descriptions, bars and number fields break."""


HANDLE = f"""() => {{
  const {{x, y}} = ({MODEL})("handles").data
  return [x[0], y[0]]
}}"""
"""Script that tells where the first handle is, px from the lower left of the scene."""
Place = tuple[float, float]


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


@pytest.fixture(scope="module")
def page(chrome: Chrome, server: Server) -> Iterator[Page]:
    """A page in the dark that is opened once for those with mouse or keys."""
    with visits(server, chrome) as visit:
        yield visit(f"?{ANSWER}&theme=dark")


def test_axe_finds_nothing_that_some_cannot_use_in_dark_and_light(page: Page) -> None:
    def is_clean(rules: dict[str, Any] = RULES) -> None:
        # No tooltip is on its way.
        page.mouse.move(640.0, 5.0)
        expect(page.get_by_role("tooltip")).to_have_count(0)
        assert not (found := violations(page, rules)), "\n".join(found)

    is_solved(page)
    is_clean()
    dark = page.evaluate(BACKGROUND)
    button(page, "Toggle theme").click()
    comes(page, f"(dark) => {BACKGROUND} !== dark", dark)
    # Tabs take their colour some frames later.
    expect(page.get_by_text("Contact force", exact=True)).to_have_css(
        "color", LIGHT_TAB
    )
    is_clean(COLOURS)
    button(page, "What if").click()
    expect(page.get_by_role("combobox", name="See what happens to")).to_be_visible()
    is_clean()
    button(page, "Live").click()
    button(page, "Lessons").click()
    page.get_by_role("button", name="Is a small indicator a small error?").click()
    expect(button(page, "Show me")).to_be_visible()
    is_clean()


@pytest.fixture(scope="module")
def phone(chrome: Chrome, server: Server) -> Iterator[Page]:
    """A page on a phone that is opened once."""
    with visits(server, chrome) as visit:
        yield visit(f"?{ANSWER}", WIDTH, HEIGHT, has_touch=True, is_mobile=True)


def swipe(page: Page, start: Place, end: Place) -> None:
    """Move a finger from a place in the window to another, px."""
    client = page.context.new_cdp_session(page)

    def touch(kind: str, *fingers: Place) -> None:
        points = [{"x": x, "y": y} for x, y in fingers]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", start)
    for share in (0.25, 0.5, 0.75, 1.0):
        x, y = (a + share * (b - a) for a, b in zip(start, end, strict=True))
        touch("touchMove", (x, y))
    touch("touchEnd")
    client.detach()


def test_a_finger_drags_a_handle_of_the_picture_and_else_scrolls_the_page(
    phone: Page,
) -> None:
    is_solved(phone)
    expect(figures(phone)).to_contain_text("Force −900 N")
    picture = figure(phone, 0)
    box = picture.bounding_box()
    assert box is not None
    x, y = phone.evaluate(HANDLE)
    handle = box["x"] + x, box["y"] + box["height"] - y
    swipe(phone, handle, (handle[0] + 40.0, handle[1]))
    expect(figures(phone)).to_contain_text(re.compile(r"Force −(1\.[5-9]|2).* kN"))
    is_solved(phone)
    middle = box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"]
    swipe(phone, middle, (middle[0], middle[1] - 150.0))
    moved = picture.bounding_box()
    assert moved is not None
    assert moved["y"] < box["y"] - 50.0
    expect(figures(phone)).to_contain_text(re.compile(r"Force −(1\.[5-9]|2).* kN"))


def test_on_a_phone_nothing_is_wider_than_the_screen_and_the_scene_comes_first(
    phone: Page,
) -> None:
    page = phone
    go(page, f"?{ANSWER}")
    expect(figures(page)).to_contain_text("Force −900 N")
    is_solved(page)
    page.locator(".status").scroll_into_view_if_needed()
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


def test_keys_open_dialogs_selects_and_the_view_for_a_projector(page: Page) -> None:
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
        expect(button(page, name)).to_be_focused()
    choice = page.get_by_role("combobox", name="Path of the force at the right end")
    choice.focus()
    for keys in ("Space", "Enter"):
        # A letter looks for a choice that begins with it, and goes nowhere else.
        page.keyboard.press(keys)
        expect(page.get_by_role("listbox")).to_be_visible()
        page.keyboard.press("t")
        page.keyboard.press("Enter")
        expect(choice).to_have_text("triangle")
        expect(choice).to_be_focused()
    page.keyboard.press("Enter")
    page.keyboard.press("End")
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog")).to_contain_text("Points")
    close_dialog(page)
    expect(choice).to_be_focused()
    go(page, f"?{ANSWER}")
    expect(choice).to_have_text("sine")
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
