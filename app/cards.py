"""The views that a page has, each on a card under its name and legend."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from app.views.axial import Axial
from app.views.basis_size import BasisSize
from app.views.convergence import Convergence
from app.views.deformed import Deformed
from app.views.drawing import Picture, View
from app.views.error_time import ErrorTime
from app.views.friction import FrictionForce
from app.views.legend import card_title
from app.views.loop import Loop
from app.views.modes import SpaceModes, TimeFunctions
from app.views.spectra import Spectra
from app.views.status_map import StatusMap
from app.views.tractions import Tractions
from solver.scenes.plane import PlaneSettings
from solver.scenes.strand import StrandSettings
from solver.settings import Settings


class Cards:
    """The views in their order; those of some scenes alone are made when the first of these comes.

    Parameters
    ----------
    style
        Style sheet.
    choose_time, choose_substructure
        Called with what was tapped: a time, s, and the number of a substructure.
    magnification
        Gives the factor on the displacement of bodies, or None to leave it to the view.
    """

    def __init__(
        self,
        style: str,
        choose_time: Callable[[float], None],
        choose_substructure: Callable[[int], None],
        magnification: Callable[[], float | None],
    ) -> None:
        self._style = style
        self._magnification = magnification
        self._made_for: set[type[Settings]] = set()
        self._titles: dict[str, Any] = {}
        self._cards: dict[str, Any] = {}
        self._views: list[View] = [
            FrictionForce(),
            StatusMap(choose_time),
            Loop(),
            Convergence(),
            Spectra(),
            ErrorTime(),
            SpaceModes(),
            TimeFunctions(),
            BasisSize(choose_substructure),
        ]

    def fitting(self, settings: Settings) -> list[View]:
        """Give the views that say anything about such a run."""
        self._add_views(settings)
        return [view for view in self._views if view.applies(settings)]

    def card_of(self, view: View) -> Any:
        """Give a view's card, made when it is first shown."""
        if view.name not in self._cards:
            self._cards[view.name] = self._make_card(view)
        return self._cards[view.name]

    def draw(self, view: View, picture: Picture) -> None:
        """Bring a view that has a card and its legend up to date."""
        view.draw(picture)
        self._titles[view.name].object = card_title(view.name, view.keys)

    def _add_views(self, settings: Settings) -> None:
        if type(settings) in self._made_for:
            return
        self._made_for.add(type(settings))
        names = [view.name for view in self._views]
        if isinstance(settings, PlaneSettings) and Deformed.name not in names:
            self._views[:0] = [Deformed(self._magnification), Tractions()]
        if isinstance(settings, StrandSettings):
            self._views.insert(names.index(StatusMap.name), Axial())

    def _make_card(self, view: View) -> Any:
        title = pn.pane.HTML(
            card_title(view.name, view.keys),
            css_classes=["title"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(4, 6, 0, 12),
        )
        self._titles[view.name] = title
        plot = pn.pane.Bokeh(view.figure, sizing_mode="stretch_both", margin=(0, 4))
        return pn.Column(
            title,
            plot,
            sizing_mode="stretch_both",
            css_classes=["card"],
            stylesheets=[self._style],
            margin=0,
        )
