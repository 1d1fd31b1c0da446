"""The runs of a page: the one at work, those before it, and the pictures of where one looks."""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from html import escape

import numpy as np

from app.picture.bathtub import Bathtub, grown
from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import Look, Manner, instant_of, thinned
from app.views.scene import Scene
from app.wire.orders import Bring, Order, Ready, Run, Seek, Tabulate, Watch
from app.wire.reports import Facts, File, Picture
from app.worker.key_figures import key_figures
from app.worker.laid import Laid
from app.worker.offline import MOST_INSTANTS, offline_page
from app.worker.painter import TAKE_AWAY, Painter
from app.worker.rivals import KeptReferences
from app.worker.run import WorkerRun
from app.worker.saving import file_of
from app.worker.twin import Twin
from app.worker.words import before_a_run, before_it_is_agreed, status_line, why_it_broke
from solver.latin import Iterate
from solver.phrases import Phrase
from solver.refusal import RefusedError

PAST_RUNS = 6

_log = logging.getLogger(__name__)


class PageRuns:
    """The runs of one page, and the pictures made of them when the page is ready for one.

    Parameters
    ----------
    send
        Takes pictures.
    urgent
        Tells whether another run is ordered.
    """

    def __init__(self, send: Callable[[Picture | File], None], urgent: Callable[[], bool]) -> None:
        self._send = send
        self._urgent = urgent
        self._references = KeptReferences()
        self._painter = Painter()
        self._others: dict[Manner, Painter] = {}
        self._look = Look()
        self._run: WorkerRun | None = None
        self._twin: Twin | None = None
        self._last: Iterate | None = None
        self._before: Recording | None = None
        self._shadow: Frame | None = None
        self._past: deque[Recording] = deque(maxlen=PAST_RUNS)
        self._bathtub: Bathtub | None = None
        self._laid = Laid()
        self._table: Tabulate | None = None
        self._paint_at: float | None = None

    def rest(self) -> float | None:
        """Give the seconds until there is something to do; None waits for an order."""
        if self._run is None:
            return None
        run, twin = self._run, self._twin
        rests = (run.rest(), twin.rest(run) if twin else None, self._rest_of_paint(run))
        return min((rest for rest in rests if rest is not None), default=None)

    def paint(self) -> bool:
        """Send a picture, if the page is ready for it and there is something new; tell."""
        run = self._run
        if run is None or self._rest_of_paint(run) != 0.0:
            return False
        self._attempt(run.ticket, lambda: self._show(run))
        return True

    def go_on(self) -> None:
        """Do the next piece of the run at work, once run A is where it is."""
        run, twin = self._run, self._twin
        if run is None:
            return
        if twin is not None and twin.rest(run) == 0.0:
            self._attempt(run.ticket, lambda: twin.advance(run))
            run.has_news = True
        else:
            self._attempt(run.ticket, run.advance)

    def obey(self, order: Order) -> None:
        """Follow an order."""
        run = self._run
        match order:
            case Run():
                self._retire()
                self._attempt(order.ticket, lambda: self._begin(order))
            case Ready():
                if order.afresh or order.whole:
                    self._painter.packer.forget()
                if order.afresh and run is not None:
                    run.has_news = True
                self._paint_at = time.monotonic() + order.rest
            case Watch():
                self._watch(order.look)
            case Tabulate() | Bring():
                if isinstance(order, Tabulate):
                    self._table = order
                else:
                    self._laid.brought = order.brought
                if run is not None:
                    run.has_news = True
            case _ if run is not None and run.ticket == order.ticket:
                self._attempt(run.ticket, lambda: run.obey(order))
                if self._twin is not None:
                    self._twin.obey(order, run)

    def _begin(self, order: Run) -> None:
        previous = self._last if order.warm else None
        run = WorkerRun(order, self._look, self._urgent, self._references, previous)
        if run.cost.is_to_be_agreed and not order.is_agreed:
            words = before_it_is_agreed(run.cost, has_run=self._before is not None)
            self._send_words(order.ticket, Facts(is_broken=True, asks=True), words)
            return
        self._run = run
        if self._run.cost.is_large and not order.follows_hand:
            words = self._look.say(before_a_run(self._run.cost))
            self._send(File(self._painter.say({"status": words})))
        self._pair(order)
        settings, before = self._run.recording.settings, self._before
        # Runs of another scene are nothing to compare with.
        if order.is_alone or (before is not None and type(before.settings) is not type(settings)):
            self._before = self._shadow = None
            self._past.clear()

    def _pair(self, order: Run) -> None:
        """Have run A go in step with a new one, afresh only where its settings are others."""
        settings, twin = order.twin, self._twin
        if settings is None:
            self._twin = None
        elif twin is not None and twin.is_of(settings):
            twin.begin(order.pace)
        else:
            # Colours are given by tickets, so it has one of its own.
            own = Run(-order.ticket, settings, pace=0.0)
            run = WorkerRun(own, self._look, self._urgent, self._references)
            self._twin = Twin(run, order.pace)

    def _retire(self) -> None:
        """Keep the run at work to compare the next with, unless it only followed a hand."""
        run, self._run = self._run, None
        if run is None or run.follows_hand:
            return
        self._last = run.last
        self._bathtub = grown(self._bathtub, run.recording)
        if run.recording.is_worth_keeping:
            run.obey(Seek(run.ticket, None))
            self._before, self._shadow = run.recording, run.keep_frame(self._look)
            self._past.append(run.recording)

    def _watch(self, look: Look) -> None:
        if look.views != self._look.views:
            # Figures that come, or come back, have nothing.
            self._painter.packer.forget()
        self._look = look
        run = self._run
        if run is not None:
            self._attempt(run.ticket, lambda: run.look_at(look))
        if self._twin is not None:
            self._twin.look_at(look)

    def _rest_of_paint(self, run: WorkerRun) -> float | None:
        if self._paint_at is None or not (run.has_news and run.is_presentable):
            return None
        if self._twin is not None and self._twin.is_behind(run):
            return None
        return max(self._paint_at - time.monotonic(), 0.0)

    def _show(self, run: WorkerRun) -> None:
        look, recording = self._look, run.recording
        run.has_news, self._paint_at = False, None
        frame, twin = run.frame(look), self._twin.recording if self._twin else None
        stand = recording.stand
        instant = instant_of(look.phase, len(stand.instants))
        scene = self._scene(run, frame, instant)
        facts = Facts(
            iteration=max(frame.iteration, twin.shown if twin else 0),
            done=max(recording.iteration or frame.iteration, twin.iteration if twin else 0),
            searched=max(recording.searched or frame.iteration, twin.searched if twin else 0),
            instants=len(stand.instants),
            instant=instant,
            time=float(stand.instants[instant]),
            duration=float(stand.instants[-1]) or 1.0,
            interface=stand.interface,
            interfaces=stand.interfaces,
            is_over=recording.status is not None and (twin is None or twin.status is not None),
            was_warm=recording.choice is not None and recording.choice.is_previous,
        )

        def told(painter: Painter, look: Look) -> bytes:
            there = scene
            if look != scene.look:
                there = replace(scene, look=look, frame=replace(frame, look=look))
            return painter.paint(there, self._words(run, there), facts)

        block = told(self._painter, look)
        self._send(Picture(run.ticket, facts, block, self._in_others(told)))
        if (asked := self._table) is not None:
            self._table = None
            self._send(File(self._saved(asked, run, scene)))

    def _saved(self, asked: Tabulate, run: WorkerRun, scene: Scene) -> bytes:
        """Give a file to be saved, or say why there is none."""
        try:
            file = file_of(asked.what, scene, lambda: self._offline(run, scene))
        except RefusedError as refusal:
            said = f"{refusal.name}: {refusal.value}; {refusal.remedy}."
            return self._painter.say({"status": Phrase("<b>{}</b>", escape(said))})
        return self._painter.say({}, {TAKE_AWAY: {"file": [*file, asked.number]}})

    def _offline(self, run: WorkerRun, scene: Scene) -> str:
        """Write a page of what is looked at, at all instants."""
        instants = len(scene.run.stand.instants)
        chosen = np.union1d(thinned(instants, MOST_INSTANTS), [scene.instant])

        def scenes() -> Iterator[tuple[Scene, Mapping[str, str]]]:
            for instant in chosen:
                look = replace(self._look, phase=instant / max(instants - 1, 1))
                frame, shadow = run.frame(look), scene.shadow and replace(scene.shadow, look=look)
                there = replace(scene, frame=frame, instant=int(instant), look=look, shadow=shadow)
                yield there, self._words(run, there)

        return offline_page(scenes(), scene, int(np.searchsorted(chosen, scene.instant)))

    def _scene(self, run: WorkerRun, frame: Frame, instant: int) -> Scene:
        twin, before, look = self._twin, self._before, self._look
        if self._shadow is not None and self._shadow.look != look:
            self._shadow = replace(self._shadow, look=look)
        shadow = self._shadow
        if twin is not None:
            shadow, before = twin.keep_frame(look), twin.recording
        past = tuple(self._past)
        return Scene(
            run.recording,
            before,
            past,
            frame,
            instant,
            look,
            is_paired=twin is not None,
            shadow=shadow,
            beside=self._laid.beside(frame, run.recording.settings),
            bathtub=None if twin else grown(self._bathtub, run.recording),
        )

    def _words(self, run: WorkerRun, scene: Scene) -> dict[str, str]:
        frame, state, complaint = scene.frame, run.state, self._look.complaint
        return {
            "status": status_line(run.recording, frame, state, run.sought, complaint),
            "figures": key_figures(scene),
        }

    def _attempt(self, ticket: int, action: Callable[[], None]) -> None:
        """Do something of a run; if it breaks, the run is over and the process lives on."""
        try:
            action()
        except Exception as problem:
            self._run = None
            if not isinstance(problem, RefusedError | FloatingPointError):
                _log.exception("A run broke.")
            words = Phrase("<b>{}</b>", escape(why_it_broke(problem)))
            self._send_words(ticket, Facts(is_broken=True), words)

    def _send_words(self, ticket: int, facts: Facts, words: str) -> None:
        """Send a picture of words alone."""

        def told(painter: Painter, look: Look) -> bytes:
            return painter.say({"status": look.say(words)})

        self._send(Picture(ticket, facts, told(self._painter, self._look), self._in_others(told)))

    def _in_others(self, told: Callable[[Painter, Look], bytes]) -> dict[Manner, bytes]:
        """Give a whole picture in the units and words of each that follows and has its own."""
        wanted = set(self._look.others) - {self._look.manner}
        self._others = {one: self._others.get(one) or Painter() for one in wanted}
        for painter in self._others.values():
            painter.packer.forget()
        return {
            one: told(painter, self._look.told_in(one)) for one, painter in self._others.items()
        }
