"""A served page and a browser, for tests and measurements of the page."""

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
from playwright.sync_api import Page, Playwright, expect
from processes import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
NO_BROWSER = "the page tests need Chromium: apt-get install chromium"


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number: int = free.getsockname()[1]
    return number


def chromium() -> str:
    """The system's Chromium; without it the test is skipped, but not on CI."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    if os.environ.get("CI"):
        pytest.fail(NO_BROWSER, pytrace=False)
    pytest.skip(NO_BROWSER)


class Chrome:
    """A browser whose windows are used again, each by one page at a time.

    A window that has shown a page opens the next in half of the processor's time: the
    programs of the page are compiled there. What pages store themselves goes with them.
    """

    def __init__(self, playwright: Playwright) -> None:
        self._browser = playwright.chromium.launch(
            executable_path=chromium(), args=FLAGS
        )
        self._free: dict[tuple[tuple[str, Any], ...], list[Page]] = {}
        self._used: dict[Page, list[Page]] = {}
        expect.set_options(timeout=1e3 * PATIENCE)

    def new_page(self, width: int = 1280, height: int = 720, **device: Any) -> Page:
        """An empty page of a size, on a device of a kind."""
        free = self._free.setdefault(tuple(sorted(device.items())), [])
        if free:
            page = free.pop()
        else:
            page = self._browser.new_page(**device)
        self._used[page] = free
        page.set_default_timeout(1e3 * PATIENCE)
        page.set_viewport_size({"width": width, "height": height})
        return page

    def leave(self, page: Page) -> None:
        """Close a page: its store is forgotten, and its window is free for another."""
        page.evaluate("localStorage.clear(), sessionStorage.clear()")
        page.context.clear_cookies()
        page.mouse.move(0.0, 0.0)
        page.goto("about:blank")
        self._used.pop(page).append(page)

    def close(self) -> None:
        """End it, with all its windows."""
        self._browser.close()


class Server:
    """`panel serve app`, or another command, in a process group of its own."""

    def __init__(
        self,
        log: Path,
        port: int = 0,
        *options: str,
        serves: Sequence[str] = (),
        place: Path = ROOT,
    ) -> None:
        self.port = port or free_port()
        self.root = f"http://localhost:{self.port}"
        self.address = f"{self.root}/app"
        self.health = f"{self.root}/liveness"
        self._log = log
        # The script, as a user calls it: `python -m panel` finds modules that it does
        # not.
        panel = str(Path(sys.executable).with_name("panel"))
        serves = serves or (panel, "serve", "app")
        with log.open("w") as output:
            self._process = subprocess.Popen(
                [*serves, "--port", str(self.port), "--liveness", *options],
                cwd=place,
                stdout=output,
                stderr=output,
                start_new_session=True,
                preexec_fn=_take_interrupts,
            )

    def wait(self, seconds: float = PATIENCE) -> None:
        """Wait until it answers."""
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
        """Number of its process."""
        return self._process.pid

    @property
    def log(self) -> str:
        """Text that the process has printed."""
        return self._log.read_text()

    def processes(self) -> list[int]:
        """The processes of its session, itself included, the oldest first."""
        pids = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                try:
                    fields = (entry / "stat").read_text().rpartition(")")[2].split()
                except OSError:
                    continue
                if fields[0] != "Z" and int(fields[3]) == self._process.pid:
                    pids.append((int(fields[19]), int(entry.name)))
        return [pid for _, pid in sorted(pids)]

    def stop(self, number: int = signal.SIGTERM) -> None:
        """End it."""
        if self._process.poll() is None:
            os.kill(self._process.pid, number)
            self._process.wait(PATIENCE)


@contextmanager
def serving(log: Path, port: int = 0, *options: str, **more: Any) -> Iterator[Server]:
    """A server that answers, and ends in any case."""
    server = Server(log, port, *options, **more)
    try:
        server.wait()
        yield server
    finally:
        server.stop()


def _take_interrupts() -> None:
    """Undo what a shell does to all that it runs in the background:
    it has interrupts ignored.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
