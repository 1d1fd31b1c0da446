"""Bodies of any shape, more and more of them: LATIN beside two incremental solvers.

`python tests/benchmarks/race.py SCENE`, of some sizes `race.py arch 31 121`, of some
ways `race.py wall 24 --ways LATIN`. Every way has a process of its own, which is ended
after `--limit` seconds. All are measured from the discrete problem on: what prepares
them (operators, condensation, factors) is billed on all sides. Making of the discrete
problem is told apart.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable, Iterator
from concurrent.futures import TimeoutError as TooLongError
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing import get_context
from typing import Any, TypeVar

import numpy as np
from pebble import ProcessPool
from sparse_newton import SparseNewton
from whole_cost import resident

from solver.arrays import Array, Flags
from solver.cache import CACHE
from solver.discrete.problem import Problem
from solver.latin import Ending, iterations, judged
from solver.reference.assembly import NoReferenceError
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study.measured_times import seconds_of
from solver.study.scene_run import warm_up
from solver.study.sweep.executors import ONE_THREAD, machine

GOAL = 0.01
MOST = 400
SAME = 1e-8
"""Error of the contact force; iterations at most; difference up to which answers are
the same."""
REPEATS = 3
LONG = 20.0
"""Times that each is measured, in turns, and seconds from which on once is enough."""
LIMIT = 150.0
"""Seconds after which a way is ended."""
FIRST = 10
"""Iterations that making is set beside."""


Found = TypeVar("Found")


@dataclass(frozen=True)
class Race:
    """A scene that is solved at several sizes.

    Attributes
    ----------
    grows
        Settings that have the size as their value.
    sizes
        Sizes by default.
    settings
        Settings that differ from those of the scene.
    """

    grows: tuple[str, ...]
    sizes: tuple[int, ...]
    settings: dict[str, Any] = field(default_factory=dict)


WALL = {
    "displacement": 5e-5,
    "elements": 6,
    "elements_up": 3,
    "instants": 41,
}
"""A tenth of the contact slips, 2 % of it are open."""
RACES = {
    "wall": Race(("bricks", "courses"), (3, 5, 8, 12, 16, 32), WALL),
    "arch": Race(("voussoirs",), (31, 121, 301)),
    "bundle": Race(("rings",), (1, 3)),
    "belt": Race(("elements",), (120, 1000)),
}
"""Walls of 10, 27, 68, 150, 264, 1040 bricks; bundles of 7 and 37 wires."""
PAPER = {"method": "paper"}
NESTED = {"start": "nested"}
LATIN: dict[str, dict[str, Any]] = {
    "LATIN": {},
    "LATIN, nested": NESTED,
    "LATIN, two threads": {"threads": 2},
    "LATIN, monoscale": {"multiscale": False},
    "LATIN-PGD, 10 modes": {"linear_stage": "pgd", "pgd_modes": 10},
    "paper's method": PAPER,
    "paper's, monoscale": {**PAPER, "multiscale": False},
}
KNOWN: dict[str, dict[str, Any]] = {
    "LATIN, until known": {},
    "nested, until known": NESTED,
}
INCREMENTAL = "incremental"
SPARSE = "sparse incremental"
RIVALS = (INCREMENTAL, SPARSE)
WAYS = (*RIVALS, *LATIN, *KNOWN)
NOTES = (
    f"Until the contact force is within {GOAL:.0%} of the incremental solvers'. "
    f"Medians, in turns (of one from {LONG:.0f} s on), s: of the processor, and by "
    "the clock on the wall, by which two threads are to be judged; MB that the "
    "process grows by, the problem apart. Ratio: to the faster incremental solver "
    "that solves all instants.",
    "Until known: until the run says itself that it is within 1 %, by an estimate or "
    "certified.",
    "Sparse incremental: tests/benchmarks/sparse_newton.py.",
)


@dataclass(frozen=True, eq=False)
class Answer:
    """Fields of an incremental solver, SI, and which instants it solved.

    Attributes
    ----------
    displacement, contact_force
        As of `solver.reference.solution.Reference`, SI.
    solved
        Which instants are, shape (n_instants,).
    """

    displacement: Array
    contact_force: Array
    solved: Flags

    def difference(self, other: Answer) -> float:
        """Largest difference of a field from another answer's, over the largest value.

        Displacements and contact forces are compared.
        """
        pairs: list[tuple[Array, Array]] = [
            (self.displacement, other.displacement),
            (self.contact_force, other.contact_force),
        ]
        shares = [
            np.abs(mine - theirs).max() / np.abs(theirs).max() for mine, theirs in pairs
        ]
        return float(max(shares))


@dataclass(frozen=True)
class Sample:
    """Seconds of the processor and of the clock on the wall, and MB."""

    seconds: float
    wall: float
    memory: float


@dataclass(frozen=True)
class Making:
    """Seconds that making and the first iterations take, and sizes of the problem."""

    substructures: int
    dofs: int
    instants: int
    seconds: float
    first: float

    def __str__(self) -> str:
        """Sentence for the head of a table."""
        return (
            f"{self.substructures} substructures, {self.dofs} degrees of freedom, "
            f"{self.instants} instants; made in {self.seconds:.2g} s, {FIRST} "
            f"iterations take {self.first:.2g} s"
        )


def settings_of(scene: str, size: int, changes: dict[str, Any]) -> Settings:
    """Settings of a scene at a size."""
    race = RACES[scene]
    grown = dict.fromkeys(race.grows, size)
    alone = {"finish": "none"}
    return CATALOGUE[scene].checked(alone | race.settings | grown | changes)


def ways_of(scene: str, ways: list[str]) -> Iterator[str]:
    """Ways of LATIN, of some ways, for which a scene has the start."""
    starts = CATALOGUE[scene].definitions()["start"].objects
    for way in ways:
        if way not in RIVALS:
            start = (LATIN | KNOWN)[way].get("start", "zero")
            if start in starts:
                yield way


def making_of(scene: str, size: int) -> Making:
    """Measure the making of a problem beside the first iterations."""
    warm_up()
    made = list[Problem]()
    settings = settings_of(scene, size, {})

    def make() -> None:
        made.append(discretise(settings_of(scene, size, {})))

    makings = [seconds_of(make) for _ in range(REPEATS)]
    firsts = []
    for problem in made:
        first = islice(iterations(problem, method_of(settings)), FIRST)
        firsts.append(seconds_of(lambda: list(first)))  # noqa: B023
    return Making(
        len(problem.substructures),
        problem.n_dofs,
        problem.n_instants,
        statistics.median(makings),
        statistics.median(firsts),
    )


def answer_of(problem: Problem, rival: str) -> Answer:
    """Solve by an incremental solver."""
    if rival == SPARSE:
        found = SparseNewton(problem).march()
        return Answer(found.displacement, found.contact_force, found.solved)
    known = reference_of(problem)
    return Answer(known.displacement, known.contact_force, known.converged)


def raced(scene: str, size: int, rival: str) -> tuple[Sample, Answer]:
    """Solve by an incremental solver with the clock on."""
    answers = list[Answer]()
    sample = measured(
        settings_of(scene, size, {}),
        lambda problem: answers.append(answer_of(problem, rival)),
    )
    return sample, answers[0]


def iterated(scene: str, size: int, way: str, count: int) -> Sample:
    """Run iterations with the clock on."""
    settings = settings_of(scene, size, (LATIN | KNOWN)[way])

    def run(problem: Problem) -> None:
        steps: Iterator[object] = iterations(problem, method_of(settings))
        if way in KNOWN:
            steps = judged(problem, method_of(settings))
        for _ in islice(steps, count):
            pass

    return measured(settings, run)


def measured(settings: Settings, work: Callable[[Problem], None]) -> Sample:
    """Measure some work on a fresh problem."""
    warm_up()
    problem = discretise(settings)
    CACHE.clear()
    before = resident("VmRSS")
    began = time.perf_counter()
    seconds = seconds_of(lambda: work(problem))
    wall = time.perf_counter() - began
    return Sample(seconds, wall, (resident("VmHWM") - before) / 1e6)


def count_of(scene: str, size: int, way: str, truth: Answer) -> tuple[int, float]:
    """Iterations until a way is near enough, 0 if it never is; and its last error."""
    settings = settings_of(scene, size, (LATIN | KNOWN)[way])
    problem = discretise(settings)
    distance = distance_to(truth, problem)
    method = method_of(settings)
    error = np.inf
    if way in KNOWN:
        for iterate, decision in islice(judged(problem, method), MOST):
            error = distance.of_friction_force(iterate)
            if decision.status and decision.status.ending is Ending.CONVERGED:
                return iterate.number, error
    else:
        for iterate in islice(iterations(problem, method), MOST):
            error = distance.of_friction_force(iterate)
            if error <= GOAL:
                return iterate.number, error
    return 0, error


class Processes:
    """Processes that take one call each, and are ended after a limit, s."""

    def __init__(self, pool: ProcessPool, limit: float) -> None:
        self._pool = pool
        self._limit = limit

    def call(self, function: Callable[..., Found], *arguments: object) -> Found | str:
        """Result of a call, or why there is none."""
        future = self._pool.schedule(
            function, args=list(arguments), timeout=self._limit
        )
        try:
            result: Found = future.result()
        except TooLongError:
            return f"does not end within {self._limit:.0f} s"
        except (NoReferenceError, MemoryError) as reason:
            return f"{reason}"
        return result


@dataclass
class Entry:
    """A way in a race: iterations, samples, and why there is nothing more.

    Attributes
    ----------
    way
        Name of the way.
    call
        Function and arguments by which it is measured.
    count
        Iterations; 0 for an incremental solver.
    remark
        Why the way does not arrive; empty where it does.
    samples
        What was measured so far.
    answer
        Fields of an incremental solver.
    """

    way: str
    call: tuple[Any, ...]
    count: int = 0
    remark: str = ""
    samples: list[Sample] = field(default_factory=list)
    answer: Answer | None = None

    def is_due(self, repeats: int) -> bool:
        """Check that fewer samples than so many are there, and that they are short."""
        if self.remark:
            return False
        spent = sum(sample.seconds for sample in self.samples)
        return len(self.samples) < repeats and spent < LONG

    @property
    def seconds(self) -> float:
        """Median of the seconds of the processor."""
        return statistics.median(sample.seconds for sample in self.samples)

    @property
    def arrives(self) -> bool:
        """Check whether a way was measured, and solves all instants."""
        is_whole = self.answer is None or bool(self.answer.solved.all())
        return bool(self.samples) and is_whole

    def measure(self, processes: Processes) -> None:
        """Take one more sample."""
        result = processes.call(*self.call)
        if isinstance(result, str):
            self.remark = result
        elif isinstance(result, Sample):
            self.samples.append(result)
        else:
            sample, self.answer = result
            self.samples.append(sample)

    def line(self, best: float) -> str:
        """Row of the table, beside the seconds of the best incremental solver."""
        cells = ""
        if self.samples:
            wall = statistics.median(sample.wall for sample in self.samples)
            memory = self.samples[0].memory
            cells = f"{self.seconds:8.2g} {wall:8.2g} {memory:8.0f}"
            cells += f" {self.seconds / best:8.2g}"
        remark = self.remark
        if self.answer is not None and not self.answer.solved.all():
            solved = self.answer.solved
            remark = f"solves {solved.sum()} of {len(solved)} instants"
        return f"  {self.way:<20} {self.count or '':>5} {cells} {remark}".rstrip()


def measure_in_turns(entries: list[Entry], processes: Processes, repeats: int) -> None:
    """Measure ways one after the other, again and again."""
    for _ in range(repeats):
        for entry in entries:
            if entry.is_due(repeats):
                entry.measure(processes)


def truth_of(entries: list[Entry]) -> tuple[Answer | None, str]:
    """Answer that errors are measured from, and a sentence about it."""
    arrived = [entry.answer for entry in entries if entry.arrives]
    answers = [answer for answer in arrived if answer is not None]
    if not answers:
        return None, "no incremental solver solves all instants"
    if len(answers) == 1:
        return answers[0], "one incremental solver alone solves all instants"
    difference = answers[0].difference(answers[1])
    if difference < SAME:
        return answers[0], "both incremental solvers find the same"
    return answers[0], f"answers of the incremental solvers differ by {difference:.1g}"


def latin_entry(
    scene: str, size: int, way: str, truth: Answer, processes: Processes
) -> Entry:
    """Count the iterations of a way of LATIN."""
    counted = processes.call(count_of, scene, size, way, truth)
    entry = Entry(way, ())
    if isinstance(counted, str):
        entry.remark = counted
        return entry
    entry.count, error = counted
    entry.call = (iterated, scene, size, way, entry.count)
    if not entry.count:
        entry.remark = f"not within {MOST} iterations: {error:.1%} away"
    return entry


def rows_of(
    scene: str, size: int, ways: list[str], processes: Processes, repeats: int
) -> Iterator[str]:
    """Rows of one size."""
    making = processes.call(making_of, scene, size)
    yield f"{scene} {size}: {making}"
    rivals = [Entry(way, (raced, scene, size, way)) for way in RIVALS if way in ways]
    # Answers come first: errors are measured from them.
    for entry in rivals:
        entry.measure(processes)
    truth, sentence = truth_of(rivals)
    yield f"  {sentence}"
    entries = rivals
    if truth is not None:
        entries = rivals + [
            latin_entry(scene, size, way, truth, processes)
            for way in ways_of(scene, ways)
        ]
    measure_in_turns(entries, processes, repeats)
    arrived = [entry.seconds for entry in rivals if entry.arrives]
    best = min(arrived, default=np.nan)
    for entry in entries:
        yield entry.line(best)


def main() -> None:
    """Print the rows of each size as soon as they are there."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=list(RACES))
    parser.add_argument("sizes", nargs="*", type=int, help="values of what grows")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=list(WAYS))
    parser.add_argument("--limit", type=float, default=LIMIT, help="seconds of a way")
    parser.add_argument("--repeats", type=int, default=REPEATS, help="samples of a way")
    chosen = parser.parse_args()
    os.environ.update(ONE_THREAD)
    print(machine())
    print(f"  {'':<20} {'iter.':>5} {'s':>8} {'s, wall':>8} {'MB':>8} {'ratio':>8}")
    context = get_context("spawn")
    with ProcessPool(1, max_tasks=1, context=context) as pool:
        processes = Processes(pool, chosen.limit)
        for size in chosen.sizes or RACES[chosen.scene].sizes:
            for row in rows_of(
                chosen.scene, size, chosen.ways, processes, chosen.repeats
            ):
                print(row, flush=True)
    print(*NOTES, sep="\n")


if __name__ == "__main__":
    main()
