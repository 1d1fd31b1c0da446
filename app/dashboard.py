"""The page: controls at the side, the run at the top, the views that apply below."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.util import edit_readonly

from app.looks import Looks
from app.pulse import Pulse, send_without_delay
from app.session import Session
from app.sidebar import Sidebar
from app.tabs import Tabs
from app.transport import Transport
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
from app.words import key_figures, status_line
from solver.scenes.plane import PlaneSettings
from solver.scenes.strand import StrandSettings
from solver.settings import Settings

STATIC = Path(__file__).resolve().parents[1] / "static"
TICK_MS = 25
IN_FLIGHT = 1
FIRST_PATIENCE = 0.4
REST = 2.0
VIEWS_AT_ONCE = 3
VIEWS_AT_FIRST = 1
FIRST_ROW = 3
LOST_AFTER = 2.0


class Dashboard:
    """One page over one session: what is done is told to the session, what it holds is drawn.

    Attributes
    ----------
    page
        What is served.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self._sent_at = 0.0
        self._dirty = False
        self._alone = True
        self._loaded = False
        self._rest_until = 0.0
        self._owed: list[View] = []
        self._drawn_ticket = -1
        self._style = (STATIC / "style.css").read_text(encoding="utf-8")
        self._pulse = self._make_pulse()
        self.transport = Transport(session, self._mark)
        self._looks = Looks(session, self._mark)
        self._views = self._make_views()
        self._made_for: set[type[Settings]] = set()
        self._titles: dict[str, Any] = {}
        self._cards: dict[str, Any] = {}
        self._sidebar = Sidebar(session, self._arrange, self.complain, self._copy)
        self._status = self._html("status")
        self._figures = self._html("figures")
        self._plots = pn.Column(
            sizing_mode="stretch_width", css_classes=["plots"], stylesheets=[self._style], margin=0
        )
        self._live = self._make_live()
        self._tabs = Tabs(session, self._live, self._style, self._mark)
        self.page = self._make_page()
        self._sidebar.show(session.wanted)
        self._arrange()

    def prepare(self) -> None:
        """Put the first iterate into the page before it is sent, if a worker is quick enough.

        The run then waits until a browser connects: whoever only asks for the page, as a crawler
        does, costs one iteration.
        """
        self.session.start(waits=True)
        end = time.monotonic() + FIRST_PATIENCE
        while self.session.shown is None and time.monotonic() < end:
            time.sleep(0.002)
            self.session.collect()
        if self.session.shown is not None:
            self._owed = []
            self._draw(self._shown[:FIRST_ROW])

    def loaded(self) -> None:
        """Begin to draw: what is sent to a browser that still builds the page may be lost."""
        self._loaded = True
        send_without_delay()
        # The first row comes first: two thirds of what the page is made of are not in it.
        self._sidebar.fill()
        self._arrange()
        self._on_narrow()

    def tick(self) -> None:
        """Keep the page alive: run while a browser shows it, and draw what came."""
        alone = self._connections() == 0 or not self._loaded
        if alone != self._alone:
            self._alone = alone
            self.session.rest(alone)
        if self.session.attend():
            self._tabs.refresh()
            self._mark()
        self._sidebar.obey()
        self._collect()

    def end(self, context: Any) -> None:
        """Leave nothing behind when the page is gone."""
        self.session.close()

    def complain(self, text: str) -> None:
        """Tell the user what was refused and why."""
        if pn.state.notifications is not None:
            pn.state.notifications.error(text, duration=8000)

    def _make_pulse(self) -> Pulse:
        pulse = Pulse()
        pulse.param.watch(self._on_painted, "painted")
        pulse.param.watch(self._on_key, "key")
        pulse.param.watch(lambda event: self._on_narrow(), "narrow")
        return pulse

    def _make_views(self) -> list[View]:
        return [
            FrictionForce(),
            StatusMap(self.transport.choose_time),
            Loop(),
            Convergence(),
            Spectra(),
            ErrorTime(),
            SpaceModes(),
            TimeFunctions(),
            BasisSize(self.transport.choose_substructure),
        ]

    def _add_views(self, settings: Settings) -> None:
        """Make the views that only some scenes have, when the first of those comes."""
        if type(settings) in self._made_for:
            return
        self._made_for.add(type(settings))
        names = [view.name for view in self._views]
        place = names.index(StatusMap.name)
        if isinstance(settings, PlaneSettings) and Deformed.name not in names:
            self._views[:0] = [Deformed(lambda: self._looks.magnification), Tractions()]
        if isinstance(settings, StrandSettings):
            self._views.insert(place, Axial())

    def _make_live(self) -> pn.Column:
        return pn.Column(
            self.transport.view,
            self._status,
            self._figures,
            self._plots,
            self._pulse,
            sizing_mode="stretch_width",
            margin=(4, 10),
        )

    def _make_page(self) -> pmui.Page:
        page = pmui.Page(
            title="Slipfront",
            favicon=STATIC / "logo.svg",
            logo=STATIC / "logo.svg",
            sidebar=[self._sidebar.view],
            sidebar_width=310,
            header=[self._tabs.bar],
            main=[self._tabs.main],
            busy_indicator=None,
            meta_description="A laboratory for frictional contact: LATIN iterations, live.",
        )
        # The page follows the server's being busy, which costs a walk over all models twice for
        # every event of the browser (60 ms), and would only turn the indicator that is not there.
        # A value would leave the server's hold on the page, for good; another reference ends it.
        with edit_readonly(page):
            page.busy = page.param.loading
        return page

    def _card_of(self, view: View) -> Any:
        """Give a view's card, made when it is first shown."""
        if view.name not in self._cards:
            self._cards[view.name] = self._card(view)
        return self._cards[view.name]

    def _card(self, view: View) -> Any:
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

    def _html(self, role: str) -> Any:
        return pn.pane.HTML(
            "",
            css_classes=[role],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(2, 10),
        )

    def _copy(self, query: str) -> None:
        """Put a query into the address bar and the clipboard, even the same one again."""
        self._pulse.copy = f"{query}#{time.monotonic()}"

    def _arrange(self) -> None:
        """Show the views that are chosen and apply; frames carry what they need."""
        settings = self.session.wanted
        self._add_views(settings)
        fitting = [view for view in self._views if view.applies(settings)]
        wanted = self._sidebar.offer([view.name for view in fitting])
        shown = [view for view in fitting if view.name in wanted]
        self.transport.arrange(settings)
        cards = [self._card_of(view) for view in shown[: None if self._loaded else FIRST_ROW]]
        if list(self._plots) != cards:
            self._plots[:] = cards
        self.session.set_watch(frozenset(view.watches for view in shown if view.watches))
        self._shown = shown
        self._offer_looks()
        self._tabs.refresh()
        self._mark()

    def _offer_looks(self) -> None:
        bodies = any(view.watches == "mesh" for view in self._shown)
        self.transport.place(self._looks.parts(shows_bodies=bodies))

    def _mark(self) -> None:
        self._dirty = True

    def _collect(self) -> None:
        """Take what the worker sent and draw it, if the page has painted what it has."""
        if self.session.collect():
            self._dirty = True
        now = time.monotonic()
        in_flight = self._pulse.frame - self._pulse.painted
        looked_at = self._loaded and self._tabs.shows_the_run
        waiting = looked_at and (self._dirty or bool(self._owed))
        # The first picture of a run overtakes what is still on its way.
        first = self.session.shown is not None and self.session.run.ticket != self._drawn_ticket
        free = in_flight < IN_FLIGHT and now >= self._rest_until
        free = free or now - self._sent_at > LOST_AFTER
        if waiting and (first or free):
            self._sent_at = now
            if self._dirty:
                self._owed += [view for view in self._shown if view not in self._owed]
                self._dirty = False
            with pn.io.hold():
                self._draw(self._next_views(), at_once=first)
                self._pulse.frame += 1

    def _draw(self, views: Sequence[View], *, at_once: bool = False) -> None:
        """Draw some views and the words about the run; `at_once` leaves the rest for the next."""
        session = self.session
        frame = session.shown
        picture = Picture(session.run, session.before, tuple(session.past), frame, session.instant)
        for view in views:
            view.draw(picture)
            self._titles[view.name].object = card_title(view.name, view.keys)
        sought = frame.iteration if frame is not None and not session.follows else None
        self._status.object = status_line(
            session.run, session.running, sought, held=session.is_held
        )
        if at_once:
            return
        self._offer_looks()
        self.transport.show()
        entry = session.run.record_of(frame) if frame is not None else None
        self._figures.object = key_figures(session.run, session.before, entry)

    def _next_views(self) -> list[View]:
        """Give the views whose turn it is: a browser paints few at once sooner than all.

        A new run shows the first views first; then all take turns.
        """
        if self.session.shown is not None and self.session.run.ticket != self._drawn_ticket:
            self._drawn_ticket = self.session.run.ticket
            self._owed = list(self._shown)
            count = VIEWS_AT_FIRST
        else:
            count = VIEWS_AT_ONCE
        turn, self._owed = self._owed[:count], self._owed[count:]
        return [view for view in turn if view in self._shown]

    def _connections(self) -> int:
        context = pn.state.curdoc.session_context if pn.state.curdoc else None
        return int(context.session.connection_count) if context is not None else 0

    def _on_painted(self, event: Any) -> None:
        """Leave the browser twice as long as it painted to listen to its user."""
        now = time.monotonic()
        if event.new == self._pulse.frame:
            self._rest_until = now + REST * (now - self._sent_at)
        if self.session.run.ticket == self._drawn_ticket:
            self._sidebar.catch_up()

    def _on_narrow(self) -> None:
        if self._loaded and self._pulse.narrow:
            self.page.sidebar_open = False
        if self._loaded and self._pulse.phone:
            self.page.header = []
            self._tabs.leave_the_header()

    def _on_key(self, event: Any) -> None:
        action = {
            " ": self.transport.toggle,
            "s": self.transport.step,
            "r": self.transport.reset,
        }[event.new[0]]
        action()
