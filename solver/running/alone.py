"""A module's work in a fresh process with one BLAS thread, beside nothing of the caller's."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from solver.running.processes import ONE_THREAD

ROOT = Path(__file__).resolve().parents[2]


def alone(module: str, asked: dict[str, Any]) -> Any:
    """Call `answer(asked)` of a module there; both ways are JSON.

    Raises
    ------
    subprocess.CalledProcessError
        If it failed; what it printed of that is on the standard error.
    """
    program = f"import json, sys\nfrom {module} import answer\n"
    program += "print(json.dumps(answer(json.load(sys.stdin))))"
    done = subprocess.run(
        [sys.executable, "-c", program],
        input=json.dumps(asked),
        env=os.environ | ONE_THREAD | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)
