"""All live views, in the order in which they stand on the page, and which share a card."""

from __future__ import annotations

from collections.abc import Collection

from app.views.bodies import axial, deformed, picture, section
from app.views.convergence import convergence, error_time
from app.views.drawing.drawing import View
from app.views.interface import friction, slip_plane, status_map, tractions, unrolled
from app.views.load import cycles, load_path, loop
from app.views.reduction import basis_size, clips, spectra
from app.views.reduction.modes import SPACE_MODES, TIME_FUNCTIONS
from solver.settings import Settings

CARDS: tuple[tuple[View, ...], ...] = (
    (picture.VIEW, deformed.VIEW),
    (section.SECTION, section.RANGES),
    (tractions.VIEW, friction.VIEW, axial.VIEW),
    (unrolled.VIEW, status_map.VIEW, slip_plane.VIEW),
    (load_path.VIEW, loop.VIEW, cycles.LOOPS, cycles.ENERGY, cycles.FRETTING),
    (convergence.VIEW, error_time.VIEW),
    (spectra.VIEW, SPACE_MODES, TIME_FUNCTIONS, basis_size.VIEW, clips.VIEW),
)
VIEWS: tuple[View, ...] = tuple(view for card in CARDS for view in card)


def fitting(settings: Settings) -> list[View]:
    """Give the views that say anything about such a run."""
    return [view for view in VIEWS if view.applies(settings)]


def beside(view: View, settings: Settings) -> list[View]:
    """Give the views that share a card with this one, itself among them."""
    card = next(card for card in CARDS if view in card)
    return [one for one in card if one.applies(settings)]


def drawn(settings: Settings, chosen: Collection[str] | None) -> list[View]:
    """Give the views that are drawn of a run: those of these names, by default one a card.

    The first of a card stands for those that were chosen of it and say nothing about this run.
    """
    found: list[View] = []
    for card in CARDS:
        fit = [view for view in card if view.applies(settings)]
        own = [view for view in fit if chosen is not None and view.name in chosen]
        is_asked = chosen is None or any(view.name in chosen for view in card)
        found += own or (fit[:1] if is_asked else [])
    return found
