"""Measure a server with many pages at a time: `python tests/measure_class.py [PAGES] [SECONDS]`.

The pages are websockets that acknowledge at once, each with a run that goes on. Prints when their
first pictures came, how many came in a second and the longest gap, how long the server took to
answer something else meanwhile, its memory, and what is left after all are closed.
"""

from __future__ import annotations

import asyncio
import statistics
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from browser import Server
from tornado.httpclient import AsyncHTTPClient
from web_pages import WebPage, until

ENDLESS = "?method=paper&tolerance=1e-30&max_iterations=100000"


def memory(pids: list[int]) -> float:
    """Give the memory that processes have for themselves, and their shares of the rest, MB."""
    total = 0.0
    for pid in pids:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        total += sum(float(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return total / 1e3


async def answers(health: str, late: list[float]) -> None:
    """Note how long the server takes to say that it is alive."""
    client = AsyncHTTPClient()
    while True:
        began = time.monotonic()
        await client.fetch(health, request_timeout=120)
        late.append(time.monotonic() - began)
        await asyncio.sleep(0.05)


async def measure(server: Server, count: int, seconds: float) -> None:
    idle = server.processes()
    late: list[float] = []
    probe = asyncio.create_task(answers(server.health, late))
    pages = [WebPage(server.address + ENDLESS) for _ in range(count)]
    await asyncio.gather(*(page.open() for page in pages))
    lives = [asyncio.create_task(page.live()) for page in pages]
    await until(lambda: all(page.times for page in pages))
    opened = max(page.times[0] - page.began for page in pages)
    print(f"{count} pages: last first picture after {opened:.1f} s")
    print(f"answers while they opened: at most {max(late):.2f} s")
    await asyncio.sleep(2.0)
    late.clear()
    began = time.monotonic()
    await asyncio.sleep(seconds)
    times = [[t for t in page.times if t >= began] for page in pages]
    rates = [len(one) / seconds for one in times]
    gaps = [b - a for one in times for a, b in pairwise(one)]
    print(f"pictures a second: median {statistics.median(rates):.1f}, least {min(rates):.1f}")
    print(f"longest gap: {max(gaps, default=seconds):.2f} s")
    print(f"answers meanwhile: median {statistics.median(late):.3f} s, at most {max(late):.2f} s")
    there = server.processes()
    print(f"memory: {memory(there):.0f} MB in {len(there)} processes ({len(idle)} without pages)")
    probe.cancel()
    for page in pages:
        page.close()
    await asyncio.gather(*lives)
    await asyncio.sleep(3.0)
    print(f"processes after closing, before sessions expire: {len(server.processes())}")


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 15.0
    with tempfile.TemporaryDirectory() as folder:
        server = Server(Path(folder) / "log")
        try:
            server.wait()
            asyncio.run(measure(server, count, seconds))
        finally:
            server.stop()


if __name__ == "__main__":
    main()
