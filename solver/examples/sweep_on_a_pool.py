"""A sweep on a pool of processes: friction takes energy as the load's third power."""

import numpy as np

from solver.scenes import CATALOGUE
from solver.study.sweep.executors import opened
from solver.study.sweep.plan import plan_of
from solver.study.sweep.run import sweep

CHANGES = {"load": "ramp", "elements": 200, "substructures": 5}


def main() -> None:
    """Run the plan, and print its answers beside the closed form F^3 / (6 E S q)."""
    settings = CATALOGUE["bar"].checked(CHANGES)
    plan = plan_of(settings, ["peak=300:900:4"], ["dissipation"])
    peaks = []
    energies = []
    with opened("processes:2") as executor:
        for row in sweep(plan, executor):
            peaks.append(plan.point(row.number)["peak"])
            energies.append(row.values[0])
            print(f"peak {peaks[-1]:g} N: {row.ending}, {energies[-1]:.5g} J")

    strength = settings.friction * settings.pressure
    exact = max(peaks) ** 3 / (6.0 * settings.young * settings.section * strength)
    power, _ = np.polyfit(np.log(peaks), np.log(energies), 1)
    print("power:", power)
    print("largest over closed form:", max(energies) / exact)


if __name__ == "__main__":  # each process of the pool imports this file
    main()
