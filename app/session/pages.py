"""The pages that a server has open: how many there may be, and how many have a run at work."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Protocol

from app.session.inquiry import LENDER
from app.session.page_worker import PageWorker

VARIABLE = "SLIPFRONT_PAGES"
"""Environment variable with the most pages that may be open."""
OF_A_PAGE = 150_000_000
"""Bytes that a page may need, most of them in its worker: 70 to 90 MB at the size of Table 1."""
SHARE = 0.8
"""Of the machine's memory, or the container's, that pages may take together."""


class Working(Protocol):
    """A page that may have a run at work."""

    worker: PageWorker

    @property
    def is_at_work(self) -> bool:
        """Whether its run goes on at present."""


class Pages:
    """The pages that are open.

    Parameters
    ----------
    most
        How many there may be.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._open: list[Working] = []

    def __len__(self) -> int:
        return len(self._open)

    @property
    def workers(self) -> int:
        """Count the worker processes of the pages."""
        return sum(page.worker.has_process for page in self._open)

    @property
    def is_full(self) -> bool:
        """Whether no other page may be opened."""
        return len(self) >= self._most

    def add(self, page: Working) -> None:
        """Count a page that opens."""
        self._open.append(page)

    def remove(self, page: Working) -> None:
        """Forget a page that is closed."""
        self._open = [other for other in self._open if other is not page]

    def at_work_beside(self, page: Working) -> int:
        """Count the other pages whose runs are at work, and the charts that fill, of any page."""
        return sum(other.is_at_work for other in self._open if other is not page) + LENDER.users


def most_pages() -> int:
    """Give the most pages that may be open, as set, or as the memory allows."""
    if text := os.environ.get(VARIABLE):
        return max(int(text), 1)
    return max(int(SHARE * _memory() / OF_A_PAGE), 1)


def _memory() -> float:
    """Give the bytes that this machine has, or this container may use."""
    pages, size = os.sysconf("SC_PHYS_PAGES"), os.sysconf("SC_PAGE_SIZE")
    limit = Path("/sys/fs/cgroup/memory.max")
    text = limit.read_text().strip() if limit.exists() else "max"
    return min(float(pages * size), float("inf") if text == "max" else float(text))
