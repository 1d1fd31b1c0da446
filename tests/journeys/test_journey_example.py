"""The example that is a page, as it is served."""

from __future__ import annotations

import sys
from pathlib import Path

from browser import ROOT, Chrome, serving
from pages import comes

SCRIPT = ROOT / "solver" / "examples" / "page.py"
TITLES = """[...(window.Bokeh?.documents[0]?._all_models.values() ?? [])]
    .filter((model) => model.type === "Figure").map((model) => model.title.text)"""
"""Titles of all figures of a page, in its browser."""
NUMBER = f"Number(({TITLES})[0]?.match(/^iteration (\\d+)$/)?.[1])"
"""Number of the iteration that the figure names."""


def test_a_page_that_is_served_shows_one_iteration_after_the_other(
    tmp_path: Path, chrome: Chrome
) -> None:
    panel = str(Path(sys.executable).with_name("panel"))
    command = (panel, "serve", str(SCRIPT))
    page = chrome.new_page()
    with serving(tmp_path / "log", serves=command, place=tmp_path) as server:
        page.goto(f"{server.root}/page")
        assert page.title() == "A bar is pulled"
        # A page that opens slowly shows a later iteration first.
        comes(page, f"() => {NUMBER} >= 10")
    chrome.leave(page)
