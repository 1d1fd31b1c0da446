"""Definition of a quantity of a run, and of its parameter."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from solver.settings.scene import Settings
from solver.study.quantities.finished import FinishedRun

NEVER = "never"
"""Word on an infinite value: an event that never comes."""


def written(value: float, unit: str, digits: int = 6) -> str:
    """Text of a value with its unit."""
    if math.isnan(value):
        return "none"
    if math.isinf(value):
        return NEVER
    return f"{value:.{digits}g} {unit}".strip()


@dataclass(frozen=True)
class Parameter:
    """Parameter of a quantity, as in `NAME@PARAMETER`; optional unless `needed`.

    Attributes
    ----------
    words
        Words that the number adds to the title, with a place for it.
    bounds
        Smallest and largest value: integers where only whole numbers have a meaning.
    needed
        Whether the quantity has no value without the number.
    """

    words: str
    bounds: tuple[float, float]
    needed: bool = False


CYCLE = Parameter(" in cycle {:g}", (1, 10_000))
WITHIN = Parameter(" {:g}", (1e-12, 1.0), needed=True)
"""An error that is to be reached."""


@dataclass(frozen=True)
class Quantity:
    """A quantity: a function from a finished run to a number.

    Attributes
    ----------
    name, title, unit
        Name by which the quantity is asked for, its title, and its SI unit, empty for a
        pure number.
    of
        Function that computes the quantity. Its arguments are the run, and then the
        instant if there is a `when`, or else the parameter or None if there is a
        parameter. NaN means that the run has no such value, infinity that an event
        never comes. A quantity of the result is NaN where some instants of the run are
        known to have no solution.
    when
        Function that finds the instant at which the quantity is taken, of the run, and
        of the parameter or None if there is one.
    parameter, at
        Parameter that the quantity may be asked with, and its value here.
    reads
        Part of the course of a run that the quantity depends on, so that a run with
        another start has another value: distances to a reference or the indicators of
        every iteration, which take their time, or neither of them. None for a quantity
        of the result alone.
    is_share
        Whether the quantity is a share of a whole, which is shown in per cent.
    applies
        Whether runs of these settings may have the quantity; others have NaN.
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
        if self.when is not None:
            given = (self.when(run, *given),)
        # Nothing is written as -0.
        return float(self.of(run, *given)) + 0.0


def quantity(title: str, unit: str = "", **options: Any) -> Callable[..., Quantity]:
    """Decorator: a function of a run becomes the quantity of its name."""
    return lambda of: Quantity(of.__name__, title, unit, of, **options)
