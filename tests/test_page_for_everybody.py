"""Numbers are typed, keys move the run, a class can read it, and the theme follows the system."""

from __future__ import annotations

import re
from typing import Any

from axe_playwright_python.sync_playwright import Axe
from pages import Visit, card, comes_true, one_page, press, slider, status
from playwright.sync_api import Locator, Page, expect

from app.picture.units import minus, rounded

SERIOUS = ("serious", "critical")
EXCEPTIONS = {
    "aria-progressbar-name": "the page component's own bar, which never moves",
    "aria-prohibited-attr": "its handle for the sidebar, and what its lists say when pointed at",
}
"""Of Panel's components, which take no other attributes."""
MOST_STOPS = 12
"""Of the Tab key, from the first control to the run, for somebody who comes for the first time."""
MOST_FROM_THE_TOP = 19
"""The same from the very top, for who does not take the way that leads there at once."""
AT_REST = """() => {
  const roots = [document]
  for (const root of roots) {
    roots.push(...[...root.querySelectorAll("*")].flatMap((one) => one.shadowRoot ?? []))
  }
  return roots.every((root) => root.getAnimations().every((one) => one.playState !== "running"))
}"""
TEXTS = """() => {
  const found = new Set(), walk = (node) => {
    if (node.shadowRoot) { walk(node.shadowRoot) }
    for (const one of node.childNodes) {
      const isText = one.nodeType === Node.TEXT_NODE
      if (isText && one.parentElement?.checkVisibility()) { found.add(one.textContent.trim()) }
      else if (!["STYLE", "SCRIPT"].includes(one.tagName)) { walk(one) }
    }
  }
  walk(document.body)
  const plots = Bokeh.documents.flatMap((one) => one.roots()).filter(({type}) => type === "Plot")
  for (const {below, left} of plots) {
    for (const {axis_label} of [...below, ...left]) { found.add(axis_label.replace("\\n", " ")) }
  }
  return [...found]
}"""
"""All that is to be read on a page."""
ALIKE = {"Iteration", "Iteration:", "LATIN", "Live", "Block", "Mode n", "Slipfront"}
"""Words of the first view that are the same in English and in German."""
SYMBOLS = re.compile(r"[^A-Za-z]*|t = .*|F, .*|±μp|[a-z]+_[a-z_]+|replay|.*\d (mm|µm|mJ|J|s|N|kN)")
"""What is no word, and the names of the small pictures on buttons."""


def field(page: Page, name: str) -> Locator:
    return page.get_by_role("textbox", name=re.compile(rf"^{name}\b"))


def violations(page: Page) -> list[Any]:
    """Give what of a page is not accessible, and where."""
    # Colours that fade into those of another theme have less contrast on their way.
    comes_true(page, AT_REST)
    return [
        (one["id"], [node["html"] for node in one["nodes"]])
        for one in Axe().run(page, options={"resultTypes": ["violations"]}).response["violations"]
        if one["impact"] in SERIOUS and one["id"] not in EXCEPTIONS
    ]


QUERY = "?elements=20&substructures=2&instants=11&finish=at+once"
page = one_page(QUERY, "✓ converged")
"""A page whose run has ended, which every test leaves as it found it."""


def test_whoever_has_no_mouse_is_soon_at_the_run_and_is_told_what_plots_show(
    page: Page,
) -> None:
    # First of all tests: the focus begins at the top of a page that is new.
    page.keyboard.press("Tab")
    expect(page.get_by_role("link", name="Go to the run")).to_be_focused()
    page.keyboard.press("Enter")
    run = page.get_by_role("button", name="Replay the run")
    expect(run).to_be_focused()
    page.get_by_role("radio", name="Clamped bar").focus()
    stops = 1
    while not run.evaluate("(one) => one.matches(':focus')"):
        page.keyboard.press("Tab")
        stops += 1
        assert stops <= MOST_STOPS + 1
    instant = page.get_by_role("slider", name="Instant", exact=True)
    expect(instant).to_have_attribute("aria-valuetext", re.compile(r"^t = [0-9.]+ s$"))
    before = instant.get_attribute("aria-valuetext")
    assert before
    page.get_by_role("link", name="Go to the run").focus()
    stops = 0
    while not run.evaluate("(one) => one.matches(':focus')"):
        page.keyboard.press("Tab")
        stops += 1
        assert stops <= MOST_FROM_THE_TOP
    expect(page.get_by_role("link", name="Slipfront")).to_have_count(1)
    expect(page.locator("a:has(img.logo)")).to_have_attribute("aria-hidden", "true")
    live = page.get_by_role("button", name="Live", exact=True)
    live.focus()
    live.press("ArrowRight")
    expect(page.get_by_role("button", name="What if")).to_be_focused()
    header = page.get_by_role("toolbar", name="Page")
    header.get_by_role("button", name="Share").focus()
    page.keyboard.press("ArrowRight")  # nothing is there to be undone or done again
    expect(header.get_by_role("button", name="Runs")).to_be_focused()
    page.keyboard.press("ArrowLeft")
    expect(header.get_by_role("button", name="Share")).to_be_focused()
    page.keyboard.press("Shift+Tab")
    expect(page.get_by_role("button", name="What if")).to_be_focused()
    expect(instant).to_have_attribute("aria-valuetext", before)
    said = page.get_by_role("figure", name="Stick and slip").get_attribute("aria-description")
    assert said is not None
    assert re.search(rf"stick \d+ %.* {re.escape(before)}, iteration \d+$", said), said


def test_a_number_is_typed_refused_in_words_and_brought_back_by_a_double_click(
    page: Page,
) -> None:
    typed, elements = field(page, "Substructures"), slider(page, "Elements")
    expect(elements).to_be_hidden()
    slider(page, "Substructures").press("4")
    expect(typed).to_be_focused()
    typed.press("Enter")
    expect(status(page)).to_contain_text("4 substructures")
    typed.fill("many")
    typed.press("Enter")
    expect(page.get_by_text("Substructures cannot be “many”").first).to_be_visible()
    expect(typed).to_have_value("4")
    typed.fill("30")
    typed.press("Enter")
    # What is said to be in the way is in sight.
    expect(elements).to_be_visible()
    typed.fill("5")
    typed.press("Enter")
    expect(page.get_by_text("Substructures cannot be")).to_have_count(0, timeout=6000)
    factor = field(page, "Factor on k")
    factor.fill("2e-3")
    factor.press("Enter")
    expect(slider(page, "Factor on k")).to_have_attribute("aria-valuenow", "0.002")
    slider(page, "Factor on k").dblclick()
    expect(factor).to_have_value("1")
    slider(page, "Substructures").press("Delete")
    expect(typed).to_have_value("10")
    for key, value in (("Control+z", "5"), ("Control+Shift+Z", "10"), ("Control+y", "10")):
        page.keyboard.press(key)
        expect(typed).to_have_value(value)
    expect(page.get_by_role("button", name="Redo")).to_be_disabled()
    press(page, "Undo")
    expect(typed).to_have_value("5")
    press(page, "Redo")
    expect(typed).to_have_value("10")


def test_keys_are_listed_step_through_time_and_play_it_to_its_end(page: Page) -> None:
    instant = page.locator("label", has_text=re.compile("^Instant:"))
    slider(page, "Instant").press("Home")
    expect(instant).to_contain_text("t = 0 s")
    # A picture of where it stood before comes late: the next key goes on from where it stands.
    page.keyboard.press("ArrowRight")
    page.evaluate("Bokeh.documents[0].get_model_by_name('instant').setv({shown: 7})")
    page.keyboard.press("ArrowRight")
    expect(instant).to_contain_text("t = 0.2 s")
    slider(page, "Instant").press("Home")
    body = page.locator("body")
    body.press("?")
    expect(page.get_by_text("presenter view, for a projector")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.get_by_text("presenter view, for a projector")).to_be_hidden()
    body.press("ArrowRight")
    expect(instant).to_contain_text("t = 0.1 s")
    body.press("ArrowLeft")
    expect(instant).to_contain_text("t = 0 s")
    slider(page, "Instant").press("End")
    expect(instant).to_contain_text("t = 1 s")
    for before in ("0.9", "0.8"):
        body.press("ArrowLeft")
        expect(instant).to_contain_text(f"t = {before} s")
    body.press("t")
    expect(instant).to_contain_text("t = 1 s")


def test_a_projector_has_one_row_without_controls_and_its_address_leads_back(
    page: Page,
) -> None:
    page.locator("body").press("p")
    expect(page.locator(".card")).to_have_count(3)
    expect(page.get_by_role("button", name="Study", exact=True)).to_be_hidden()
    expect(slider(page, "Substructures")).not_to_be_in_viewport()
    expect(status(page)).to_be_visible()
    expect(page).to_have_url(re.compile("view=present"))
    expect(page.locator(".card").first).to_be_in_viewport(ratio=1)
    comes_true(
        page,
        """() => [...Bokeh.index.roots].flatMap((one) => one.renderer_views ? [one] : []).some(
          (one) => [...one.renderer_views.values()].some(
            (axis) => parseInt(axis.visuals?.axis_label_text?.get_text_font_size()) >= 20))""",
    )
    page.reload()
    expect(status(page)).to_contain_text("✓ converged")
    expect(page.locator(".card")).to_have_count(3)
    # Plots that have shrunk, as the words above them came, are laid out anew.
    comes_true(
        page,
        """() => Bokeh.documents.flatMap((one) => one.roots()).filter((one) => one.type === "Plot")
          .map((one) => Bokeh.index.find_one_by_id(one.id)).filter((one) => one?.layout)
          .every((one) => one.layout.bbox.height === one.bbox.height)""",
    )
    page.locator("body").press("p")
    expect(page.get_by_role("button", name="Study", exact=True)).to_be_visible()


def test_a_frame_of_a_course_page_has_plots_alone(open_page: Visit) -> None:
    page = open_page("?view=embed&plots=Scene,Convergence,Load path", width=800, height=500)
    expect(page.get_by_role("figure", name="Load path")).to_be_visible()
    cards = page.locator(".card")
    expect(cards).to_have_count(3)
    expect(status(page)).to_be_hidden()
    expect(page.get_by_role("button", name="Run or pause")).to_be_hidden()
    for one in cards.all():
        expect(one).to_be_in_viewport(ratio=1)
        assert one.evaluate("(card) => card.clientHeight") > 120
    page.set_viewport_size({"width": 390, "height": 600})
    expect(page.get_by_role("button", name="Controls")).to_be_hidden()
    expect(page.get_by_role("button", name="Study", exact=True)).to_be_hidden()
    expect(page.get_by_role("heading", name="Slipfront")).to_be_hidden()


def test_the_page_follows_the_systems_theme_is_accessible_in_it_and_remembers_a_choice(
    page: Page,
) -> None:
    expect(page.locator(".card").nth(3)).to_be_attached()
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        expect(page.locator(f".mui-{scheme}").first).to_be_visible()
        expect(page).to_have_url(re.compile("^(?!.*theme=)"))
        assert violations(page) == []
    expect(page.get_by_role("figure", name="Friction force")).to_have_accessible_description(
        re.compile(r"LATIN from .* reference from .* bar, t = [0-9.]+ s, iteration \d+")
    )
    page.get_by_role("button", name="Toggle theme").click()
    expect(page.locator(".mui-dark").first).to_be_visible()
    expect(page).to_have_url(re.compile("theme=dark"))
    page.reload()
    expect(page.locator(".mui-dark").first).to_be_visible()
    page.emulate_media(color_scheme="dark")
    page.get_by_role("button", name="Toggle theme").click()
    page.get_by_role("button", name="Toggle theme").click()
    expect(page).to_have_url(re.compile("^(?!.*theme=)"))


def test_the_value_under_a_pointer_that_rests_is_that_of_the_plot_that_came_there(
    page: Page,
) -> None:
    page.set_viewport_size({"width": 1280, "height": 520})
    value = page.locator("output").filter(has_text="N/m")
    # The plot's view is not there yet, as where a plot is laid out late.
    page.evaluate("""() => {
      const find = Bokeh.index.find_one_by_id
      Bokeh.index.find_one_by_id = () => null
      setTimeout(() => { Bokeh.index.find_one_by_id = find }, 300)
    }""")
    box = card(page, "Friction force").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    expect(value).to_be_visible()
    for _ in range(10):
        page.mouse.wheel(0.0, 60.0)
    expect(value).to_have_count(0)
    page.set_viewport_size({"width": 1280, "height": 720})


def test_numbers_beside_an_axis_are_written_as_those_in_words(page: Page) -> None:
    numbers = [4e8, -5e-5, 2.34e-12, 210_000.0, -1000.0, 0.25, 0.0]
    along = """(numbers) => Bokeh.index.roots.flatMap(({model}) => model.left ?? [])
      .filter(({axis_label}) => /^(Force|Load)\\s/.test(axis_label))
      .map(({formatter}) => formatter.doFormat(numbers, {loc: 0}))"""
    assert page.evaluate(along, numbers) == 2 * [[minus(rounded(one, 6)) for one in numbers]]


def test_keys_move_the_run_only_where_it_is_seen(page: Page) -> None:
    figures, instant = page.locator(".figures"), slider(page, "Instant")
    expect(figures).to_contain_text("this run")
    seen = figures.text_content() or ""
    press(page, "Stability")
    expect(page.get_by_text("Stiff and extreme cases of every scene")).to_be_visible()
    page.locator("body").press("r")
    press(page, "Live")
    # What is heard is heard in turn.
    before = instant.input_value()
    instant.press("ArrowLeft")
    expect(instant).not_to_have_value(before)
    assert figures.text_content() == seen
    page.locator("body").press("r")
    expect(figures).not_to_have_text(seen)


def words(page: Page) -> set[str]:
    """Give the words that are to be read on a page."""
    found: list[str] = page.evaluate(TEXTS)
    return {one for one in found if not SYMBOLS.fullmatch(one)}


def test_a_visitor_who_wants_german_reads_no_english_beside_one_who_does(
    page: Page, open_page: Visit
) -> None:
    german = open_page(f"{QUERY}&lang=de")
    expect(status(german)).to_contain_text("✓ gelöst")
    expect(german.locator(".card .title", has_text="Singulärwerte")).to_be_visible()
    assert german.evaluate("document.documentElement.lang") == "de"
    expect(german).to_have_url(re.compile("lang=de"))
    english = words(page)
    assert {"Scene", "Load path", "Time t (s)", "reference"} <= english
    assert words(german) & english <= ALIKE
