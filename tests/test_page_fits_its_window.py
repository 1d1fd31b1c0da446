"""Two rows of plots fit a projector's window, and keys move the run only where it is seen."""

from playwright.sync_api import expect

WAIT = 60_000


def test_two_rows_of_plots_fit_a_window_under_all_buttons_and_words(open_page):
    page = open_page("?scene=layers&method=paper&layers=2&elements=16&max_iterations=3", 1280, 720)
    status = page.locator(".status").first
    expect(status).to_contain_text("after 3 iterations", timeout=WAIT)
    expect(page.get_by_role("slider", name="Magnification")).to_be_visible(timeout=WAIT)
    page.wait_for_timeout(500)
    box = page.locator(".card").nth(5).bounding_box()
    assert box is not None
    assert box["height"] > 200
    assert box["y"] + box["height"] <= 720


def test_keys_move_the_run_only_where_it_is_seen(open_page):
    page = open_page("?method=paper&max_iterations=5")
    status = page.locator(".status").first
    expect(status).to_contain_text("after 5 iterations", timeout=WAIT)
    page.get_by_role("button", name="Stability", exact=True).click()
    expect(page.get_by_text("Stiff and extreme cases of every scene")).to_be_visible(timeout=WAIT)
    page.locator("body").press("r")
    page.get_by_role("button", name="Live", exact=True).click()
    expect(page.locator(".figures")).to_contain_text("this run", timeout=WAIT)
    page.wait_for_timeout(1000)
    expect(page.locator(".figures")).not_to_contain_text("before")
    page.locator("body").press("r")
    expect(page.locator(".figures")).to_contain_text("before (first settings)", timeout=WAIT)
