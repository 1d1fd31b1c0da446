"""All views, and which share a card."""

from __future__ import annotations

from app.views.contact_force import ContactForce
from app.views.convergence import Convergence
from app.views.rope import CrossSection, ForceInWires, StressRanges, Unrolled
from app.views.scene.stress import Stress
from app.views.spectra import Spectra
from app.views.status_map import StatusMap
from app.views.view import View

CARDS: tuple[tuple[type[View], ...], ...] = (
    (ContactForce, ForceInWires),
    (StatusMap, Unrolled, CrossSection, Stress),
    (Convergence,),
    (Spectra, StressRanges),
)
"""The views of each card; the first that applies is shown first."""
