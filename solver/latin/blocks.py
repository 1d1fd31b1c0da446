"""Blocks of instants: what is local in time, done block by block, by as many threads as asked."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from itertools import pairwise

import scipy.linalg  # noqa: F401  # brings its own BLAS, which is looked for below
from threadpoolctl import ThreadpoolController

VALUES = 100_000
"""Least numbers of a boundary field in a block: of less, handing it to a thread costs a share of
the work (each of the seven hand-overs of an iteration takes some 0.05 ms)."""
MOST = 8
"""Blocks at most: enough for an even share among four threads. More make the matrix products of a
block small: 51 blocks instead of 8 take 6 % longer on one thread (measured)."""

ALL = slice(None)


class Blocks:
    """Instants of a boundary field cut into blocks, on which so many threads work at once.

    The blocks do not depend on the number of threads; nor do the results.
    """

    def __init__(self, n_rows: int, n_instants: int, threads: int = 1) -> None:
        count = min(max(n_rows * n_instants // VALUES, 1), MOST, n_instants)
        ends = (number * n_instants // count for number in range(count + 1))
        self.slices = [slice(first, last) for first, last in pairwise(ends)]
        workers = min(threads, count)
        self._pool = ThreadPoolExecutor(workers) if workers > 1 else None

    def each(self, work: Callable[[slice], None]) -> None:
        """Do some work for every block of instants."""
        if self._pool is None:
            for instants in self.slices:
                work(instants)
            return
        # Read to the end, so that an error in a thread is raised here.
        for _ in self._pool.map(work, self.slices):
            pass


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")


def one_blas_thread() -> AbstractContextManager[object]:
    """Have BLAS work on one thread meanwhile: products of few rows take longer on several."""
    if all(library.num_threads == 1 for library in _libraries().lib_controllers):
        return nullcontext()
    limit: AbstractContextManager[object] = _libraries().limit(limits=1)
    return limit
