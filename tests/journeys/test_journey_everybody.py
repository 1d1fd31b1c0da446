"""The page on a phone, on a projector, in the dark, and without sight or mouse."""

from __future__ import annotations

import re

import pytest
from accessibility import COLOURS, all_can_use
from markup import watched
from pages import (
    ANSWER,
    MODEL,
    PHONE,
    Desk,
    button,
    close_controls,
    close_dialog,
    comes,
    enter,
    field,
    figure,
    figures,
    go,
    is_solved,
    slider,
    status,
)
from playwright.sync_api import Page, expect

ABOVE = """([upper, lower]) =>
  upper.getBoundingClientRect().bottom <= lower.getBoundingClientRect().top
"""
DARK = "rgb(18, 18, 18)"
DARK_TAB = "rgb(144, 202, 249)"
BACKGROUND = "getComputedStyle(document.body).backgroundColor"
SIZE = """() => {
  const models = [...Bokeh.documents[0].all_models]
  const axis = models.find((model) => model.axis_label == "force, kN/m")
  return axis.major_label_text_font_size
}"""

HANDLE = f"""() => {{
  const {{x, y}} = ({MODEL})("handles").data
  return [x[0], y[0]]
}}"""
"""Script that tells where the first handle is, px from the lower left of the scene."""
Place = tuple[float, float]


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


@pytest.fixture
def phone(stranger: Desk) -> Page:
    """A page on a phone in the dark."""
    return stranger.page()


def test_what_a_foolish_address_has_is_said_on_its_page_and_nothing_of_it_runs(
    stranger: Desk,
) -> None:
    # Only of a page that has just been opened.
    stranger.close()
    page = stranger.page()
    line = page.locator(".status")
    with watched(page):
        expect(line).to_contain_text("From the address: ")
        expect(line).to_contain_text("cannot be −1")
        expect(line).to_contain_text("moon: there is no such setting")
        expect(line).to_contain_text("there is no scene <img")
        expect(line).to_contain_text("There is no class <img")
        is_solved(page)
    # What a person does next is all that is said.
    button(page, "Open drawer").click()
    enter(page, "Peak load", "1000", over="900")
    expect(line).not_to_contain_text("From the address: ")
    expect(figures(page)).to_contain_text("Force −1 kN")
    close_controls(page)


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
    go(phone, f"?{ANSWER}")
    expect(figures(phone)).to_contain_text("Force −900 N")
    is_solved(phone)
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


def test_on_a_phone_in_the_dark_nothing_is_wider_than_the_screen_and_the_scene_is_first(
    phone: Page,
) -> None:
    page = phone
    go(page, f"?{ANSWER}")
    expect(figures(page)).to_contain_text("Force −900 N")
    is_solved(page)
    page.locator(".status").scroll_into_view_if_needed()
    assert page.evaluate(BACKGROUND) == DARK
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    box = figure(page, 0).bounding_box()
    assert box is not None
    assert box["width"] > 0.85 * PHONE["width"]
    assert box["y"] + box["height"] < PHONE["height"]
    # Nothing lies over it, neither when the controls are opened.
    figure(page, 0).click(trial=True)
    button(page, "Open drawer").click()
    load = field(page, "Peak load")
    # At its foot a number is not its slider.
    load.click(position={"x": 4, "y": 21}, trial=True)
    figure(page, 0).click(trial=True)
    # A finger that scrolls the controls sets nothing on its way.
    box = slider(page, "Peak load").locator("..").bounding_box()
    assert box is not None
    rail = box["x"] + 200.0, box["y"]
    swipe(page, rail, (rail[0], rail[1] - 100.0))
    expect(load).to_have_value("900")
    moved = slider(page, "Peak load").locator("..").bounding_box()
    assert moved is not None
    assert moved["y"] < box["y"] - 50.0
    close_controls(page)
    # All buttons of the header are in sight, or in its list.
    for name in ("Lessons", "More", "Toggle theme"):
        expect(button(page, name)).to_be_in_viewport(ratio=1.0)
    button(page, "More").click()
    # A dialog has all its buttons, and the one that closes it.
    page.get_by_role("menuitem", name="Take away").click()
    dialog = page.get_by_role("dialog")
    for name in ("Copy link", "close"):
        expect(dialog.get_by_role("button", name=name)).to_be_in_viewport(ratio=1.0)
    close_dialog(page)


def test_on_a_phone_a_high_picture_stands_with_its_keys_above_the_controls(
    phone: Page,
) -> None:
    page = phone
    go(page, "?scene=arch&finish=at-once&voussoirs=12&instants=11")
    expect(figures(page)).to_contain_text("Thrust")
    button(page, "Open drawer").click()
    expect(field(page, "Movement of the abutment")).to_be_visible()
    parts = [figure(page, 0), page.locator(".sidebar").first]
    comes(page, ABOVE, [part.element_handle() for part in parts])
    close_controls(page)


def test_on_a_phone_the_picture_stays_in_sight_above_the_text_of_a_case(
    phone: Page,
) -> None:
    page = phone
    go(page, "?case=pile")
    spring = field(page, "Spring at the right end")
    spring.scroll_into_view_if_needed()
    expect(spring).to_be_in_viewport()
    # All of it, with its keys.
    picture = figure(page, 0).bounding_box()
    sheet = page.locator(".lesson").bounding_box()
    assert picture is not None
    assert sheet is not None
    assert picture["y"] + picture["height"] <= sheet["y"]
    # The plots below the picture come up to the text, too.
    last = page.locator(".plots .bk-Figure").last
    last.evaluate("(plot) => plot.scrollIntoView({block: 'start'})")
    expect(spring).to_be_in_viewport()
    foot = last.bounding_box()
    text = page.locator(".lesson").bounding_box()
    assert foot is not None
    assert text is not None
    assert foot["y"] + foot["height"] <= text["y"] + 1.0


def test_on_a_phone_the_first_plot_of_a_lesson_stands_above_its_text(
    phone: Page,
) -> None:
    go(phone, "?lesson=what-the-solver-does")
    expect(phone.locator(".lesson")).to_contain_text("guesses the whole motion")
    phone.mouse.move(0.5 * PHONE["width"], 100.0)
    phone.mouse.wheel(0.0, -PHONE["height"])
    parts = [figure(phone, 2), phone.locator(".lesson").first]
    comes(phone, ABOVE, [part.element_handle() for part in parts])


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
    # A tooltip takes no click from the next button.
    button(page, "Take away").hover()
    expect(page.get_by_role("tooltip")).to_be_visible()
    button(page, "Keys and words").click(trial=True)
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
