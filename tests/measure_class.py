"""Measure a server with many pages: `python tests/measure_class.py [PAGES] [SECONDS] [--class]`.

The pages are websockets that acknowledge at once, each with a run that goes on. Prints when their
first pictures came, how many came in a second and the longest gap, how long the server took to
answer something else meanwhile and how late its event loop was, its memory, and what is left after
all are closed.

With `--class` all follow one more, whose pictures are computed once.

With `--change` settings are changed at random instead, and now and then a page is closed and
another opened; prints the memory of the server and of its workers every minute.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import random
import statistics
import tempfile
import time
from itertools import pairwise
from pathlib import Path

from app.components.form import POINTS
from browser import Server
from pages import OURS
from tornado.httpclient import AsyncHTTPClient
from tornado.websocket import WebSocketClosedError
from web_pages import WebPage, until

from solver.scenes import CATALOGUE

EXPIRY = 60.0
"""Seconds after which sessions without a page are gone."""
ENDLESS = "?method=paper&tolerance=1e-30&max_iterations=100000"
SIZES = ("elements", "elements_up", "instants", "layers", "wires", "substructures")


def memory(pids: list[int]) -> float:
    """Give the memory that processes have for themselves, and their shares of the rest, MB."""
    total = 0.0
    for pid in pids:
        try:
            lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        except OSError:  # it has just ended
            continue
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


async def measure(server: Server, count: int, seconds: float, *, follow: bool) -> None:
    idle = server.processes()
    leader = WebPage(server.address + ENDLESS)
    if follow:
        await leader.open()
        leads = asyncio.create_task(leader.live())
        await leader.lead()
        await until(lambda: leader.code)
    query = f"?class={leader.code}" if follow else ENDLESS
    late: list[float] = []
    probe = asyncio.create_task(answers(server.health, late))
    pages = [WebPage(server.address + query) for _ in range(count)]
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
    for page in [*pages, leader]:
        page.close()
    await asyncio.gather(*lives, *([leads] if follow else []))
    await asyncio.sleep(3.0)
    print(f"processes after closing, before sessions expire: {len(server.processes())}")
    end = time.monotonic() + EXPIRY
    while len(server.processes()) > len(idle) and time.monotonic() < end:
        await asyncio.sleep(1.0)
    left = server.processes()
    print(f"processes left: {len(left)} of {len(idle)}, {memory(left):.0f} MB")


async def move(page: WebPage) -> None:
    """Move one of the controls that a page has, anywhere; sizes stay small."""
    item = random.choice([item for item in page.items if item["name"] in page.shown])
    name, kind = item["name"], item["kind"]
    if kind == "slider":
        low, high = item["start"], item["end"]
        share = random.random() * (0.1 if name in SIZES else 1.0)
        value = low * (high / low) ** share if item["log"] else low + share * (high - low)
        value = round(value) if item["whole"] else value
        await page.move(name, value, hand=True)
        await page.move(name, None)
    elif kind in ("choice", "curve"):
        await page.move(name, random.choice([one for _, one in item["options"] if one != POINTS]))
    elif kind == "flip":
        await page.move(name, random.random() < 0.5)


async def visit(server: Server, end: float, pages: list[WebPage]) -> None:
    """Have a page open until the end, now and then another one."""
    while time.monotonic() < end:
        page = WebPage(f"{server.address}?scene={random.choice(list(CATALOGUE))}")
        await page.open()
        pages.append(page)
        life = asyncio.create_task(page.live())
        leaves = time.monotonic() + random.uniform(20.0, 200.0)
        while time.monotonic() < min(end, leaves) and not life.done():
            await asyncio.sleep(random.uniform(0.1, 2.0))
            try:
                await move(page)
            except WebSocketClosedError:
                print("a page was closed by the server")
        page.close()
        # What it was about to send would wait for ever.
        life.cancel()


async def change(server: Server, count: int, seconds: float) -> None:
    end, pages = time.monotonic() + seconds, list[WebPage]()
    visits = [asyncio.create_task(visit(server, end, pages)) for _ in range(count)]
    print("minutes  pages opened  pictures  server MB  workers MB  processes")
    while time.monotonic() < end:
        await asyncio.sleep(min(60.0, seconds))
        there = server.processes()
        others = [pid for pid in there if pid != server.pid]
        print(
            f"{(seconds - end + time.monotonic()) / 60:7.1f}{len(pages):14}"
            f"{sum(len(page.times) for page in pages):10}{memory([server.pid]):11.0f}"
            f"{memory(others):12.0f}{len(there):11}",
            flush=True,
        )
    await asyncio.gather(*visits)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pages", type=int, nargs="?", default=10)
    parser.add_argument("seconds", type=float, nargs="?", default=15.0)
    parser.add_argument("--change", action="store_true")
    parser.add_argument("--class", action="store_true", dest="follow")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(Path(folder) / "log")
        try:
            server.wait()
            if asked.change:
                asyncio.run(change(server, asked.pages, asked.seconds))
            else:
                asyncio.run(measure(server, asked.pages, asked.seconds, follow=asked.follow))
            print("errors of ours in the log:", len(OURS.findall(server.log)))
        finally:
            server.stop()


if __name__ == "__main__":
    main()
