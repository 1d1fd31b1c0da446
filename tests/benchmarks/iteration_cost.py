"""Cost of an iteration by stage, beside the arithmetic that it cannot do without.

`python tests/benchmarks/iteration_cost.py`, `iteration_cost.py 3` with medians of three
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

import numpy as np
from reduction_cost import medians_of, samples_of, step_of

from solver.arrays import space_time
from solver.discrete.problem import Problem
from solver.latin import Full, Iterate, StopState, iterations, solve
from solver.latin.end.estimate import ErrorEstimate
from solver.latin.iteration import Iteration
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.linear import LinearStage
from solver.latin.stages.local import LocalStage
from solver.latin.stages.response import DenseResponse
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of
from solver.settings.scene import Settings

SIZES = ((51, 101), (201, 101), (1001, 101), (1001, 1001))


@dataclass(frozen=True)
class Cost:
    """Median seconds of one iteration's parts.

    Attributes
    ----------
    local, coarse, linear
        Local stage; coarse problem; gathering, relaxation, elasticity and scattering.
    floor
        The matrix product and the element-wise passes alone: a step of the friction law
        for every point and instant, the reflections, the relaxation.
    """

    nodes: int
    instants: int
    local: float
    coarse: float
    linear: float
    floor: float

    @property
    def iteration(self) -> float:
        """Seconds of the whole iteration."""
        return self.local + self.coarse + self.linear


def iteration_cost(nodes: int, instants: int, repeats: int) -> Cost:
    """Measure the stages and the floor, interleaved, in one run.

    Parameters
    ----------
    nodes, instants
        Size of the friction bar; 10 substructures, multiscale, relaxation 0.8.
    repeats
        Measurements of each, whose median is taken.
    """
    settings = BarSettings.checked(
        {"method": "paper", "elements": nodes - 1, "instants": instants}
    )
    parts = _parts_of(settings)
    number = max(3, int(2e6 / (nodes * instants)))
    of_local, of_mono, of_multi, of_floor = medians_of(parts, repeats, number)
    coarse = max(of_multi - of_mono, 0.0)
    return Cost(nodes, instants, of_local, coarse, of_mono, of_floor)


def _parts_of(settings: Settings) -> list[Callable[[], object]]:
    """Local stage; linear stage without and with a coarse problem; the floor."""
    problem = discretise(settings)
    k = method_of(settings).direction.of(problem)
    blocks = Blocks(problem.n_rows, problem.n_instants)
    local = LocalStage(problem, k, blocks)
    multi = LinearStage(problem, k, Full(), blocks, multiscale=True)
    mono = LinearStage(problem, k, Full(), blocks, multiscale=False)
    multi.restore(None)
    mono.restore(None)
    incoming = space_time(problem.n_rows, problem.n_instants)
    target = local(incoming)
    return [
        lambda: local(incoming),
        step_of(mono, target),
        step_of(multi, target),
        _floor(problem, multi),
    ]


def _floor(problem: Problem, stage: LinearStage) -> Callable[[], None]:
    law = problem.friction
    friction = np.zeros((4, problem.n_instants, len(law.points)))
    low, high, before, after = friction
    rows = np.zeros((3, problem.n_instants, problem.n_rows))
    one, two, three = rows
    products = [
        (
            np.eye(len(group.k)),
            group.target.reshape(len(group.k), -1, order="F"),
            group.field(),
        )
        for group in stage.groups
        if isinstance(group.response, DenseResponse)
    ]

    def passes() -> None:
        np.subtract(before, 1.0, out=low)
        np.add(before, 1.0, out=high)
        np.maximum(before, low, out=after)
        np.minimum(after, high, out=after)
        np.multiply(one, 2.0, out=two)
        np.subtract(two, three, out=two)
        np.subtract(two, three, out=one)
        np.multiply(one, 0.8, out=one)
        np.add(three, one, out=three)
        for matrix, columns, out in products:
            np.matmul(matrix, columns, out=out.reshape(len(matrix), -1, order="F"))

    return passes


def print_iteration_cost(repeats: int) -> None:
    """Print the table of all sizes."""
    print(f"one iteration, ms: 10 substructures, multiscale; medians of {repeats}")
    print(
        f"{'nodes x instants':>17} {'all':>8} {'local':>8} {'coarse':>8} {'linear':>8} "
        f"{'floor':>8} {'all/floor':>9} {'ns/value':>9}"
    )
    for nodes, instants in SIZES:
        cost = iteration_cost(nodes, instants, repeats)
        parts = (cost.iteration, cost.local, cost.coarse, cost.linear, cost.floor)
        cells = " ".join(f"{1e3 * part:8.3f}" for part in parts)
        each = 1e9 * cost.iteration / (nodes * instants)
        print(
            f"{nodes:>8} x {instants:<6} {cells} {cost.iteration / cost.floor:9.2f} "
            f"{each:9.1f}"
        )


OVERHEADS: tuple[tuple[str, dict[str, object]], ...] = (
    ("bar", {"method": "paper"}),
    ("bar", {}),
    ("block", {}),
    ("layers", {}),
)


@dataclass(frozen=True)
class Overhead:
    """Cost of a run beside both stages, as shares of an iteration's own work.

    Attributes
    ----------
    own
        Seconds of an iteration: both stages, the coarse problem, acceleration.
    snapshot, stop
        Of making an iterate that can be kept, and of the stop rules without the status
        step.
    """

    own: float
    snapshot: float
    stop: float


class _Unproven(ErrorEstimate):
    """Errors that are estimated without a status step."""

    def is_step_worthwhile(self, iterate: Iterate) -> bool:
        return False


def overhead(settings: Settings, repeats: int) -> Overhead:
    """Measure a run up to its accuracy three ways in turns: bare, iterates, judged."""
    settings = settings.replace(finish="none")
    problem = discretise(settings)
    method = method_of(settings)
    number = len(solve(problem, method, watch=False).records)

    def bare() -> None:
        iteration = Iteration(problem, method)
        for _ in range(number):
            iteration.local_stage()
            iteration.linear_stage()

    def kept() -> None:
        for _ in islice(iterations(problem, method), number):
            pass

    def judged_without_step() -> None:
        rules = StopState(method)
        rules.estimate = _Unproven(method.stop.accuracy)
        for iterate in islice(iterations(problem, method), number):
            rules.judge(iterate)

    ways: list[Callable[[], object]] = [bare, kept, judged_without_step]
    alone, watched, whole = np.array(samples_of(ways, repeats))
    own = float(np.median(alone))
    snapshot = float(np.median((watched - alone) / alone))
    stop = float(np.median((whole - watched) / alone))
    return Overhead(own / number, snapshot, stop)


def print_overheads(repeats: int) -> None:
    """Print what runs pay for their snapshots and their stop rules."""
    print(
        "\n"
        f"beside the stages, as shares of an iteration's own work; medians of {repeats}"
    )
    print(f"{'scene':<8} {'method':<8} {'own, ms':>8} {'snapshot':>9} {'stop test':>9}")
    for scene, changes in OVERHEADS:
        settings = CATALOGUE[scene].checked(changes)
        found = overhead(settings, repeats)
        print(
            f"{scene:<8} {settings.method:<8} {1e3 * found.own:8.3f} "
            f"{100 * found.snapshot:7.0f} % {100 * found.stop:7.0f} %"
        )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        repeats = int(sys.argv[1])
    else:
        repeats = 7
    print_iteration_cost(repeats)
    print_overheads(repeats)
