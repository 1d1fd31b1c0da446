"""The LATIN method as a value made of parts (paper, Fig. 1; MATHEMATICS.md, 2)."""

from __future__ import annotations

from dataclasses import dataclass
from types import NoneType

from solver.checks import FLAG, Count, InstanceOf, Number, check
from solver.latin.anderson import Anderson
from solver.latin.direction.directions import Auto, SearchDirection
from solver.latin.end.status_step import StatusStep
from solver.latin.end.stop import Stop
from solver.latin.stages.linear import Full
from solver.latin.stages.pgd import PGD
from solver.latin.start import Nested


@dataclass(frozen=True)
class Latin:
    """The multiscale LATIN method, made of parts.

    A part is a value with its own few numbers, checked where it is made; `solve` and
    `iterations` put it to work on a problem.

    Attributes
    ----------
    direction
        Search direction k: `Auto` or `Paper`.
    linear
        Form of the fields in the linear stage: `Full`, or `PGD`.
    multiscale
        Whether the coarse problem brings macro forces into balance in every iteration.
    relaxation
        Share of the new iterate; the rest is the one before.
    acceleration
        `Anderson`, or None.
    start
        `Nested`, or None. Without it fields start at zero, and a body that contact
        alone holds starts where it comes to rest.
    finish
        `StatusStep`, which ends a run with a certified solution, or None.
    stop
        Criteria that end a run.
    threads
        Number of threads that share an iteration on a large structure, each with one
        thread of BLAS; the results are the same to the bit.

    Raises
    ------
    RefusedError
        For a number out of its range, or a value that is no such part.

    Examples
    --------
    >>> Latin(linear=PGD(modes=5), stop=Stop(accuracy=0.05, iterations=100)).relaxation
    0.8
    """

    direction: SearchDirection = Auto()
    linear: Full | PGD = Full()
    multiscale: bool = True
    relaxation: float = 0.8
    acceleration: Anderson | None = Anderson()
    start: Nested | None = None
    finish: StatusStep | None = StatusStep()
    stop: Stop = Stop(accuracy=0.01, tolerance=1e-3, iterations=1000)
    threads: int = 1

    def __post_init__(self) -> None:
        check(
            self,
            direction=InstanceOf(SearchDirection),
            linear=InstanceOf(Full, PGD),
            multiscale=FLAG,
            relaxation=Number(0.0, 1.0, above=True),
            acceleration=InstanceOf(Anderson, NoneType),
            start=InstanceOf(Nested),
            finish=InstanceOf(StatusStep, NoneType),
            stop=InstanceOf(Stop),
            threads=Count(1, 64),
        )

    @property
    def may_shift(self) -> bool:
        """Check whether bodies are shifted as rigid ones where hinges are free."""
        return self.multiscale and isinstance(self.linear, Full)
