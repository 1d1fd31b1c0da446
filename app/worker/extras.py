"""What only some views need of an iterate, computed while one of them is in sight."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from app.frame import BesideRun, Floats
from app.messages import Needs
from app.worker.geometry import floats, thinned
from solver.latin import Iterate
from solver.reduction.svd import friction_spectra
from solver.study.other_programs.beside import Beside
from solver.study.other_programs.brought import Brought

if TYPE_CHECKING:
    from app.worker.sampling import Sampler

MOST_SPECTRA, MOST_VALUES = 60, 64
"""Substructures, and singular values of each, that are shown at most."""


def spectra(sampler: Sampler, iterate: Iterate, needs: Needs) -> list[Floats]:
    """Singular values of the friction force in every substructure, over the largest of all."""
    values = friction_spectra(iterate)
    shown = [values[place][:MOST_VALUES] for place in thinned(len(values), MOST_SPECTRA)]
    largest = max((float(own.max(initial=0.0)) for own in shown), default=0.0) or 1.0
    return [floats(np.asarray(own) / largest) for own in shown]


@lru_cache(maxsize=1)
def _laid_beside(brought: Brought, sampler: Sampler, interface: str) -> Beside:
    return Beside(brought, sampler.problem, interface)


def beside(sampler: Sampler, iterate: Iterate, needs: Needs) -> BesideRun | None:
    """Results of another program and their distance to the iterate, if they are of its scene."""
    brought = needs.brought
    if brought is None or brought.scene != sampler.settings.scene:
        return None
    laid = _laid_beside(brought, sampler, needs.interface)
    return BesideRun(
        source=brought.source,
        quantity=brought.quantity,
        interface=laid.interface,
        x=floats(brought.positions),
        t=floats(brought.times),
        values=floats(brought.values),
        distance=laid.of(iterate),
    )


Extra = Callable[["Sampler", Iterate, Needs], Any]
EXTRAS: dict[str, Extra] = {"spectra": spectra, "beside": beside}
"""By the name that a view needs them by."""
