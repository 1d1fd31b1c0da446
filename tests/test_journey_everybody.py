"""The page on a phone, on a projector, in the dark, and for whoever sees or moves otherwise."""

from __future__ import annotations

import pytest
from axe_playwright_python.sync_playwright import Axe
from pages import ANSWER, Visit, button, close_dialog, figure, is_solved, status
from playwright.sync_api import Page, expect

WIDTH, HEIGHT = 390, 844
BACKGROUND = "getComputedStyle(document.body).backgroundColor"

OF_THE_WIDGETS = ("aria-prohibited-attr", "aria-progressbar-name", "button-name")
"""What panel-material-ui's own descriptions, bars and number fields break."""


def violations(page: Page) -> list[str]:
    """What the rules of WCAG find, as far as they are of level A and AA."""
    options = {"runOnly": {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"]}}
    response = Axe().run(page, options=options).response
    return [
        f"{rule['id']}: {node['html'][:160]}"
        for rule in response["violations"]
        if rule["id"] not in OF_THE_WIDGETS
        for node in rule["nodes"]
    ]


def test_it_is_dark_where_one_wants_it_dark(visit: Visit) -> None:
    page = visit(f"?{ANSWER}&theme=dark")
    is_solved(page)
    assert not (found := violations(page)), "\n".join(found)
    dark = page.evaluate(BACKGROUND)
    button(page, "Toggle theme").click()
    page.wait_for_function(f"(dark) => {BACKGROUND} !== dark", arg=dark)


def test_on_a_phone_nothing_is_wider_than_the_screen_and_the_scene_comes_first(
    visit: Visit,
) -> None:
    page = visit(f"?{ANSWER}", WIDTH, HEIGHT, has_touch=True, is_mobile=True)
    is_solved(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    box = figure(page, 0).bounding_box()
    assert box is not None
    assert box["width"] > 0.85 * WIDTH
    assert box["y"] + box["height"] < HEIGHT


def test_a_projector_has_the_scene_and_two_plots_and_nothing_else(visit: Visit) -> None:
    page = visit(f"?{ANSWER}")
    is_solved(page)
    count = page.locator(".bk-Figure").count()
    page.locator(".sentence").click()
    page.keyboard.press("p")
    expect(page.locator(".bk-Figure")).to_have_count(4)
    expect(page.get_by_role("banner")).to_be_hidden()
    expect(status(page)).to_contain_text("certified")
    assert "view=present" in page.url
    page.keyboard.press("p")
    expect(page.locator(".bk-Figure")).to_have_count(count)


@pytest.mark.parametrize("place", ["", "&tab=What if", "&lesson=best-k"])
def test_axe_finds_nothing_that_some_cannot_use(visit: Visit, place: str) -> None:
    page = visit(f"?{ANSWER}{place}" if "lesson" not in place else f"?{place[1:]}")
    if "What if" in place:
        expect(page.get_by_role("combobox", name="See what happens to")).to_be_visible()
    elif "lesson" in place:
        expect(button(page, "Show me")).to_be_visible()
    else:
        is_solved(page)
    assert not (found := violations(page)), "\n".join(found)


def test_dialogs_are_opened_and_closed_by_keys(visit: Visit) -> None:
    page = visit(f"?{ANSWER}")
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
