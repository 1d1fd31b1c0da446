"""The page: controls at the side, the run at the top, the views that apply below."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.util import edit_readonly

from app.cards import Cards
from app.looks import Looks
from app.painter import Painter
from app.pulse import Pulse, send_without_delay
from app.session import Session
from app.sidebar import Sidebar
from app.tabs import Tabs
from app.transport import Transport
from app.views.drawing import Picture, View
from app.words import key_figures, status_line

STATIC = Path(__file__).resolve().parents[1] / "static"
TICK_MS = 25
FIRST_ROW = 3
DIMMED = {"opacity": "0.35"}
"""Of plots that do not show the run at work yet."""


class Dashboard:
    """One page over one session: what is done is told to the session, what it holds is drawn.

    Parameters
    ----------
    session
        What the page shows.
    complaint
        What was refused in the page's address; it is shown until a setting changes.
    on_phone
        Whether the run comes first, with the settings out of the way and the tabs above it.

    Attributes
    ----------
    page
        What is served.
    """

    def __init__(self, session: Session, *, complaint: str = "", on_phone: bool = False) -> None:
        self.session = session
        self._complaint = complaint
        self._asked_for = session.wanted
        self._alone = True
        self._loaded = False
        self._style = (STATIC / "style.css").read_text(encoding="utf-8")
        self._pulse = Pulse()
        self._painter = Painter(self._pulse)
        self._listen()
        self.transport = Transport(session, self._painter.mark)
        self._looks = Looks(session, self._painter.mark)
        self._cards = Cards(
            self._style,
            self.transport.choose_time,
            self.transport.choose_substructure,
            lambda: self._looks.magnification,
        )
        self._sidebar = Sidebar(session, self._arrange, self.complain, self._copy)
        self._status = self._html("status")
        self._figures = self._html("figures")
        self._plots = pn.Column(
            sizing_mode="stretch_width", css_classes=["plots"], stylesheets=[self._style], margin=0
        )
        self._live = self._make_live()
        self._tabs = Tabs(session, self._live, self._style, self._on_tab)
        self.page = self._make_page()
        if on_phone:
            self.page.sidebar_open = False
            self._clear_the_header()
        self._sidebar.show(session.wanted)
        self._arrange()

    def loaded(self) -> None:
        """Begin to run and to draw, now that a browser has built the page.

        Whoever only asks for the page, as a crawler does, starts no process.
        """
        self._loaded = True
        self._alone = False
        self.session.start()
        send_without_delay()
        # The first row comes first: two thirds of what the page is made of are not in it.
        self._sidebar.fill()
        self._arrange()
        self._on_narrow()

    def tick(self) -> None:
        """Keep the page alive: run while a browser shows it, and draw what came."""
        alone = self._connections() == 0 or self._pulse.hidden or not self._loaded
        if alone != self._alone:
            self._alone = alone
            self.session.rest(alone)
        if self.session.attend():
            self._tabs.refresh()
            self._painter.mark()
        self._sidebar.obey()
        self._collect()

    def end(self, context: Any) -> None:
        """Leave nothing behind when the page is gone."""
        self.session.close()

    def complain(self, text: str) -> None:
        """Tell the user what was refused and why."""
        if pn.state.notifications is not None:
            pn.state.notifications.error(text, duration=8000)

    def _listen(self) -> None:
        self._pulse.param.watch(self._on_painted, "painted")
        self._pulse.param.watch(self._on_key, "key")
        self._pulse.param.watch(lambda event: self._on_narrow(), "narrow")

    def _make_live(self) -> pn.Column:
        return pn.Column(
            self.transport.view,
            self._status,
            self._figures,
            self._plots,
            self._pulse,
            css_classes=["live"],
            stylesheets=[self._style],
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
        fitting = self._cards.fitting(settings)
        wanted = self._sidebar.offer([view.name for view in fitting])
        shown = [view for view in fitting if view.name in wanted]
        self.transport.arrange(settings)
        cards = [self._cards.card_of(view) for view in shown[: None if self._loaded else FIRST_ROW]]
        if list(self._plots) != cards:
            self._plots[:] = cards
        self.session.set_watch(frozenset(view.watches for view in shown if view.watches))
        self._shown = shown
        self._offer_looks()
        self._tabs.refresh()
        self._painter.mark()

    def _offer_looks(self) -> None:
        bodies = any(view.watches == "mesh" for view in self._shown)
        self.transport.place(self._looks.parts(shows_bodies=bodies))

    def _collect(self) -> None:
        """Take what the worker sent and draw it, if the page has painted what it has."""
        if self.session.collect():
            self._painter.mark()
        if not (self._loaded and self._tabs.shows_the_run):
            return
        if self._painter.is_due():
            with pn.io.hold():
                self._draw(self._shown)
                self._painter.send()

    def _draw(self, views: Sequence[View]) -> None:
        """Draw all views, and the words about the run."""
        session = self.session
        frame = session.shown
        picture = Picture(session.run, session.before, tuple(session.past), frame, session.instant)
        for view in views:
            self._cards.draw(view, picture)
        sought = frame.iteration if frame is not None and not session.follows else None
        self._status.object = status_line(
            session.run,
            session.running,
            sought,
            held=session.is_held,
            complaint=self._complaint if session.wanted is self._asked_for else "",
        )
        self._plots.styles = {} if frame is not None else DIMMED
        self._offer_looks()
        self.transport.show()
        entry = session.run.record_of(frame) if frame is not None else None
        self._figures.object = key_figures(session.run, session.before, entry)

    def _connections(self) -> int:
        context = pn.state.curdoc.session_context if pn.state.curdoc else None
        return int(context.session.connection_count) if context is not None else 0

    def _on_painted(self, event: Any) -> None:
        if self.session.shown is not None:
            self._sidebar.catch_up()

    def _on_narrow(self) -> None:
        if self._loaded and self._pulse.narrow:
            self.page.sidebar_open = False
        if self._loaded and self._pulse.phone:
            self._clear_the_header()

    def _clear_the_header(self) -> None:
        self.page.header = []
        self._tabs.leave_the_header()

    def _on_tab(self) -> None:
        self._pulse.hears = self._tabs.shows_the_run
        self._painter.mark()

    def _on_key(self, event: Any) -> None:
        action = {
            " ": self.transport.toggle,
            "s": self.transport.step,
            "r": self.transport.reset,
        }[event.new[0]]
        action()
