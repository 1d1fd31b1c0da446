"""A page whose server is killed says so, and comes back with its settings when there is one."""

from __future__ import annotations

import signal
from pathlib import Path

from browser import Server
from pages import slider, status
from playwright.sync_api import Browser, expect


def test_a_page_says_that_it_is_not_connected_and_comes_back_with_its_settings(
    tmp_path: Path, chrome: Browser
) -> None:
    server = Server(tmp_path / "first")
    server.wait()
    page = chrome.new_page()
    page.goto(server.address + "?substructures=5")
    expect(status(page)).to_contain_text("5 substructures")
    slider(page, "Substructures").press("ArrowRight")
    expect(status(page)).to_contain_text("6 substructures")
    server.stop(signal.SIGKILL)
    expect(status(page)).to_contain_text("not connected")
    again = Server(tmp_path / "second", server.port)
    try:
        again.wait()
        expect(status(page)).to_contain_text("6 substructures")
        slider(page, "Substructures").press("ArrowRight")
        expect(status(page)).to_contain_text("7 substructures")
    finally:
        page.close()
        again.stop()
