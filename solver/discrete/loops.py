"""The hysteresis loop that a scene shows: a force over a displacement, through time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from solver.arrays import Array
from solver.discrete.contact_fields import ContactFields
from solver.discrete.probes import Probe, reaction
from solver.discrete.problem import Problem


class LoopFields(Protocol):
    """What a loop is taken from: an iterate, or a reference; SI, shape (n, n_instants)."""

    @property
    def displacement(self) -> Array:
        """Displacement of the problem's degrees of freedom, m."""

    def contact(self, name: str) -> ContactFields:
        """Show one interface with friction."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A force over the displacement that it works on; what is inside the loop is dissipated.

    Or over whatever drives it: then the loop shows how it lags behind.

    Attributes
    ----------
    across, up
        Title and unit of both.
    displacement
        Of m, or 1 for a rotation; or what drives.
    force
        Over time, N, shape (n_instants,), where it is given; else what finds it.
    """

    across: tuple[str, str]
    up: tuple[str, str]
    displacement: Probe
    force: Array | Callable[[LoopFields], Array]


def loop_of_ends(problem: Problem, title: str) -> Loop:
    """Give the mean force on the loaded ends of rods over their mean displacement."""
    law = problem.interfaces["load"]
    pulled = law.given_force
    count = len(law.rows)
    weights = np.full(count, 1.0 / count)
    ends = Probe(problem.row_dofs[law.rows], weights)
    force: Array | Callable[[LoopFields], Array]
    if pulled is not None:
        force = weights @ pulled.values * problem.scales.force
    else:
        held = reaction(problem, "load")
        force = lambda fields: held(fields.displacement) / count  # noqa: E731
    mean = "End" if count == 1 else "Mean end"
    return Loop((f"{mean} displacement", "m"), (title, "N"), ends, force)
