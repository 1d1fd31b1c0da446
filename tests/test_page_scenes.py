"""The page shows every scene: chosen at the side, from an address, or from a file."""

from __future__ import annotations

import re

from pages import Visit, bodies_drawn, choose, slider, status
from playwright.sync_api import expect

CARDS = {"bar": 8, "strand": 9, "block": 9, "layers": 9, "incline": 9}
PARTS = {"bar": 10, "strand": 18, "block": 8, "layers": 16, "incline": 8}
TITLES = {
    "bar": "Clamped bar",
    "strand": "Parallel wires",
    "block": "Block pressed",
    "layers": "Stack of layers",
    "incline": "Block on an inclined",
}
WITH_SEVERAL_INTERFACES = {"strand", "layers", "incline"}
WITH_STRESSES = {"block", "layers", "incline"}


def test_scenes_are_chosen_and_keep_their_settings(open_page: Visit) -> None:
    page = open_page("?substructures=5&tolerance=1e-3")
    box = {
        name: page.get_by_role("combobox", name=name) for name in ("Scene", "Interface", "Stress")
    }
    expect(status(page)).to_contain_text("5 substructures")
    expect(slider(page, "Substructures")).to_be_visible()
    for scene in ("layers", "strand", "incline", "block"):
        choose(box["Scene"], TITLES[scene])
        expect(status(page)).to_contain_text(f"{PARTS[scene]} substructures")
        expect(status(page)).to_contain_text(re.compile("iteration [1-9]|after"))
        expect(page.locator(".card")).to_have_count(CARDS[scene])
        expect(status(page)).to_contain_text("friction force error")
        expect(page.get_by_text("Friction coefficient").first).to_be_visible()
        expect(box["Interface"]).to_have_count(int(scene in WITH_SEVERAL_INTERFACES))
        expect(box["Stress"]).to_have_count(int(scene in WITH_STRESSES))
    choose(box["Scene"], TITLES["bar"])
    expect(status(page)).to_contain_text("5 substructures")
    expect(page.locator(".figures")).not_to_contain_text("before")


def test_bodies_are_drawn_in_the_browser_and_looked_at_otherwise(open_page: Visit) -> None:
    page = open_page("?scene=layers&layers=3&elements=16&method=paper&max_iterations=30")
    bodies_drawn(page, f"=== {3 * 16 * 2}")
    expect(page.get_by_text("displacement ×").first).to_be_visible()
    slider(page, "Magnification").fill("7")
    expect(page.get_by_text("displacement × 100").first).to_be_visible()
    choose(page.get_by_role("combobox", name="Stress"), "stress xx")
    expect(page.locator(".title").filter(has_text="Deformed")).to_contain_text("xx")
    interface = page.get_by_role("combobox", name="Interface")
    choose(interface, "contact 2-3")
    expect(interface).to_contain_text("contact 2-3")
    slider(page, "Instant").fill("20")
    expect(status(page)).to_contain_text(re.compile("iteration|after"))
