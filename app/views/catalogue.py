"""Catalogue of views, by the card that they share."""

from __future__ import annotations

from app.views.bases import ClipErrors, SpaceModes, Spectra, TimeFunctions
from app.views.contact_force import ContactForce
from app.views.errors import Convergence, ErrorTime
from app.views.inside import Stress, Thrust
from app.views.loops import CycleEnergy, Cycles, HysteresisLoop, SlipPlane
from app.views.pieces import PiecesView
from app.views.rope import AxialForces, WireSection
from app.views.status_map import StatusMap
from app.views.view import View
from app.views.zigzag import Zigzag

CARDS: tuple[tuple[type[View], ...], ...] = (
    (Thrust, ContactForce, AxialForces, HysteresisLoop, Stress),
    (StatusMap, WireSection, SlipPlane, Cycles, CycleEnergy),
    (Convergence, ErrorTime, PiecesView, Zigzag),
    (Spectra, SpaceModes, TimeFunctions, ClipErrors),
)
"""The views of each card; the first that applies is shown first."""
MOTION, SLIP, METHOD, BASES = CARDS
LARGE_CARDS = (MOTION + SLIP, METHOD + BASES)
"""The same views in two large cards: the motion, and the method."""
