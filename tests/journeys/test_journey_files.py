"""A person asks what if, takes the run away, and brings a file."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

from accessibility import all_can_use
from browser import ROOT, Chrome, Server
from markup import MARKUP, watched
from pages import (
    ANSWER,
    button,
    close_dialog,
    comes,
    enter,
    field,
    figures,
    go,
    inside,
    is_solved,
)
from playwright.sync_api import Browser, Page, expect

SEARCH = "elements=20&instants=21&substructures=4&pace=fastest"
SMALL = f"{SEARCH}&{ANSWER}"
LOAD = "time (s),force (kN)\n0,0\n1,1.2\n2,-0.6\n"
ROWS = "".join(f"{x},0.75,1.4\n" for x in range(0, 1001, 100))
RESULTS = f"x (mm),t (s),friction force (kN/m)\n{ROWS}"


def download(page: Page, name: str, folder: Path) -> Path:
    """Text that a button of the dialog writes."""
    with page.expect_download() as event:
        page.get_by_role("button", name=name).click()
    path = folder / event.value.suggested_filename
    event.value.save_as(path)
    return path


def upload(page: Page, path: Path, text: str) -> None:
    """Open a file by the browser's own dialog."""
    path.write_text(text, encoding="utf-8")
    with page.expect_file_chooser() as chooser:
        page.locator("label, button").filter(
            has=page.locator("input[type=file]")
        ).first.click()
    chooser.value.set_files(path)


FRAMES = """() => Bokeh.documents[0].roots().filter((root) => root.inner_height)
  .map((root) => root.inner_height / root.outer_height)"""
"""Heights of the frames of all figures over those of the figures."""


def opens_alone(browser: Browser, path: Path) -> None:
    """Check that a page is drawn from a file without a network, and runs no text."""
    context = browser.new_context(offline=True, viewport={"width": 1280, "height": 720})
    complaints = list[str]()
    page = context.new_page()
    page.on("request", lambda request: complaints.append(request.url))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(f"{said.type}: {said.text}"))
    with watched(page):
        page.goto(path.as_uri())
        is_whole(page)
    context.close()
    known = ("file:", "data:", "blob:", "log: ", "info: ")
    assert [text for text in complaints if not text.startswith(known)] == []


def is_whole(page: Page) -> None:
    """Check that plots are in full, texts beside them, and the run is there."""
    plots = page.locator(".scene .bk-Figure, figure .bk-Figure")
    expect(plots.nth(2)).to_be_visible()
    comes(page, f"() => Math.min(...({FRAMES})()) > 0.5")
    for plot in plots.all():
        box = plot.bounding_box()
        assert box
        assert box["width"] >= 300.0
        assert box["height"] >= 200.0
    parts = page.locator(".bk-Figure, .bk-Slider, .status, figcaption, table, h1, h2")
    lie_apart([part.bounding_box() for part in parts.all()])
    expect(page.locator("table")).to_contain_text("Friction coefficient")
    expect(page.locator(".status")).to_contain_text("certified")


def lie_apart(boxes: Sequence[Any]) -> None:
    """Check that no two of some boxes lie over each other."""
    for one, other in combinations(boxes, 2):
        # Positions are in fractions of a pixel.
        is_beside = (
            one["x"] + one["width"] < other["x"] + 1.0
            or other["x"] + other["width"] < one["x"] + 1.0
        )
        is_below = (
            one["y"] + one["height"] < other["y"] + 1.0
            or other["y"] + other["height"] < one["y"] + 1.0
        )
        assert is_beside or is_below, (one, other)


def open_files(page: Page) -> None:
    """Show the run of the address anew, with the place where files are opened."""
    go(page, f"?{SMALL}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    if not page.get_by_role("button", name="Save settings").is_visible():
        button(page, "Files").click()
    expect(page.get_by_role("button", name="Save settings")).to_be_visible()


def test_what_if_draws_a_chart_and_a_run_is_taken_away_as_table_and_program(
    page: Page, tmp_path: Path
) -> None:
    go(page, f"?{SEARCH}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    button(page, "What if").click()
    expect(page.get_by_role("combobox", name="See what happens to")).to_be_visible()
    expect(
        page.get_by_text(re.compile(r"13 of 13 runs: \d+ converged"))
    ).to_be_visible()
    expect(page.locator(".bk-Figure").locator("visible=true")).to_have_count(1)
    all_can_use(page)
    button(page, "Live").click()
    is_solved(page)
    button(page, "Take away").click()
    table = (
        download(page, "All iterations", tmp_path)
        .read_text(encoding="utf-8")
        .splitlines()
    )
    (head,) = [number for number, line in enumerate(table) if "error" in line]
    assert len(table) > head + 2
    # The worker sends slip once files are offered.
    contact = download(page, "Contact over x and t", tmp_path).read_text("utf-8")
    assert '"slip, m"' in contact.splitlines()[0]
    program = download(page, "The run as a program", tmp_path)
    done = subprocess.run(
        [sys.executable, program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    close_dialog(page)


def test_a_file_is_opened_by_keys_and_what_is_said_of_it_is_spoken(
    page: Page, tmp_path: Path
) -> None:
    open_files(page)
    spoken = page.get_by_role("status")
    expect(spoken).to_have_text(re.compile("solved.*certified"))
    region = spoken.element_handle()
    label = page.locator("label", has=page.locator("input[type=file]"))
    expect(label).to_be_visible()
    before = label.inner_text()
    (tmp_path / "bad.csv").write_text("time,force\n0,0\n1,much\n", encoding="utf-8")
    # The same file may be opened again.
    for _ in range(2):
        page.get_by_role("button", name="Save settings").focus()
        page.keyboard.press("Tab")
        expect(label).to_have_css("outline-style", "solid")
        with page.expect_file_chooser() as chooser:
            page.wait_for_timeout(500.0)
            page.keyboard.press("Enter")
        chooser.value.set_files(tmp_path / "bad.csv")
        expect(spoken).to_contain_text("much")
        expect(page.get_by_text("bad.csv was refused")).to_be_visible()
        assert label.inner_text() == before
        enter(page, "Peak load", "1000", over="900")
        expect(spoken).not_to_contain_text("much")
        enter(page, "Peak load", "900", over="1000")
        is_solved(page)
    # A screen reader follows the text of one element.
    assert page.evaluate("(one) => one.isConnected", region)
    expect(page.get_by_role("status")).to_have_count(1)


def test_what_a_file_has_is_drawn_beside_or_run_and_what_was_understood_is_said(
    page: Page, tmp_path: Path
) -> None:
    open_files(page)
    expect(page.get_by_text("Open settings, a table or a mesh").first).to_be_visible()
    upload(page, tmp_path / "theirs.csv", RESULTS)
    expect(figures(page)).to_contain_text("Distance to theirs.csv")
    button(page, "Remove theirs.csv").click()
    expect(figures(page)).not_to_contain_text("Distance to")
    expect(field(page, "Peak load")).to_have_value("900")
    upload(page, tmp_path / "pulled.csv", LOAD)
    expect(page.get_by_text("The run lasts 2 s").first).to_be_visible()
    expect(page).to_have_url(re.compile("load="))
    is_solved(page)
    upload(page, tmp_path / "bad.csv", "time,force\n0,0\n1,much\n")
    expect(page.get_by_text("much").first).to_be_visible()


HANDLER = "<img src='data:,' onerror='window.ran=1'>"
NAME = "<img src=x onerror=window.ran=1>[go](javascript:window.ran=1)"
"""The same, as a file may be called."""
LOOP = f"displacement (mm),force (kN),{MARKUP}\n" + "".join(
    f"{n / 10},{n},{MARKUP}\n" for n in (0, 1, 2, 1, 0)
)
HOSTILE = {
    "cell.csv": f"time,force\n0,0\n1,{MARKUP}\n",
    "head.csv": f"time,{MARKUP}\n0,0\n1,1\n",
    "unit.csv": f"time [s],force [{MARKUP}]\n0,0\n1,1\n",
    f"{NAME} refused.csv": "time,force\n0,0\n1,much\n",
    "scene.toml": f'scene = "{MARKUP}"\n',
    "key.toml": f'scene = "bar"\n"{MARKUP}" = 1\n',
    "value.toml": f'scene = "bar"\nfriction = "{MARKUP}"\n',
    "no.toml": f"{MARKUP}\n",
    f"{NAME}.toml": "scene = 1\n",
    f"{NAME} load.csv": "time (s),force (kN)\n0,0\n1,0.9\n",
    f"{NAME} theirs.csv": RESULTS,
    f"{NAME} {{0}} loop.csv": LOOP,
}
"""Files by their names; those that are not refused come last."""


def test_nothing_runs_that_a_file_says_or_is_called_nor_in_the_page_taken_away(
    page: Page, tmp_path: Path
) -> None:
    open_files(page)
    said = inside(page, ".line")
    with watched(page):
        for number, (name, text) in enumerate(HOSTILE.items()):
            folder = tmp_path / str(number)
            folder.mkdir()
            if number:
                before = said.inner_text()
            else:
                before = ""
            upload(page, folder / name, text)
            expect(said).not_to_have_text(before)
        expect(said).to_contain_text(NAME)
        close_dialog(page)
        button(page, "Take away").click()
        offline = download(page, "The run as one page", tmp_path)
        close_dialog(page)
        button(page, "Fit").click()
        expect(page.locator(".fit .bk-Figure")).to_be_visible()
        button(page, "Live").click()
        button(page, "Remove").click()
        expect(button(page, "Remove")).to_have_count(0)
    assert page.context.browser
    opens_alone(page.context.browser, offline)


def test_a_handler_in_an_element_does_not_run_should_a_text_become_one(
    chrome: Chrome, server: Server
) -> None:
    page = chrome.new_page()
    page.goto(server.address)
    with page.expect_console_message(
        lambda message: "Content Security Policy" in message.text
    ):
        page.evaluate(
            "(text) => document.body.insertAdjacentHTML('beforeend', text)", HANDLER
        )
    assert page.evaluate("window.ran") is None
    chrome.leave(page)
