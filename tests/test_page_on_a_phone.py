"""On a phone a sheet has the controls and leaves a plot in sight; key figures fold."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from browser import Chrome, Server
from pages import Visit, slider, status, visits
from playwright.sync_api import Page, expect
from test_page_for_everybody import violations

BELOW_THE_HEADER = 50.0


@pytest.fixture(scope="module")
def phone(server: Server, chrome: Chrome) -> Iterator[Page]:
    """Give a page on a phone, whose sheet every test leaves as it found it."""
    query = "?elements=20&substructures=2&instants=11&finish=at+once"
    with visits(server, chrome) as visit:
        page = visit(query, 390, 844, has_touch=True, is_mobile=True)
        expect(status(page)).to_contain_text("converged")
        expect(page.get_by_role("button", name="Controls")).to_be_visible()
        yield page


def test_a_slider_is_dragged_in_a_sheet_below_the_scene(phone: Page) -> None:
    handle, peak = phone.get_by_role("button", name="Controls"), slider(phone, "Peak load")
    scene = phone.get_by_role("figure", name="Scene")
    expect(peak).to_be_hidden()
    handle.tap()
    peak.scroll_into_view_if_needed()
    before = peak.get_attribute("aria-valuenow")
    peak.tap(position={"x": 40, "y": 5})
    expect(peak).not_to_have_attribute("aria-valuenow", before or "")
    drawn, sheet = scene.bounding_box(), handle.bounding_box()
    assert drawn is not None
    assert sheet is not None
    assert drawn["y"] > BELOW_THE_HEADER
    assert drawn["y"] + drawn["height"] <= sheet["y"]
    handle.tap()
    expect(peak).to_be_hidden()


def test_the_plot_that_one_looks_at_stays_above_the_sheet(phone: Page) -> None:
    last = phone.get_by_role("figure", name="Singular values")
    last.scroll_into_view_if_needed()
    handle = phone.get_by_role("button", name="Controls")
    handle.press("Enter")
    expect(handle).to_have_attribute("aria-expanded", "true")
    runs = phone.get_by_role("button", name=re.compile("^(Run|Pause|Replay)")).first
    expect(runs).to_be_visible()
    sheet = handle.bounding_box()
    assert sheet is not None
    above = [
        box
        for figure in phone.get_by_role("figure").all()
        if (box := figure.bounding_box())
        and box["y"] > BELOW_THE_HEADER
        and box["y"] + box["height"] <= sheet["y"]
    ]
    assert len(above) == 1
    handle.press("Space")
    expect(handle).to_have_attribute("aria-expanded", "false")


def test_figures_of_the_method_and_details_come_with_a_tap_and_all_is_accessible(
    phone: Page,
) -> None:
    figures, detail = phone.locator(".figures"), status(phone).get_by_text("substructures")
    expect(figures.get_by_text("End displacement")).to_be_visible()
    expect(figures.get_by_text("Run time")).to_be_hidden()
    expect(detail).to_be_hidden()
    status(phone).get_by_text("details").tap()
    expect(detail).to_be_visible()
    status(phone).get_by_text("details").blur()
    expect(detail).to_be_hidden()
    phone.get_by_role("button", name="Method").tap()
    expect(figures.get_by_text("Run time")).to_be_visible()
    phone.get_by_role("button", name="Controls").tap()
    assert violations(phone) == []
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390


def test_the_plots_of_a_lesson_stay_above_its_sentences(open_page: Visit) -> None:
    page = open_page("?lesson=best-k", 390, 844, has_touch=True, is_mobile=True)
    page.get_by_role("button", name="Show me").tap()
    scene, factor = page.get_by_role("figure", name="Scene"), slider(page, "Factor on k").first
    expect(scene).to_be_in_viewport(ratio=1)
    page.get_by_role("button", name="Explore freely").scroll_into_view_if_needed()
    expect(scene).to_be_in_viewport(ratio=1)
    factor.scroll_into_view_if_needed()
    before = factor.get_attribute("aria-valuenow")
    factor.tap(position={"x": 40, "y": 5})
    expect(factor).not_to_have_attribute("aria-valuenow", before or "")
    lesson, words = page.locator(".lesson").bounding_box(), status(page).bounding_box()
    assert lesson is not None
    assert words is not None
    assert lesson["y"] + lesson["height"] <= words["y"]
