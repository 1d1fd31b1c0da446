"""Where one looks: which interface, which stress, how much the displacement is magnified."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

from app.scrubber import Scrubber
from app.session import Session
from app.views.deformed import Deformed
from app.worker.protocol import STRESSES

STEPS = (1.0, 2.0, 5.0)
DECADES = 6
MOST = DECADES * len(STEPS) + 1
STRESS_TITLES = {name if name == STRESSES[0] else f"stress {name}": name for name in STRESSES}


class Looks:
    """What is chosen beside the instant, as far as the scene has it.

    Parameters
    ----------
    session
        Is told the interface and the stress.
    deformed
        Is told the magnification.
    refresh
        Called when something is to be drawn again.

    """

    def __init__(self, session: Session, deformed: Deformed, refresh: Callable[[], None]) -> None:
        self._session = session
        self._deformed = deformed
        self._refresh = refresh
        self._interface = pmui.Select(
            label="Interface",
            options=[],
            width=145,
            size="small",
            description="The interface whose forces and status are drawn.",
        )
        self._stress = pmui.Select(
            label="Stress",
            options=STRESS_TITLES,
            value=STRESSES[0],
            width=128,
            size="small",
            description="What colours the deformed bodies.",
        )
        self._magnification = Scrubber(
            label="Magnification",
            help="Factor on the displacement of the drawn bodies; at the left end it is chosen so "
            "that they are seen to move.",
            end=MOST,
            text="auto",
            margin=(0, 8),
            min_width=140,
            sizing_mode="stretch_width",
            styles={"flex": "1 1 140px"},
        )
        self._showing = False
        self._interface.param.watch(self._on_interface, "value")
        self._stress.param.watch(lambda event: session.look_for(event.new), "value")
        self._magnification.param.watch(self._on_magnification, "wanted")

    def parts(self, shows_bodies: bool) -> list[Any]:
        """Give the widgets that choose anything at present."""
        begun = self._session.run.begun
        several = begun is not None and len(begun.interfaces) > 1
        return [
            *([self._interface] if several else []),
            *([self._stress, self._magnification] if shows_bodies else []),
        ]

    def show(self) -> None:
        """Offer the interfaces of the run."""
        begun = self._session.run.begun
        if begun is None or self._interface.options == list(begun.interfaces):
            if begun is not None and self._interface.value != begun.interface:
                self._set(value=begun.interface)
            return
        self._set(options=list(begun.interfaces), value=begun.interface)

    def _set(self, **values: Any) -> None:
        self._showing = True
        try:
            self._interface.param.update(**values)
        finally:
            self._showing = False

    def _on_interface(self, event: Any) -> None:
        if not self._showing and event.new:
            self._session.look_into(event.new)
            self._refresh()

    def _on_magnification(self, event: Any) -> None:
        place = int(event.new)
        factor = None if place == 0 else STEPS[(place - 1) % 3] * 10.0 ** ((place - 1) // 3)
        self._deformed.magnification = factor
        self._magnification.param.update(
            shown=place, text="auto" if factor is None else f"× {factor:,.0f}"
        )
        self._refresh()
