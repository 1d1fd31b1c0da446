"""What a run is compared with: the one place that knows which scenes have a reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from solver.discrete import Problem
from solver.discrete.contact_fields import ContactFields
from solver.reference import incremental
from solver.scenes.bar import BarSettings
from solver.settings import Settings

Array = NDArray[np.float64]


class Rival(Protocol):
    """A reference: fields of a whole structure, SI, shape (n_points, n_instants).

    Attributes
    ----------
    displacement
        Of the problem's degrees of freedom, m.
    friction_force
        Of all interfaces, one after the other, N.
    status
        The same, as in `ContactFields`.
    residual, seconds
        How exact it is, and the time that it took.
    """

    displacement: Array
    friction_force: Array
    status: NDArray[np.int8]
    residual: float
    seconds: float

    def contact(self, name: str) -> ContactFields:
        """Show one interface with friction."""


Known = incremental.Reference | Rival


def has_reference(settings: Settings) -> bool:
    """Tell whether a scene has a reference to measure errors by."""
    return isinstance(settings, BarSettings)


def find_reference(settings: Settings, problem: Problem, stop: Callable[[], bool]) -> Known | None:
    """Compute the reference of a problem, or give None where there is none.

    Raises
    ------
    Interrupted
        As soon as `stop` gives True.
    """
    return incremental.incremental(problem, stop) if has_reference(settings) else None


def contact_of(found: Known, name: str) -> ContactFields:
    """Show one interface of a reference; that of the bar has no other."""
    if isinstance(found, incremental.Reference):
        slip = found.displacement
        return ContactFields(None, found.friction_force, None, slip, found.status)
    return found.contact(name)
