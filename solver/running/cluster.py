"""The workers of a Dask cluster as an executor; the only module that needs `distributed`."""

from __future__ import annotations

import logging
import time
from asyncio import CancelledError
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from typing import Any

from distributed import Client
from distributed.scheduler import KilledWorker

from solver.definitions import SettingError
from solver.running.pool import EndedError, GoneError, Pool

PATIENCE = 10.0
"""Seconds that a scheduler has to answer."""
FRESH = 1.0
"""Seconds for which the number of workers is taken for known."""


# A scheduler that is gone is told in a line; the client logs it with its traceback besides.
logging.getLogger("distributed.client").setLevel(logging.CRITICAL)


class Caller(Client):  # type: ignore[misc]  # its types are not read
    """A client that is closed where it finds no scheduler.

    One that was left open is closed when its memory is collected. If that is while another client
    is made, both wait for the same lock, for ever.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        try:
            super().__init__(*args, **kwargs)
        except (OSError, ValueError):
            self.close()
            raise


class Cluster(Pool):
    """Workers of a scheduler, which come and go; those that are lost have their calls done again.

    Parameters
    ----------
    address
        `HOST:PORT` of the scheduler.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        try:
            self._client = Caller(f"tcp://{address}", timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as problem:
            answers = "the HOST:PORT of a Dask scheduler that answers"
            reason = f"{type(problem).__name__}: {problem}".splitlines()[0]
            raise SettingError("--on", f"dask://{address}", answers, reason) from None
        # Equal calls are not one call: a piece that was lost is asked for again.
        self._executor = self._client.get_executor(pure=False)
        self._width, self._counted = 1, 0.0

    @property
    def width(self) -> int:
        """Number of threads of all workers; one while there are none, for those that may come."""
        now = time.monotonic()
        if now - self._counted > FRESH:
            with self._answering():
                self._width, self._counted = sum(self._client.nthreads().values()), now
        return max(1, self._width)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have something done by a worker, which has to know the function by its name."""
        with self._answering():
            return Remote(self._executor.submit(fn, *args, **kwargs), self._client)

    @contextmanager
    def _answering(self) -> Iterator[None]:
        """Tell that the scheduler is gone, where what it was asked for shows that it is."""
        try:
            yield
        except (Exception, CancelledError) as trouble:
            is_told = isinstance(trouble, OSError | RuntimeError | CancelledError)
            if not is_told and not _is_closed(self._client):
                raise
            where = self._address
            raise GoneError(f"the scheduler at {where} does not answer any more") from trouble

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leave the cluster; it forgets what is not done yet if futures are to be cancelled."""
        # One that is gone takes no leave, whatever its client says to that.
        with suppress(Exception, CancelledError):
            self._executor.shutdown(wait=wait and not cancel_futures)
            self._client.close()


class Remote(Future[Any]):
    """A call whose loss with its worker is an `EndedError`, as it is on this machine."""

    def __init__(self, call: Future[Any], client: Client) -> None:
        super().__init__()
        self._call, self._client = call, client
        self.set_running_or_notify_cancel()
        call.add_done_callback(self._hear)

    def cancel(self) -> bool:
        """Have the cluster forget the call; what a worker is at goes on until it is done."""
        # One that is closed can tell nobody, and says that with a stack.
        return not _is_closed(self._client) and self._call.cancel()

    def _hear(self, call: Future[Any]) -> None:
        if call.cancelled():
            self.set_exception(EndedError("it was cancelled"))
            return
        trouble = call.exception()
        if trouble is None:
            self.set_result(call.result())
        elif isinstance(trouble, KilledWorker | OSError):
            self.set_exception(EndedError("its workers were lost"))
        else:
            self.set_exception(trouble)


def _is_closed(client: Client) -> bool:
    """Tell whether a client has given up its scheduler, by itself too."""
    return client.status in ("closing", "closed")
