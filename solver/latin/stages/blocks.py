"""Blocks of instants, for several threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from itertools import pairwise
from threading import Lock

import scipy.linalg  # noqa: F401  # brings its own BLAS, which `OneBlasThread` limits
from threadpoolctl import ThreadpoolController

VALUES = 100_000
"""Smallest count of numbers of a boundary field in a block: with less the handing to a
thread costs a share of the work (each of the seven hand-overs of an iteration takes
some 0.05 ms)."""
MOST = 8
"""Largest number of blocks: enough for an even share among four threads. More make the
matrix products of a block small: 51 blocks instead of 8 take 6 % longer on one thread
(measured)."""
ALL = slice(None)
"""All instants."""


class Blocks:
    """Blocks of the instants of a boundary field, for several threads.

    Neither the blocks nor the results depend on the number of threads.

    Parameters
    ----------
    n_rows, n_instants
        Shape of a boundary field.
    threads
        Largest number of threads.
    """

    def __init__(self, n_rows: int, n_instants: int, threads: int = 1) -> None:
        # By the size alone: results must not depend on the machine.
        count = min(max(n_rows * n_instants // VALUES, 1), MOST, n_instants)
        ends = [number * n_instants // count for number in range(count + 1)]
        self.slices = [slice(first, last) for first, last in pairwise(ends)]
        workers = min(threads, count)
        self._pool: ThreadPoolExecutor | None = None
        if workers > 1:
            self._pool = ThreadPoolExecutor(workers)

    def each(self, work: Callable[[slice], None]) -> None:
        """Call `work` for every block of instants."""
        if self._pool is None:
            for instants in self.slices:
                work(instants)
            return
        # Read to the end, so that an error in a thread is raised here.
        for _ in self._pool.map(work, self.slices):
            pass


class OneBlasThread:
    """Context that limits BLAS to one thread: faster for products of few rows.

    It may be entered several times; the last to leave lifts the limit.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._inside = 0
        self._libraries = ThreadpoolController().select(user_api="blas")
        self._limits = ExitStack()

    def __enter__(self) -> None:
        with self._lock:
            if not self._inside:
                self._limit()
            self._inside += 1

    def _limit(self) -> None:
        """Limit BLAS to one thread, unless it has one already."""
        libraries = self._libraries.lib_controllers
        if any(library.num_threads > 1 for library in libraries):
            self._limits.enter_context(self._libraries.limit(limits=1))

    def __exit__(self, *_raised: object) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside:
                self._limits.close()


one_blas_thread = OneBlasThread()
