"""What stands on the page is taken away, compared and linked to, in a real browser."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
from browser import Chrome
from pages import Visit, card, one_page, open_sheets, press, slider, status
from PIL import Image
from playwright.sync_api import Page, expect

PLOTS = "plots=Friction+force,Load+path"
SMALL = "elements=20&instants=13&substructures=4&method=paper&max_iterations=12"
CLIPBOARD = """(answer) => {
  navigator.clipboard.writeText = async (text) => {
    if (answer === "refused") { throw new Error(answer) }
    window.copied = text
  }
}"""


page = one_page(f"?{SMALL}&{PLOTS}", "after 12 iterations")
"""A page that is taken away from, and stays as it is."""


def take_away(page: Page) -> None:
    """Have in sight what can be taken away."""
    if not page.get_by_role("combobox", name="Plot").is_visible():
        press(page, "Take away")


def saved(page: Page, button: str) -> Path:
    with page.expect_download() as download:
        press(page, button)
    assert re.fullmatch(r"slipfront-[\w-]+\.\w+", download.value.suggested_filename)
    return Path(download.value.path())


def test_a_plot_is_saved_with_name_legend_and_units(page: Page) -> None:
    theme = page.get_by_role("button", name="Toggle theme")
    theme.click()
    expect(page.locator(".mui-dark").first).to_be_visible()
    expect(card(page, "Friction force").first).to_contain_text("reference")
    take_away(page)
    page.get_by_role("combobox", name="Plot").select_option("Friction force")
    drawing = ElementTree.fromstring(saved(page, "SVG").read_text())
    words = {one.text for one in drawing.iter("{http://www.w3.org/2000/svg}text")}
    assert {"Friction force", "reference", "Position x (m)", "Force (kN/m)"} < words
    assert "bar, t = 0.75 s, iteration 12" in words
    with Image.open(saved(page, "PNG")) as picture:
        pixels = np.asarray(picture.convert("L"))
    # Dark paper, and light words on it.
    assert np.median(pixels) < 64
    assert pixels[:60].max() > 200
    theme.click()
    expect(page.locator(".mui-light").first).to_be_visible()


def test_an_animation_has_a_picture_of_every_instant(page: Page) -> None:
    take_away(page)
    page.get_by_role("combobox", name="Plot").select_option("Load path")
    with Image.open(saved(page, "GIF over time")) as film:
        assert film.n_frames == 13
        frames = []
        for number in range(13):
            film.seek(number)
            frames.append(np.asarray(film.convert("RGB")).astype(int))
    assert all(abs(one - other).max() > 100 for one, other in pairwise(frames))
    assert np.median(frames[0]) > 250
    expect(page.get_by_text("t = 0.75 s").first).to_be_visible()


def test_a_table_and_a_program_are_saved(page: Page) -> None:
    take_away(page)
    page.get_by_role("combobox", name="Table").select_option("iterations")
    for _ in range(2):
        lines = saved(page, "CSV").read_text().splitlines()
        assert sum(line.startswith("LATIN,") for line in lines) == 12
    assert '"max_iterations": 12,' in saved(page, "Python").read_text()


def test_a_run_is_a_file_that_shows_its_instants_without_a_network(
    page: Page, chrome: Chrome
) -> None:
    take_away(page)
    file = saved(page, "HTML")
    alone, said = chrome.new_page(offline=True), list[str]()
    alone.on("console", lambda message: said.append(message.text))
    alone.on("pageerror", lambda problem: said.append(str(problem)))
    alone.on("request", lambda request: said.append(request.url))
    # A browser shows what has no ending as text.
    address = file.rename(file.with_suffix(".html")).as_uri()
    alone.goto(address)
    expect(alone.get_by_text("bar, t = 0.75 s, iteration 12")).to_be_visible()
    expect(alone.get_by_text("Friction force", exact=True).first).to_be_visible()
    curves = """Bokeh.documents[0].get_model_by_name("load-path.curves").data"""
    instants = alone.get_by_label("Instant")
    for key, time in ("Home", 0.0), ("End", 1.0), ("ArrowLeft", 11 / 12):
        instants.press(key)
        expect(alone.get_by_text(f"bar, t = {time:.3g} s, iteration 12")).to_be_visible()
        assert abs(alone.evaluate(f"{curves}.xs.at(-1)[0]") - time) < 1e-6
    assert all(one == address or one.startswith("[bokeh") for one in said), said
    alone.close()


def test_two_runs_are_compared_and_a_link_comes_back_to_both(open_page: Visit) -> None:
    page = open_page(
        "?elements=20&instants=21&max_iterations=60&plots=Friction+force&finish=at+once"
    )
    expect(status(page)).to_contain_text("✓ converged")
    open_sheets(page)
    compared = page.get_by_role("combobox", name="Compare with")
    compared.select_option("monoscale | multiscale")
    expect(page.locator(".figures")).to_contain_text("A (multiscale off)")
    expect(page.locator(".figures")).to_contain_text("at B's run time")
    expect(card(page, "Friction force").first).to_contain_text("A, iteration 60")
    slider(page, "Iteration").fill("7")
    expect(card(page, "Friction force").first).to_contain_text("A, iteration 7")
    page.wait_for_url(re.compile("iteration=7"))
    assert 'compare={"multiscale":false}' in unquote(page.url)
    page.reload()
    expect(status(page)).to_contain_text("paused at iteration 7")
    expect(card(page, "Friction force").first).to_contain_text("A, iteration 7")
    expect(compared).to_have_value("monoscale | multiscale")
    compared.select_option("nothing")
    expect(page.locator(".figures")).not_to_contain_text("A (")


def test_that_a_link_is_copied_is_said_and_that_it_could_not_be(page: Page) -> None:
    page.evaluate(CLIPBOARD, "taken")
    press(page, "Share")
    press(page, "Copy link")
    expect(page.get_by_text("Copied: the link").first).to_be_visible()
    assert "max_iterations=12" in page.evaluate("window.copied")
    page.evaluate(CLIPBOARD, "refused")
    press(page, "Copy link")
    expect(page.get_by_text("Not copied").first).to_be_visible()
