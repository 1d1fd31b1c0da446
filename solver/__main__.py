"""The command line: `python -m solver`, or `slipfront` where it is installed."""

import os
import signal
import sys

# The matrices are small: one thread is fastest.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_threads, "1")

# Ctrl-C while libraries are imported ends the process at once: one of them would else
# be left half imported, and complain. A process that ignores it continues to do so.
_is_heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if _is_heard:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from solver.commands import cli  # noqa: E402
from solver.commands.console import INTERRUPTED  # noqa: E402


def main() -> int:
    """Run the command of the arguments; return its exit code."""
    try:
        if _is_heard:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        return cli.main()
    except KeyboardInterrupt:  # before or after all that `cli.main` guards
        return INTERRUPTED
    finally:
        # Python would complain of an exit that is interrupted.
        if _is_heard:
            signal.signal(signal.SIGINT, signal.SIG_DFL)


if __name__ == "__main__":
    sys.exit(main())
