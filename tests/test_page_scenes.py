"""The page shows every scene: chosen at the side, from an address, or from a file."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

WAIT = 60_000
CARDS = {"bar": 6, "strand": 7, "block": 7, "layers": 7}
PARTS = {"bar": 10, "strand": 18, "block": 8, "layers": 16}
TITLES = {
    "bar": "Clamped bar",
    "strand": "Parallel wires",
    "block": "Block pressed",
    "layers": "Stack of layers",
}
OURS = r'File ".*/(app|solver)/'
"""In a traceback; a page that is closed leaves those of the web server."""
DRAWN = """() => {
  const models = window.Bokeh && Bokeh.documents.length ? Bokeh.documents[0]._all_models : new Map()
  for (const model of models.values()) {
    const data = model.data
    if (model.type === "ColumnDataSource" && data.xs && data.ys && data.value) {
      return data.xs.length && data.xs[0].length === 4 ? data.xs.length : 0
    }
  }
  return -1
}"""


def status(page: Page):
    return page.locator(".status").first


def choose(page: Page, label: str, option: str) -> None:
    page.get_by_role("combobox", name=label).click()
    page.get_by_role("menuitem", name=option).click()


def slider(page: Page, name: str):
    return page.get_by_role("slider", name=name, exact=True)


def test_scenes_are_chosen_and_keep_their_settings(open_page, server):
    page = open_page("?substructures=5&tolerance=1e-3")
    expect(status(page)).to_contain_text("5 substructures", timeout=WAIT)
    expect(slider(page, "Substructures")).to_be_visible(timeout=WAIT)
    for scene in ("layers", "strand", "block"):
        choose(page, "Scene", TITLES[scene])
        expect(status(page)).to_contain_text(f"{PARTS[scene]} substructures", timeout=WAIT)
        expect(status(page)).to_contain_text(re.compile("iteration [1-9]|after"), timeout=WAIT)
        expect(page.locator(".card")).to_have_count(CARDS[scene], timeout=WAIT)
        expect(status(page)).to_contain_text("friction force error", timeout=WAIT)
        expect(page.get_by_text("Friction coefficient").first).to_be_visible(timeout=WAIT)
    choose(page, "Scene", TITLES["bar"])
    expect(status(page)).to_contain_text("5 substructures", timeout=WAIT)
    expect(page.locator(".figures")).not_to_contain_text("before")
    assert not re.search(OURS, server.log)


def test_bodies_are_drawn_in_the_browser_and_looked_at_otherwise(open_page):
    page = open_page("?scene=layers&layers=3&elements=16&max_iterations=30")
    expect(status(page)).to_contain_text("iteration", timeout=WAIT)
    page.wait_for_function(f"({DRAWN})() === {3 * 16 * 2}", timeout=WAIT)
    expect(page.get_by_text("displacement ×").first).to_be_visible(timeout=WAIT)
    slider(page, "Magnification").fill("7")
    expect(page.get_by_text("displacement × 100").first).to_be_visible(timeout=WAIT)
    choose(page, "Stress", "stress xx")
    expect(page.locator(".title").filter(has_text="Deformed")).to_contain_text("xx", timeout=WAIT)
    choose(page, "Interface", "contact 2-3")
    expect(page.get_by_role("combobox", name="Interface")).to_contain_text("contact 2-3")
    slider(page, "Instant").fill("20")
    expect(status(page)).to_contain_text(re.compile("iteration|after"), timeout=WAIT)


def test_an_interface_is_chosen_only_where_there_are_several(open_page):
    page = open_page("?scene=block&max_iterations=5")
    expect(page.get_by_role("combobox", name="Stress")).to_be_visible(timeout=WAIT)
    expect(page.get_by_role("combobox", name="Interface")).to_have_count(0)


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("?scene=layers&layers=1", "layers = 1 is refused"),
        ("?scene=strand&broken=9", "broken = 9 is refused"),
    ],
)
def test_a_bad_address_is_explained_and_its_scene_is_shown(open_page, query, words):
    page = open_page(query)
    expect(page.get_by_text(words).first).to_be_visible(timeout=WAIT)
    scene = re.match(r"\?scene=(\w+)", query)[1]
    expect(status(page)).to_contain_text(f"{PARTS[scene]} substructures", timeout=WAIT)


def test_odd_settings_run_without_a_complaint(open_page, server):
    query = "?scene=strand&wires=20&broken=0&elements=2&substructures=1&max_iterations=4"
    page = open_page(query)
    expect(status(page)).to_contain_text(re.compile("iteration [1-9]|after"), timeout=WAIT)
    expect(page.get_by_role("combobox", name="Interface")).to_be_visible(timeout=WAIT)
    expect(page.get_by_role("combobox", name="Stress")).to_have_count(0)
    assert not re.search(OURS, server.log)


def test_a_study_is_offered_where_there_is_a_reference(open_page):
    page = open_page("?scene=layers&layers=20&instants=11&max_iterations=5")
    expect(status(page)).to_contain_text("iteration", timeout=WAIT)
    expect(status(page)).not_to_contain_text("error")
    page.get_by_role("button", name="Study", exact=True).click()
    expect(page.get_by_text("would take too long here")).to_be_visible(timeout=WAIT)
    expect(page.get_by_role("button", name="Start").first).to_be_disabled()


def test_a_phone_sees_the_bodies(open_page):
    page = open_page("?scene=block&max_iterations=5", width=390, height=844)
    page.wait_for_function(f"({DRAWN})() > 1000", timeout=WAIT)
    expect(page.get_by_text("Deformed bodies").first).to_be_visible(timeout=WAIT)
