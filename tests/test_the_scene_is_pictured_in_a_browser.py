"""The picture of the scene and the load path on a page: alive, and ways to choose."""

from __future__ import annotations

from pages import (
    Visit,
    at_rest,
    bodies_drawn,
    card,
    comes_true,
    one_page,
    open_report,
    press,
    status,
)
from playwright.sync_api import Page, expect
from processes import PATIENCE, wait_for

from app.picture.units import measured

MODEL = """const model = (name) =>
  Bokeh.documents.map((one) => one.get_model_by_name(name)).find((one) => one)"""


page = one_page("?elements=20&substructures=4&instants=21&finish=at+once", "✓ converged")
"""A page with a bar whose run has ended; the last test pulls it by another load."""


def place(page: Page, name: str, share: float) -> tuple[float, float]:
    """Give a place on a plot's frame, at a share of its width and half of its height."""
    found = card(page, name).locator(".bk-Figure, .bk-Plot, canvas").first.bounding_box()
    assert found is not None
    return found["x"] + share * found["width"], found["y"] + 0.5 * found["height"]


def load_arrow(page: Page) -> list[float]:
    """Give the tail and the head of the handle of the peak load, on the screen."""
    comes_true(
        page,
        f"() => {{{MODEL}; return model('scene.handles.drawn')?.data.setting.includes('peak')}}",
    )
    found: list[float] = page.evaluate(
        f"() => {{{MODEL}"
        """
          const source = model("scene.handles.drawn"), {xs, ys, setting} = source.data
          const [figure] = source.document.roots()
          const view = Bokeh.index.find_one_by_id(figure.id)
          const {left, top} = view.canvas_view.el.getBoundingClientRect()
          const {x_scale, y_scale} = view.frame, own = setting.indexOf("peak")
          return [0, 1].flatMap((end) =>
            [left + x_scale.compute(xs[own][end]), top + y_scale.compute(ys[own][end])])
        }"""
    )
    return found


MIDDLE = (
    f"() => {{{MODEL}"
    """
      const bodies = model("scene.bodies"), {xs, ys, value} = bodies.data
      const [figure] = bodies.document.roots()
      const view = Bokeh.index.find_one_by_id(figure.id)
      const {x, y} = view.el.getBoundingClientRect()
      const at = [...value].findIndex((part) => part === 1)
      const middle = (ends) => ends.reduce((a, b) => a + b) / ends.length
      const {x_scale, y_scale} = view.frame
      return [
        x + x_scale.compute(middle([...xs[at]])), y + y_scale.compute(middle([...ys[at]]))]
    }"""
)
"""Of the first element of the second substructure, on the screen."""


def test_a_tap_on_the_bar_marks_its_place_in_the_plots_and_another_takes_it_away(
    page: Page,
) -> None:
    lines = f"{MODEL}; return model('friction-force.curves').data.xs.map((xs) => xs[0])"
    shown = f"() => {{{lines}.some((x) => Math.abs(x - 0.275) < 1e-6)}}"
    assert not page.evaluate(shown)
    # Arrows of the pressure end there: who does not drag them taps on the bar.
    page.mouse.click(*at_rest(page, MIDDLE))
    comes_true(page, shown)
    # Two taps that follow at once would be a double one.
    page.wait_for_timeout(400)
    page.mouse.click(*at_rest(page, MIDDLE))
    comes_true(page, f"() => !({shown})()")


def test_an_instant_is_chosen_on_the_load_path_and_the_picture_follows(page: Page) -> None:
    expect(page.get_by_text("Load path").last).to_be_visible()
    words = f"{MODEL}; return model('scene.words').data.text.join()"
    comes_true(page, f"() => {{{words}.includes('F = −900 N')}}")
    page.mouse.click(*place(page, "Load path", 0.4))
    comes_true(page, f"() => {{{words}.match(/F = \\d/)}}")
    expect(page.get_by_text("Instant").first).not_to_contain_text("0.75")


def test_the_load_arrow_is_dragged_and_the_run_follows(page: Page) -> None:
    page.get_by_role("slider", name="Instant", exact=True).fill("15")
    words = f"{MODEL}; return model('scene.words').data.text.join()"
    comes_true(page, f"() => {{{words}.includes('F = −900 N')}}")
    tail, height, head, _ = load_arrow(page)
    assert head < tail
    middle = 0.5 * (tail + head)
    label = page.locator(".gripped")
    expect(label).to_be_hidden()
    page.mouse.move(middle + 3, height)
    page.mouse.move(middle, height)
    expect(label).to_have_text("Peak load: 900 N")
    page.mouse.down()
    peak = page.get_by_role("slider", name="Peak load")
    # A hand that is held still is taken for one that has let go.
    for step in range(round(PATIENCE / 0.05)):
        page.mouse.move(middle - 20 - 10 * (step % 3), height)
        page.wait_for_timeout(50)
        if page.get_by_text("follows the slider").is_visible():
            break
    else:
        raise AssertionError("no run followed the hand")
    expect(peak).not_to_have_value("900")
    page.mouse.up()
    expect(label).to_be_hidden()
    expect(status(page)).to_contain_text("✓ converged")

    def is_drawn() -> bool:
        """Tell whether the run is of what the slider shows, which may still be on its way."""
        value = float(peak.input_value())
        told = f"F = −{measured(value, 'N')}"
        return value > 950.0 and bool(page.evaluate(f"() => {{{words}.includes('{told}')}}"))

    wait_for(is_drawn)


def test_a_narrow_window_sees_the_run_first_with_all_tabs_and_no_word_is_cut_before_a_class(
    open_page: Visit,
) -> None:
    page = open_page(
        "?scene=block&method=paper&max_iterations=5&plots=Scene,Deformed+bodies",
        width=390,
        height=844,
    )
    bodies_drawn(page, "> 1000")
    expect(page.get_by_text("Deformed bodies").first).to_be_visible()
    expect(page.get_by_text("Friction coefficient").first).not_to_be_visible()
    open_report(page, "Stability")
    box = page.get_by_role("button", name="Study", exact=True).bounding_box()
    assert box is not None
    assert 0.0 <= box["x"] <= 390.0 - box["width"]
    press(page, "Live")
    # Keys are heard where the run is seen.
    expect(status(page)).to_be_visible()
    page.set_viewport_size({"width": 1280, "height": 720})
    page.locator("body").press("p")
    comes_true(
        page,
        f"() => {{{MODEL}"
        """
          const words = model("scene.words.drawn"), [figure] = words.document.roots()
          const view = Bokeh.index.find_one_by_id(figure.id), {y, up} = words.data
          const {glyph} = figure.renderers.find(({glyph}) => glyph.type === "Text")
          const size = parseInt(glyph.text_font_size.value), {y_scale} = view.frame
          const above = {bottom: 1, middle: 0.5, top: 0}
          return size >= 20 && y.length
            && [...y].every((at, i) => y_scale.compute(at) >= above[up[i]] * 1.25 * size)
        }""",
    )


def test_a_page_opens_in_motion_until_it_is_touched(open_page: Visit) -> None:
    page = open_page(
        "?elements=20&substructures=4&instants=21&plots=Scene", reduced_motion="no-preference"
    )
    instant = page.get_by_role("slider", name="Instant", exact=True)
    expect(instant).to_have_value("15")
    expect(instant).not_to_have_value("15")
    page.keyboard.press("Shift")
    expect(instant).to_have_value("15")
    expect(page.get_by_role("button", name="Play through time")).to_be_visible()


DRAWN = """() => Bokeh.documents.flatMap(({_all_models}) => [..._all_models.values()])
  .filter(({name}) => /\\.(bodies|curves|contacts|image|patches)$/.test(name ?? ""))
  .map(({name, data, line_alpha}) => `${name} ${JSON.stringify(data ?? line_alpha)}`).sort()"""


def test_pictures_bit_by_bit_come_to_what_is_drawn_afresh(open_page: Visit) -> None:
    page = open_page(
        "?scene=rope&layers=1&elements=10&instants=21&finish=at+once&instant=0.4"
        "&plots=Scene,Cross-section,Friction+force,All+wires"
    )
    expect(status(page)).to_contain_text("solved")
    instant = page.get_by_role("slider", name="Instant", exact=True)
    for key in ("ArrowRight", "ArrowRight", "ArrowRight", "ArrowLeft"):
        drawn = page.evaluate(DRAWN)
        instant.press(key)
        comes_true(page, f"(drawn) => String(({DRAWN})()) !== String(drawn)", drawn)
    drawn = at_rest(page, DRAWN)
    names = {one.split()[0] for one in drawn}
    assert names >= {"scene.bodies", "scene.contacts", "scene.patches", "all-wires.image"}
    comes_true(page, "() => location.search.includes('instant=0.5')")
    page.reload()
    expect(status(page)).to_contain_text("solved")
    comes_true(page, f"(drawn) => String(({DRAWN})()) === String(drawn)", drawn)
