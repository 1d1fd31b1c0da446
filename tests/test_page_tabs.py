"""The tabs beside the live run: nothing is in them before one asks, and all of it can be left."""

from __future__ import annotations

import re

from pages import at_rest, choose, comes_true, one_page, open_report, open_sheets, press
from playwright.sync_api import Page, expect

TINY = "?elements=4&substructures=2&instants=5&plots=Load+path"
DRAWN = """[...Bokeh.documents[0].all_models].filter((one) => one.type === "Figure" &&
  Bokeh.index.find_one_by_id(one.id)?.el.getClientRects().length)"""
"""Figures that are seen: those of other tabs are not, and some that have gone are not forgotten."""


page = one_page(TINY, "iteration")
"""One page: every test below has a tab of its own on it."""


def test_browsers_translate_no_program_of_the_page(page: Page) -> None:
    programs = page.evaluate(
        """[...Bokeh.documents[0]._all_models.values()].filter(({esm}) => esm)
          .map(({class_name, compiled, esm}) => [class_name, compiled === esm])"""
    )
    assert ["Pulse", True] in programs
    assert [name for name, as_it_is in programs if not as_it_is] == []


def test_browsers_load_no_letters_that_the_page_does_not_have(page: Page) -> None:
    has_loaded = "(range) => [...document.fonts].some((font) => font.status === 'loaded' &&" + (
        " font.family === 'Roboto' && font.unicodeRange.startsWith(range))"
    )
    comes_true(page, has_loaded, arg="U+0-FF")
    assert not page.evaluate(has_loaded, "U+0-10FFFF")
    cyrillic, vietnamese = "U+301", "U+102-103"
    assert not any(page.evaluate(has_loaded, range) for range in (cyrillic, vietnamese))


def test_the_page_makes_a_study_of_its_settings_when_asked(page: Page) -> None:
    open_report(page, "Study")
    measured = page.get_by_text("How it was measured")
    expect(measured).to_have_count(0)
    choose(page.get_by_role("combobox", name="Timed passes"), "3")
    press(page, "Start")
    expect(measured).to_be_visible()
    expect(page.get_by_text("Study: substructures 2")).to_be_visible()
    expect(page.get_by_text("incremental solver").locator("visible=true").first).to_be_visible()
    with page.expect_download() as caught:
        page.get_by_text("levels.csv").click()
    assert caught.value.suggested_filename == "levels.csv"
    press(page, "Live")
    expect(measured).to_be_hidden()
    open_report(page, "Study")
    expect(measured).to_be_visible()


def test_a_study_of_other_settings_says_so_and_is_done_again(page: Page) -> None:
    open_report(page, "Study")
    if not page.get_by_text("How it was measured").count():
        press(page, "Start")
    expect(page.get_by_text("How it was measured")).to_be_visible()
    open_sheets(page)
    expect(page.get_by_role("combobox", name="Method", exact=True)).to_be_hidden()
    pressure = page.get_by_role("textbox", name="Pressure p (kN/m)")
    pressure.fill("6")
    pressure.press("Enter")
    other = page.get_by_text("These results are of other settings: pressure 5 kN/m.")
    expect(other).to_be_visible()
    press(page, "Do it again")
    expect(page.get_by_text("pressure 6 kN/m").first).to_be_visible()
    expect(other).to_be_hidden()
    press(page, "Live")
    expect(page.get_by_role("combobox", name="Method", exact=True)).to_be_visible()


def test_the_stability_table_fills_row_by_row_and_can_be_filtered(page: Page) -> None:
    open_report(page, "Stability")
    press(page, "Start")
    verdicts = page.locator("td.verdict")
    expect(verdicts.nth(1)).to_have_text("right")
    press(page, "Cancel")
    expect(page.get_by_text(re.compile("runs pass"))).to_be_visible()
    press(page, "Hide the right ones")
    expect(page.locator("td.verdict.right:visible")).to_have_count(0)
    # Whichever is not right is seen; the first of these would take seconds to come.
    verdicts.first.evaluate("(one) => one.classList.replace('right', 'unsolved')")
    expect(verdicts.first).to_be_visible()


def test_a_link_of_the_proof_opens_its_run_on_the_same_page(page: Page) -> None:
    open_report(page, "Proof")
    press(page, "Start")
    link = page.get_by_role("link", name="bar pulled", exact=True)
    expect(link).to_be_visible()
    press(page, "Cancel")
    page.evaluate("window.isTheSame = true")
    link.click()
    expect(page.locator(".plots").first).to_be_visible()
    comes_true(page, "location.search.includes('elements=200')")
    # The bar's loop, over its closed form.
    expect(page.get_by_text("Hysteresis loop").locator("visible=true").first).to_be_visible()
    expect(page.get_by_text("closed form").locator("visible=true")).to_have_count(1)
    assert page.evaluate("window.isTheSame")
    open_report(page, "Proof")
    expect(link).to_be_visible()


def test_figures_drawn_before_and_after_are_dark_in_the_dark_theme_say_values_and_can_be_left(
    page: Page,
) -> None:
    """Of the paper's figures the first two: all are drawn without a browser."""
    theme = page.get_by_role("button", name="Toggle theme")
    press(page, "Figures")
    expect(page.locator(".plots").first).to_be_hidden()
    comes_true(page, f"{DRAWN}.length > 0")
    theme.click()
    comes_true(
        page,
        f"""() => {{
          const drawn = {DRAWN}
          const rgb = (color) => color.match(/[0-9a-f]{{2}}/gi).map((part) => parseInt(part, 16))
          return drawn.length >= 4 && drawn.every(
            (one) => Math.max(...rgb(one.background_fill_color)) < 80)
        }}""",
    )
    # If there is still something to cancel.
    cancel = page.get_by_role("button", name="Cancel").locator("visible=true")
    cancel.evaluate_all("(all) => all.forEach((one) => one.click())")
    # The plots move as it goes.
    expect(cancel).to_have_count(0)
    place = at_rest(
        page,
        """() => {
          const figure = [...Bokeh.documents[0].all_models].find(
            (one) => one.type === "Figure" && one.title?.text === "What is true")
          const view = Bokeh.index.find_one_by_id(figure.id)
          const {x, y} = view.el.getBoundingClientRect()
          const {data_source} = figure.renderers.find(
            (one) => one.data_source.name === "curve-0")
          const {x: along, y: up} = data_source.data
          const {x_scale, y_scale} = view.frame
          return [x + x_scale.compute(along[100]), y + y_scale.compute(up[100])]
        }""",
    )
    page.mouse.move(*place)
    expect(page.locator(".bk-Tooltip").first).to_contain_text("friction force, multiscale")
    press(page, "Live")
    expect(page.locator(".plots").first).to_be_visible()
    expect(page.get_by_text("Fig. 3").first).to_be_hidden()
    corners = page.locator(".card canvas").evaluate_all(
        """(all) => all.map(
          (one) => one.getContext("2d")?.getImageData(1, one.height - 2, 1, 1).data[3])"""
    )
    assert set(corners) == {0}
    theme.click()
