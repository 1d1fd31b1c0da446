"""Cost of the linear stage on separated bases, against the full one, by size."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from scipy import sparse
from scipy.fft import idct

from solver.arrays import Array
from solver.discrete import Problem
from solver.discrete.substructure import Elasticity, Scales, Substructure
from solver.latin import PGD, Full, Paper, iterations
from solver.latin.iterate import Checkpoint
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.linear import LinearStage
from solver.laws import Component, Contact, Friction
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.scenes.method import method_of

MODES = (2, 4, 8, 16, 32, 64)
BARS = ((51, 101), (201, 101), (1001, 101), (1001, 1001))
HALF_PLANES = (101, 1001)
HALF_PLANE_POINTS = 400


@dataclass(frozen=True)
class ReductionCost:
    """Seconds per linear stage, medians of repeats; and what the states hold.

    Attributes
    ----------
    operator, points, instants
        What is solved: a name, boundary rows of a substructure, instants.
    full
        Of the full stage.
    reduced
        By number of modes: projection and reconstruction, without enrichment.
    enriched
        By number of modes: with one pair added and one dropped in every substructure.
    values, reduced_values
        Numbers that the state holds: in full; by number of modes.
    """

    operator: str
    points: int
    instants: int
    full: float
    reduced: dict[int, float]
    enriched: dict[int, float]
    values: int
    reduced_values: dict[int, int]

    @property
    def pays_up_to(self) -> int:
        """Largest measured number of modes with which projecting is cheaper."""
        return max(
            (n for n, seconds in self.reduced.items() if seconds < self.full), default=0
        )


def samples_of(
    parts: Sequence[Callable[[], object]], repeats: int, calls: int = 1
) -> list[list[float]]:
    """Seconds of a call of each part, in turns:
    a machine that slows down slows all of them.
    """
    samples: list[list[float]] = [[] for _ in parts]
    for _ in range(repeats):
        for part, own in zip(parts, samples, strict=True):
            start = time.perf_counter()
            for _ in range(calls):
                part()
            own.append((time.perf_counter() - start) / calls)
    return samples


def medians_of(
    parts: Sequence[Callable[[], object]], repeats: int, calls: int
) -> list[float]:
    """Median of `samples_of` for each part."""
    return [statistics.median(own) for own in samples_of(parts, repeats, calls)]


def half_plane(points: int, instants: int) -> Problem:
    """Make a body whose boundary response is dense: an elastic half plane.

    Its surface stiffness is the root of the negative second derivative (Johnson,
    Contact Mechanics, 1985, chapter 2), here with a spring to rest so that it cannot
    fly off. All points rub; there is no cut.
    """
    shapes = idct(np.eye(points), axis=0, norm="ortho")
    dense = shapes.T * (1.0 + np.pi * np.arange(points)) @ shapes
    rows = np.arange(points)
    positions = (rows + 0.5) / points
    law = Contact(
        tangential=Friction(
            component=Component(rows),
            bound=np.full((points, 1), 1e-3),
            friction=np.zeros(points),
        ),
        points=rows,
        positions=positions,
        weights=np.full(points, 1.0 / points),
    )
    elasticity = Elasticity(
        sparse.csr_array(dense), rows, np.full(points, float(points))
    )
    return Problem(
        substructures=(Substructure(elasticity, rows, rows, None),),
        interfaces={"surface": law},
        positions=positions,
        instants=np.linspace(0.0, 1.0, instants),
        scales=Scales(1.0, 1.0, 1.0),
    )


def reduction_cost(
    operator: str, problem: Problem, modes: Sequence[int], repeats: int
) -> ReductionCost:
    """Measure the linear stage in full and on bases of given sizes, in turns.

    The fields are random numbers of full rank, so that bases are as large as they may
    be.

    Parameters
    ----------
    operator
        Name of what is solved.
    problem
        What to solve, with the paper's search direction.
    modes
        Sizes of the bases; those larger than a substructure's boundary are left out.
    repeats
        Measurements of each, whose median is taken.
    """
    shape = (problem.n_rows, problem.n_instants)
    fields = np.random.default_rng(0).normal(size=(2, *shape))
    smallest = min(len(part.rows) for part in problem.substructures)
    sizes = [size for size in modes if size <= min(smallest - 1, problem.n_instants)]
    start = Checkpoint(0, 0.0, np.asfortranarray(fields[0]))
    target = np.asfortranarray(fields[1])
    steps = [step_of(stage, target) for stage in _stages(problem, sizes, start)]
    full, *rest = medians_of(steps, repeats, max(3, int(2e6 / np.prod(shape))))
    return ReductionCost(
        operator,
        smallest,
        problem.n_instants,
        full,
        dict(zip(sizes, rest[: len(sizes)], strict=True)),
        dict(zip(sizes, rest[len(sizes) :], strict=True)),
        int(np.prod(shape)),
        {size: size * _lengths(problem) for size in sizes},
    )


def _stages(
    problem: Problem, sizes: Sequence[int], start: Checkpoint
) -> list[LinearStage]:
    """Linear stages: in full; for each size on bases that stay; on bases that change.

    All begin from bases that are full, also where no residual is enough for another
    mode.
    """
    k = Paper().of(problem)
    blocks = Blocks(problem.n_rows, problem.n_instants)

    def stage_of(size: int, tolerance: float) -> LinearStage:
        form = PGD(size, tolerance, pairs=1, sharing=0.0)
        return LinearStage(problem, k, form, blocks, multiscale=True)

    whole = LinearStage(problem, k, Full(), blocks, multiscale=True)
    loose = [stage_of(size, 1.0) for size in sizes]
    tight = [stage_of(size, TIGHT) for size in sizes]
    for stage in (whole, *tight):
        stage.restore(start)
    for stage, full_bases in zip(loose, tight, strict=True):
        stage.restore(replace(start, bases=full_bases.bases()))
    return [whole, *loose, *tight]


def _lengths(problem: Problem) -> int:
    """Count of numbers of one mode of every substructure."""
    n_instants = problem.n_instants
    return sum(len(part.rows) + n_instants for part in problem.substructures)


WHOLE = ((51, 101), (201, 101), (1001, 101), (1001, 1001), (4001, 401))
FORMS: dict[str, dict[str, object]] = {
    "full": {"linear_stage": "full"},
    "pgd": {},
}
FIRST = 20
LAST = 60
TIGHT = 1e-14
"""Share of a field that is all but nothing."""


def whole_iterations(
    nodes: int, instants: int, repeats: int
) -> dict[str, tuple[float, float]]:
    """Measure whole iterations of a bar of 5 substructures, in full and reduced.

    Returns
    -------
    By form: seconds per iteration between two late iterations, median of repeats taken
    in turns; and the relative L2 distance of the displacement from that of the full
    form.
    """
    seconds: dict[str, list[float]] = {form: [] for form in FORMS}
    fields: dict[str, Array] = {}
    for _ in range(repeats):
        for form, changes in FORMS.items():
            settings = BarSettings.checked(
                {
                    "method": "paper",
                    "linear_stage": "pgd",
                    "elements": nodes - 1,
                    "instants": instants,
                    "substructures": 5,
                    **changes,
                }
            )
            clock = []
            for iterate in islice(
                iterations(discretise(settings), method_of(settings)), LAST
            ):
                clock.append(iterate.seconds)
                fields[form] = iterate.boundary_displacement
            seconds[form].append((clock[-1] - clock[FIRST - 1]) / (LAST - FIRST))
    full = fields["full"]
    return {
        form: (
            statistics.median(times),
            float(np.linalg.norm(fields[form] - full) / np.linalg.norm(full)),
        )
        for form, times in seconds.items()
    }


def step_of(stage: LinearStage, target: Array) -> Callable[[], None]:
    """Step of a linear stage towards a target, (n_rows, n_instants), relaxed by 0.8."""

    def step() -> None:
        stage.read(target)
        stage.advance(0.8)
        stage.incoming()

    return step


def print_reduction_cost(repeats: int) -> None:
    """Print the table of all sizes."""
    print(
        f"one linear stage, ms; medians of {repeats}; bars have 5 substructures, "
        "multiscale"
    )
    print("in brackets: with a pair added and one dropped in every substructure")
    heads = [f"{n:>15}" for n in MODES]
    print(f"{'operator':<11} {'rows x instants':>15} {'full':>9}", *heads)
    for nodes, instants in BARS:
        bar = BarSettings.checked(
            {
                "method": "paper",
                "elements": nodes - 1,
                "instants": instants,
                "substructures": 5,
            }
        )
        _print(reduction_cost("bar", discretise(bar), MODES, repeats))
    for instants in HALF_PLANES:
        problem = half_plane(HALF_PLANE_POINTS, instants)
        _print(reduction_cost("half plane", problem, MODES, repeats))

    print(
        "\n"
        "whole iterations, ms, of the bar with 5 substructures; in brackets: distance "
        "of the"
    )
    print(f"displacement from the full form's, iteration {LAST}")
    heads = [f"{form:>17}" for form in FORMS]
    print(f"{'nodes x instants':>17}", *heads)
    for nodes, instants in WHOLE:
        found = whole_iterations(nodes, instants, min(repeats, 3))
        texts = [f"{1e3 * time:8.2f} ({far:.1e})" for time, far in found.values()]
        cells = [f"{text:>17}" for text in texts]
        print(f"{nodes:>8} x {instants:<6}", *cells)


def _print(cost: ReductionCost) -> None:
    cells = [
        f"{1e3 * cost.reduced[size]:6.3f} ({1e3 * cost.enriched[size]:6.3f})"
        if size in cost.reduced
        else "-"
        for size in MODES
    ]
    aligned = [f"{cell:>15}" for cell in cells]
    print(
        f"{cost.operator:<11} {cost.points:>6} x {cost.instants:<6} "
        f"{1e3 * cost.full:9.3f}",
        *aligned,
        f" pays up to {cost.pays_up_to} modes",
    )
    values = " ".join(
        f"{size}: {100.0 * n / cost.values:.0f} %"
        for size, n in cost.reduced_values.items()
    )
    print(f"{'':<11} state against the full field: {values}")


if __name__ == "__main__":
    print_reduction_cost(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
