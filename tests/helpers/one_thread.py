"""A single BLAS thread for every process of the tests, as the workers have it.

Those of several processes spin against each other, and a dense factor takes twenty
times as long.
"""

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
