"""Measure a served page in headless Chromium: `python tests/measure_page.py http://localhost:5006/app`.

Prints, of a first visit and three more, seconds until the first picture is painted and the bytes
received; and by scene how many pictures a second are painted of a search without an end.
"""

from __future__ import annotations

import sys
import time

from playwright.sync_api import sync_playwright

PULSE = "Bokeh.documents.find(d => d.get_model_by_name('pulse'))?.get_model_by_name('pulse')"
PAINTED = f"(n) => window.Bokeh && Bokeh.documents.length && {PULSE}?.painted > n"
ENDLESS = (
    "method=paper&finish=none&start=zero&max_iterations=100000&tolerance=1e-30&k_scale=0.01"
    "&pace=20%20a%20second"
)
SECONDS = 5.0


def measure(address: str) -> None:
    with sync_playwright() as driver:
        chromium = driver.chromium.launch(
            executable_path="/usr/bin/chromium", args=["--no-sandbox", "--disable-gpu"]
        )
        context = chromium.new_context(viewport={"width": 1280, "height": 720})
        for _ in range(4):
            page, received = context.new_page(), [0.0]
            network = context.new_cdp_session(page)
            network.send("Network.enable")
            network.on(
                "Network.loadingFinished",
                lambda event, received=received: received.append(event["encodedDataLength"]),
            )
            began = time.perf_counter()
            page.goto(address)
            page.wait_for_function(PAINTED, arg=0, timeout=60_000)
            print(f"opens in {time.perf_counter() - began:.2f} s, {sum(received) / 1e6:.2f} MB")
            page.close()
        page = context.new_page()
        for scene in ("bar", "block", "layers", "rope"):
            page.goto(f"{address}?scene={scene}&{ENDLESS}")
            page.wait_for_function(PAINTED, arg=3, timeout=60_000)
            before, began = page.evaluate(f"{PULSE}.painted"), time.perf_counter()
            page.wait_for_timeout(1e3 * SECONDS)
            pictures = page.evaluate(f"{PULSE}.painted") - before
            print(f"{scene}: {pictures / (time.perf_counter() - began):.1f} pictures a second")
        chromium.close()


if __name__ == "__main__":
    measure(sys.argv[1])
