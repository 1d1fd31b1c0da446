"""A person loses network or worker, reloads, or comes by a foolish address."""

from __future__ import annotations

import os
import re
import signal
import time
import urllib.request
from urllib.error import HTTPError

import pytest
from browser import Chrome, Server
from pages import (
    ANSWER,
    ENDLESS,
    Desk,
    button,
    enter,
    field,
    figures,
    go,
    is_solved,
    painted,
    status,
)
from playwright.sync_api import Page, expect
from processes import is_alive, wait_for
from proxy import Proxy

FOOLISH = (
    "?friction=nan&elements=1e99&lesson=moon&class=ZZZZ",
    "?scene=moon&peak=900",
    "?tab=%00&view=&plots=,,,&pace=never&load=[[0,0],[0,1]]&instant=7",
    "?peak=" + "9" * 4000 + "&%3Cscript%3Ealert(1)%3C/script%3E=1",
)
QUIET = 1.0
"""Seconds without a message after which none is on its way."""
SPEAK = """async (address) => {
  const [, token] = (await (await fetch(address)).text()).match(/"token":\\s*"([^"]+)"/)
  const socket = new WebSocket(address.replace("http", "ws") + "/ws", ["bokeh", token])
  await new Promise((resolve) => {
    socket.onmessage = () => socket.send("Hello?")
    socket.onclose = resolve
  })
}"""
"""Has the browser open a session, and say what is no message of Bokeh's."""


def test_a_network_that_breaks_and_is_mended_costs_no_settings(
    page: Page, proxy: Proxy
) -> None:
    go(page, f"?{ANSWER}&peak=1000")
    expect(field(page, "Peak load")).to_have_value("1000")
    is_solved(page)
    expect(figures(page)).to_contain_text("Force −1 kN")
    # Of a message that is cut in two Bokeh's client keeps the first part for the next
    # connection.
    wait_for(lambda: time.monotonic() > proxy.heard_at + QUIET)
    sign = page.locator("#network")
    expect(sign).to_be_hidden()
    with page.expect_console_message(lambda message: "Lost websocket" in message.text):
        proxy.cut()
    expect(sign).to_contain_text("does not answer")
    # A device knows it sooner than a socket closes.
    page.context.set_offline(True)
    expect(sign).to_contain_text("No network")
    page.context.set_offline(False)
    with page.expect_console_message(lambda message: "is now open" in message.text):
        proxy.mend()
    expect(sign).to_be_hidden()
    enter(page, "Peak load", "1100", over="1000")
    expect(figures(page)).to_contain_text("Force −1.1 kN")
    is_solved(page)


def test_a_reload_keeps_the_settings_and_back_undoes_them(
    page: Page, desk: Desk
) -> None:
    go(page, f"?{ANSWER}")
    expect(field(page, "Peak load")).to_have_value("900")
    is_solved(page)
    enter(page, "Peak load", "1100", over="900")
    expect(figures(page)).to_contain_text("Force −1.1 kN")
    button(page, "Rope").click()
    expect(page.locator(".sentence")).to_contain_text("A strand")
    page.go_back()
    expect(figures(page)).to_contain_text("Force −1.1 kN")
    page.go_back()
    expect(figures(page)).to_contain_text("Force −900 N")
    page.go_forward()
    expect(figures(page)).to_contain_text("Force −1.1 kN")
    page.reload()
    expect(figures(page)).to_contain_text("Force −1.1 kN")
    expect(field(page, "Peak load")).to_have_value("1100")
    desk.arrive()


def test_a_worker_that_is_gone_is_said_and_none_is_left_of_a_page_that_is_closed(
    page: Page, desk: Desk, stranger: Desk, server: Server
) -> None:
    other = stranger.page()
    before = server.processes()

    def goes_on(page: Page, worker: int, words: str) -> None:
        expect(page.locator(".status")).to_contain_text(
            f"{words}; the run was started anew"
        )
        painted(page, 3)
        wait_for(lambda: not is_alive(worker))

    for each in (page, other):
        go(each, f"?{ENDLESS}&pace=5 a second")
        expect(status(each)).to_contain_text(re.compile(r"iteration \d"))
    # Both waits at once: for the sign of life, and for the end of a page that is
    # closed.
    os.kill(desk.worker, signal.SIGSTOP)
    os.kill(stranger.worker, signal.SIGKILL)
    goes_on(other, stranger.worker, "process ended")
    stranger.close()
    goes_on(page, desk.worker, "no sign of life for some seconds")
    wait_for(lambda: len(set(server.processes()) - set(before)) == 1)
    go(page, f"?{ANSWER}")
    desk.arrive()


@pytest.mark.parametrize("query", FOOLISH, ids=range(len(FOOLISH)))
def test_a_foolish_address_is_answered_by_a_page_that_says_that_it_loads(
    server: Server, query: str
) -> None:
    before = len(server.log)
    with urllib.request.urlopen(server.address + query) as answer:
        text = answer.read().decode()
    # While a slow page loads a word says so, and is there before any script has come.
    assert "Slipfront is loading" in text.partition("<body")[0]
    assert 'id="loader"' in text
    assert "Traceback" not in server.log[before:]


@pytest.mark.parametrize(
    ("path", "code"),
    [("/app?load=" + "1" * 20_000, 414), ("/static/%00", 404), ("/moon", 404)],
)
def test_what_is_no_address_is_refused(server: Server, path: str, code: int) -> None:
    before = len(server.log)
    with pytest.raises(HTTPError) as refused:
        urllib.request.urlopen(server.root + path)
    with refused.value as answer:
        assert answer.code == code
    assert "Traceback" not in server.log[before:]


def test_whoever_speaks_another_language_leaves_a_line_in_the_log(
    chrome: Chrome, server: Server
) -> None:
    page = chrome.new_page()
    page.goto(server.health)
    before = len(server.log)
    page.evaluate(SPEAK, server.address)
    chrome.leave(page)
    said = server.log[before:]
    assert "Traceback" not in said
    assert len([line for line in said.splitlines() if "onnection" not in line]) <= 1, (
        said
    )
