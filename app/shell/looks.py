"""Where one looks: which interface, which stress, how much the displacement is magnified."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

from app.components.panes import SLIM, row, select
from app.components.scrubber import Scrubber, scrubber
from app.picture.labels import called
from app.picture.shown import STRESSES
from app.session.session import Session

STEPS = (1.0, 2.0, 5.0)
DECADES = 6
SAME = 0.02
"""Distance of two places that count as one, as a share of the length."""
STRESS_TITLES = {name if name == STRESSES[0] else f"stress {name}": name for name in STRESSES}


PLACES = """
.looks:not(.shown), :host(:is(.asks, .present, .embed)) .looks { display: none !important; }
@media (min-width: 761px) {
  .looks { align-self: flex-end; width: 400px !important; margin: 0 12px -28px 0 !important; }
  .looks.shown + .status { width: calc(100% - 412px) !important; }
  .looks.shown + .status { min-height: 28px; padding-top: 4px; }
  :host(.taught:not(.asks, .present)) :is(.looks, .status) { grid-area: 2 / 2; place-self: start; }
  :host(.taught) .looks { justify-self: end !important; }
}
"""
"""Where what chooses how bodies are drawn stands: in the line of the status, at its right."""


class Looks:
    """What is chosen beside the instant; a widget is made for the first scene that needs it.

    Parameters
    ----------
    session
        Is told what is chosen.

    Attributes
    ----------
    view
        What chooses how bodies are drawn; it stands in the line of the status, at its right.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.view = row(css_classes=["looks"])
        self._showing = False
        self._scene = ""
        self._interfaces: list[str] = []

    def draw_bodies(self, *, is_wanted: bool) -> None:
        """Have one choose how bodies are drawn, or not."""
        if is_wanted and not self.view:
            self.view[:] = [self._stress, self._magnification]
        self.view.css_classes = ["looks", "shown"] if is_wanted else ["looks"]

    def parts(self) -> list[Any]:
        """Give the widgets that choose anything else at present."""
        facts, scene = self._session.facts, self._session.settings.scene
        # A widget that went until the next run of the scene is shown would have the browser build
        # all that stand beside it twice for every change.
        if facts is not None or scene != self._scene:
            self._scene, self._interfaces = scene, list(facts.interfaces) if facts else []
        if len(self._interfaces) <= 1:
            return []
        if facts is not None:
            self._show(self._interfaces, facts.interface)
        return [self._interface]

    @cached_property
    def _interface(self) -> Any:
        what = "The one whose forces and status are drawn; a tap on it in the picture chooses it."
        say = self._session.say
        return select(say("Interface"), [], self._choose, width=118, description=say(what))

    @cached_property
    def _stress(self) -> Any:
        return select(
            self._session.say("Stress"),
            {self._session.say(title): name for title, name in STRESS_TITLES.items()},
            lambda stress: self._session.watch(stress=stress),
            value=STRESSES[0],
            width=112,
            margin=(0, 8),
            sx=SLIM,
            description=self._session.say("What colours the deformed bodies."),
        )

    @cached_property
    def _magnification(self) -> Scrubber:
        return scrubber(
            140,
            self._magnify,
            label="Magnification",
            help="How many times larger displacements are drawn than they are; at the left end "
            "as many as shows them well.",
            end=DECADES * len(STEPS) + 1,
            text="auto",
            css_classes=["inline"],
        )

    def _show(self, interfaces: list[str], chosen: str) -> None:
        select = self._interface
        options = {self._session.say(called(name, interfaces)): name for name in interfaces}
        if select.options == options and select.value == chosen:
            return
        self._showing = True
        try:
            select.param.update(options=options, value=chosen)
        finally:
            self._showing = False

    def chooses(self) -> dict[str, Callable[[Any], None]]:
        """Give what a tap on the picture of the scene does, by what it chooses."""
        return {"interface": self._choose, "place": self._mark, "wire": self._choose_number}

    def _choose_number(self, number: int) -> None:
        """Choose an interface by its place in the list."""
        if 0 <= number < len(self._interfaces):
            self._choose(self._interfaces[number])

    def _choose(self, interface: str) -> None:
        if not self._showing and interface:
            self._session.watch(interface=interface)

    def _mark(self, place: float) -> None:
        """Mark a place along the bodies, m; one that is marked already is no more."""
        marked, near = self._session.look.place, SAME * self._session.settings.length
        is_marked = marked is not None and abs(marked - place) <= near
        self._session.watch(place=None if is_marked else place)

    def _magnify(self, place: int) -> None:
        decade, step = divmod(place - 1, len(STEPS))
        factor = None if place == 0 else STEPS[step] * 10.0**decade
        text = "auto" if factor is None else f"× {factor:,.0f}"
        self._magnification.param.update(shown=place, text=text)
        self._session.watch(magnification=factor)
