"""Plots, figures and lessons fit a projector's window."""

import time

import pytest
from pages import at_rest, comes_true, press, status
from playwright.sync_api import expect
from processes import PATIENCE

from app.lessons.lesson import LESSONS
from solver.scenes import CATALOGUE

NOTHING_SCROLLS = """() => {
  const found = [], look = (root) => root.querySelectorAll("*").forEach((one) => {
    const {overflowX, overflowY} = getComputedStyle(one), scrolls = (how) => /auto|scroll/.test(how)
    const away = one.closest(".sidebar") || one.classList.contains("points")
    if (!away && scrolls(overflowY) && one.scrollHeight > one.clientHeight + 1 ||
        !away && scrolls(overflowX) && one.scrollWidth > one.clientWidth + 1) {
      found.push(String(one.className || one.tagName))
    }
    if (one.shadowRoot && !away) { look(one.shadowRoot) }
  })
  look(document)
  return found.length === 0
}"""
"""Whether the window shows the whole of all that it shows, except of the sidebar."""

COLLIDES = """() => {
  const marks = "button, output, label > span, td, th, .key, .title b, input, select, .status > div"
  const found = [], atoms = []
  const name = (one) => (one.ariaLabel || one.textContent || one.tagName).trim().slice(0, 40)
  const look = (root, above) => root.querySelectorAll("*").forEach((one) => {
    if (one.closest(".sidebar, dialog, .MuiInputBase-root") || !one.checkVisibility()) { return }
    const box = one.getBoundingClientRect()
    if (one.matches(marks) && box.width && box.height) { atoms.push([one, box, above]) }
    if (one.shadowRoot) { look(one.shadowRoot, [...above, one]) }
  })
  look(document, [])
  const apart = (a, b) =>
    Math.min(a.right, b.right) - Math.max(a.left, b.left) < 2 ||
    Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) < 3
  // Of what scrolls one can see the rest, of what hides it never.
  const cut = (one, {bottom}) => {
    for (let up = one; up; up = up.parentElement ?? up.getRootNode().host) {
      const {overflowY} = getComputedStyle(up)
      if (/auto|scroll/.test(overflowY)) { return false }
      if (overflowY === "hidden" && bottom > up.getBoundingClientRect().bottom + 3) { return true }
    }
    return false
  }
  atoms.forEach(([one, box, above], place) => {
    for (const [other, its, over] of atoms.slice(place + 1)) {
      const nested = one.contains(other) || over.includes(one) || above.includes(other)
      if (!nested && !apart(box, its)) { found.push(`${name(one)} lies over ${name(other)}`) }
    }
    if (cut(one, box)) { found.push(`${name(one)} is cut`) }
    const swiped = above.some((host) => host.classList.contains("plots"))
    if (!swiped && box.right > innerWidth + 1) { found.push(`${name(one)} is beyond the window`) }
  })
  return found
}"""
"""What of words and controls lies over another, is cut, or lies beyond the window."""
CUT = """() => {
  const found = [], pen = document.createElement("canvas").getContext("2d")
  const plots = Bokeh.index.roots.filter(({model}) => model.type === "Plot")
  for (const {model, axis_views, el, canvas_view: {bbox: room}} of plots) {
    if (!el.checkVisibility()) { continue }
    for (const {model: axis, visuals, bbox} of axis_views) {
      pen.font = visuals.axis_label_text.font_value()
      const lines = axis.axis_label.split("\\n").map((line) => pen.measureText(line).width)
      const [middle, end] = model.left.includes(axis)
        ? [bbox.vcenter, room.height] : [bbox.hcenter, room.width]
      const half = Math.max(...lines) / 2
      if (middle < half + 1 || middle + half + 1 > end) { found.push(`${axis.axis_label} is cut`) }
    }
  }
  return found
}"""
"""Titles of axes that are longer than their plot has room for."""
SIZES = (1240, 900), (1280, 720), (1000, 700), (720, 450)


def nothing_collides(page):
    """Wait until all words and controls have come to rest in places of their own."""
    end = time.monotonic() + PATIENCE
    while found := at_rest(page, f"[...({COLLIDES})(), ...({CUT})()]"):
        assert time.monotonic() < end, found


def nothing_collides_at_any_size(page):
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        nothing_collides(page)


def all_are_seen(page, count):
    cards = page.locator(".card")
    expect(cards).to_have_count(count)
    for card in cards.all():
        expect(card).to_be_in_viewport(ratio=1)


FILLED = """() => {
  const named = (one) => one.get_model_by_name("scene.bodies")
  const source = Bokeh.documents.map(named).find((one) => one)
  const {xs} = source?.data ?? {}
  if (!xs?.length) { return 0 }
  const [figure] = source.document.roots(), view = Bokeh.index.find_one_by_id(figure.id)
  const places = xs.flatMap((one) => [...one].map((x) => view.frame.x_scale.compute(x)))
  return (Math.max(...places) - Math.min(...places)) / view.el.clientWidth
}"""
"""How much of the width of its card the bodies of the scene have."""


def test_six_plots_are_in_the_first_view_under_all_buttons_and_words(open_page):
    query = "?scene=layers&method=paper&layers=2&elements=16&max_iterations=3&plots="
    rarer = "Deformed bodies,Contact tractions,Stick and slip,Load path,Convergence,Singular values"
    page = open_page(query + rarer, 1280, 720)
    expect(status(page)).to_contain_text("after 3 iterations")
    expect(page.get_by_role("slider", name="Magnification")).to_be_visible()
    all_are_seen(page, 6)
    # What chooses how bodies are drawn stands in a line that there is anyway.
    slider, said = page.get_by_role("slider", name="Magnification"), status(page)
    assert 0.0 < slider.bounding_box()["y"] - said.bounding_box()["y"] < 28.0
    # With the picture there is a band above them.
    press(page, "Scene")
    expect(page.locator(".long .card").first).to_have_accessible_name("Scene")
    all_are_seen(page, 6)
    comes_true(page, f"() => ({FILLED})() > 0.75")
    nothing_collides_at_any_size(page)
    expect(page.locator(".card").first).to_be_in_viewport(ratio=1)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_plots_of_two_runs_are_in_the_first_view(open_page, scene):
    page = open_page(f'?scene={scene}&compare={{"k_scale":3}}&finish=at-once', 1280, 720)
    expect(page.locator(".figures .thing")).to_have_count(2)
    for card in page.locator(".card").all():
        expect(card).to_be_in_viewport(ratio=1)


def top_of_plots(page):
    return page.locator(".card").first.bounding_box()["y"]


def test_nothing_pushes_plots_but_figures_that_are_asked_for_or_of_two_runs(open_page):
    page = open_page("?elements=20&substructures=2&instants=11", 1280, 720)
    figures, method = page.locator(".figures"), page.get_by_role("button", name="Method")
    expect(page.locator(".card").first).to_be_visible()
    first = top_of_plots(page)
    expect(status(page)).to_contain_text("certified")
    expect(figures).to_contain_text("End displacement")
    status(page).get_by_text("details").focus()
    expect(status(page).get_by_text("substructures")).to_be_visible()
    assert top_of_plots(page) == first
    comes_true(page, f"() => ({FILLED})() > 0.75")
    press(page, "Method")
    expect(figures.get_by_text("Iterations to 1 %")).to_be_visible()
    assert top_of_plots(page) > first
    page.reload()
    expect(figures.get_by_text("Iterations to 1 %")).to_be_visible()
    method.click()
    expect(figures.get_by_text("Iterations to 1 %")).to_be_hidden()
    page.goto(f'{page.url}&compare={{"multiscale":false}}')
    expect(figures.locator("tbody tr")).to_have_count(3)
    # A low window has them for the asking, a higher one anyway.
    expect(figures.get_by_text("Iterations to 1 %")).to_be_hidden()
    page.set_viewport_size({"width": 1280, "height": 900})
    expect(figures.get_by_text("Iterations to 1 %")).to_be_visible()
    assert figures.bounding_box()["x"] + figures.bounding_box()["width"] <= 1280
    nothing_collides_at_any_size(page)
    page.set_viewport_size({"width": 1280, "height": 720})
    page.locator("body").press("p")
    leave = "Leave the presenter's view (p)."
    expect(page.get_by_role("button", name=leave)).to_be_visible()
    nothing_collides(page)
    press(page, leave)
    expect(figures).to_be_visible()


def size_of_type(region):
    sizes = "(found) => found.map((one) => parseFloat(getComputedStyle(one).fontSize))"
    return min(region.locator("p:visible").evaluate_all(sizes))


def test_all_that_a_lesson_names_is_seen_without_scrolling_and_it_leads_to_the_next(open_page):
    first, *_, last = LESSONS.values()
    page = open_page(f"?lesson={first.name}", 1280, 720)
    region = page.get_by_role("region", name="Lesson")
    leave = page.get_by_role("button", name="Explore freely")
    following = page.get_by_role("button", name="Next: ")
    parts = page.get_by_role("navigation", name="Parts of the lesson")

    def all_is_on_the_page(lesson):
        expect(parts).to_be_hidden()
        all_are_seen(page, len(lesson.views))
        expect(region.locator(".control:visible")).to_have_count(len(lesson.controls))

    def all_comes_in_front_of_a_class(lesson):
        expect(parts).to_be_visible()
        all_are_seen(page, len(lesson.views))
        while not leave.is_visible():
            comes_true(page, NOTHING_SCROLLS)
            assert size_of_type(region) >= 24
            page.keyboard.press("PageDown")

    def all_fits():
        expect(leave).to_be_in_viewport(ratio=1)
        comes_true(page, NOTHING_SCROLLS)
        nothing_collides(page)

    views = [all_is_on_the_page, all_comes_in_front_of_a_class]
    for lesson in LESSONS.values():
        expect(region).to_contain_text(lesson.question)
        comes_true(page, NOTHING_SCROLLS)
        wrong = [choice for place, choice in enumerate(lesson.choices) if place != lesson.right]
        press(page, max(wrong, key=len))
        views[0](lesson)
        all_fits()
        page.locator("body").press("p")
        # The next lesson begins in the view that this one ends in.
        views.reverse()
        views[0](lesson)
        all_fits()
        if lesson is not last:
            following.press("Enter")
    expect(following).to_have_count(0)
