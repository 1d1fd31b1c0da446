"""A page's state and its one owner: settings, the run at work, the run before, what is looked at.

Reports of the worker arrive on another thread and wait in a mailbox; everything else happens on
the page's own event loop.
"""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from app.errand import Errand
from app.pages import Pages
from app.recording import Recording
from app.worker.bench import Bench
from app.worker.link import Link
from app.worker.orders import Look, Order, Pace, Run, Seek, Step, Watch
from app.worker.reports import Died, Frame, Refused, Report
from app.worker.shown import instant_of
from solver.definitions import about
from solver.files import scene_settings
from solver.settings import Settings

_log = logging.getLogger(__name__)

PAST_RUNS = 6
DEFAULT_PACE = 20.0
LEFT_ALONE = 180.0
"""Seconds after which a page that nobody sees gives its process back."""
RESTARTS = 2
"""Times that a run is started again after its process died."""
AGAIN = "The worker stopped unexpectedly; the run was started again."
GIVEN_UP = (
    "The worker stopped unexpectedly several times; the run was given up. Lower the numbers of "
    "elements and instants, or start it again."
)
AT_THE_INSTANT = frozenset({"mesh", "axial"})
"""What frames carry for the chosen instant alone."""


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
        Gives a worker process, whose reports go to what it is called with.

    Attributes
    ----------
    settings
        Of the run at work.
    run, before
        The run at work, and the last one worth comparing with.
    past
        Finished runs, oldest first, for error against run time.
    instant
        Index of the chosen instant among those that frames carry.
    look
        Where one looks: the interface, the instant as a share of the interval, and the stress.
    substructure
        The one whose modes are looked at, counted from 0; None is the last one.
    running, pace
        Whether iterations go on by themselves, and how many a second (None: all it can).
    warm_start
        Whether a changed setting starts from the run before, where that is better; a run that is
        reset never does. It is no setting of the method: a run alone has none before it.
    follows
        Whether the newest iterate is looked at, not one that was sought.
    figures, study, stability
        The reports that this page has asked for.
    crowd
        Most runs of other pages that were at work at a time during the last study.
    wake
        Called on another thread when the first frame of a run has come.
    """

    def __init__(
        self,
        pages: Pages,
        bench: Bench,
        settings: Settings,
        hire: Callable[[Callable[[Report], None]], Link] = Link,
    ) -> None:
        self.settings = settings
        self.wake: Callable[[], None] = lambda: None
        self.before: Recording | None = None
        self.past: deque[Recording] = deque(maxlen=PAST_RUNS)
        self.instant = 0
        self.look = Look()
        self._left: dict[str, Settings] = {}
        self.substructure: int | None = None
        self.running = True
        self.pace: float | None = DEFAULT_PACE
        self.warm_start = False
        self.watch: frozenset[str] = frozenset()
        self.follows = True
        self.figures, self.study, self.stability = (Errand(bench) for _ in range(3))
        self.crowd = 0
        self._alone = False
        self._held = False
        self._mailbox: deque[tuple[int, Report]] = deque()
        self._lock = threading.Lock()
        self._hire = hire
        self._link: Link | None = None
        self._hired = 0
        self._deaths = 0
        self._closed = False
        self._alone_since = 0.0
        self._pages = pages
        pages.add(self)
        self._pending: Settings | None = None
        self.run = Recording(0, settings, "")

    def start(self, settings: Settings | None = None, *, warm: bool = False) -> None:
        """Start a run, with new settings or those that are wanted, in place of the one at work.

        A `warm` one starts from the last iterate of the run at work, where that is better.
        """
        settings = settings or self.wanted
        if settings.scene == self.settings.scene:
            self._retire()
        else:
            self._leave_scene()
        before = self.settings.values() if settings.scene == self.settings.scene else {}
        changed = {
            name: value for name, value in settings.values().items() if value != before.get(name)
        }
        self.settings = settings
        label = self.run.label if before else ""
        label = _label(self.settings, changed) if before and changed else label
        self.run = Recording(self.run.ticket + 1, self.settings, label, is_warm=warm)
        self.follows = True
        self._pending = None
        self._deaths = 0
        self._work(warm=warm)

    def change(self, name: str, value: Any) -> None:
        """Change one setting; the run starts again as soon as the last change was shown.

        Raises
        ------
        SettingError
            If the value is refused; then nothing changes.
        """
        self.adopt((self._pending or self.settings).with_change(name, value))

    def adopt(self, settings: Settings) -> None:
        """Take new settings as a whole; those of another scene start at once."""
        if settings.scene != self.settings.scene:
            self.start(settings)
            return
        if settings.values() == self.settings.values() and self._pending is None:
            return
        self._pending = settings
        if self.run.newest is not None or self.run.notice or self.run.ticket == 0:
            self.start(settings, warm=self.warm_start)

    def choose_scene(self, scene: str) -> None:
        """Go to another scene, with the settings that it was left with, or its defaults."""
        if scene != self.wanted.scene:
            self.adopt(self._left.get(scene) or scene_settings(scene).checked({}))

    def collect(self) -> bool:
        """Take the waiting reports; tell whether anything is new."""
        with self._lock:
            reports = [report for number, report in self._mailbox if number == self._hired]
            self._mailbox.clear()
        for report in reports:
            if isinstance(report, Died):
                self._bury()
            elif report.ticket == self.run.ticket:
                self._take(report)
        if reports and self.run.begun is not None:
            self.instant = instant_of(self.look.phase, len(self.run.begun.instants))
        if self._pending is not None and (self.run.newest is not None or self.run.notice):
            self.start(self._pending, warm=self.warm_start)
        return bool(reports)

    def go(self) -> None:
        """Let iterations go on by themselves; a run that ended, or broke, starts again."""
        self.running = True
        self.follows = True
        if self.run.is_over:
            self.start()
        else:
            self._keep_pace()

    def pause(self) -> None:
        """Wait after the present iteration."""
        self.running = False
        self._send(Pace(self.run.ticket, 0.0))

    def step(self) -> None:
        """Do one iteration and wait; a run that broke starts again, one that ended stays."""
        self.running = False
        self.follows = True
        if self.run.is_broken:
            self.start()
        else:
            self._send(Step(self.run.ticket))

    def set_pace(self, pace: float | None) -> None:
        """Set the iterations per second."""
        self.pace = pace
        self._keep_pace()

    def seek(self, iteration: int) -> None:
        """Look at an iteration that was done already."""
        self.follows = iteration >= self.run.iteration
        if not self.follows:
            self._send(Seek(self.run.ticket, iteration))

    def look_at(self, instant: int) -> None:
        """Choose the instant at which fields are drawn."""
        if self.run.begun is not None:
            count = len(self.run.begun.instants)
            self.instant = min(max(instant, 0), count - 1)
            self._look(phase=self.instant / max(count - 1, 1))

    def look_into(self, interface: str) -> None:
        """Choose the interface whose fields are drawn."""
        self._look(interface=interface)

    def look_for(self, stress: str) -> None:
        """Choose the stress that is drawn."""
        self._look(stress=stress)

    def set_watch(self, watch: frozenset[str]) -> None:
        """Set what frames carry beyond the fields."""
        if watch != self.watch:
            self.watch = watch
            self._look_again()

    def choose_substructure(self, number: int) -> None:
        """Choose the substructure whose modes are looked at, counted from 0."""
        last = self.settings.n_substructures - 1
        chosen = None if number >= last else max(number, 0)
        if chosen != self.substructure:
            self.substructure = chosen
            self._look_again()

    def close(self) -> None:
        """Leave: the process of the run ends, and so do the reports."""
        self._closed = True
        self._part()
        self._pages.remove(self)
        for errand in self._errands:
            errand.cancel()

    def rest(self, alone: bool) -> None:
        """Hold the run while nobody sees the page, and let it go on afterwards."""
        self._alone, self._alone_since = alone, time.monotonic()
        if not alone and self._link is None and self.run.ticket and not self.run.is_broken:
            self._work()
        else:
            self._keep_pace()

    def attend(self) -> bool:
        """Do what is due: hear the reports, hold the run while one is timed; tell if it is new."""
        if self._alone and time.monotonic() - self._alone_since > LEFT_ALONE:
            self._part()
        heard = [errand.collect() for errand in self._errands]
        if self.study.is_begun != self._held:
            self._held = self.study.is_begun
            self.crowd = self.crowd if not self._held else 0
            self._keep_pace()
        if self._held:
            self.crowd = max(self.crowd, self._pages.at_work_beside(self))
        return any(heard)

    @property
    def goes_on(self) -> bool:
        """Whether the run is one that goes on until the user pauses it."""
        return self.running and not self.run.is_over

    @property
    def is_at_work(self) -> bool:
        """Whether iterations of the run go on at present."""
        return self._link is not None and not self.run.is_over and self._is_free

    @property
    def is_held(self) -> bool:
        """Whether the run stands still for a study that is timed."""
        return self._held

    @property
    def wanted(self) -> Settings:
        """The settings that the user sees: of the run at work, or of the one about to start."""
        return self._pending or self.settings

    @property
    def shown(self) -> Frame | None:
        """The frame that is looked at, or None before the first."""
        if self.follows or self.run.sought is None:
            return self.run.newest
        return self.run.sought

    @property
    def _errands(self) -> tuple[Errand, ...]:
        return self.figures, self.study, self.stability

    @property
    def _is_free(self) -> bool:
        """Whether iterations go on by themselves at present."""
        return self.running and not self._alone and not self._held

    def _keep_pace(self) -> None:
        if self.goes_on:
            self._send(Pace(self.run.ticket, self.pace if self._is_free else 0.0))

    def _look(self, **changes: Any) -> None:
        look = replace(self.look, **changes)
        if look == self.look:
            return
        elsewhere = look.interface != self.look.interface or self.watch & AT_THE_INSTANT
        self.look = look
        if elsewhere:
            self._look_again()

    def _look_again(self) -> None:
        """Have frames carry what is watched, and the one that is looked at sent again."""
        self._send(Watch(self.run.ticket, self.watch, self.substructure, self.look))
        if not self.follows and self.run.sought is not None:
            self._send(Seek(self.run.ticket, self.run.sought.iteration))

    def _retire(self) -> None:
        if self.run.is_worth_keeping:
            self.before = self.run
            self.past.append(self.run)

    def _leave_scene(self) -> None:
        """Keep the settings for a return; runs of another scene are nothing to compare with."""
        self._left[self.settings.scene] = self.wanted
        self.before = None
        self.past.clear()
        self.look = replace(self.look, interface="")
        self.substructure = None

    def _work(self, *, warm: bool = False) -> None:
        """Have a process do the run from its beginning."""
        if self._link is None and not self._closed:
            self._hired += 1
            self._link = self._hire(partial(self._receive, self._hired))
        self._send(
            Run(
                self.run.ticket,
                self.settings.scene,
                self.settings.values(),
                pace=self.pace,
                pause_after=None if self._is_free else 1,
                watch=self.watch,
                substructure=self.substructure,
                look=self.look,
                warm=warm,
            )
        )

    def _send(self, order: Order) -> None:
        if self._link is not None:
            self._link.send(order)

    def _part(self) -> None:
        """End the process; what it had is lost, and the run would begin again."""
        if self._link is not None:
            self._link.close()
            self._link = None
            self.run.lose("")
            self.follows = True

    def _bury(self) -> None:
        """Follow the end of a process: start the run again, or give it up."""
        self._link = None
        self._deaths += 1
        again = self._deaths <= RESTARTS
        _log.error("A worker process ended. %s", AGAIN if again else GIVEN_UP)
        self.run.lose(AGAIN if again else GIVEN_UP, is_broken=not again)
        self.follows = True
        if again:
            self._work()

    def _take(self, report: Report) -> None:
        if isinstance(report, Refused) and report.trace:
            _log.error("A run broke.\n%s", report.trace)
        self.run.take(report)

    def _receive(self, number: int, report: Report) -> None:
        with self._lock:
            self._mailbox.append((number, report))
        if isinstance(report, Frame) and self.run.newest is None:
            self.wake()


def _label(settings: Settings, changed: dict[str, Any]) -> str:
    definitions = settings.definitions()
    parts = []
    for name, value in list(changed.items())[:2]:
        unit = about(definitions[name]).unit
        text = f"{value:.4g}" if isinstance(value, float) else str(value)
        text = "points" if isinstance(value, tuple) else text
        parts.append(f"{name.replace('_', ' ')} {text} {unit}".strip())
    return ", ".join(parts) + (", ..." if len(changed) > 2 else "")
