"""What a page shows and what is chosen on it, as one object that its parts watch."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from typing import Any

import param
from param.parameterized import batch_call_watchers

from app.languages.language import Language
from app.picture.shown import Look
from app.picture.usual import ANSWER
from app.session.classroom import Room
from app.views.catalogue import VIEWS as ALL_VIEWS
from app.wire.orders import WHOLE, Rate
from app.wire.reports import Facts
from solver.lessons.lesson import Lesson
from solver.settings import Settings
from solver.study.other_programs.brought import Brought

WHAT_IF = "What if"
TABS = ("Live", WHAT_IF, "Figures", "Study", "Stability", "Proof")
VIEWS = ("page", "present", "embed")
DEFAULT_PACE = WHOLE
PACES: dict[str, Rate] = {WHOLE: WHOLE, "1": 1.0, "5": 5.0, "20": 20.0, "fastest": None}
"""Iterations per second, or what an address calls another pace."""


class State(param.Parameterized):
    """The state of one page; all of it changes on the event loop of the server."""

    @property
    def say(self) -> Language:
        """What says an English text in the page's language."""
        look: Look = self.look
        return look.say

    settings = param.Parameter[Settings](doc="Of the run at work.")
    wanted = param.Parameter[Settings](doc="Those that the user sees: of this run, or of the next.")
    twin = param.Parameter[Settings | None](
        doc="Of run A, which goes in step with this one as run B, from the next start on."
    )
    brought = param.Parameter[Brought | None](
        doc="Results of another program, which are laid beside the runs of their scene."
    )
    ticket = param.Integer(default=0, doc="Number of the run; 0 before the first.")
    facts = param.Parameter[Facts | None](doc="What its newest picture says, once there is one.")
    look = param.Parameter[Look](default=Look(), doc="Where one looks.")
    opens = param.Boolean(
        default=False, doc="Whether time goes by itself, until somebody touches the page."
    )
    running = param.Boolean(default=True, doc="Whether iterations go on by themselves.")
    pace = param.Parameter[Rate](default=PACES[DEFAULT_PACE], doc="As in `app.wire.orders.Pace`.")
    warm_start = param.Boolean(
        default=False, doc="Whether a changed setting starts from the run before, if that is better"
    )
    tab = param.String(default=TABS[0], doc="Which of `TABS` is looked at.")
    view = param.String(default=VIEWS[0], doc="Which of `VIEWS`: how much stands around plots.")
    chosen = param.Parameter[frozenset[str] | None](
        doc="Names of the views that are drawn; None has the first of each card."
    )
    keeps = param.Parameter[tuple[str, list[str]] | None](
        doc="A scene, and names of the views that were chosen for it last: its browser keeps them."
    )
    is_named = param.Boolean(
        default=False, doc="Whether these are those that a lesson or an address names."
    )
    lesson = param.Parameter[Lesson | None](doc="The one that is open.")
    choice = param.Parameter[int | None](doc="What was predicted in it.")
    asks = param.Boolean(
        default=False, doc="Whether its question waits, which nothing on the page may give away."
    )
    question = param.Parameter[Any](doc="What is asked over ranges of settings.")
    drag = param.Integer(default=0, doc="Number of the drag that goes on, which is one step.")
    steps = param.Parameter[tuple[bool, bool]](
        default=(False, False), doc="Whether what was set can be undone, and done again."
    )
    refusal = param.String(doc="What was refused and why; empty as soon as that is past.")
    told = param.String(doc="What was done.")
    room = param.Parameter[Room | None](doc="The class that is followed.")
    is_left = param.Boolean(default=False, doc="Whether nobody leads that at present.")
    in_class = param.Integer(default=0, doc="Counts the news of the class.")
    reported = param.Integer(default=0, doc="Counts the news of reports and the sweep.")

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)  # type: ignore[no-untyped-call]
        self._kept_views: dict[str, frozenset[str]] = {}
        self.param.watch(self._on_wanted, "wanted")

    def _on_wanted(self, event: Any) -> None:
        if self.lesson is None and event.old.scene != event.new.scene:
            self.draw_for(None)

    def together(self) -> AbstractContextManager[None]:
        """Have what changes in here told at its end, all of it together."""
        return batch_call_watchers(self)

    def draw(self, names: Iterable[str], *, is_named: bool = False) -> None:
        """Draw the views of these names and no others; the scene keeps them."""
        scene, chosen = self.wanted.scene, frozenset(names)
        self._kept_views[scene] = chosen
        keeps = self.keeps if is_named else (scene, sorted(chosen))
        self.param.update(chosen=chosen, is_named=is_named, keeps=keeps)

    def recall(self, kept: Mapping[str, Any]) -> None:
        """Take what a browser has kept for scenes, but where an address, or somebody, has chosen.

        Anything may stand there: only names of views are taken.
        """
        for scene, names in kept.items():
            listed = names if isinstance(names, list) else []
            found = frozenset(view.name for view in ALL_VIEWS if view.name in listed)
            if found:
                self._kept_views.setdefault(scene, found)
        if self.lesson is None and self.chosen is None:
            self.draw_for(None)

    def draw_for(self, lesson: Lesson | None) -> None:
        """Draw the views that a lesson names, or without one those that the scene has kept."""
        kept = self._kept_views.get(self.wanted.scene)
        chosen = frozenset(lesson.views) if lesson else kept
        self.param.update(chosen=chosen, is_named=lesson is not None)

    @property
    def is_over(self) -> bool:
        """Whether the run ended or broke: only another run can go on."""
        return self.facts is not None and (self.facts.is_over or self.facts.is_broken)

    @property
    def rate(self) -> Rate:
        """The pace of the run at work: an answer at once is not waited for."""
        return None if self.pace == WHOLE and self.settings.finish == ANSWER else self.pace

    @property
    def goes_on(self) -> bool:
        """Whether the run is one that goes on until the user pauses it."""
        return self.running and not self.is_over

    @property
    def plots(self) -> str:
        """Names of the views that are chosen, separated by commas, or nothing if none are."""
        chosen = self.chosen or ()
        return ",".join(view.name for view in ALL_VIEWS if view.name in chosen)
