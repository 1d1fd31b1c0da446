"""Time of a sweep besides its runs."""

from __future__ import annotations

import time

from solver.scenes.bar import BarSettings
from solver.study.sweep.executors import machine, opened, processors
from solver.study.sweep.plan import plan_of
from solver.study.sweep.run import sweep


def print_overhead(side: int) -> None:
    """Print the time of a square chart of the bar against that of its runs alone."""
    vary = [f"friction=0.1:0.6:{side}", f"peak=300:1500:{side}"]
    plan = plan_of(BarSettings.checked({}), vary, ["dissipation"])
    began = time.perf_counter()
    width = processors()
    with opened("processes") as executor:
        seconds = [row.seconds for row in sweep(plan, executor)]
        whole = time.perf_counter() - began
    alone = sum(seconds) / width
    print(machine())
    print(f"{plan.size} runs of the bar at Table 1 in {width} processes: {whole:.1f} s")
    print(f"their own seconds, over the number of processes: {alone:.1f} s")
    print(f"ratio: {whole / alone:.2f}")


if __name__ == "__main__":
    print_overhead(20)
