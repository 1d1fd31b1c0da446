"""A page's state and its one owner: settings, what is looked at, and the worker that has the run.

All of it happens on the page's own event loop; pictures go through as bytes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from app.picture.labels import changes_of, label_of
from app.picture.shown import Look
from app.session.attendance import Attendance
from app.session.bench import Bench
from app.session.errand import Errand
from app.session.inquiry import Inquiry
from app.session.keeper import AGAIN, GIVEN_UP, Hire, Keeper
from app.session.pages import Pages
from app.session.pending import Pending
from app.session.uploads import cut_off
from app.wire.block import said
from app.wire.orders import Pace, Ready, Run, Seek, Step, Watch
from app.wire.reports import Died, Facts, Picture
from app.worker.link import Link
from app.worker.words import REPLAYED
from solver.files import scene_settings
from solver.settings import Settings

DEFAULT_PACE = 20.0


class Session:
    """The state of one page.

    Parameters
    ----------
    pages
        Those of this server; this one is added.
    bench
        Where reports are made.
    settings
        Of the first run, for which `start` has to be called.
    hire
        Gives a worker process.

    Attributes
    ----------
    settings
        Of the run at work.
    twin
        Those of run A, which goes in step with it as run B, from the next start on; None has none.
    ticket
        Its number; 0 before the first.
    facts
        What its newest picture says; None before there is one.
    look
        Where one looks.
    running, pace
        Whether iterations go on by themselves, and how many a second (None: all it can).
    warm_start
        Whether a changed setting starts from the run before, where that is better.
    follows_hand, is_held
        Whether the run is one of many while a slider is dragged, and whether it stands still for a
        study that is timed.
    figures, study, stability, inquiry
        The reports and the sweep that this page has asked for.
    crowd
        Most runs of other pages that were at work at a time during the last study.
    keeper, attendance
        Have the worker process, and the page's part in a class.
    """

    def __init__(self, pages: Pages, bench: Bench, settings: Settings, hire: Hire = Link) -> None:
        self.settings = settings
        self.keeper = Keeper(hire)
        self.attendance = Attendance(self.keeper, hire)
        self.twin: Settings | None = None
        self.ticket = self.crowd = 0
        self.facts: Facts | None = None
        self.look = Look()
        self.running = True
        self.pace: float | None = DEFAULT_PACE
        self.warm_start = self.follows_hand = self.is_held = False
        self.figures, self.study, self.stability = (Errand(bench) for _ in range(3))
        self.inquiry = Inquiry()
        self._asked = self.figures, self.study, self.stability, self.inquiry
        self._left: dict[str, Settings] = {}
        self._label = ""
        self._pending = Pending()
        self._pages = pages
        pages.add(self)

    def start(
        self, settings: Settings | None = None, *, follows_hand: bool = False, **how: Any
    ) -> None:
        """Start a run, with new settings or those that are wanted, in place of the one at work.

        What it means to follow a hand, and all of `how`, stands with the order `Run`.
        """
        settings = settings or self.wanted
        self.attendance.heed(settings)
        if settings.scene != self.settings.scene:
            self._left[self.settings.scene] = self.wanted
            self._label, self.twin = "", None
            self.watch(interface="", substructure=None, place=None)
        elif self.ticket:
            self._label = label_of(settings, changes_of(settings, self.settings)) or self._label
        if "is_alone" in how:
            self._label, self.twin = "", None
        self.settings = settings
        self.ticket += 1
        self.facts = self._pending.settings = None
        self.keeper.renew()
        self.follows_hand = follows_hand and self._is_free
        self._work(**how)

    def change(self, name: str, value: Any, *, by_hand: bool = False) -> None:
        """Change one setting; the run starts again as soon as the last change was shown.

        A change `by_hand` is one of many while a slider is dragged, until it is `let_go`.

        Raises
        ------
        SettingError
            If the value is refused; then nothing changes.
        """
        self.adopt(self.wanted.with_change(name, value), by_hand=by_hand)

    def adopt(self, settings: Settings, *, by_hand: bool = False) -> None:
        """Take new settings as a whole; those of another scene start at once."""
        if settings.scene != self.settings.scene:
            self.start(settings)
        elif settings.values() != self.settings.values() or self._pending.settings is not None:
            self._pending.put(settings, by_hand=by_hand)
            self._start_pending()

    def let_go(self) -> None:
        """Replay the iteration of what a hand has chosen."""
        self._pending.by_hand = False
        if self.follows_hand:
            self._pending.settings = self.wanted
            self._start_pending()

    def choose_scene(self, scene: str) -> None:
        """Go to another scene, with the settings that it was left with, or its defaults."""
        if scene != self.wanted.scene:
            self.adopt(self._left.get(scene) or scene_settings(scene).checked({}))

    def collect(self) -> list[bytes]:
        """Take the waiting reports; give the pictures that the page has to be given."""
        blocks: list[bytes] = []
        for report in self.keeper.collect():
            blocks.append(self._bury() if isinstance(report, Died) else report.block)
            if isinstance(report, Picture):
                self.attendance.share(self.settings, self.look.views, report)
                if report.ticket == self.ticket:
                    self.facts = report.facts
                    self.keeper.note(report.facts.done)
        self._start_pending()
        return blocks

    def ask(self, *, rest: float = 0.0, afresh: bool = False) -> None:
        """Have the next picture made, after some seconds of rest."""
        self.keeper.send(Ready(afresh, rest, whole=self.attendance.leads is not None))

    def go(self) -> None:
        """Let iterations go on by themselves; a run that ended, or broke, starts again."""
        self.running = True
        if self.is_over:
            self._replay()
        else:
            self.keeper.send(Seek(self.ticket, None))
            self._keep_pace()

    def pause(self) -> None:
        """Wait after the present iteration."""
        self.running = False
        self.keeper.send(Pace(self.ticket, 0.0))

    def step(self, count: int = 1) -> None:
        """Do so many iterations and wait; a run that ended, or broke, starts again."""
        self.running = False
        if self.is_over:
            self._replay()
        else:
            self.keeper.send(Step(self.ticket, count))

    def set_pace(self, pace: float | None) -> None:
        """Set the iterations per second."""
        self.pace = pace
        self._keep_pace()

    def seek(self, iteration: int) -> None:
        """Look at an iteration that was done already; the last one follows the run."""
        is_past = self.facts is not None and iteration < self.facts.done
        self.keeper.send(Seek(self.ticket, iteration if is_past else None))

    def watch(self, **changes: Any) -> None:
        """Look elsewhere."""
        look = replace(self.look, **changes)
        if look != self.look:
            self.look = look
            self.keeper.send(Watch(look))

    def close(self) -> None:
        """Leave: the process of the run ends, and so do the reports."""
        self.keeper.close()
        self.attendance.close()
        self._pages.remove(self)
        for one in self._asked:
            one.cancel()

    def rest(self, alone: bool) -> None:
        """Hold the run while nobody sees the page, and let it go on afterwards."""
        self.keeper.rest(alone)
        if not alone and self.keeper.link is None and self.ticket and not self.is_over:
            self._work()
        else:
            self._keep_pace()

    def attend(self) -> bool:
        """Do what is due: hear the reports, hold the run while one is timed; tell if it is new."""
        if self.keeper.give_back():
            self.facts = None
        if self.follows_hand and self._pending.is_still:
            self.let_go()
        heard = [one.collect() for one in self._asked]
        if self.study.is_begun != self.is_held:
            self.is_held = not self.is_held
            self.crowd = 0 if self.is_held else self.crowd
            self._keep_pace()
        if self.is_held:
            self.crowd = max(self.crowd, self._pages.at_work_beside(self))
        return any(heard)

    @property
    def is_over(self) -> bool:
        """Whether the run ended or broke: only another run can go on."""
        return self.facts is not None and (self.facts.is_over or self.facts.is_broken)

    @property
    def goes_on(self) -> bool:
        """Whether the run is one that goes on until the user pauses it."""
        return self.running and not self.is_over

    @property
    def is_at_work(self) -> bool:
        """Whether iterations of the run go on at present."""
        return self.keeper.link is not None and not self.is_over and self._is_free

    @property
    def wanted(self) -> Settings:
        """The settings that the user sees: of the run at work, or of the one about to start."""
        return self._pending.settings or self.settings

    @property
    def _is_free(self) -> bool:
        """Whether iterations go on by themselves at present."""
        return self.running and not self.keeper.is_alone and not self.is_held

    def _start_pending(self) -> None:
        """Start with what is wanted, once the run before was shown."""
        wanted = self._pending.settings
        if wanted is not None and (self.facts is not None or self.ticket == 0):
            self.start(wanted, warm=self.warm_start, follows_hand=self._pending.by_hand)

    def _replay(self) -> None:
        self.start(notice=REPLAYED if self.facts and self.facts.is_over else "")

    def _keep_pace(self) -> None:
        if self.goes_on:
            pace = self.pace if self._is_free else 0.0
            self.keeper.send(Pace(self.ticket, pace, self.is_held))

    def _work(self, *, notice: str = "", **how: bool) -> None:
        """Have a process do the run from its beginning."""
        again = AGAIN if self.keeper.deaths else notice
        self.keeper.begin(Watch(self.look), Ready())
        self.keeper.send(
            Run(
                self.ticket,
                self.settings.scene,
                self.settings.values(),
                label=self._label,
                notice=" ".join(filter(None, (again, cut_off(self.settings)))),
                pace=None if self.follows_hand else self.pace,
                pause_after=None if self._is_free else 1,
                is_held=self.is_held,
                **how,
                follows_hand=self.follows_hand,
                twin=self.twin.values() if self.twin else None,
            )
        )

    def _bury(self) -> bytes:
        """Follow the end of a process: start the run again, or give it up; say so."""
        self.facts = None if (again := self.keeper.may_try_again) else Facts(is_broken=True)
        if again:
            self._work()
        return said(AGAIN if again else GIVEN_UP)
