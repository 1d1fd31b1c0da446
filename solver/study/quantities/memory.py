"""The memory of a run: by how much the resident memory of a process of its own grows at most.

Allocations that Python counts would leave out what sparse factorisations take. So a run is made in
a fresh process, after tiny ones that bring in the code; what the operating system says of its
resident memory then is subtracted from the highest value at the end.
"""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from solver.executors import ONE_THREAD
from solver.scenes import CATALOGUE
from solver.settings import Settings
from solver.study.quantities.finished import finished_run

STATUS = Path("/proc/self/status")
ROOT = Path(__file__).resolve().parents[3]
PROGRAM = f"import json, sys\nfrom {__name__} import answer\nprint(answer(json.load(sys.stdin)))"
TINY: dict[str, dict[str, object]] = {
    "bar": {"elements": 4, "substructures": 2, "instants": 3},
    "block": {"elements": 4, "elements_up": 2, "substructures": 2, "instants": 3},
}
"""Runs that go before: to bring in code is no part of a run's memory, nor of its time."""


def memory_of(settings: Settings) -> float:
    """Memory that a scene takes, B, by one run more; NaN where the system says none (not Linux)."""
    if not STATUS.exists():
        return math.nan
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input=json.dumps({"scene": settings.scene, "changed": settings.changed()}),
        env=os.environ | ONE_THREAD | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return float(done.stdout)


@cache
def settle() -> None:
    """Make tiny runs, once in a process, after which a run brings in no code any more."""
    for scene, tiny in TINY.items():
        finished_run(CATALOGUE[scene].settings.checked(tiny))


def answer(asked: dict[str, Any]) -> int:
    """Memory that a run of these settings took in this process, B."""
    settings = CATALOGUE[asked["scene"]].settings.checked(asked["changed"])
    settle()
    before = resident("VmRSS")
    finished_run(settings, errors=False, indicators=False)
    return resident("VmHWM") - before


def resident(name: str) -> int:
    """A line of what the operating system says of this process, B."""
    line = re.search(rf"^{name}:\s+(\d+) kB$", STATUS.read_text(encoding="ascii"), re.MULTILINE)
    if line is None:
        raise LookupError(name)
    return 1024 * int(line[1])
