"""Draw the pictures of the page in the READMEs, as it is today.

`python tests/benchmarks/draw_pictures.py`

It serves the page, opens each address in Chromium at its size, and writes the window to
`static/`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

from browser import ROOT, Chrome, serving
from pages import holds, status

LARGEST = 200_000
"""Largest size of a picture, bytes."""


class Picture(NamedTuple):
    """A picture of the page: its file, its address, and the size of the window, px."""

    file: str
    query: str
    width: int = 1280
    height: int = 900
    seconds: float = 1.0
    """Time from the end of the run, or of an open question's first picture."""


PICTURES = (
    # An instant that was chosen stays: the page does not play.
    Picture("page.png", "?scene=bar&instant=0.7"),
    Picture("method.png", "?lesson=what-the-solver-does", height=720, seconds=4.0),
    Picture("block.png", "?scene=block&instant=0.7"),
)


def draw(chrome: Chrome, address: str, picture: Picture) -> None:
    """Write a picture once its run has ended or waits."""
    page = chrome.new_page(picture.width, picture.height)
    page.goto(address + picture.query)
    holds(page, "model('pulse')?.painted > 0")
    # While a question is open there is no status that would give its answer away.
    if "lesson=" not in picture.query:
        status(page).filter(has_text="certified").wait_for()
    page.wait_for_timeout(1e3 * picture.seconds)
    file = ROOT / "static" / picture.file
    page.screenshot(path=file)
    size = file.stat().st_size
    if size > LARGEST:
        raise ValueError(f"{file} has {size} bytes, and may have {LARGEST}")
    print(f"{file}: {size} bytes")
    chrome.leave(page)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        chrome = Chrome(driver)
        with serving(Path(folder) / "log") as server:
            for picture in PICTURES:
                draw(chrome, server.address, picture)
        chrome.close()


if __name__ == "__main__":
    main()
