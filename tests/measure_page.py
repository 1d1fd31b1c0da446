"""Measure the page in headless Chromium: `python tests/measure_page.py`.

Prints the weight of a page, and medians, in ms, of opening the page until its first picture is
painted, of a key press on a slider until the first picture of the new run is painted, and of the
last of many quick presses until its own picture is; and for every scene how often its plots are
painted in a second, the one that is painted least and the one that is painted most.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from browser import Server, browser
from playwright.sync_api import BrowserContext, Page

from solver.scenes import CATALOGUE

REPEATS = 15
BURSTS = 4
PRESSES = 10
"""Quick presses in a burst, as of a key that is held."""
FIRST_PICTURE = """() => new Promise((resolve) => {
  const look = () => {
    const status = document.querySelector("body") && window.findStatus()
    if (status && status.textContent.includes("iteration") && window.isPainted(document)) {
      requestAnimationFrame(() => resolve(performance.now()))
    } else { requestAnimationFrame(look) }
  }
  look()
})"""
FIND = """window.findStatus = () => {
  const search = (root) => {
    for (const element of root.querySelectorAll("*")) {
      if (element.classList.contains("status")) { return element.shadowRoot || element }
      const found = element.shadowRoot && search(element.shadowRoot)
      if (found) { return found }
    }
  }
  return window.statusFound || (window.statusFound = search(document))
}
window.plotsOf = (views, found = new Set()) => {
  for (const view of views) {
    if (view._actual_paint) { found.add(view) }
    window.plotsOf(view.children ? view.children() : [], found)
  }
  return found
}
window.isPainted = (root) => {
  for (const element of root.querySelectorAll("*")) {
    if (element.tagName === "CANVAS" && element.width > 100 && element.height > 100) {
      const row = element.getContext("2d").getImageData(0, element.height >> 1, element.width, 1)
      if (new Set(row.data).size > 2) { return true }
    }
    if (element.shadowRoot && window.isPainted(element.shadowRoot)) { return true }
  }
  return false
}
window.afterKey = (text) => new Promise((resolve) => {
  let since
  const note = () => { since = performance.now() }
  window.addEventListener("keydown", note, {capture: true, once: true})
  const look = () => {
    if (since && window.findStatus().textContent.includes(text)) {
      requestAnimationFrame(() => requestAnimationFrame(() => resolve(performance.now() - since)))
    } else { requestAnimationFrame(look) }
  }
  look()
})"""

# A run that goes on: no tolerance stops it, and nothing helps it to converge.
ENDLESS = "method=paper&max_iterations=100000&tolerance=1e-30&pace=20"
SECONDS = 5
WATCH = """(seconds) => new Promise((resolve) => {
  const counts = new Map()
  for (const view of window.plotsOf(Bokeh.index.roots)) {
    counts.set(view, 0)
    const paint = view._actual_paint
    view._actual_paint = function (...rest) {
      counts.set(view, counts.get(view) + 1)
      return paint.apply(this, rest)
    }
  }
  setTimeout(() => resolve([...counts.values()]), 1e3 * seconds)
})"""


def slider_latency(page: Page) -> list[float]:
    handle = page.get_by_role("slider", name="Substructures")
    times = []
    for repeat in range(REPEATS):
        page.wait_for_timeout(1200)
        target, key = (11, "ArrowRight") if repeat % 2 == 0 else (10, "ArrowLeft")
        page.evaluate(f"() => {{ window.waited = window.afterKey('· {target} substructures') }}")
        handle.press(key)
        times.append(page.evaluate("window.waited"))
    return times


def burst_latency(page: Page) -> list[float]:
    """Give the times from a burst of keys until the page shows what the slider then stands at."""
    handle = page.get_by_role("slider", name="Substructures")
    times = []
    for repeat in range(BURSTS):
        page.wait_for_timeout(1200)
        handle.focus()
        for _ in range(PRESSES):
            page.keyboard.press("ArrowRight" if repeat % 2 == 0 else "ArrowLeft")
        pressed = time.perf_counter()
        words = f"· {handle.get_attribute('aria-valuenow')} substructures"
        page.wait_for_function(
            "(words) => window.findStatus().textContent.includes(words)", arg=words
        )
        times.append(1e3 * (time.perf_counter() - pressed))
    return times


def paints_per_second(context: BrowserContext, address: str) -> tuple[float, float]:
    page = context.new_page()
    page.goto(address, wait_until="commit")
    page.evaluate(FIRST_PICTURE)
    page.wait_for_timeout(3000)
    paints = page.evaluate(WATCH, SECONDS)
    page.close()
    return min(paints, default=0) / SECONDS, max(paints, default=0) / SECONDS


def weight(context: BrowserContext, address: str) -> tuple[float, float]:
    """Give what a new visitor's page loads, in MB: files, and what it then hears in two seconds."""
    page = context.new_page()
    session = context.new_cdp_session(page)
    session.send("Network.enable")
    files: list[float] = []
    heard: list[float] = []
    session.on("Network.loadingFinished", lambda event: files.append(event["encodedDataLength"]))
    session.on(
        "Network.webSocketFrameReceived",
        # What is not text (1) is told in base 64.
        lambda event: heard.append(
            len(event["response"]["payloadData"])
            * (1 if event["response"]["opcode"] == 1 else 0.75)
        ),
    )
    page.goto(address, wait_until="commit")
    page.evaluate(FIRST_PICTURE)
    page.wait_for_timeout(2000)
    page.close()
    return 1e-6 * sum(files), 1e-6 * sum(heard)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder, browser() as chrome:
        server = Server(Path(folder) / "log")
        try:
            server.wait()
            context = chrome.new_context(
                viewport={"width": 1280, "height": 720}, reduced_motion="reduce"
            )
            context.add_init_script(FIND)
            loaded, heard = weight(context, server.address)
            opened = []
            for repeat in range(6):
                page = context.new_page()
                start = time.perf_counter()
                page.goto(server.address, wait_until="commit")
                page.evaluate(FIRST_PICTURE)
                opened.append(1e3 * (time.perf_counter() - start))
                if repeat == 0:
                    page.wait_for_timeout(3000)
                    latency = slider_latency(page)
                    bursts = burst_latency(page)
                page.close()
            pictures = {
                name: paints_per_second(context, f"{server.address}?scene={name}&{ENDLESS}")
                for name in CATALOGUE
            }
        finally:
            server.stop()
    print(f"a page loads {loaded:.2f} MB, and hears {heard:.2f} MB")
    print(f"open to first picture: first {opened[0]:.0f}, then {statistics.median(opened[1:]):.0f}")
    print(
        f"slider to picture: median {statistics.median(latency):.0f}, "
        f"from {min(latency):.0f} to {max(latency):.0f} ({REPEATS} presses)"
    )
    print(
        f"last of {PRESSES} quick presses to its picture: median {statistics.median(bursts):.0f}, "
        f"from {min(bursts):.0f} to {max(bursts):.0f}"
    )
    for name, (least, most) in pictures.items():
        print(f"{name}: plots are painted {least:.1f} to {most:.1f} times a second")


if __name__ == "__main__":
    main()
