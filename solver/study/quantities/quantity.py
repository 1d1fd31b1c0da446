"""What a quantity of a run is, and the number that it may be asked with."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from solver.settings.scene import Settings
from solver.study.quantities.finished import FinishedRun


@dataclass(frozen=True)
class Parameter:
    """The number that a quantity may be asked with, or has to, if it is needed.

    `words` is what it adds to the title, with a place for the number; the smallest and
    the largest are integers where only whole numbers have a meaning.
    """

    words: str
    bounds: tuple[float, float]
    needed: bool = False


CYCLE = Parameter(" in cycle {:g}", (1, 10_000))
WITHIN = Parameter(" {:g}", (1e-12, 1.0), needed=True)
"""An error that is to be reached."""


@dataclass(frozen=True)
class Quantity:
    """A number that a finished run has.

    Attributes
    ----------
    name, title, unit
        By which it is asked for, what it is called, and its SI unit, empty for a pure
        number.
    of
        Takes it of a run, and of the instant if there is a `when`, or else of the
        parameter or None if there is one: NaN where the run has none, infinity where
        what is waited for never comes. What a run came to is NaN where some of its
        instants are known to have no solution.
    when
        Instant at which it is taken of a run, and of the parameter or None if there is
        one.
    parameter, at
        What it may be asked with, and what it is asked with.
    reads
        What of how the run went it follows from, so that a run that starts elsewhere
        has another: distances to a reference or the indicators of every iteration,
        which take their time, or neither of them. None where it is of what the run came
        to.
    is_share
        Whether it is a share of a whole, which is told in per cent.
    applies
        Whether runs of these settings may have it; others have NaN.
    """

    name: str
    title: str
    unit: str
    of: Callable[..., float]
    when: Callable[..., int] | None = None
    parameter: Parameter | None = None
    reads: Literal["errors", "indicators", "course"] | None = None
    is_share: bool = False
    applies: Callable[[Settings], bool] = lambda settings: True
    at: float | None = None

    def __call__(self, run: FinishedRun) -> float:
        """Value of a run."""
        if not self.applies(run.settings):
            return math.nan
        if self.reads is None and run.lost_from is not None:
            return math.nan
        given: tuple[float | None, ...] = ()
        if self.parameter is not None:
            given = (self.at,)
        if self.when is None:
            return float(self.of(run, *given))
        return float(self.of(run, self.when(run, *given)))


def quantity(title: str, unit: str = "", **options: Any) -> Callable[..., Quantity]:
    """Decorator of a function of a run that makes it the quantity of its name."""
    return lambda of: Quantity(of.__name__, title, unit, of, **options)
