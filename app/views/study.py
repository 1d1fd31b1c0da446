"""Error against run time, every method on the settings of the page: a tab."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.errand import Errand, Found
from app.views.legend import card_title
from app.views.panels import keys, plot
from app.views.report import Report, bullets, table
from app.worker.shown import has_reference
from app.worker.studies import StudyFound, study_of
from solver.settings import Settings
from solver.study.figure_data import Panel
from solver.study.study_files import NO_PAGE
from solver.study.study_panels import CAPTION, CURVES, GROWTH, error_panels, growth_panels
from solver.study.study_report import (
    GROWTH_NOTE,
    TIMES,
    TIMES_NOTE,
    conditions,
    growth_table,
    verdicts,
)
from solver.study.study_report import table as table_of

WORDS = (
    "Every form of LATIN, the incremental solver and the public QP solvers that are installed, on "
    "the present settings, one after the other in a process of their own. The run of this page "
    "stands still while they are timed."
)
REPEATS = (3, 5, 9)
NO_REFERENCE = (
    "The reference to measure errors by would take too long here: choose fewer bodies or elements, "
    "or the command line."
)


class StudyReport(Report):
    """The study of the settings that the page has when it is asked for.

    Parameters
    ----------
    errand, style
        As for `Report`.
    settings
        Gives the present settings.
    crowd
        Gives the most runs of other pages that were at work during the last study.
    """

    def __init__(
        self,
        errand: Errand,
        style: str,
        settings: Callable[[], Settings],
        crowd: Callable[[], int],
    ) -> None:
        super().__init__(errand, style, "Error against run time", WORDS)
        self._settings = settings
        self._crowd = crowd
        self._crowds: dict[Found, int] = {}
        self._shown: Found | None = None

    def _choices(self) -> list[Any]:
        self._repeats = pmui.Select(
            label="Timed passes",
            options=list(REPEATS),
            value=REPEATS[1],
            width=130,
            size="small",
            description="The median of the passes counts.",
        )
        self._growth = pmui.Switch(
            label="Growth with the size",
            description="Time and iterations at other numbers of elements, instants and "
            "substructures too; that takes several times as long.",
            margin=(0, 10),
        )
        self._choice = pmui.Select(label="Shown", options=[], width=260, size="small")
        self._choice.visible = False
        self._choice.param.watch(lambda event: self._show_one(event.new), "value")
        return [self._repeats, self._growth, self._choice]

    def _ask(self) -> None:
        settings, repeats = self._settings(), int(self._repeats.value)
        sizes = bool(self._growth.value)
        work = partial(study_of, settings.scene, settings.values(), repeats, sizes)
        self._errand.ask(title_of(settings), work)

    def _refusal(self) -> str:
        return "" if has_reference(self._settings()) else NO_REFERENCE

    def _show(self) -> None:
        found = list(self._errand.found)
        if found and found[-1] not in self._crowds:
            self._crowds = {one: self._crowds.get(one, self._crowd()) for one in found}
            options = {f"{number}: {one.title}": one for number, one in enumerate(found, start=1)}
            self._choice.param.update(options=options, value=found[-1], visible=len(found) > 1)
            self._show_one(found[-1])

    def _show_one(self, found: Found | None) -> None:
        if found is None or found is self._shown:
            return
        self._shown = found
        result: StudyFound = found.result
        study = result.study
        parts = [
            self._text(f"<h2>Study: {escape(found.title)}</h2>{bullets(verdicts(study))}"),
            *self._figure(CURVES, error_panels(study)),
            self._text(
                f"<p>{CAPTION}</p><h3>{TIMES}</h3><p>{TIMES_NOTE}</p>" + table(table_of(study))
            ),
        ]
        if result.growth:
            parts += [
                *self._figure(GROWTH, growth_panels(result.growth)),
                self._text(f"<p>{GROWTH_NOTE}</p>{table(growth_table(result.growth))}"),
            ]
        lines = [*conditions(study), company(self._crowds[found])]
        if not any(name.endswith(".html") for name in result.files):
            lines.append(NO_PAGE)
        parts += [
            self._text(f"<h3>How it was measured</h3>{bullets(lines)}"),
            self._downloads(result.files),
        ]
        self._results[:] = [self._card(*parts)]

    def _figure(self, title: str, panels: list[Panel]) -> list[Any]:
        """Draw panels under one legend."""
        legend = pn.pane.HTML(
            card_title(title, keys(panels)),
            css_classes=["title"],
            stylesheets=[self._style],
            sizing_mode="stretch_width",
            margin=(6, 14, 0, 14),
        )
        row = pn.FlexBox(
            *(plot(panel, legend=False) for panel in panels), sizing_mode="stretch_width"
        )
        return [legend, row]


def title_of(settings: Settings) -> str:
    """Name a study by its settings."""
    changed = [
        f"{name.replace('_', ' ')} {'points' if isinstance(value, tuple) else value}"
        for name, value in settings.changed().items()
    ]
    return ", ".join(changed) or "defaults"


def company(crowd: int) -> str:
    """Say who else was at work on the same processors."""
    if not crowd:
        return "The run of this page stood still, and no other page had one at work."
    runs = "a run of another page was" if crowd == 1 else f"{crowd} runs of other pages were"
    return (
        f"The run of this page stood still, but {runs} at work on the same processors: times may "
        "be too long."
    )
