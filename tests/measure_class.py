"""Measure a server with many pages at a time: `python tests/measure_class.py [PAGES] [SECONDS]`.

The pages are websockets that acknowledge at once, each with a run that goes on. Prints when their
first pictures came, how many came in a second and the longest gap, how long the server took to
answer something else meanwhile and how late its event loop was, its memory, and what is left after
all are closed.
"""

from __future__ import annotations

import asyncio
import json
import os
import statistics
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from browser import Server
from tornado.httpclient import AsyncHTTPClient
from web_pages import WebPage, until

EXPIRY = 60.0
"""Seconds after which sessions without a page are gone."""
ENDLESS = "?method=paper&tolerance=1e-30&max_iterations=100000"


def memory(pids: list[int]) -> float:
    """Give the memory that processes have for themselves, and their shares of the rest, MB."""
    total = 0.0
    for pid in pids:
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        total += sum(float(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return total / 1e3


def cpu(server: Server) -> float:
    """Give the processor time that the server itself has taken, s."""
    fields = Path(f"/proc/{server.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


async def answers(health: str, late: list[float]) -> None:
    """Note how long the server takes to say that it is alive."""
    client = AsyncHTTPClient(force_instance=True)
    while True:
        began = time.monotonic()
        await client.fetch(health, request_timeout=120)
        late.append(time.monotonic() - began)
        await asyncio.sleep(0.05)


async def lateness(health: str) -> str:
    """Give what the server says of its event loop in the last minute."""
    answer = await AsyncHTTPClient(force_instance=True).fetch(health, request_timeout=120)
    told = json.loads(answer.body)["lateness"]
    return f"at most {told['most']:.2f} s, 95 % below {told['95%']:.3f} s"


async def measure(server: Server, count: int, seconds: float) -> None:
    idle = server.processes()
    late: list[float] = []
    probe = asyncio.create_task(answers(server.health, late))
    pages = [WebPage(server.address + ENDLESS) for _ in range(count)]
    before = cpu(server)
    await asyncio.gather(*(page.open() for page in pages))
    lives = [asyncio.create_task(page.live()) for page in pages]
    await until(lambda: all(page.times for page in pages))
    opened = max(page.times[0] - page.began for page in pages)
    print(f"{count} pages: last first picture after {opened:.1f} s")
    print(f"processor time of the server meanwhile: {(cpu(server) - before) / count:.2f} s a page")
    print(f"answers while they opened: at most {max(late):.2f} s")
    print(f"event loop late while they opened: {await lateness(server.health)}")
    await asyncio.sleep(2.0)
    late.clear()
    began, before = time.monotonic(), cpu(server)
    await asyncio.sleep(seconds)
    spent = cpu(server) - before
    times = [[t for t in page.times if t >= began] for page in pages]
    rates = [len(one) / seconds for one in times]
    gaps = [b - a for one in times for a, b in pairwise(one)]
    print(f"pictures a second: median {statistics.median(rates):.1f}, least {min(rates):.1f}")
    print(f"processor time of the server: {1e3 * spent / sum(map(len, times)):.1f} ms a picture")
    print(f"longest gap: {max(gaps, default=seconds):.2f} s")
    print(f"answers meanwhile: median {statistics.median(late):.3f} s, at most {max(late):.2f} s")
    print(f"event loop late in the last minute: {await lateness(server.health)}")
    there = server.processes()
    print(f"memory: {memory(there):.0f} MB in {len(there)} processes ({len(idle)} without pages)")
    probe.cancel()
    for page in pages:
        page.close()
    await asyncio.gather(*lives)
    await asyncio.sleep(3.0)
    print(f"processes after closing, before sessions expire: {len(server.processes())}")
    end = time.monotonic() + EXPIRY
    while len(server.processes()) > len(idle) and time.monotonic() < end:
        await asyncio.sleep(1.0)
    left = server.processes()
    print(f"processes left: {len(left)} of {len(idle)}, {memory(left):.0f} MB")


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
