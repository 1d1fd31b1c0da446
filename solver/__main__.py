"""The command line: `python -m solver`, or `slipfront` where it is installed."""

import os
import signal
import sys

# The matrices are small: one thread is fastest.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")

# Ctrl-C while libraries are imported ends the process at once: one of them would else
# be left half imported, and complain. Who ignores it from the start goes on to.
_is_heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if _is_heard:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from solver.commands.cli import main  # noqa: E402

if _is_heard:
    signal.signal(signal.SIGINT, signal.default_int_handler)

if __name__ == "__main__":
    sys.exit(main())
