"""With separated bases the page shows them, and without them nothing of it is there."""

import re

from playwright.sync_api import Page, expect

WAIT = 30_000
VIEWS = ("PGD space modes", "PGD time functions", "PGD basis size")
SLOW = "max_iterations=100000&tolerance=1e-30"


def card(page: Page, name: str):
    return page.locator(".card").filter(has_text=name)


def status(page: Page):
    return page.locator(".status")


def choose_linear_stage(page: Page, name: str) -> None:
    box = page.get_by_role("combobox").filter(has_text=re.compile("^(full|pgd)$"))
    box.click()
    page.get_by_role("menuitem", name=name, exact=True).click()


def test_views_of_the_bases_come_and_go_with_them(open_page, server):
    page = open_page(f"?{SLOW}")
    expect(page.locator(".card")).to_have_count(6, timeout=WAIT)
    for _ in range(2):
        choose_linear_stage(page, "pgd")
        expect(page.locator(".card")).to_have_count(9, timeout=WAIT)
        expect(status(page)).to_contain_text(re.compile("modes? at most, [0-9]+ stored"))
        for name in VIEWS:
            expect(page.get_by_role("checkbox", name=name)).to_be_checked()
        expect(card(page, "Convergence")).to_contain_text("full stage", timeout=WAIT)
        expect(card(page, "Error against run time")).to_contain_text("full stage", timeout=WAIT)
        expect(card(page, "Singular values")).to_contain_text("PGD, sub. 10", timeout=WAIT)
        choose_linear_stage(page, "full")
        expect(page.locator(".card")).to_have_count(6, timeout=WAIT)
        expect(page.get_by_role("checkbox", name=re.compile("^PGD"))).to_have_count(0)
        expect(page.get_by_role("slider", name="Substructure", exact=True)).to_have_count(0)
        expect(status(page)).not_to_contain_text("stored")
        expect(card(page, "Singular values")).not_to_contain_text("PGD", timeout=WAIT)
        expect(card(page, "Convergence")).not_to_contain_text("full stage", timeout=WAIT)
    assert "Traceback" not in server.log


def test_the_chosen_substructure_is_the_one_that_is_drawn(open_page):
    page = open_page(f"?linear_stage=pgd&{SLOW}")
    modes, values = card(page, "PGD space modes"), card(page, "Singular values")
    expect(modes).to_contain_text("substructure 10", timeout=WAIT)
    expect(modes).to_contain_text(re.compile("modes?, [0-9]+ added, [0-9]+ dropped"))
    page.get_by_role("slider", name="Substructure", exact=True).fill("4")
    expect(modes).to_contain_text("substructure 4", timeout=WAIT)
    expect(values).to_contain_text("PGD, sub. 4", timeout=WAIT)


def test_another_substructure_of_a_sought_iterate_is_drawn(open_page):
    page = open_page(f"?linear_stage=pgd&{SLOW}")
    expect(status(page)).to_contain_text(re.compile("iteration [2-9][0-9]"), timeout=WAIT)
    page.get_by_role("button", name="Run or pause").click()
    expect(status(page)).to_contain_text("paused", timeout=WAIT)
    page.get_by_role("slider", name="Iteration").fill("7")
    expect(status(page)).to_contain_text("showing iteration 7", timeout=WAIT)
    page.get_by_role("slider", name="Substructure", exact=True).fill("3")
    expect(card(page, "PGD space modes")).to_contain_text("substructure 3", timeout=WAIT)
    expect(status(page)).to_contain_text("showing iteration 7")


def test_a_view_that_was_not_wanted_stays_away(open_page):
    page = open_page(f"?linear_stage=pgd&{SLOW}")
    expect(page.locator(".card")).to_have_count(9, timeout=WAIT)
    page.get_by_role("checkbox", name="PGD basis size").click()
    expect(page.locator(".card")).to_have_count(8, timeout=WAIT)
    choose_linear_stage(page, "full")
    expect(page.locator(".card")).to_have_count(6, timeout=WAIT)
    choose_linear_stage(page, "pgd")
    expect(page.locator(".card")).to_have_count(8, timeout=WAIT)
    expect(page.get_by_role("checkbox", name="PGD basis size")).not_to_be_checked()


def test_one_substructure_leaves_no_choice(open_page):
    page = open_page(f"?linear_stage=pgd&substructures=1&{SLOW}")
    expect(card(page, "PGD space modes")).to_contain_text("substructure 1", timeout=WAIT)
    expect(page.get_by_role("slider", name="Substructure", exact=True)).to_have_count(0)
    one = open_page("?linear_stage=pgd&instants=1")
    expect(one.locator(".card")).to_have_count(6, timeout=WAIT)
