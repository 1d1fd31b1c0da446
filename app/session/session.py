"""A page's state and its one owner: settings, what is looked at, and the worker that has the run.

All of it happens on the page's own event loop; pictures go through as bytes.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from app.picture.labels import difference
from app.picture.usual import hurried, shown, usual_settings
from app.session.asked import Asked
from app.session.attendance import Attendance
from app.session.page_worker import AGAIN, GIVEN_UP, Hire, PageWorker
from app.session.pages import Pages
from app.session.report_executor import ReportExecutor
from app.session.state import State
from app.session.turns import Turns
from app.session.uploads import cut_off
from app.wire.block import said
from app.wire.orders import Bring, Pace, Rate, Ready, Run, Seek, Step, Watch
from app.wire.reports import Died, Facts, Picture
from app.worker.link import Link
from app.worker.words import REPLAYED
from solver.files import scene_settings
from solver.settings import Settings

HELD_STILL = 0.5
"""Seconds after which a slider that does not move counts as let go."""
LEFT_ALONE = 180.0
"""Seconds after which a page that nobody sees gives its process back."""
LOOKS = 0.2
"""Seconds between two looks at reports and the sweep: another machine may make them, by files."""


class Session(State):
    """The state of one page, and what changes it.

    Parameters
    ----------
    pages
        Those of this server; this one is added.
    executor
        Where reports are made.
    settings
        Of the first run, for which `start` has to be called.
    hire
        Gives a worker process.
    turns
        On the event loop; without it nothing comes by itself.

    Attributes
    ----------
    follows_hand, is_held
        Whether a slider is dragged, and whether the run stands still for a study that is timed.
    asked
        The reports and the sweep of this page.
    crowd
        Most runs of other pages that were at work at a time during the last study.
    worker, attendance
        Have the worker process, and the page's part in a class.
    """

    def __init__(
        self,
        pages: Pages,
        executor: ReportExecutor,
        settings: Settings,
        hire: Hire = Link,
        turns: Turns | None = None,
    ) -> None:
        super().__init__(settings=settings, wanted=settings)
        self.turns = turns or Turns()
        self.worker = PageWorker(hire)
        self.attendance = Attendance(self, self.worker, hire, self.turns, self.start)
        self.crowd, self.follows_hand, self.is_held = 0, False, False
        timer = self.turns.timer
        self._stands_still, self._is_left_alone = timer(self._stand_still), timer(self._give_back)
        self._looks = timer(self.attend)
        self.asked = Asked(executor, partial(self._looks.set, LOOKS))
        self._left: dict[str, Settings] = {}
        self._label, self._by_hand = "", False
        self._due: Settings | None = None
        self._agreed: Settings | None = None
        self._pages = pages
        pages.add(self)

    def start(
        self, settings: Settings | None = None, *, follows_hand: bool = False, **how: Any
    ) -> None:
        """Start a run, with new settings or those that are wanted, in place of the one at work.

        What it means to follow a hand, and all of `how`, stands with the order `Run`.
        """
        settings = settings or self.wanted
        with self.together():
            self.attendance.heed(settings)
            if settings.scene != self.settings.scene:
                self._left[self.settings.scene] = self.wanted
                self._label, self.twin = "", None
                self.watch(interface="", substructure=None, place=None, is_held=False)
            elif self.ticket:
                self._label = difference(settings, self.settings, self.look.units) or self._label
            if "is_alone" in how:
                self._label, self.twin = "", None
            self.settings, self.facts, self._due = settings, None, None
            self._want(settings)
            self.ticket += 1
            self.worker.renew()
            self.follows_hand = follows_hand and self._is_free
            self._work(**how)

    def change(self, name: str, value: Any, *, by_hand: bool = False) -> None:
        """Change one setting; the run starts again as soon as the last change was shown.

        One `by_hand` is one of many, until `let_go`; one that a `SettingError` refuses is not made.
        """
        self.adopt(shown(self.wanted.with_change(name, value), self.wanted), by_hand=by_hand)

    def adopt(self, settings: Settings, *, by_hand: bool = False) -> None:
        """Take new settings as a whole; those of another scene start at once."""
        if settings.scene != self.settings.scene:
            self.start(settings)
        elif settings.values() != self.settings.values() or self._due is not None:
            with self.together():
                self._due, self._by_hand = settings, by_hand
                if by_hand:
                    self.watch(is_held=True)
                    self._stands_still.set(HELD_STILL)
                self._want(settings)
                self._start_due()

    def let_go(self) -> None:
        """Replay the iteration of what a hand has chosen, to a scale that suits it."""
        self.watch(is_held=False)
        self._stand_still()

    def _stand_still(self) -> None:
        self._stands_still.stop()
        self._by_hand = False
        if self.follows_hand:
            self._due = self.wanted
            self._start_due()

    def choose_scene(self, scene: str) -> None:
        """Go to another scene, with the settings that it was left with, or its defaults."""
        if scene != self.wanted.scene:
            self.adopt(self._left.get(scene) or usual_settings(scene_settings(scene)))

    def collect(self) -> list[bytes]:
        """Take the waiting reports; give the pictures that the page has to be given."""
        blocks: list[bytes] = []
        with self.together():
            for report in self.worker.collect():
                blocks.append(self._bury() if isinstance(report, Died) else report.block)
                if isinstance(report, Picture):
                    self.attendance.share(self.settings, self.look.views, report)
                    if report.ticket == self.ticket:
                        self.facts = report.facts
                        self.worker.note(report.facts.done)
            self._start_due()
        return blocks

    def ask(self, *, rest: float = 0.0, afresh: bool = False) -> None:
        """Have the next picture made, after some seconds of rest."""
        self.worker.send(Ready(afresh, rest, whole=self.attendance.leads is not None))

    def go(self) -> None:
        """Let iterations go on by themselves; a run that ended, or broke, starts again."""
        self.running = True
        if self.is_over:
            self._replay()
        else:
            self.worker.send(Seek(self.ticket, None))
            self._keep_pace()

    def pause(self) -> None:
        """Wait after the present iteration."""
        self.running = False
        self.worker.send(Pace(self.ticket, 0.0))

    def step(self, count: int = 1) -> None:
        """Do so many iterations and wait; a run that ended, or broke, starts again."""
        self.running = False
        if self.is_over:
            self._replay()
        else:
            self.worker.send(Step(self.ticket, count))

    def set_pace(self, pace: Rate) -> None:
        """Set how the run goes on."""
        self.pace = pace
        self._keep_pace()

    def seek(self, iteration: int) -> None:
        """Look at an iteration that was done already; the last one follows the run."""
        is_past = self.facts is not None and iteration < self.facts.done
        self.worker.send(Seek(self.ticket, iteration if is_past else None))

    def watch(self, **changes: Any) -> None:
        """Look elsewhere."""
        look = replace(self.look, **changes)
        if look != self.look:
            self.look = look
            self.worker.send(Watch(look))

    def close(self) -> None:
        """Leave: the process of the run ends, and so do the reports."""
        self.turns.close()
        self.worker.close()
        self.attendance.close()
        self._pages.remove(self)
        self.asked.cancel()

    def rest(self, alone: bool) -> None:
        """Hold the run while nobody sees the page, and let it go on afterwards."""
        self.worker.is_alone = alone
        self._is_left_alone.set(LEFT_ALONE) if alone else self._is_left_alone.stop()
        if not alone and self.worker.link is None and self.ticket and not self.is_over:
            self._work()
        else:
            self._keep_pace()

    def attend(self) -> bool:
        """See what reports and the sweep have come to, and soon again; tell if that is new."""
        is_new = self.asked.collect()
        if self.asked.study.is_begun != self.is_held:
            self.is_held = not self.is_held
            self.crowd = 0 if self.is_held else self.crowd
            self._keep_pace()
        if self.is_held:
            self.crowd = max(self.crowd, self._pages.at_work_beside(self))
        if self.asked.is_busy:
            self._looks.set(LOOKS)
        self.reported += is_new
        return is_new

    @property
    def is_at_work(self) -> bool:
        """Whether iterations of the run go on at present."""
        return self.worker.link is not None and not self.is_over and self._is_free

    @property
    def _is_free(self) -> bool:
        """Whether iterations go on by themselves at present."""
        return self.running and not self.worker.is_alone and not self.is_held

    def _want(self, settings: Settings) -> None:
        """Take it that these are wanted: what was refused before is past."""
        if settings is not self.wanted:
            self.wanted, self.refusal = settings, ""
            self.watch(complaint="")

    def _start_due(self) -> None:
        """Start with what is wanted, once the run before was shown."""
        if self._due is not None and (self.facts is not None or self.ticket == 0):
            self.start(self._due, warm=self.warm_start, follows_hand=self._by_hand)

    def _give_back(self) -> None:
        """End the process of a page that nobody sees."""
        self.worker.part()
        self.facts = None

    def _replay(self) -> None:
        if self.facts is not None and self.facts.asks:
            self._agreed = self.settings
        self.start(notice=REPLAYED if self.facts and self.facts.is_over else "")

    def _keep_pace(self) -> None:
        if self.goes_on:
            self.worker.send(Pace(self.ticket, self.rate if self._is_free else 0.0, self.is_held))

    def _work(self, *, notice: str = "", **how: bool) -> None:
        """Have a process do the run from its beginning."""
        notices = AGAIN if self.worker.deaths else notice, cut_off(self.settings)
        self.worker.begin(Watch(self.look), Bring(self.brought), Ready())
        self.worker.send(
            Run(
                self.ticket,
                hurried(self.settings) if self.follows_hand else self.settings,
                label=self._label,
                notice=" ".join(filter(None, notices)),
                pace=None if self.follows_hand else self.rate,
                pause_after=None if self._is_free else 1,
                is_held=self.is_held,
                is_agreed=self.settings is self._agreed,
                **how,
                follows_hand=self.follows_hand,
                twin=self.twin,
            )
        )

    def _bury(self) -> bytes:
        """Follow the end of a process: start the run again, or give it up; say so."""
        self.facts = None if (again := self.worker.may_try_again) else Facts(is_broken=True)
        if again:
            self._work()
        return said(AGAIN if again else GIVEN_UP)
