"""What only some views need of an iterate, computed while one of them is in sight."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from app.frame import Floats
from app.messages import Needs
from app.worker.geometry import Stress, floats, thinned
from app.worker.rope_extras import ROPE_EXTRAS
from solver.latin import Iterate
from solver.reduction.svd import friction_spectra

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


def stress(sampler: Sampler, iterate: Iterate, needs: Needs) -> Stress:
    """Stress of all quadrilaterals that are drawn, at all instants."""
    return sampler.drawn.stress(iterate, needs.stress, sampler.settings)


Extra = Callable[["Sampler", Iterate, Needs], Any]
EXTRAS: dict[str, Extra] = {"spectra": spectra, "stress": stress, **ROPE_EXTRAS}
"""By the name that a view needs them by."""
