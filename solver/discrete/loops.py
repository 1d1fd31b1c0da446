"""The hysteresis loop that a scene shows: a force over a displacement, through time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.contact_fields import ContactFields
from solver.discrete.probes import Probe, end_rotation, reaction, side_mean
from solver.discrete.problem import Problem
from solver.laws import Dirichlet, Interface, Neumann
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings
from solver.scenes.layers import LayersSettings
from solver.scenes.sides import AT_REST
from solver.scenes.strand import StrandSettings
from solver.settings import Settings


class Fields(Protocol):
    """What a loop is taken from: an iterate, or a reference; SI, shape (n, n_instants)."""

    @property
    def displacement(self) -> Array:
        """Displacement of the problem's degrees of freedom, m."""

    def contact(self, name: str) -> ContactFields:
        """Show one interface with friction."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A force over the displacement that it works on; what is inside the loop is dissipated.

    Attributes
    ----------
    across, up
        Title and unit of both.
    displacement
        Of m, or 1 for a rotation.
    force
        Over time, N, shape (n_instants,), where it is given; else what finds it.
    """

    across: tuple[str, str]
    up: tuple[str, str]
    displacement: Probe
    force: Array | Callable[[Fields], Array]


def loop_of(settings: Settings, problem: Problem) -> Loop:
    """Give the loop of a scene; forces of plane bodies are those on a metre of thickness."""
    match settings:
        case BarSettings() | StrandSettings():
            return _of_wires(problem, "Force" if isinstance(settings, BarSettings) else "Tension")
        case BlockSettings():
            return _of_block(settings, problem)
        case LayersSettings():
            return _of_layers(settings, problem)
        case _:
            raise TypeError(f"no loop for the settings of {settings.scene!r}")


def _of_wires(problem: Problem, title: str) -> Loop:
    """Give the mean force on the loaded ends over their mean displacement."""
    law = problem.interfaces["load"]
    count = len(_rows(law))
    weights = np.full(count, 1.0 / count)
    ends = Probe(problem.row_dofs[_rows(law)], weights)
    force: Array | Callable[[Fields], Array]
    if isinstance(law, Neumann):
        force = weights @ law.force * problem.scales.force
    else:
        held = reaction(problem, "load")
        force = lambda fields: held(fields.displacement) / count  # noqa: E731
    mean = "End" if count == 1 else "Mean end"
    return Loop((f"{mean} displacement", "m"), (title, "N"), ends, force)


def _of_block(settings: BlockSettings, problem: Problem) -> Loop:
    """Give the shear force on the support over the horizontal displacement of the moved side."""
    moved = [side for side in ("top", "left", "right") if getattr(settings, side) not in AT_REST]
    side = moved[0] if moved else "top"
    return Loop(
        (f"Displacement of the {side}", "m"),
        ("Shear force", "N"),
        side_mean(problem, side, 0),
        lambda fields: -fields.contact("support").tangential_force.sum(axis=0),
    )


def _of_layers(settings: LayersSettings, problem: Problem) -> Loop:
    if settings.bending == "moment":
        moment = settings.path("bend_load", settings.moment)
        return Loop(("Rotation of the end", ""), ("Moment", "N m"), end_rotation(problem), moment)
    held = reaction(problem, "right")
    return Loop(
        ("Deflection of the end", "m"),
        ("Transverse force", "N"),
        side_mean(problem, "right", 1),
        lambda fields: held(fields.displacement),
    )


def _rows(law: Interface) -> Indices:
    assert isinstance(law, Neumann | Dirichlet)
    return law.rows
