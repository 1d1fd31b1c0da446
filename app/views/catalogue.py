"""All views, and which share a card."""

from __future__ import annotations

from app.views.contact_force import ContactForce
from app.views.convergence import Convergence
from app.views.spectra import Spectra
from app.views.status_map import StatusMap
from app.views.view import View

CARDS: tuple[tuple[type[View], ...], ...] = (
    (ContactForce,),
    (StatusMap,),
    (Convergence,),
    (Spectra,),
)
"""The views of each card; the first that applies is shown first."""
