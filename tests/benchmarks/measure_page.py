"""Measure a served page in headless Chromium, by its address.

`python tests/benchmarks/measure_page.py http://localhost:5006/app`

Prints, of a first visit and three more by the same person, seconds until the first
picture is painted and the bytes received; from a slider's move, by the mouse and by a
key, to the picture that it changes; and by scene how many pictures a second are painted
of a search without an end.
"""

from __future__ import annotations

import sys
import tempfile
import time
from statistics import median

from playwright.sync_api import BrowserContext, Locator, Page, sync_playwright

PULSE = (
    "Bokeh.documents.find(d => "
    "d.get_model_by_name('pulse'))?.get_model_by_name('pulse')"
)
PAINTED = f"(n) => window.Bokeh && Bokeh.documents.length && {PULSE}?.painted > n"
ANSWER = "start=nested&finish=at-once"
ENDLESS = (
    "method=paper&finish=none&start=zero&max_iterations=100000&tolerance=1e-30&k_scale=0.01"
    "&pace=20%20a%20second"
)
SECONDS = 5.0
MOVES = 11
REST = 700.0
"""Milliseconds between two moves, in which nothing is painted any more."""
NEXT = f"""(event) => {{
  const pulse = {PULSE}
  window.moved = new Promise((resolve) => addEventListener(event, () => {{
    const began = performance.now()
    const see = () => {{
      pulse.disconnect(pulse.properties.painted.change, see)
      resolve(performance.now() - began)
    }}
    pulse.connect(pulse.properties.painted.change, see)
  }}, {{once: true, capture: true}}))
}}"""


def measure(address: str) -> None:
    with sync_playwright() as driver:
        # A profile, as a person has it: without one, as in a private window, a browser
        # compiles all programs at each visit.
        context = driver.chromium.launch_persistent_context(
            tempfile.mkdtemp(),
            executable_path="/usr/bin/chromium",
            args=["--no-sandbox", "--disable-gpu"],
            viewport={"width": 1280, "height": 720},
        )
        for _ in range(4):
            seconds, received = opening(context, address)
            print(f"opens in {seconds:.2f} s, {received / 1e6:.2f} MB")
        page = context.new_page()
        for scene in ("bar", "block", "layers", "rope", "strand", "wall"):
            page.goto(f"{address}?scene={scene}&{ANSWER}")
            page.wait_for_function(PAINTED, arg=0, timeout=60_000)
            page.wait_for_timeout(2000.0)
            for way, to_picture in (
                ("slider", slider_to_picture),
                ("key", key_to_picture),
            ):
                taken = to_picture(page)
                print(
                    f"{scene}: {way} to picture {median(taken):.0f} ms, "
                    f"{max(taken):.0f} at most"
                )
                page.wait_for_timeout(2000.0)
        for scene in ("bar", "block", "layers", "rope"):
            page.goto(f"{address}?scene={scene}&{ENDLESS}")
            page.wait_for_function(PAINTED, arg=3, timeout=60_000)
            print(f"{scene}: {pictures_a_second(page):.1f} pictures a second")
            # A search without an end would go on beside the next scene's.
            page.keyboard.press(" ")
            page.wait_for_timeout(REST)
        context.close()


def opening(context: BrowserContext, address: str) -> tuple[float, float]:
    """Seconds until the first picture of a visit, and bytes received."""
    page = context.new_page()
    received = [0.0]
    network = context.new_cdp_session(page)
    network.send("Network.enable")
    network.on(
        "Network.loadingFinished",
        lambda event: received.append(event["encodedDataLength"]),
    )
    began = time.perf_counter()
    page.goto(address)
    page.wait_for_function(PAINTED, arg=0, timeout=60_000)
    seconds = time.perf_counter() - began
    page.close()
    return seconds, sum(received)


def slider_to_picture(page: Page) -> list[float]:
    """Milliseconds from each move of the friction's slider to the picture of it."""
    box = _friction(page).locator("xpath=..").bounding_box()
    assert box is not None
    x = box["x"] + box["width"] / 2
    y = box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.wait_for_timeout(REST)
    taken = []
    for move in range(MOVES):
        page.evaluate(NEXT, "pointermove")
        page.mouse.move(x + 5.0 * (move + 1), y)
        taken.append(page.evaluate("window.moved"))
        page.wait_for_timeout(REST)
    page.mouse.up()
    return taken


def key_to_picture(page: Page) -> list[float]:
    """Milliseconds from each key on the friction's slider to the picture of its run."""
    slider = _friction(page)
    taken = []
    for move in range(MOVES):
        page.evaluate(NEXT, "keydown")
        slider.press("ArrowLeft" if move % 2 else "ArrowRight")
        taken.append(page.evaluate("window.moved"))
        page.wait_for_timeout(REST)
    return taken


def _friction(page: Page) -> Locator:
    return page.get_by_role("slider", name="Friction coefficient").first


def pictures_a_second(page: Page) -> float:
    """Number of pictures that are painted in a second."""
    before = page.evaluate(f"{PULSE}.painted")
    began = time.perf_counter()
    page.wait_for_timeout(1e3 * SECONDS)
    return float(page.evaluate(f"{PULSE}.painted") - before) / (
        time.perf_counter() - began
    )


if __name__ == "__main__":
    measure(sys.argv[1])
