"""The page: controls at the side, the run at the top, the views that apply below."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn

from app.components.fold import Fold
from app.components.keys import Keys
from app.components.panes import STYLE, column, page, text
from app.components.pulse import pulse
from app.controls.sidebar import Sidebar
from app.picture.glossary import terms_in
from app.session.session import Session
from app.session.state import TABS, WHAT_IF
from app.session.undo import Undo
from app.shell.actions import Actions
from app.shell.address import Sight, settings_from_query, sight_from_query
from app.shell.banner import Banner
from app.shell.delivery import Delivery
from app.shell.gallery import gallery
from app.shell.log import RunLog
from app.shell.looks import PLACES, Looks
from app.shell.notes import Notes
from app.shell.opening import Opening
from app.shell.page_link import PageLink
from app.shell.phone import Phone
from app.shell.presence import Presence
from app.shell.stage import EMBED, PRESENT, Stage
from app.shell.tabs import Tabs
from app.shell.transport import Transport
from app.takeaway.takeaway import Saver
from app.teaching.teaching import Teaching, name_of
from app.views.bodies import deformed
from app.views.catalogue import drawn
from app.whatif.ready import over_k
from app.whatif.whatif import WhatIf
from solver.settings import Settings

AT_RIGHT: dict[str, Any] = {"justify_content": "flex-end", "styles": {"margin-right": "44px"}}
"""In the header, beside the button for keys and words."""
UNDOING = {"Ctrl+z": "undo", "Ctrl+Shift+z": "redo", "Ctrl+y": "redo"}
"""Keys, and what they do."""
FIRST_ROW = 3
"""Plots that a projector, or a frame of a course page, has room for."""


class Dashboard:
    """One page over one session: what is done is told to the session, its pictures are passed on.

    Parameters
    ----------
    session
        What the page shows.
    sight
        What is looked at first; instant and pace are the session's.
    on_phone
        Whether the run comes first, with the settings out of the way and the tabs above it.

    Attributes
    ----------
    page, pulse
        What is served, and its part that has its name.
    """

    def __init__(
        self,
        session: Session,
        *,
        sight: Sight | None = None,
        on_phone: bool = False,
    ) -> None:
        self.session = session
        self._loaded = False
        self._sight = sight or Sight()
        session.worker.wake = partial(session.turns.soon, self.hear)
        self.pulse, self._keys = pulse(), Keys(terms=terms_in(session.say), css_classes=["keys"])
        self._notes, self._log = Notes(session), RunLog(session)
        self._presence = Presence(session, self.pulse)
        self._transport, self._looks = Transport(session), Looks(session)
        chosen = {**self._transport.chooses(), **self._looks.chooses()}
        chosen |= {"drag": self._drag, "tab": self._turn, "bathtub": self._ask_over_k}
        self._gallery = gallery(chosen, session.say)
        self._banner = Banner(session)
        self._sidebar = Sidebar(session, lambda name: self._teaching.open(name))
        self._teaching = Teaching(session, self._sidebar)
        undo = Undo(session, self._teaching.take)
        self._actions = Actions(
            session, self._sidebar.obey, undo, lambda: self._link.copy(), self._present
        )
        self._saver = Saver(session)
        self._live = self._make_live()
        self._tabs = Tabs(session, self._live, WhatIf(session, self._open_run), self._open_run)
        self._delivery = Delivery(
            session, self.pulse, self._gallery, lambda: self._tabs.shows_the_run
        )
        self._furnish(on_phone=on_phone)
        self._listen()
        if self._sight.plots:
            session.draw(self._sight.plots.split(","), is_named=True)
        if self._sight.lesson:
            self._teaching.take(self._sight.lesson)
        else:
            self._arrange()
        self._link = PageLink(session, self.pulse, self._sight.lang)
        self._opening = Opening(session, self.pulse, self._transport, is_still=self._sight.is_still)

    def _furnish(self, *, on_phone: bool) -> None:
        """Make the page of its parts, in the theme and the view that are looked at first."""
        acts = self._actions.view, self._saver.view
        beside = pn.FlexBox(*acts, flex_wrap="nowrap", **AT_RIGHT)
        header = [self._tabs.bar, beside]
        self.page = page(self._sidebar.view, header, self._tabs.main, self.session.say)
        controls = [self._transport.view, self._looks.view, beside, self._sidebar.view]
        self._phone = Phone(self.page, self._tabs, self._live, controls, self.session.say)
        if on_phone:
            self._phone.fit()
        self.page.dark_theme = self._sight.theme == "dark"
        self._stage = Stage(self.session, self.page, self._live, self._gallery)
        self.session.view = self._sight.view
        self._dress()

    def loaded(self) -> None:
        """Begin to run and to draw, now that a browser has built the page.

        Whoever only asks for the page, as a crawler does, starts no process.
        """
        self._loaded = True
        self._presence.begin()
        self._recall()
        self._begin(self._sight.iteration)
        self._on_narrow()
        self._keys.hears = self._teaching.view.recalls = self.pulse.recalls = True
        if self.session.view == EMBED and self.session.look.complaint:
            # There is no status line to say it.
            self.session.refusal = self.session.look.complaint
        with self._link.going_back():
            self.session.tab = self._sight.tab
        self.session.turns.begin()

    def _begin(self, iteration: int) -> None:
        """Start the run, to go on or to wait at an iteration; in a class, as that is."""
        session = self.session
        if room := session.attendance.follows:
            session.start(room.settings)
            # What the class shows stands there as the page is seen, and not from the next news on.
            session.attendance.note()
            return
        session.running = iteration == 0
        session.start()
        if iteration > 1:
            session.step(iteration - 1)

    def hear(self) -> None:
        """Take what the worker has said, and give the browser the pictures among it."""
        with pn.io.hold():
            for block in self.session.collect():
                self._delivery.send(block)

    def _listen(self) -> None:
        self.pulse.on("leads", self._lead_again)
        self.pulse.on("went", self._go_to)
        self.pulse.param.watch(lambda event: self._on_narrow(), "narrow")
        undoes = {key: partial(self._actions.hear, kind) for key, kind in UNDOING.items()}
        does: dict[str, Callable[[], Any]] = {**self._transport.keys(), **undoes}
        does["p"] = self._stage.toggle
        self._keys.on_msg(lambda message: does[message.data]())
        self._gallery.param.watch(lambda event: self._recall(), "recalls")
        watch = self.session.param.watch
        watch(lambda event: self._gallery.param.update(keeps=list(event.new)), "keeps")
        watch(lambda event: self._on_tab(), "tab")
        watch(lambda *events: self._on_lesson(), ["lesson", "asks"])
        watch(lambda event: self._dress(), "view")
        watch(lambda event: self._on_class(), "in_class")
        watch(lambda *events: self._place(), ["facts", "settings"])
        arranged = ["wanted", "chosen", "lesson", "asks", "view", "tab", "room"]
        watch(lambda *events: self._arrange(), arranged)
        watch(self._on_look, "look")

    def _make_live(self) -> pn.Column:
        words, figures = (text(role=role, tags=[role]) for role in ("status", "figures"))
        label = self.session.say("Method")
        whole = Fold(label=label, css_classes=["whole"], width=76, kept_as="method-figures")
        heads = self._banner.view, self._teaching.view, self._transport.view
        folding = column(whole, figures, role="folding")
        parts = *heads, self._looks.view, words, folding, self._gallery, self.pulse, self._keys
        return column(*parts, role="live", margin=(4, 10), stylesheets=[STYLE, PLACES])

    def _arrange(self) -> None:
        """Show the views that are chosen and apply."""
        session, room = self.session, self.session.room
        chosen = (room.views if room else ()) or session.chosen
        self._shown = [] if session.asks else drawn(session.wanted, chosen)
        few = self._stage.is_bare and not session.is_named
        there = self._shown[: FIRST_ROW if few else None]
        self._transport.view.visible = self._looks.view.visible = room is None
        self._saver.view.visible = room is None and self._tabs.shows_the_run
        is_free = not (room or session.lesson or self._stage.is_bare)
        self._gallery.offer(there, session.wanted, has_tabs=is_free)
        self._gallery.let_drag(session.wanted, self._teaching.controls, session.look.units)
        self._saver.offer(there)
        # The worker sends what a view had already only when the choice of views changes.
        session.watch(views=tuple(view.name for view in there))
        self._place()

    def _place(self) -> None:
        """Have the widgets stand there that choose anything at present."""
        self._looks.draw_bodies(is_wanted=deformed.VIEW in self._shown)
        self._transport.place(self._looks.parts())

    def _lead_again(self, ticket: str) -> None:
        attendance = self.session.attendance
        if attendance.follows is None and attendance.resume(ticket):
            self.session.ask(afresh=True)

    def _present(self) -> None:
        self.session.tab = TABS[0]
        self._stage.toggle()

    def _go_to(self, query: str) -> None:
        """Show what the browser has gone back to, or on to; what was asked for is kept."""
        with self._link.going_back():
            if self.session.room is None:
                lesson = self._link.restore(query)
                if lesson != name_of(self.session.lesson):
                    self._teaching.take(lesson)
            self.session.tab = sight_from_query(query)[0].tab

    def _drag(self, told: dict[str, Any]) -> None:
        self._sidebar.hear(**told)

    def _turn(self, names: list[str]) -> None:
        """Draw a view in place of another one."""
        session, (seen, other) = self.session, names
        drawn_now = {view.name for view in drawn(session.wanted, session.chosen)}
        session.draw(drawn_now - {seen} | {other})

    def _recall(self) -> None:
        """Draw what was chosen for the scene last; a frame shows what its address says."""
        if self._loaded and self.session.view != EMBED:
            self.session.recall(self._gallery.recalls)

    def _ask_over_k(self, _: Any) -> None:
        """Have the fields of *What if* ask over k alone, ready to be started."""
        with self.session.together():
            self.session.question = over_k(self.session.wanted)
            self.session.tab = WHAT_IF

    def _dress(self) -> None:
        """Have the style sheet know the view, and whether there is a lesson or its question."""
        classes = ["taught", "asks"] if self.session.asks else ["taught"]
        lesson = classes if self.session.lesson else []
        # What has a layout of its own does not go away when it is not to be visible.
        laid_out = lesson if self._tabs.shows_the_run else []
        view = [self.session.view] if self._stage.is_bare else []
        self._live.css_classes = ["live", *view, *laid_out]
        self._stage.magnify(has_lesson=bool(lesson))
        self._teaching.view.is_strip = self._keys.presents = self.session.view == PRESENT
        self._phone.dress(is_bare=self._stage.is_bare)

    def _on_lesson(self) -> None:
        """Make room for a lesson, for its question alone, or for all else."""
        self._dress()
        is_aside = self.session.lesson or self.pulse.narrow or self._stage.is_bare
        self.page.sidebar_open = not is_aside
        self.session.tab = TABS[0]

    def _on_look(self, event: Any) -> None:
        if event.new.units != event.old.units:
            self._arrange()

    def _on_class(self) -> None:
        """Have the browser keep what leads the class again; show what it shows."""
        self.pulse.leads = self.session.attendance.ticket
        if self.session.room is not None:
            self._arrange()

    def _on_narrow(self) -> None:
        if self._loaded and self.pulse.narrow:
            self.page.sidebar_open = False
        if self._loaded and self.pulse.phone:
            self._phone.fit()

    def _on_tab(self) -> None:
        self._keys.hears = self._tabs.shows_the_run
        self._sidebar.show_for(self._tabs.report)
        self._dress()
        if self._tabs.shows_the_run:
            self.session.ask(afresh=True)

    def _open_run(self, chosen: Settings | str) -> None:
        """Show the run of a point of a chart, or of an address."""
        settings = settings_from_query(chosen)[0] if isinstance(chosen, str) else chosen
        with self.session.together():
            self.session.tab = TABS[0]
            self.session.adopt(settings)
            self.session.go()
