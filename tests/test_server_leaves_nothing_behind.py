"""A server starts without a complaint, and ends with all the processes that it had."""

from __future__ import annotations

import asyncio
import re
from pathlib import Path

from browser import Chrome, Server
from pages import open_report, press, status
from playwright.sync_api import expect
from processes import wait_for
from web_pages import WebPage, run_apart, until


def test_a_server_has_a_worker_at_hand_and_leaves_neither_it_nor_a_study_behind(
    tmp_path: Path, chrome: Chrome
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
    chrome.leave(page)
    wait_for(lambda: server.processes() == [])


def test_a_server_that_is_interrupted_leaves_no_worker_of_its_pages(tmp_path: Path) -> None:
    async def visit() -> None:
        pages = [WebPage(server.address) for _ in range(3)]
        for page in pages:
            await page.open()
        lives = [asyncio.create_task(page.live()) for page in pages]
        await until(lambda: all(page.times for page in pages))
        server.interrupt()
        await asyncio.gather(*lives)
        for page in pages:
            page.close()

    server = Server(tmp_path / "log")
    try:
        server.wait()
        run_apart(visit())
        wait_for(lambda: server.processes() == [])
        assert "Traceback" not in server.log
    finally:
        server.stop()
