"""All live views, in the order in which they stand on the page."""

from __future__ import annotations

from app.views import (
    axial,
    basis_size,
    convergence,
    deformed,
    error_time,
    friction,
    load_path,
    loop,
    picture,
    spectra,
    status_map,
    tractions,
)
from app.views.drawing import View
from app.views.modes import SPACE_MODES, TIME_FUNCTIONS
from solver.settings import Settings

VIEWS: tuple[View, ...] = (
    picture.VIEW,
    deformed.VIEW,
    tractions.VIEW,
    friction.VIEW,
    axial.VIEW,
    status_map.VIEW,
    load_path.VIEW,
    loop.VIEW,
    convergence.VIEW,
    spectra.VIEW,
    error_time.VIEW,
    SPACE_MODES,
    TIME_FUNCTIONS,
    basis_size.VIEW,
)


def fitting(settings: Settings) -> list[View]:
    """Give the views that say anything about such a run."""
    return [view for view in VIEWS if view.applies(settings)]
