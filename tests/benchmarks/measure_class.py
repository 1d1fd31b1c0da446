"""Measure a server with many pages: `python tests/benchmarks/measure_class.py [PAGES]
[--waves N]`.

Serves the page and opens all pages, thirty without a number, at once: websockets that
say *painted* at once, as browsers of thirty machines do, for which these two cores are
too few. Prints when the first picture of the last page came, the longest time that the
server took meanwhile to say that it lives, how many pictures a second
each got at 20 iterations a second and of searches without an end in 3 s, the memory of
a worker, and what is left once all are closed.

With waves all pages are opened and closed so many times, and the memory of the server
after each is printed. What counts is how much each wave adds from the second on: memory
that was once taken is kept for what comes next.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path
from urllib.parse import quote

from measure_page import ANSWER, ENDLESS

# What tests share, too
sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))
from browser import Server, serving
from pages_without_browser import Visitor

PACES = {"20 a second": ENDLESS, "whole in 3 s": ENDLESS.rpartition("&pace")[0]}
SECONDS = 20.0
LEAVING = 50.0
"""Seconds in which the server ends what belongs to closed pages."""
LOOK = 0.1
"""Seconds between two questions whether the server lives."""


class Watch:
    """The longest time that the server took to say that it lives, in `longest`, s."""

    def __init__(self, server: Server) -> None:
        self.longest = 0.0
        self._server = server
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._ask)

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._is_over.set()
        self._thread.join()

    def _ask(self) -> None:
        while not self._is_over.wait(LOOK):
            began = time.perf_counter()
            urllib.request.urlopen(self._server.health).close()
            self.longest = max(self.longest, time.perf_counter() - began)


async def measure(server: Server, number: int) -> None:
    idle = len(server.processes())
    for pace, query in PACES.items():
        began = time.perf_counter()
        with Watch(server) as watch:
            visitors, tasks = await opened(server, number, query)
        last = max(visitor.pictures[0] for visitor in visitors) - began
        print(
            f"{pace}: the last opens after {last:.1f} s; the server answered within "
            f"{watch.longest:.1f} s"
        )
        before = [len(visitor.pictures) for visitor in visitors]
        began = time.perf_counter()
        await asyncio.sleep(SECONDS)
        got = [len(v.pictures) - old for v, old in zip(visitors, before, strict=True)]
        rate = sum(got) / number / (time.perf_counter() - began)
        print(
            f"{pace}: {rate:.1f} pictures a second and page; {memory(server):.0f} MB "
            "a worker"
        )
        await close(visitors, tasks)
        print(f"{pace}: {len(server.processes()) - idle} processes left")


async def measure_waves(server: Server, number: int, waves: int) -> None:
    """Print what the server keeps of pages that were opened and closed repeatedly."""
    idle = len(server.processes())
    before = resident(server)
    print(f"at first: {before:.0f} MB")
    for wave in range(1, waves + 1):
        await close(*await opened(server, number, ANSWER))
        kept = resident(server)
        left = len(server.processes()) - idle
        each = (kept - before) / number
        print(
            f"wave {wave}: {kept:.0f} MB, {each:.2f} MB more a page; {left} processes "
            "left"
        )
        before = kept


async def opened(
    server: Server, number: int, query: str
) -> tuple[list[Visitor], list[asyncio.Task[None]]]:
    """Open pages, all at once, until each has a picture."""
    visitors = [Visitor() for _ in range(number)]
    address = f"{server.address}?{quote(query, safe='=&%')}"
    tasks = [asyncio.create_task(visitor.open(address)) for visitor in visitors]
    while not all(visitor.pictures for visitor in visitors):
        await asyncio.sleep(0.1)
        for task in tasks:
            if task.done():
                await task
    return visitors, tasks


async def close(visitors: list[Visitor], tasks: list[asyncio.Task[None]]) -> None:
    """Close pages, and wait until the server has let go of them."""
    for visitor in visitors:
        visitor.close()
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(asyncio.gather(*tasks, return_exceptions=True), 5.0)
    await asyncio.sleep(LEAVING)


def resident(server: Server) -> float:
    """Memory that the server's own process holds, MB."""
    lines = Path(f"/proc/{server.pid}/status").read_text().splitlines()
    return (
        int(next(line for line in lines if line.startswith("VmRSS:")).split()[1]) / 1e3
    )


def memory(server: Server) -> float:
    """Share of the memory that a worker has, MB, the median of all."""
    shares = []
    for pid in server.processes()[1:]:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        shares.append(
            int(next(line for line in lines if line.startswith("Pss:")).split()[1])
        )
    return sorted(shares)[len(shares) // 2] / 1e3


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Measure a server with many pages.")
    parser.add_argument("pages", type=int, nargs="?", default=30)
    parser.add_argument("--waves", type=int, default=0)
    chosen = parser.parse_args()
    quick = ("--unused-session-lifetime", "30000", "--check-unused-sessions", "1000")
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "log", 0, *quick) as made,
    ):
        if chosen.waves:
            asyncio.run(measure_waves(made, chosen.pages, chosen.waves))
        else:
            asyncio.run(measure(made, chosen.pages))
