"""The command line: `python -m solver`, or `slipfront` where it is installed."""

import os
import sys

for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")

from solver.cli import main  # noqa: E402  # the matrices are small: one thread is fastest

if __name__ == "__main__":
    sys.exit(main())
