"""What a measured time depends on besides the code: processors and BLAS threads."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np
import scipy

ENDINGS = ("64_", "")
"""Of the names of functions in the OpenBLAS that wheels of NumPy and SciPy bring along."""
LIMITS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def machine() -> str:
    """Describe processors, BLAS threads and versions in a line."""
    processors = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    )
    threads = ", ".join(f"{_threads(part)} ({part.__name__})" for part in (np, scipy))
    return (
        f"{processors} processors; BLAS threads: {threads}; Python {sys.version.split()[0]}, "
        f"NumPy {np.__version__}, SciPy {scipy.__version__}"
    )


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep BLAS to one thread, where it lets itself be told.

    The matrices here are small: a second thread mostly waits, and where processors are shared it
    waits for them (measured: iterations of 0.3 ms that take 12 ms).
    """
    found = [library for part in (np, scipy) if (library := _openblas(part)) is not None]
    before = [_call(library, "get")() for library in found]
    try:
        for library in found:
            _call(library, "set")(1)
        yield
    finally:
        for library, number in zip(found, before, strict=True):
            _call(library, "set")(number)


def _threads(package: ModuleType) -> str:
    library = _openblas(package)
    if library is not None:
        return str(_call(library, "get")())
    said = [f"{limit}={os.environ[limit]}" for limit in LIMITS if limit in os.environ]
    return ", ".join(said) or "not limited"


def _openblas(package: ModuleType) -> ctypes.CDLL | None:
    """Find the OpenBLAS that a wheel brings along; None where there is none."""
    folder = Path(package.__path__[0])
    for place in (folder.parent / f"{folder.name}.libs", folder / ".dylibs"):
        for file in sorted(place.glob("*openblas*")):
            library = ctypes.CDLL(str(file))
            if _name(library, "get") and _name(library, "set"):
                return library
    return None


def _call(library: ctypes.CDLL, verb: str) -> ctypes._NamedFuncPointer:
    found: ctypes._NamedFuncPointer = getattr(library, _name(library, verb) or "")
    return found


def _name(library: ctypes.CDLL, verb: str) -> str | None:
    names = (f"scipy_openblas_{verb}_num_threads{ending}" for ending in ENDINGS)
    return next((name for name in names if hasattr(library, name)), None)
