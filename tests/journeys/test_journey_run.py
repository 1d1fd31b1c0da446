"""A person opens the page, watches a search, and moves through it."""

from __future__ import annotations

import re
from io import BytesIO
from urllib.parse import urlencode

import numpy as np
from pages import (
    ANSWER,
    ENDLESS,
    MODEL,
    button,
    comes,
    drag,
    enter,
    field,
    figure,
    figures,
    go,
    holds,
    inside,
    is_solved,
    iteration,
    slider,
    status,
)
from PIL import Image, ImageColor
from playwright.sync_api import Page, expect
from processes import wait_for
from small_scenes import SMALL

from app.views.colors import BACKWARD, FORCE
from solver.scenes import CATALOGUE

HIGH = {"block", "fault", "incline", "arch", "belt", "bundle"}
"""Scenes whose bodies are not long."""
BESIDE = "(element) => element.scrollWidth - element.clientWidth"
"""Width by which an element can be scrolled sideways, px."""
WHOLE = """() => {
  const models = Bokeh.documents.flatMap((document) => [...document.all_models])
  return models.every((model) => {
    const range = model.x_range
    if (!range?.bounds?.length) return true
    return range.start == range.bounds[0] && range.end == range.bounds[1]
  })
}"""
"""Whether the time line has the whole interval."""
PIECES = """() => {
  const models = Bokeh.documents.flatMap((document) => [...document.all_models])
  const arrows = models.find((model) => model.name == "macro above")
  return arrows?.data_source.get_array("x").length > 2
}"""
"""Whether the pieces of the structure have forces."""


REST = """() => {
  const canvases = (root) => [...root.querySelectorAll("*")].flatMap((each) => [
    ...(each.matches(".bk-events") ? [each] : []),
    ...(each.shadowRoot ? canvases(each.shadowRoot) : []),
  ])
  let count = 0
  const move = () => {
    for (const canvas of canvases(document)) {
      const {x, y, width, height} = canvas.getBoundingClientRect()
      const place = {clientX: x + 0.5 * width, clientY: y + 0.5 * height}
      const who = {isPrimary: true, bubbles: true, composed: true}
      canvas.dispatchEvent(new PointerEvent("pointermove", {...place, ...who}))
      count += 1
    }
  }
  const timer = setInterval(move, 5)
  window.stopped = () => { clearInterval(timer); return count }
}"""
"""Script that moves a pointer in the middle of each plot, until it is stopped."""
SHEETS = """() => {
  const element = document.head.appendChild(document.createElement("style"))
  const sheets = ["p {}", "p {}", "b {}"].map((text) => {
    element.textContent = text
    return element.sheet
  })
  element.remove()
  return [sheets[1] === sheets[0], sheets[2].cssRules[0].selectorText]
}"""
"""Whether a style sheet stays as the same text is set, and what is there of another."""
OPACITY = "(element) => getComputedStyle(element).opacity"
MEANING = "(term) => getComputedStyle(term, '::after').content"
MET = "localStorage.getItem('slipfront')"


def test_a_new_page_shows_a_search_plays_its_cycle_and_may_have_the_answer_at_once(
    new_page: Page,
) -> None:
    page = new_page
    expect(status(page)).to_contain_text(re.compile(r"iteration \d+"))
    expect(status(page)).to_contain_text("% wrong")
    first = iteration(page)
    wait_for(lambda: iteration(page) > first)
    is_solved(page)
    expect(status(page)).to_contain_text(re.compile(r"search: \d+ iterations"))
    term = page.locator("abbr", has_text="certified")
    term.focus()
    assert "balance" in term.evaluate(MEANING)
    assert page.evaluate(MET) is None

    # It plays its load cycle until somebody does something.
    expect(figures(page)).to_contain_text(re.compile(r"Force \d"))
    figure(page, 1).click()
    expect(page.get_by_text("play_circle", exact=True)).to_be_visible()
    expect(figures(page)).to_contain_text(re.compile(r"Force −?\d\d? N"))

    last = iteration(page)
    expect(page.locator(".iterate")).to_have_text(f"Answer after {last} iterations")
    drag(page, page.locator(".times"), 0.9, 0.5, height=0.97)
    expect(status(page)).to_contain_text(re.compile(rf"iteration \d+ of {last}"))
    page.mouse.up()
    scrub = slider(page, "Iteration")
    # Pictures follow a hand with some delay; counted back from the answer, which comes
    # after the last iterate.
    wait_for(lambda: iteration(page) == last + 1 + int(scrub.input_value()))
    # Not each was painted, but each can be seen.
    back = iteration(page)
    page.locator(".sentence").click()
    for number in range(back - 1, back - 6, -1):
        page.keyboard.press("Shift+ArrowLeft")
        expect(status(page)).to_contain_text(f"iteration {number} of")
    expect(page.locator(".iterate")).to_have_text(f"Iteration {number} of {last}")
    scrub.press("End")
    expect(status(page)).to_contain_text("certified")

    button(page, "Answer").click()
    expect(status(page)).to_contain_text("answer:")
    button(page, "Watch").click()
    expect(status(page)).to_contain_text(re.compile(r"iteration \d+"))

    before = figures(page).inner_text()
    drag(page, slider(page, "Peak load"), 0.5, 2.5)
    expect(status(page)).to_contain_text("answer:")
    expect(figures(page)).not_to_have_text(before)
    page.mouse.up()
    expect(status(page)).to_contain_text(re.compile(r"iteration \d+"))
    is_solved(page)
    expect(status(page)).to_contain_text("search:")
    expect(page).to_have_url(re.compile("peak="))
    assert page.evaluate(MET) == "met"


def test_what_is_of_a_run_before_fades_until_a_picture_of_the_new_one_is_there(
    page: Page,
) -> None:
    go(page, f"?{ANSWER}&peak=1000")
    expect(figures(page)).to_contain_text("Force −1 kN")
    is_solved(page)
    parts = [page.locator(part).first for part in (".scene > div", ".plots", ".words")]

    def looks(is_stale: str, opacity: str) -> bool:
        # A picture that comes late, as that with the reference, takes the mark back.
        page.evaluate(f"({MODEL})('browser').is_stale = {is_stale}")
        return all(part.evaluate(OPACITY) == opacity for part in parts)

    wait_for(lambda: looks("true", "0.3"))
    wait_for(lambda: looks("false", "1"))


def heights_of_plots(page: Page) -> list[float]:
    """Heights of the figures in the cards, px."""
    boxes = [figure(page, number).bounding_box() for number in (2, 3)]
    return [box["height"] for box in boxes if box is not None]


def has_plots_beside(page: Page) -> bool:
    """Check whether plots stand beside the picture, and not below it."""
    scene, plot = (figure(page, number).bounding_box() for number in (0, 2))
    return bool(scene and plot and scene["x"] + scene["width"] <= plot["x"])


def test_a_style_sheet_is_read_anew_where_its_text_is_another_alone(
    page: Page,
) -> None:
    assert page.evaluate(SHEETS) == [True, "b"]


def test_a_pointer_that_rests_on_a_plot_may_be_there_before_it_is_painted(
    page: Page,
) -> None:
    go(page, f"?{ANSWER}")
    is_solved(page)
    # What goes wrong in the browser meanwhile fails the page.
    page.evaluate(REST)
    for name in ("Loop", "Contact force", "Error over run time", "Convergence"):
        before = page.evaluate(f"({MODEL})('pulse').painted")
        page.get_by_role("tab", name=name, exact=True).click()
        holds(page, "model('pulse').painted > arg", before)
    assert page.evaluate("stopped()") > 20
    box = figure(page, 2).bounding_box()
    assert box is not None
    # Once it is there the plot tells its values.
    tip = page.locator(".bk-tooltip-row-value, .bk-Tooltip").first

    def finds() -> bool:
        for share in range(10, 90, 2):
            page.mouse.move(
                box["x"] + 0.5 * box["width"], box["y"] + 0.01 * share * box["height"]
            )
            if tip.is_visible():
                return True
        return False

    wait_for(finds)


def count_of(page: Page, color: str) -> int:
    """Number of pixels of a colour in the picture of the scene."""
    with Image.open(BytesIO(figure(page, 0).screenshot())) as image:
        pixels = np.asarray(image.convert("RGB"))
    return int(np.all(pixels == ImageColor.getrgb(color), axis=-1).sum())


def test_whoever_goes_through_the_scenes_finds_each_told_and_solved(
    page: Page,
) -> None:
    first, *others = CATALOGUE
    sentence = inside(page, ".sentence")
    go(page, f"?scene={first}&{ANSWER}")
    expect(sentence).to_contain_text("steel bar")
    told = [sentence.inner_text()]
    for scene in (*others, first):
        asked = {"scene": scene} | SMALL[scene]
        if scene == "wall":
            # One of three courses is as long as others are only with more bricks
            asked["bricks"] = 9
        go(page, f"?{urlencode(asked)}&{ANSWER}&plots=Pieces")
        expect(sentence).not_to_have_text(told[-1])
        if scene == "bundle":
            # A search that ends by its estimate, as a proof would take longer.
            expect(status(page)).to_contain_text("solved")
        else:
            is_solved(page)
        told.append(sentence.inner_text())
        wait_for(lambda scene=scene: has_plots_beside(page) == (scene in HIGH))
        assert min(heights_of_plots(page)) >= 200.0
        assert page.locator(".live").evaluate(BESIDE) == 0
        comes(page, WHOLE)
        comes(page, PIECES)
    # Arrows of the pressure are much more than the words beside them.
    assert count_of(page, FORCE) > 800
    assert count_of(page, BACKWARD) > 500
    assert len(set(told)) == len(CATALOGUE)


def test_typed_values_run_or_are_refused_and_leave_the_pinned_run(
    page: Page,
) -> None:
    go(page, f"?{ANSWER}")
    enter(page, "Peak load", "1.2 kN", over="900")
    expect(field(page, "Peak load")).to_have_value("1200")
    expect(figures(page)).to_contain_text("Force −1.2 kN")
    enter(page, "Friction coefficient", "-1", over="0.3")
    expect(page.get_by_text("cannot be −1").first).to_be_visible()
    # Bokeh's figures would not follow what moves them.
    place = page.locator(".scene").bounding_box()
    expect(field(page, "Friction coefficient")).to_have_value("0.3")
    expect(figures(page)).to_contain_text("Force −1.2 kN")

    button(page, "Keep this run").click()
    for before, value in (("1200", "1000"), ("1000", "1100")):
        enter(page, "Peak load", value, over=before)
        expect(figures(page)).to_contain_text(f"Force −{int(value) / 1000:g} kN")
    expect(page.get_by_text("cannot be −1")).to_have_count(0)
    assert page.locator(".scene").bounding_box() == place
    legend = "model('pulse').document._all_models"
    holds(
        page,
        f"[...{legend}.values()].some(m => m.label?.value === 'pinned run' && "
        "m.visible)",
    )
    field(page, "Peak load").fill("1050")
    # Pressed before Panel has handed on what was typed.
    button(page, "Keep this run").click()
    expect(figures(page)).to_contain_text("Force −1.05 kN")
    holds(
        page,
        f"![...{legend}.values()].some(m => m.label?.value === 'pinned run' && "
        "m.visible)",
    )


def test_hidden_curves_come_back_and_the_chosen_plot_stays(page: Page) -> None:
    go(page, f"?{ANSWER}")
    expect(figures(page)).to_contain_text("Force −900 N")
    models = "[...model('pulse').document._all_models.values()]"
    hidden = f"{models}.filter(m => m.type === 'GlyphRenderer' && !m.visible).length"
    # The curve and its copy in the legend.
    for count in (2, 0):
        page.get_by_text("closed form", exact=True).first.click()
        holds(page, f"{hidden} === {count}")

    page.get_by_role("tab", name="Loop").click()
    titles = f"{models}.filter(m => m.type === 'Title')"
    holds(page, f"{titles}.some(m => m.text.startsWith('End displacement'))")
    enter(page, "Peak load", "1000", over="900")
    expect(figures(page)).to_contain_text("Force −1 kN")
    expect(page.get_by_role("tab", name="Loop")).to_have_attribute(
        "aria-selected", "true"
    )
    button(page, "Rope").click()
    expect(page.locator(".sentence")).to_contain_text("A strand")
    expect(page.get_by_role("tab", name="Loop")).to_have_attribute(
        "aria-selected", "true"
    )


def test_the_load_path_is_the_time_line_which_one_plays_and_stops(page: Page) -> None:
    go(page, f"?{ANSWER}")
    expect(figures(page)).to_contain_text("Force −900 N")
    drag(page, figure(page, 1), 0.75, 0.26)
    expect(figures(page)).to_contain_text(re.compile(r"Force (8|9)\d\d N"))
    page.mouse.up()
    page.locator(".sentence").click()
    before = figures(page).inner_text()
    page.keyboard.press("ArrowRight")
    expect(figures(page)).not_to_have_text(before)
    button(page, "Play through time").click()
    expect(figures(page)).to_contain_text(re.compile(r"Force −\d"))
    expect(figures(page)).to_contain_text(re.compile(r"Force \d"))
    page.locator(".sentence").click()
    page.keyboard.press("t")
    expect(page.get_by_text("play_circle", exact=True)).to_be_visible()


def test_a_run_is_paused_stepped_and_begun_anew_by_buttons_and_keys(
    page: Page,
) -> None:
    go(page, f"?{ENDLESS}&plots=Zigzag")
    expect(status(page)).to_contain_text(re.compile(r"iteration \d\d"))
    button(page, "Run or pause").click()
    expect(status(page)).to_contain_text("paused")
    button(page, "From the start").click()
    expect(status(page)).to_contain_text("iteration 1 ")
    # A step is a stage.
    button(page, "One stage").click()
    expect(status(page)).to_contain_text("iteration 2 · local stage")
    page.locator(".sentence").click()
    page.keyboard.press("s")
    expect(status(page)).to_contain_text("iteration 2 · ")
    expect(status(page)).not_to_contain_text("local stage")
    page.keyboard.press("s")
    expect(status(page)).to_contain_text("iteration 3 · local stage")
    page.keyboard.press("r")
    expect(status(page)).to_contain_text("iteration 1 ")
    page.keyboard.press(" ")
    expect(status(page)).to_contain_text(re.compile(r"iteration \d\d"))
    expect(status(page)).not_to_contain_text("paused")
    page.keyboard.press(" ")
    expect(status(page)).to_contain_text("paused")
