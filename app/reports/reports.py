"""The reports that a page can ask for, each on a tab."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from html import escape
from typing import Any
from weakref import WeakKeyDictionary

import panel_material_ui as pmui

from app.components.panes import select
from app.picture.labels import changes_of, label_of
from app.picture.shown import has_reference
from app.picture.usual import changed
from app.reports.report import Report
from app.session.report_job import Found
from app.session.session import Session
from app.session.studies import figures_of_the_paper, stability_of, study_of
from solver.scenes import entry_of
from solver.settings import Settings
from solver.study.speed.error_against_time import acting

COMPUTED: list[Found] = []
"""The paper's figures, once a page of this server has had them made: they depend on no setting."""
REPEATS = (3, 5, 9)
NO_REFERENCE = (
    "The reference to measure errors by would take too long here: choose fewer bodies or elements, "
    "or the command line."
)
CASES = {"a quarter of the cases": True, "all cases": False}
EVERY, WRONG = "All runs", "Hide the right ones"
PLAIN = {"& button": {"textTransform": "none", "whiteSpace": "nowrap", "padding": "4px 14px"}}


class PaperFigures(Report):
    """The paper's figures with their claims; they are asked for when they are first looked at."""

    title = "The paper's figures"
    words = (
        "The paper's Figs. 3 to 8, computed anew for its bar (Table 1): each with what the paper "
        "says of it, and the numbers that bear it out or do not. Takes a few seconds the first "
        "time."
    )

    def open(self) -> None:
        """Show the figures; have them made if nobody has."""
        is_first = not self.view.objects
        super().open()
        if is_first and not COMPUTED:
            self._on_start()

    def _choices(self) -> list[Any]:
        self._start.label = "Try again"
        return []

    def _ask(self) -> None:
        self._job.ask("once for all pages", figures_of_the_paper)

    def _found(self) -> list[Found]:
        return COMPUTED

    def _refresh(self) -> None:
        if COMPUTED:
            # What waits for its turn was asked for before another page had them.
            self._job.cancel()
        elif self._job.last is not None:
            COMPUTED.append(self._job.last)
        super()._refresh()
        self._start.visible = not (COMPUTED or self._job.is_busy)
        self._progress.visible = not COMPUTED


class StudyReport(Report):
    """Error against run time, every method on the settings that the page has when it is asked for.

    Parameters
    ----------
    session
        Has it made, with its settings.
    """

    title = "Error against run time"
    words = (
        "Every form of LATIN and the incremental solver "
        "solve the present settings in turn: how near to the solution is each, after what time? "
        "The run of this page stands still meanwhile, to leave the clock alone."
    )
    note = "Settings that change a study; the methods set all others themselves."

    def __init__(self, session: Session) -> None:
        super().__init__(session.asked.study, session.turns.soon)
        self._session = session
        self._crowds: WeakKeyDictionary[Found, int] = WeakKeyDictionary()
        self._settings: WeakKeyDictionary[Found, Settings] = WeakKeyDictionary()

    def acting(self) -> Collection[str]:
        """Give the names of the settings that no method of the study sets itself."""
        return acting(self._session.wanted)

    def _choices(self) -> list[Any]:
        what = "How often each method runs; its median time counts."
        self._repeats = select(
            "Timed passes", list(REPEATS), value=REPEATS[1], width=130, description=what
        )
        self._growth = pmui.Switch(
            label="Growth with the size",
            description="Also measure other numbers of elements, instants and substructures; takes "
            "several times as long.",
            margin=(0, 10),
        )
        return [self._repeats, self._growth]

    def _ask(self) -> None:
        settings, repeats = self._session.wanted, int(self._repeats.value)
        sizes = bool(self._growth.value)
        work = partial(study_of, settings.scene, settings.values(), repeats, sizes)
        self._job.ask(title_of(settings), work)
        self._settings.setdefault(self._job.growing, settings)

    def _differs(self, found: Found) -> str:
        now = self._session.wanted
        then = self._settings.get(found, now)
        if then.scene != now.scene:
            return f"These results are of another scene: {entry_of(then).title.lower()}."
        acts = acting(then) | acting(now)
        old, new = (
            {name: value for name, value in changes_of(one, other).items() if name in acts}
            for one, other in ((then, now), (now, then))
        )
        if not new:
            return ""
        units = self._session.look.units
        was, now_is = label_of(then, old, units, 4), label_of(now, new, units, 4)
        return f"These results are of other settings: {was}. At present: {now_is}."

    def _refusal(self) -> str:
        return "" if has_reference(self._session.wanted) else NO_REFERENCE

    def _title(self, found: Found) -> str:
        crowd = self._crowds.setdefault(found, self._session.crowd)
        return f"<h2>Study: {escape(found.title)}</h2><p>{company(crowd)}</p>"


class StabilityReport(Report):
    """Stiff and extreme cases, each with a verdict."""

    title = "Stability on stiff and extreme cases"
    words = (
        "Stiff and extreme cases of every scene, whatever the settings of the page: does each end "
        "with the right answer, or say that it has none? The run of this page goes on beside them "
        "and slows them down, so do not compare their times."
    )

    def _choices(self) -> list[Any]:
        self._cases = select("Cases", list(CASES), width=230, value=next(iter(CASES)))
        choice = pmui.RadioButtonGroup(
            options=[EVERY, WRONG], value=EVERY, size="small", margin=(8, 10), sx=PLAIN
        )
        choice.param.watch(lambda event: self._filter(event.new), "value")
        return [self._cases, choice]

    def _ask(self) -> None:
        quick = CASES[self._cases.value]
        self._job.ask(self._cases.value, partial(stability_of, quick))

    def _filter(self, wanted: str) -> None:
        """Leave the rows to the style sheet, which need not be sent again."""
        self._role = "report wrong" if wanted == WRONG else "report"
        for pane in self._sheet:
            pane.css_classes = self._role.split()


def title_of(settings: Settings) -> str:
    """Name a study by its settings."""
    found = changed(settings)
    return label_of(settings, found, most=len(found)) or "defaults"


def company(crowd: int) -> str:
    """Say who else was at work on the same processors."""
    if not crowd:
        return "The run of this page stood still, and nothing else was at work for any page."
    others = "a run or a chart was" if crowd == 1 else f"{crowd} runs or charts were"
    return (
        f"The run of this page stood still, but {others} at work on the same processors: times may "
        "be too long."
    )
