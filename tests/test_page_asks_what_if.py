"""In a browser: the bathtub in few clicks, a point's run, an end, a link, and two pages at once."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from browser import Chrome, Server
from pages import ENDLESS, Visit, card, comes_true, open_sheets, press, slider, status, visits
from playwright.sync_api import Locator, Page, expect
from test_page_for_everybody import violations

TINY = "?elements=20&substructures=2&instants=11&plots=Scene&finish=at+once"
CURVE = f"{TINY}&tab=What+if&vary=peak=300:1500:5&of=peak_displacement"
MAP = f"{TINY}&tab=what+if&vary=friction=0.1:0.7:7&vary=peak=300:1500:7&of=peak_displacement"
SLOW = f"{ENDLESS}&elements=400&instants=401&plots=Scene"
TOLD = re.compile(r"40 elements, .*Refine \w+ first|Neither more elements")
ENDED = re.compile(r"(\d+) of \1 runs: ")


def chart(page: Page) -> Locator:
    return page.get_by_role("application")


SOURCE = """(kind) => Bokeh.documents.flatMap(({_all_models}) => [..._all_models.values()])
  .filter(({name}) => name === kind).at(-1)?.data ?? {}"""
"""The newest of a kind: a figure that is replaced is there a moment longer."""


def has(page: Page, kind: str, number: str) -> None:
    """Wait until so much stands in the chart of a kind: answers, hollow ones, ghosts, contours."""
    comes_true(
        page,
        f"""(kind) => {{
          const data = ({SOURCE})(kind), count = (data.number ?? data.xs ?? []).length
          return count {number}
        }}""",
        arg=kind,
    )


def place(page: Page, x: float, y: float) -> tuple[float, float]:
    """Give where something stands on the page, by the numbers of the axes."""
    expect(chart(page)).to_be_visible()
    found: list[float] = chart(page).evaluate(
        """(element, [x, y]) => {
          const [view] = [...Bokeh.index.query(({el}) => el === element)]
          const {left, top} = element.getBoundingClientRect(), {x_scale, y_scale} = view.frame
          return [left + x_scale.compute(x), top + y_scale.compute(y)]
        }""",
        [x, y],
    )
    return found[0], found[1]


def first_answer(page: Page) -> tuple[float, float]:
    """Give where the run of the lowest number stands on the page."""
    x, y = page.evaluate(
        f"""() => {{
          const {{number, x, y}} = ({SOURCE})("answer"), all = Array.from(number)
          const first = all.indexOf(Math.min(...all))
          return [x[first], y[first]]
        }}"""
    )
    return place(page, x, y)


@pytest.fixture(scope="module")
def curve(server: Server, chrome: Chrome) -> Iterator[Page]:
    """Give a page with a curve of five answers."""
    with visits(server, chrome) as visit:
        opened = visit(CURVE)
        has(opened, "answer", "=== 5")
        yield opened


@pytest.fixture(scope="module")
def mapped(server: Server, chrome: Chrome) -> Iterator[Page]:
    """Give a page with a map that is whole."""
    with visits(server, chrome) as visit:
        opened = visit(MAP)
        expect(opened.get_by_text(ENDED).first).to_be_visible()
        has(opened, "answer", "=== 49")
        yield opened


def test_values_of_k_that_one_tries_grow_into_a_bathtub_that_leads_to_what_if(
    open_page: Visit,
) -> None:
    query = "?elements=20&substructures=2&instants=11&plots=Convergence&pace=fastest"
    page = open_page(query, 1280, 720)
    earlier = card(page, "Convergence").locator(".key", has_text="k × ")
    corner = page.get_by_role("button", name=re.compile("^Iterations to 1 %"))
    expect(status(page)).to_contain_text("certified")
    for count in (1, 2):
        expect(corner).to_be_hidden()
        slider(page, "Factor on k").press("ArrowRight")
        # What stands in the status comes with the first picture of the new run.
        expect(earlier).to_have_count(count)
        expect(status(page)).to_contain_text("certified")
    corner.click()
    over = page.get_by_role("combobox", name=re.compile("setting")).first
    expect(over).to_have_value("k_scale")
    expect(page.get_by_role("button", name="Start")).to_be_visible()
    expect(chart(page)).to_have_count(0)


def test_a_stranger_has_the_bathtub_in_two_clicks_and_a_third_opens_one_of_its_runs(
    open_page: Visit,
) -> None:
    page = open_page(TINY)
    expect(status(page)).to_contain_text("iteration")
    press(page, "What if")
    press(page, "The bathtub")
    expect(page.get_by_text(ENDED).first).to_be_visible()
    has(page, "answer", "=== 26")
    expect(page.get_by_text("Acceleration anderson")).to_be_visible()
    page.mouse.click(*first_answer(page))
    expect(status(page)).to_contain_text("iteration")
    expect(page.get_by_role("textbox", name=re.compile("^Factor on k"))).to_have_value("0.01")
    expect(page).to_have_url(re.compile("k_scale=0.01&"))


def test_a_link_comes_back_to_a_map_whose_points_say_what_they_are_and_keys_open_them(
    mapped: Page,
) -> None:
    page = mapped
    has(page, "contour", "> 2")
    page.mouse.move(*place(page, 0.4, 0.9))
    expect(page.get_by_text("Friction coefficient μ 0.4, Peak load 900 N: ")).to_be_visible()
    chart(page).focus()
    page.keyboard.press("ArrowRight")
    expect(chart(page).get_by_text("Friction coefficient μ 0.1, Peak load 300 N: ")).to_be_visible()
    page.keyboard.press("ArrowUp")
    expect(chart(page).get_by_text("Friction coefficient μ 0.1, Peak load 500 N: ")).to_be_visible()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    expect(page.get_by_role("textbox", name=re.compile("^Friction coeff"))).to_have_value("0.2")
    press(page, "What if")
    with page.expect_download() as caught:
        press(page, "Table (CSV)")
    text = caught.value.path().read_text()
    assert text.count(",converged,") == 49
    with page.expect_download() as caught:
        press(page, "Chart (SVG)")
    words = caught.value.path().read_text()
    assert words.startswith("<svg")
    assert re.search(">Largest displacement [(](mm|µm)[)]<", words)
    assert ">Friction coefficient μ<" in words


def test_a_chart_leaves_a_ghost_of_that_before_and_fills_beside_one_of_another_page(
    curve: Page, open_page: Visit
) -> None:
    slow = open_page(
        f"?{SLOW}&tab=What+if&vary=max_iterations=1,2,3,4,5,90000,91000,92000&of=peak_displacement"
    )
    has(slow, "hollow", "> 0")
    open_sheets(curve)
    field = curve.get_by_role("textbox", name=re.compile("^Pressure"))
    before = float(field.input_value())
    field.fill(f"{before / 2.0:g}")
    field.press("Enter")
    expect(curve.get_by_text("have changed since")).to_be_visible()
    press(curve, "Start")
    has(curve, "ghost", "=== 1")
    has(curve, "answer", "=== 5")
    expect(curve.get_by_text("the chart before")).to_be_visible()
    press(slow, "Cancel")
    expect(slow.get_by_text(re.compile(r"Cancelled\. \d of 8 runs: ")).first).to_be_visible()
    expect(slow.get_by_role("button", name="Cancel", exact=True)).to_be_hidden()


def test_a_foolish_range_is_refused(curve: Page) -> None:
    upper = curve.get_by_role("textbox", name="Over: to")
    before = upper.input_value()
    upper.fill("1e99")
    upper.press("Enter")
    expect(curve.get_by_text("Peak load cannot be 1·10⁹⁹ N")).to_be_visible()
    expect(curve.get_by_role("button", name="Start", exact=True)).to_be_disabled()
    upper.fill("1200")
    upper.press("Enter")
    expect(curve.get_by_text("Peak load cannot be")).to_be_hidden()
    expect(curve).to_have_url(re.compile("vary=peak%3D300%3A1200%3A5"))
    upper.fill(before)
    upper.press("Enter")
    expect(curve).to_have_url(re.compile("vary=peak%3D300%3A1500%3A5"))


def test_three_meshes_say_whether_one_is_fine_enough(curve: Page) -> None:
    button = curve.get_by_role("button", name="Is the mesh fine enough?")
    button.click()
    expect(curve.get_by_text("10 elements, ")).to_contain_text(TOLD)
    of = curve.get_by_role("combobox", name="Quantity")
    of.select_option("seconds")
    expect(button).to_be_disabled()
    of.select_option("peak_displacement")
    expect(button).to_be_enabled()


def test_the_tab_is_accessible_and_needs_no_scrolling(mapped: Page) -> None:
    page = mapped
    for scheme in ("dark", "light"):
        page.emulate_media(color_scheme=scheme)
        expect(page.locator(f".mui-{scheme}").first).to_be_visible()
        assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollHeight <= innerHeight")
    box = chart(page).bounding_box()
    assert box is not None
    assert box["y"] + box["height"] <= 720


def test_back_from_a_run_of_a_chart_shows_the_chart(curve: Page) -> None:
    page = curve
    expect(page).to_have_url(re.compile("vary=peak%3D"))
    before = page.url
    chart(page).press("ArrowRight")
    chart(page).press("Enter")
    expect(status(page)).to_be_visible()
    expect(page).not_to_have_url(re.compile("tab="))
    opened = page.url
    page.go_back()
    expect(page).to_have_url(before)
    has(page, "answer", "=== 5")
    page.go_forward()
    expect(status(page)).to_be_visible()
    expect(page).to_have_url(opened)
    page.go_back()
    expect(chart(page)).to_be_visible()
