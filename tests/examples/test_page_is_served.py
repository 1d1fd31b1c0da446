"""The example that is a page, as Panel serves it to a page without a browser."""

from __future__ import annotations

import asyncio
import re

from browser import ROOT
from coroutines import awaited
from pages_without_browser import connected
from panel.io.server import get_server
from processes import PATIENCE

SCRIPT = ROOT / "solver" / "examples" / "page.py"
LAST = 5
"""Iteration until which a page is looked at."""


async def visited() -> tuple[str, list[int]]:
    """HTML of the page, and the iterations that it is told of, one by one."""
    server = get_server({"page": str(SCRIPT)})
    server.start()
    numbers: list[int] = []
    try:
        html, socket = await connected(f"http://localhost:{server.port}/page")
        async with asyncio.timeout(PATIENCE):
            while LAST not in numbers:
                said = str(await socket.read_message())
                numbers += map(int, re.findall(r'"iteration (\d+)"', said))
        socket.close()
    finally:
        server.stop()
    return html, numbers


def test_a_page_that_is_served_shows_one_iteration_after_the_other() -> None:
    html, numbers = awaited(visited())
    assert "<title>A bar is pulled</title>" in html
    assert numbers == list(range(numbers[0], LAST + 1))
