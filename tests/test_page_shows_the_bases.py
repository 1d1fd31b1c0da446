"""With separated bases the page shows them, and without them nothing of it is there."""

from __future__ import annotations

import re

from pages import ENDLESS, Visit, at_rest, card, choose, open_sheets, slider, status
from playwright.sync_api import Page, expect
from test_the_scene_is_pictured_in_a_browser import MIDDLE

VIEWS = ("PGD space modes", "PGD time functions", "PGD basis size", "Friction as clips")


def choose_linear_stage(page: Page, name: str) -> None:
    choose(page.get_by_role("combobox", name="Linear stage"), name)


def test_views_of_the_bases_come_and_go_and_are_of_the_substructure_and_iteration_asked_for(
    open_page: Visit,
) -> None:
    page = open_page(f"?{ENDLESS}")
    tabs = card(page, "Singular values").get_by_role("button")
    expect(card(page, "Singular values")).to_be_visible()
    expect(tabs).to_have_text(VIEWS[-1:])
    open_sheets(page)
    choose_linear_stage(page, "pgd")
    expect(tabs).to_have_text(VIEWS)
    expect(status(page)).to_contain_text(re.compile("modes? a substructure, [0-9]+ in all"))
    expect(card(page, "Convergence")).to_contain_text("full stage")
    expect(card(page, "Singular values")).to_contain_text("PGD, sub. 10")
    tabs.filter(has_text="basis size").click()
    expect(card(page, "PGD basis size")).to_be_visible()
    expect(card(page, "Singular values")).to_have_count(0)
    choose_linear_stage(page, "full")
    # What says nothing of this run leaves its place to the first on its card.
    expect(card(page, "Singular values")).not_to_contain_text("PGD")
    expect(page.get_by_role("checkbox", name=re.compile("^PGD"))).to_have_count(0)
    expect(slider(page, "Substructure")).to_have_count(0)
    expect(status(page)).not_to_contain_text("in all")
    expect(card(page, "Convergence")).not_to_contain_text("full stage")
    choose_linear_stage(page, "pgd")
    expect(card(page, "PGD basis size")).to_be_visible()
    for name in ("PGD space modes", "Singular values"):
        page.get_by_role("checkbox", name=name).click()
    # Of the chosen substructure: of the newest iterate, and of a sought one.
    modes, values = card(page, "PGD space modes"), card(page, "Singular values")
    expect(modes).to_contain_text(re.compile("modes?, [0-9]+ added, [0-9]+ dropped"))
    slider(page, "Substructure").fill("4")
    expect(modes).to_contain_text("substructure 4")
    expect(values).to_contain_text("PGD, sub. 4")
    expect(status(page)).to_contain_text(re.compile(r"iteration \d\d"))
    page.get_by_role("button", name="Run or pause").click()
    expect(status(page)).to_contain_text("paused")
    slider(page, "Iteration").fill("7")
    expect(status(page)).to_contain_text("showing iteration 7")
    slider(page, "Substructure").fill("3")
    expect(modes).to_contain_text("substructure 3")
    expect(status(page)).to_contain_text("showing iteration 7")
    # Arrows end at its bodies: who does not drag them taps on these.
    page.mouse.click(*at_rest(page, MIDDLE))
    expect(slider(page, "Substructure")).to_have_value("2")
