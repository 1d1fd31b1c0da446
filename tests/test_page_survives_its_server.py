"""A page that has lost its server, or its network, says so, and comes back to where it stood."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from browser import Chrome, Server
from pages import choose, press, slider, status
from playwright.sync_api import Page, expect
from processes import PATIENCE, wait_for
from proxy import Proxy

PAGES = """Bokeh.documents.filter((one) => one.roots().some(({type}) => type !== "Plot")).length"""
"""Documents that are no figure's."""


@contextmanager
def behind_a_network(
    log: Path, chrome: Chrome, *options: str
) -> Iterator[tuple[Proxy, Server, Page]]:
    """Give a page, its server, and the network between them."""
    with closing(Proxy()) as proxy:
        origin = f"localhost:{proxy.port}"
        server = Server(log, 0, "--allow-websocket-origin", origin, *options)
        proxy.target = server.port
        try:
            server.wait()
            page = chrome.new_page()
            page.goto(f"http://{origin}/app?substructures=5")
            expect(status(page)).to_contain_text("after")
            slider(page, "Substructures").press("ArrowRight")
            expect(status(page)).to_contain_text(re.compile("after .* 6 substructures"))
            page.evaluate("window.stayed = true")
            yield proxy, server, page
            expect(status(page)).to_contain_text(re.compile("after .* 6 substructures"))
            slider(page, "Substructures").press("ArrowRight")
            expect(status(page)).to_contain_text("7 substructures")
            # What listens on the document goes with the page that is taken from it.
            page.evaluate("Bokeh.documents[0].clear()")
            assert keys_heard(page) == 0
            chrome.leave(page)
            assert "Traceback" not in server.log, server.log
        finally:
            server.stop()


def keys_heard(page: Page) -> int:
    """Count the listeners to keys on the document."""
    session = page.context.new_cdp_session(page)
    found = session.send("Runtime.evaluate", {"expression": "document"})["result"]["objectId"]
    listeners = session.send("DOMDebugger.getEventListeners", {"objectId": found})["listeners"]
    return sum(one["type"] == "keydown" for one in listeners)


def test_a_page_comes_back_to_its_settings_tab_instant_and_pace(
    tmp_path: Path, chrome: Chrome
) -> None:
    server = Server(tmp_path / "first")
    page = chrome.new_page()
    try:
        server.wait()
        page.goto(server.address + "?scene=strand&wires=5")
        expect(status(page)).to_contain_text("iteration")
        slider(page, "Instant").press("Home")
        choose(page.get_by_role("combobox", name=re.compile("^Pace")), "5 iterations/s")
        slider(page, "Wires").press("ArrowRight")
        press(page, "Stability")
        page.wait_for_url(re.compile("(?=.*wires=6)(?=.*tab=Stability)(?=.*instant=0)(?=.*pace=5)"))
    finally:
        server.stop(signal.SIGKILL)
    expect(status(page)).to_contain_text("not connected")
    again = Server(tmp_path / "second", server.port)
    try:
        again.wait()
        expect(status(page)).to_contain_text("iteration")
        expect(page.get_by_role("button", name="Stability")).to_have_attribute(
            "aria-pressed", "true"
        )
        press(page, "Live")
        expect(page.get_by_text("t = 0 s")).to_be_visible()
        expect(page.get_by_role("combobox", name=re.compile("^Pace"))).to_have_text(
            "5 iterations/s"
        )
        expect(slider(page, "Wires")).to_have_value("6")
        assert "Traceback" not in again.log
        chrome.leave(page)
    finally:
        again.stop()


def test_a_page_whose_socket_broke_goes_on_where_it_was(tmp_path: Path, chrome: Chrome) -> None:
    with behind_a_network(tmp_path / "log", chrome) as (proxy, _, page):
        heard = keys_heard(page)
        proxy.cut()
        expect(status(page)).to_contain_text("not connected")
        proxy.mend()
        expect(status(page)).to_contain_text("6 substructures")
        # Nothing is left of what Bokeh asked for, and keys are heard as often as before.
        page.wait_for_function(f"window.stayed && {PAGES} === 1", timeout=1e3 * PATIENCE)
        assert keys_heard(page) == heard > 0
        proxy.hush()
        expect(status(page)).to_contain_text("not connected")
        proxy.mend()
        expect(status(page)).to_contain_text("6 substructures")
        # Nothing is left of what Bokeh asked for, and keys are heard as often as before.
        page.wait_for_function(f"window.stayed && {PAGES} === 1", timeout=1e3 * PATIENCE)
        assert keys_heard(page) == heard > 0


def test_a_page_that_was_given_up_meanwhile_is_made_anew(tmp_path: Path, chrome: Chrome) -> None:
    short = ("--unused-session-lifetime", "3000", "--check-unused-sessions", "100")
    with behind_a_network(tmp_path / "log", chrome, *short) as (proxy, server, page):
        with_page = len(server.processes())
        proxy.cut()
        expect(status(page)).to_contain_text("not connected")
        wait_for(lambda: len(server.processes()) < with_page)
        proxy.mend()
        expect(status(page)).to_contain_text("6 substructures")
