"""The page shows every scene: chosen at the side, from an address, or from a file."""

from __future__ import annotations

import re

from pages import Visit, bodies_drawn, choose, slider, status
from playwright.sync_api import expect

SCENES = [("Parallel wires", 18, 0), ("Block on an inclined", 8, 1)]
"""Title, substructures, and whether there are bodies with stresses; each has several interfaces."""


def test_scenes_are_chosen_and_keep_their_settings(open_page: Visit) -> None:
    page = open_page("?substructures=5&tolerance=1e-3")
    box = {
        name: page.get_by_role("combobox", name=name) for name in ("Scene", "Interface", "Stress")
    }
    expect(status(page)).to_contain_text("5 substructures")
    expect(slider(page, "Substructures")).to_be_visible()
    for title, parts, bodies in SCENES:
        choose(box["Scene"], title)
        expect(status(page)).to_contain_text(f"{parts} substructures")
        expect(status(page)).to_contain_text("friction force error")
        expect(page.locator(".card")).to_have_count(9)
        expect(page.get_by_text("Friction coefficient").first).to_be_visible()
        expect(box["Interface"]).to_have_count(1)
        expect(box["Stress"]).to_have_count(bodies)
    choose(box["Scene"], "Clamped bar")
    expect(status(page)).to_contain_text("5 substructures")
    expect(page.locator(".figures")).not_to_contain_text("before")


def test_bodies_are_drawn_in_the_browser_and_looked_at_otherwise(open_page: Visit) -> None:
    page = open_page("?scene=layers&layers=1&elements=16&method=paper&max_iterations=30")
    # What is refused of an address is told; the rest of it holds.
    expect(page.get_by_text("Layers cannot be 1: ").first).to_be_visible()
    field = page.get_by_role("textbox", name=re.compile("^Layers"))
    field.fill("3")
    field.press("Enter")
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
