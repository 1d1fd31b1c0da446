"""A server starts without a complaint, and ends with all the processes that it had."""

from __future__ import annotations

import re
from pathlib import Path

from browser import Server
from pages import open_report, press, status
from playwright.sync_api import Browser, expect
from processes import wait_for


def test_a_server_has_a_worker_at_hand_and_leaves_neither_it_nor_a_study_behind(
    tmp_path: Path, chrome: Browser
) -> None:
    server = Server(tmp_path / "log")
    try:
        server.wait()
        assert len(server.processes()) > 1
        page = chrome.new_page()
        page.goto(server.address)
        expect(status(page)).to_contain_text("iteration")
        for word in ("Error", "WARNING", "Traceback"):
            assert word not in server.log, server.log
        open_report(page, "Study")
        page.get_by_text("Growth with the size").click()
        press(page, "Start")
        expect(page.get_by_text(re.compile("Errors of LATIN")).first).to_be_visible()
    finally:
        server.stop()
    page.close()
    wait_for(lambda: server.processes() == [])
