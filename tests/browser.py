"""A served page and a browser to look at it, for the tests and measurements of the page."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, Playwright, ViewportSize, sync_playwright
from processes import PATIENCE

ROOT = Path(__file__).resolve().parents[1]


def _heed_interrupts() -> None:
    """Undo what a shell does to all that it runs in the background: it has interrupts ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
    return number


NO_BROWSER = "the page tests need Chromium: apt-get install chromium"


def chromium() -> str:
    """Find the system's Chromium; skip the test without one, where nobody promised one (CI)."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    if os.environ.get("CI"):
        pytest.fail(NO_BROWSER, pytrace=False)
    pytest.skip(NO_BROWSER)


@contextmanager
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        try:
            yield opened
        finally:
            opened.close()


class Chrome:
    """A browser whose windows are used again, each by one page at a time.

    A window that has shown a page opens the next in half of the processor's time: the programs of
    the page are compiled there. What pages store themselves goes with them.
    """

    def __init__(self, playwright: Playwright) -> None:
        self._browser = playwright.chromium.launch(executable_path=chromium(), args=FLAGS)
        self._free: dict[tuple[tuple[str, Any], ...], list[Page]] = {}
        self._used: dict[Page, list[Page]] = {}

    def new_page(self, width: int = 1280, height: int = 720, **device: Any) -> Page:
        """Open an empty page of a size, on a device of a kind; nothing moves by itself on it."""
        device = {"reduced_motion": "reduce", **device}
        free = self._free.setdefault(tuple(sorted(device.items())), [])
        page = free.pop() if free else self._browser.new_page(**device)
        self._used[page] = free
        page.set_default_timeout(1e3 * PATIENCE)
        page.set_viewport_size(ViewportSize(width=width, height=height))
        return page

    def leave(self, page: Page) -> None:
        """Close a page: what it has stored is forgotten, and its window is free for another."""
        page.evaluate("localStorage.clear(), sessionStorage.clear()")
        page.context.clear_cookies()
        page.emulate_media(color_scheme="light")
        page.mouse.move(0.0, 0.0)
        page.goto("about:blank")
        self._used.pop(page).append(page)

    def close(self) -> None:
        """End it, with all its windows."""
        self._browser.close()


class Server:
    """`panel serve app` in a process group of its own, or another command that serves the page."""

    def __init__(
        self,
        log: Path,
        port: int = 0,
        *options: str,
        serves: Sequence[str] = (),
        place: Path = ROOT,
    ) -> None:
        port = port or free_port()
        self.port = port
        self.address = f"http://localhost:{port}/app"
        self.health = f"http://localhost:{port}/liveness"
        self._log = log
        # The script, as a user calls it: `python -m panel` finds modules that it does not.
        panel = str(Path(sys.executable).with_name("panel"))
        serves = serves or (panel, "serve", "app")
        command = [*serves, "--port", str(port), "--liveness", *options]
        with log.open("w") as output:
            self._process = subprocess.Popen(
                command,
                cwd=place,
                stdout=output,
                stderr=output,
                start_new_session=True,
                preexec_fn=_heed_interrupts,
            )

    def wait(self, seconds: float = PATIENCE) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            code = self._process.poll()
            assert code is None, f"the server has ended with code {code}:\n{self.log}"
            try:
                urllib.request.urlopen(self.health, timeout=1).close()
            except OSError:
                time.sleep(0.1)
            else:
                return
        raise TimeoutError(self.log)

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def log(self) -> str:
        return self._log.read_text()

    def processes(self) -> list[int]:
        """Give the processes of the server's session, itself included."""
        found = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    fields = (entry / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if fields[0] != "Z" and int(fields[3]) == self._process.pid:
                    found.append(int(entry.name))
        return found

    def stop(self, number: int = signal.SIGTERM) -> None:
        if self._process.poll() is None:
            os.kill(self._process.pid, number)
            self._process.wait(PATIENCE)
