"""A page that has lost its server, or its network, says so, and comes back to where it stood."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from browser import Chrome, Server
from pages import choose, comes_true, open_sheets, press, slider, status
from playwright.sync_api import Page, expect
from proxy import Proxy

PAGES = """Bokeh.documents.filter((one) => one.roots().some(({type}) => type !== "Plot")).length"""
"""Documents that are no figure's."""
SMALL = "scene=strand&wires=5&elements=12&instants=11&plots=Scene&pace=1"
"""Its search goes on while the network is cut."""
KEPT = "--unused-session-lifetime", "600000", "--session-token-expiration", "1"
"""However long a busy machine takes to mend the network, the server still knows the page; and one
that has been open for longer than a second may come back too."""


class Network:
    """A page, and its server behind a network that can be cut."""

    def __init__(self, folder: Path, proxy: Proxy, chrome: Chrome, ends: ExitStack) -> None:
        self.proxy = proxy
        origin = ("--allow-websocket-origin", f"localhost:{self.proxy.port}")
        self.server = Server(folder / "log", 0, *origin, *KEPT)
        ends.callback(self.server.stop)
        self.server.wait()
        self.proxy.target = self.server.port
        self.page = chrome.new_page()
        # No other page may have its clock, which can be put forward.
        ends.callback(self.page.close)
        self.page.clock.install()
        self.page.goto(f"http://localhost:{self.proxy.port}/app?{SMALL}")
        expect(status(self.page)).to_contain_text("iteration")
        open_sheets(self.page)


@pytest.fixture(scope="module")
def network(
    tmp_path_factory: pytest.TempPathFactory, proxy: Proxy, chrome: Chrome
) -> Iterator[Network]:
    with ExitStack() as ends:
        yield Network(tmp_path_factory.mktemp("servers"), proxy, chrome, ends)


def keys_heard(page: Page) -> int:
    """Count the listeners to keys on the document."""
    session = page.context.new_cdp_session(page)
    found = session.send("Runtime.evaluate", {"expression": "document"})["result"]["objectId"]
    listeners = session.send("DOMDebugger.getEventListeners", {"objectId": found})["listeners"]
    return sum(one["type"] == "keydown" for one in listeners)


def test_a_page_whose_socket_broke_goes_on_where_it_was(network: Network) -> None:
    page, proxy = network.page, network.proxy

    def anew() -> None:
        """Have the silent socket close when the page has seen that its server is there."""
        with page.expect_response(lambda answer: answer.request.method == "HEAD"):
            proxy.renew()
        proxy.drop()

    def slowly() -> None:
        """Have a sign of life fall due while the new socket is not open yet."""
        with page.expect_websocket():
            proxy.mend_slowly()
        page.clock.run_for(2000)
        proxy.mend()

    slider(page, "Wires").press("ArrowRight")
    expect(status(page)).to_contain_text("36 substructures")
    page.evaluate("window.stayed = true")
    heard = keys_heard(page)
    for broken, mended in (
        (proxy.cut, proxy.mend),
        (proxy.cut, slowly),
        (proxy.tear, proxy.mend),
        (proxy.hush, proxy.mend),
        (proxy.hush, anew),
    ):
        broken()
        # Nothing is heard for so long, and longer than a page waits that has found its server.
        page.clock.run_for(16000)
        expect(status(page)).to_contain_text("not connected")
        mended()
        # Whoever waits for a page in vain should know whether there was a server.
        network.server.wait()
        expect(status(page)).to_contain_text("36 substructures")
        # Nothing is left of what Bokeh asked for, and keys are heard as often as before.
        comes_true(page, f"window.stayed && {PAGES} === 1")
        assert keys_heard(page) == heard > 0
    slider(page, "Wires").press("ArrowLeft")
    expect(status(page)).to_contain_text("30 substructures")
    assert "Traceback" not in network.server.log, network.server.log


def test_a_page_comes_back_to_its_settings_tab_instant_and_pace_on_another_server(
    network: Network, server: Server
) -> None:
    page, proxy = network.page, network.proxy
    slider(page, "Instant").press("Home")
    choose(page.get_by_role("combobox", name=re.compile("^Pace")), "5 iterations/s")
    slider(page, "Wires").press("ArrowRight")
    press(page, "Stability")
    page.wait_for_url(re.compile("(?=.*wires=6)(?=.*tab=Stability)(?=.*instant=0)(?=.*pace=5)"))
    page.evaluate("window.stayed = true")
    network.server.stop(signal.SIGKILL)
    expect(status(page)).to_contain_text("not connected")
    said_before = len(server.log)
    # As one to which the page is not known, it is as one that has given it up meanwhile.
    proxy.target = server.port
    comes_true(page, "!window.stayed")
    expect(status(page)).to_contain_text("36 substructures")
    tab = page.get_by_role("button", name="Stability")
    expect(tab).to_have_attribute("aria-pressed", "true")
    press(page, "Live")
    expect(page.get_by_text("t = 0 s")).to_be_visible()
    expect(page.get_by_role("combobox", name=re.compile("^Pace"))).to_have_text("5 iterations/s")
    slider(page, "Wires").press("ArrowRight")
    expect(status(page)).to_contain_text("42 substructures")
    # What listens on the document goes with the page that is taken from it.
    page.evaluate("Bokeh.documents[0].clear()")
    assert keys_heard(page) == 0
    assert "Traceback" not in server.log[said_before:], server.log
