"""The command line: `python -m solver`, or `slipfront` where it is installed."""

import os
import sys

# The matrices are small: one thread is fastest.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")

try:
    from solver.cli import main
except KeyboardInterrupt:
    sys.exit(130)

if __name__ == "__main__":
    sys.exit(main())
