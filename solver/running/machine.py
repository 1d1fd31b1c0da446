"""What a measured time depends on besides the code: processors and BLAS threads."""

from __future__ import annotations

import os
import sys

import numpy as np
import scipy

LIMITS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""What `python -m solver` sets to 1 before it imports NumPy, unless its user said otherwise."""


def processors() -> int:
    """Count the processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def machine() -> str:
    """Describe processors, BLAS threads and versions in a line."""
    limits = {os.environ[name] for name in LIMITS if name in os.environ}
    return (
        f"{processors()} processors; BLAS threads: {', '.join(sorted(limits)) or 'not limited'}; "
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, SciPy {scipy.__version__}"
    )
