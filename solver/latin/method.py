"""The method as a value: parts that are plugged together (paper, Fig. 1; solver/README.md, 2)."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.linalg import LinAlgError

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.acceleration.anderson import Anderson
from solver.latin.blocks import Blocks
from solver.latin.cycle import Parts
from solver.latin.direction.rules import Auto, Paper, SearchDirection
from solver.latin.direction.update import FromStatus
from solver.latin.finish.status_step import StatusStep
from solver.latin.linear.parts import PGD, Full
from solver.latin.local.stage import LocalStage
from solver.latin.start.nested import Nested
from solver.latin.stop import Stop
from solver.refusal import RefusedError, check_range


@dataclass(frozen=True)
class Latin:
    """The multiscale LATIN method, made of parts.

    A part is a value with its own few numbers, checked where it is made; `solve` and `iterations`
    put it to work on a problem.

    Attributes
    ----------
    direction
        Search direction k: `Auto`, `Paper`, or `FromStatus` of one of these.
    linear
        How fields are held: `Full`, or `PGD`.
    multiscale
        Whether macro forces are in balance after every iteration, by the coarse problem.
    relaxation
        Share of the new iterate, the rest being the one before.
    acceleration
        `Anderson`, or None.
    start
        `Nested`, or None: zero, and of a body that only contact holds the place where it comes to
        rest.
    finish
        `StatusStep`, which ends a run with a certified solution, or None.
    stop
        When a run ends.
    threads
        That share an iteration on a large structure; the results are the same to the bit.

    Raises
    ------
    RefusedError
        For a number out of its range.

    Examples
    --------
    >>> Latin(linear=PGD(modes=5), stop=Stop(accuracy=0.05, iterations=100)).relaxation
    0.8
    """

    direction: SearchDirection | FromStatus = Auto()
    linear: Full | PGD = Full()
    multiscale: bool = True
    relaxation: float = 0.8
    acceleration: Anderson | None = Anderson()
    start: Nested | None = None
    finish: StatusStep | None = StatusStep()
    stop: Stop = Stop(accuracy=0.01, tolerance=1e-3, iterations=1000)
    threads: int = 1

    def __post_init__(self) -> None:
        check_range(self, "relaxation", 0.0, 1.0, above=True)
        check_range(self, "threads", 1, 64)

    @classmethod
    def paper(cls) -> Latin:
        """Give the method of the paper, as its section 3 has it."""
        return cls(
            direction=Paper(),
            acceleration=None,
            finish=None,
            stop=Stop(accuracy=0.01, tolerance=1e-10, iterations=1000),
        )

    def plugged(self, problem: Problem, k: Array) -> Parts:
        """Plug the parts together for one search direction; the linear stage is factored.

        Parameters
        ----------
        problem
            What to solve.
        k
            Search direction of the rows, shape (n_rows,), scaled, read-only.

        Raises
        ------
        RefusedError
            If k is so far from the stiffness that a factor breaks down.
        """
        blocks = Blocks(problem.n_rows, problem.n_instants, self.threads)
        try:
            linear = self.linear.at_work(problem, k, blocks, multiscale=self.multiscale)
        except (LinAlgError, RuntimeError):  # of a dense factor, and of a sparse one
            raise RefusedError(
                "k_scale",
                self.direction.scale,
                "a k that holds every substructure in the digits of a number",
                "bring the factors on k nearer to 1, or the sides of the elements to each other",
            ) from None
        local = LocalStage(problem, k, blocks)
        own = self.acceleration
        mix = own.at_work(problem, linear, blocks) if own else None
        return Parts(k, local, linear, mix, float(self.relaxation))
