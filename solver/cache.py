"""Cache of results between runs: those that load and friction do not change.

A run that follows another one often has the same bodies on the same mesh. What depends
on these alone is found again by its key: by everything that it was made from, so that a
kept result has the bits of a new one. Kept results are never changed.
"""

from __future__ import annotations

import hashlib
import sys
from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

LARGEST = 120_000_000
"""Largest memory of all kept results, B; a wall of 75 bricks takes 33 MB, a bundle of
19 wires 103 MB."""


Result = TypeVar("Result")


class Cache:
    """Cache of results by key, with a limit on memory: the oldest results go first.

    Parameters
    ----------
    largest
        Largest memory of all results together, B; a larger result is not kept.

    Attributes
    ----------
    nbytes
        Memory of all results, B, as each was when it was made.
    """

    def __init__(self, largest: int) -> None:
        self._largest = largest
        self.nbytes = 0
        # Results with their sizes, B: that of an object may change with its use.
        self._results: OrderedDict[Hashable, tuple[Any, int]] = OrderedDict()
        self._lock = Lock()

    def get(self, key: Hashable, make: Callable[[], Result]) -> Result:
        """Result of a key: from the cache, or made and stored.

        Parameters
        ----------
        key
            Everything that the result depends on.
        make
            Function that makes the result; one with arrays in it has `nbytes`.
        """
        with self._lock:
            if key in self._results:
                self._results.move_to_end(key)
                known: Result = self._results[key][0]
                return known
        result = make()
        size = _size_of(result)
        if size <= self._largest:
            self._keep(key, result, size)
        return result

    def _keep(self, key: Hashable, result: object, size: int) -> None:
        """Store a result of a size in B, and drop the oldest that no longer fit."""
        with self._lock:
            # Another thread may have kept the same result meanwhile.
            _, before = self._results.get(key, (None, 0))
            self.nbytes += size - before
            self._results[key] = (result, size)
            while self.nbytes > self._largest:
                _, (_, gone) = self._results.popitem(last=False)
                self.nbytes -= gone

    def clear(self) -> None:
        """Drop all results."""
        with self._lock:
            self._results.clear()
            self.nbytes = 0


def _size_of(result: object) -> int:
    """Memory of a result, B: its `nbytes`, as an array has, or that of the object."""
    return int(getattr(result, "nbytes", sys.getsizeof(result)))


CACHE = Cache(LARGEST)
"""The cache of this process."""


def content_of(*fields: NDArray[Any] | sparse.sparray) -> bytes:
    """Digest of arrays, dense or sparse, of any shape: equal for equal bits."""
    digest = hashlib.blake2b(digest_size=16)
    for field in fields:
        digest.update(f"{field.shape} {field.dtype}".encode())
        if isinstance(field, np.ndarray):
            digest.update(field.tobytes())
        else:
            rows = sparse.csr_array(field)
            digest.update(rows.data)
            digest.update(rows.indices)
            digest.update(rows.indptr)
    return digest.digest()
