"""Share of fits whose margins of two standard errors hold the values behind a loop.

    python tests/benchmarks/fit_coverage.py 40            seeds 0 to 39 of all kinds
    python tests/benchmarks/fit_coverage.py 40 20 young   20 to 39 of kinds with young

A loop is made by a run of a small bar, to whose displacement noise of 1 % of its range
is added. What the seed draws: the settings that made the loop, where the fit begins,
the peak of the load as a share of that which the whole bar takes, the number of
elements, and the noise.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import dataclass

import numpy as np

from solver.scenes.bar import BarSettings
from solver.settings.scene import Settings
from solver.study.fit import Fit, fit
from solver.study.measured_loop import MeasuredLoop
from solver.study.scene_run import finished_run

COMPLIANT = {"friction_law": "compliant"}
GENERAL = {"friction_law": "general", "cycles": 2}
KINDS: dict[tuple[str, ...], dict[str, object]] = {
    ("friction",): {},
    ("friction", "young"): {},
    ("friction", "contact_stiffness"): COMPLIANT,
    ("friction", "young", "contact_stiffness"): COMPLIANT,
    ("friction", "pressure"): {},
    ("friction", "cohesion", "friction_cap"): GENERAL,
    ("friction", "tangential_stiffness", "cohesion"): GENERAL,
    ("friction", "cohesion", "tangential_stiffness", "young"): GENERAL,
}
"""What is fitted, and under which law."""
RANGES = {
    "friction": (0.1, 0.8),
    "young": (3e10, 3e11),
    "contact_stiffness": (2.0, 100.0),
    "pressure": (2000.0, 10_000.0),
    "cohesion": (100.0, 900.0),
    "tangential_stiffness": (1e7, 1e9),
    "friction_cap": (1500.0, 4000.0),
}
"""Between which what made a loop is drawn, evenly in its logarithm."""
OFF = 0.5
"""How far from there a fit begins at most, in the logarithm."""
ELEMENTS = 16, 20, 25
INSTANTS = 41
NOISE = 0.01
HEAD = "fitted", "loops", "known", "within", "products", "within", "runs", "s"


@dataclass(frozen=True, eq=False)
class MadeLoop:
    """A made loop: settings from which a fit begins, and the values that made it."""

    start: Settings
    true: dict[str, float]
    measured: MeasuredLoop


def loop_of(settings: Settings, noise: float, rng: np.random.Generator) -> MeasuredLoop:
    """Loop of a run as measured, with noise as a share of the displacement's range."""
    run = finished_run(settings, errors=False, indicators=False)
    loop = settings.structure().loop(run.problem)
    size = noise * np.ptp(run.displacement)
    displacement = run.displacement + size * rng.standard_normal(len(run.displacement))
    units = loop.across[1], loop.up[1]
    times = run.problem.instants
    return MeasuredLoop(displacement, run.force, times, units, "made.csv", "")


def made_loop(names: tuple[str, ...], seed: int) -> MadeLoop:
    """The loop of a seed by which some settings are to be found."""
    rng = np.random.default_rng([seed, len(names), len(names[-1])])
    true = {}
    start = {}
    for name in names:
        low, high = np.log(RANGES[name])
        true[name] = float(np.exp(rng.uniform(low, high)))
        start[name] = true[name] * float(np.exp(rng.uniform(-OFF, OFF)))
    bar = BarSettings.checked({})
    largest = (
        true["friction"] * true.get("pressure", bar.values()["pressure"]) * bar.length
    )
    settings = BarSettings.checked(
        KINDS[names]
        | true
        | {
            "load": "cycle",
            "peak": rng.uniform(0.2, 0.98) * largest,
            "elements": int(rng.choice(ELEMENTS)),
            "substructures": 4,
            "instants": INSTANTS,
        }
    )
    measured = loop_of(settings, NOISE, rng)
    return MadeLoop(settings.replace(**start), true, measured)


def judge(found: Fit, true: dict[str, float]) -> tuple[list[bool], list[bool]]:
    """Check whether true values are in the margins: settings alone, and products."""
    values = np.array(list(true.values()))
    is_known = np.isfinite(found.errors)
    is_within = (found.lower <= values) & (values <= found.upper)
    products = []
    for one in found.together:
        product = math.prod(true[name] ** power for name, power in one.powers.items())
        products.append(one.lower <= product <= one.upper)
    return is_within[is_known].tolist(), products


def measure(names: tuple[str, ...], seeds: range) -> list[str]:
    """Row of the table: results of a number of fits."""
    settings: list[bool] = []
    products: list[bool] = []
    runs = 0
    began = time.perf_counter()
    for seed in seeds:
        made = made_loop(names, seed)
        found = fit(made.start, made.measured, names)
        known, combined = judge(found, made.true)
        if not all(known + combined):
            report(seed, found, made.true)
        settings += known
        products += combined
        runs += found.runs
    seconds = (time.perf_counter() - began) / len(seeds)
    asked = len(seeds) * len(names)
    return [
        ", ".join(names),
        str(len(seeds)),
        f"{len(settings)} of {asked}",
        share(settings),
        str(len(products)),
        share(products),
        f"{runs / len(seeds):.0f}",
        f"{seconds:.1f}",
    ]


def report(seed: int, found: Fit, true: dict[str, float]) -> None:
    """Print what is outside of its margins."""
    rows = zip(
        true.items(), found.nearest.values, found.lower, found.upper, strict=True
    )
    for (name, made), value, lower, upper in rows:
        print(
            f"seed {seed}: {name} {value:.4g}, {lower:.4g} to {upper:.4g}, made "
            f"{made:.4g}"
        )
    for one in found.together:
        product = math.prod(true[name] ** power for name, power in one.powers.items())
        print(f"  {one.powers} {one.lower:.4g} to {one.upper:.4g}, made {product:.4g}")
    sys.stdout.flush()


def share(hits: list[bool]) -> str:
    """Share of what holds."""
    if not hits:
        return "-"
    return f"{sum(hits)} = {100.0 * np.mean(hits):.1f} %"


def main() -> None:
    """Print a line of each kind of loops."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stop", nargs="?", type=int, default=40, help="last seed + 1")
    parser.add_argument("begin", nargs="?", type=int, default=0, help="first seed")
    parser.add_argument("fitted", nargs="*", help="settings that a kind has to have")
    given = parser.parse_args()
    print("; ".join(HEAD))
    for kind in KINDS:
        if all(name in kind for name in given.fitted):
            print("; ".join(measure(kind, range(given.begin, given.stop))), flush=True)


if __name__ == "__main__":
    main()
