"""All views, and which share a card."""

from __future__ import annotations

from app.views.axial_force import AxialForce
from app.views.clips import Clips
from app.views.contact_force import ContactForce
from app.views.convergence import Convergence
from app.views.cycles import CycleEnergy, Cycles, Fretting
from app.views.error_time import ErrorTime
from app.views.loop import HysteresisLoop
from app.views.modes import BasisSizes, SpaceModes, TimeFunctions
from app.views.rope import CrossSection, StressRanges, Unrolled
from app.views.scene.stress import Stress
from app.views.slip_plane import SlipPlane
from app.views.spectra import Spectra
from app.views.status_map import StatusMap
from app.views.view import View

CARDS: tuple[tuple[type[View], ...], ...] = (
    (ContactForce, AxialForce, HysteresisLoop, Stress),
    (StatusMap, Unrolled, CrossSection, SlipPlane, Cycles, CycleEnergy, Fretting),
    (Convergence, ErrorTime),
    (Spectra, SpaceModes, TimeFunctions, BasisSizes, StressRanges, Clips),
)
"""The views of each card; the first that applies is shown first."""
