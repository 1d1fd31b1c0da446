"""Text that is markup, and pages that are watched lest it runs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Dialog, Page, Request

QUIET = 500.0
"""Milliseconds in which what was made of markup has run."""
MARKUP = "<img/src='x'/onerror='window.ran=1'>[go](javascript:window.ran=1)"
"""Runs wherever it is taken for HTML or Markdown."""


@contextmanager
def watched(page: Page) -> Iterator[None]:
    """Check that text written for a page has not become a part of it, nor run."""
    done: list[str] = []

    def ask(request: Request) -> None:
        done.append(request.url)

    def speak(dialog: Dialog) -> None:
        done.append(f"dialog/{dialog.message}/x")
        dialog.dismiss()

    page.on("request", ask)
    page.on("dialog", speak)
    yield
    page.wait_for_timeout(QUIET)
    page.remove_listener("request", ask)
    page.remove_listener("dialog", speak)
    assert page.evaluate("window.ran") is None
    assert page.locator("img[src='x'], a[href^='javascript:']").count() == 0
    assert not [what for what in done if what.endswith("/x")]
