"""What the tabs of long reports share: ask, watch, cancel, read, and take away.

What is read is the report of the command line, as it grows; its plots are drawn for the page.
Only the page's own turns touch its document. A callback that a thread adds to a document while
Bokeh lets that go from a hold is lost, and what document is the current one is the whole process's.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import Future
from functools import partial
from html import escape
from io import BytesIO
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.charts.filling import drawn
from app.charts.keys import legend
from app.components.panes import STYLE, button, column, row, select, text
from app.picture.glossary import explained
from app.session.report_job import Found, ReportJob
from solver.study.page import Section


class Report:
    """A tab on which a report is asked for, watched while it is made, and read.

    A subclass says what it is, and what asking for it means for the page (`title`, `words`), what
    is asked (`_ask`), what can be chosen (`_choices`), and which settings it depends on (`acting`).

    Parameters
    ----------
    job
        The state that it shows.
    soon
        Has something done on a turn of the page.

    Attributes
    ----------
    view
        What stands on the page; it is empty until `open`.
    """

    title = words = ""
    note = "Nothing here depends on a setting."
    """What stands in the sidebar, above the settings that do something here."""

    def __init__(
        self, job: ReportJob, soon: Callable[[Callable[[], object]], None] = lambda act: None
    ) -> None:
        self._job, self._soon = job, soon
        self._newest: Found | None = None
        self._shown: tuple[Any, ...] = (None,)
        self._role = "report"
        self._drawings: deque[tuple[pn.Column, Future[Any]]] = deque()
        # Without the style sheet, 20 kB, before somebody looks.
        self.view = column(role="paper", margin=(4, 10), visible=False, stylesheets=[])

    def open(self) -> None:
        """Show the report; nothing is computed before somebody asks."""
        if not self.view.objects:
            self.view.param.update(objects=self._made(), stylesheets=[STYLE])
        self._refresh()

    def refresh(self) -> None:
        """Follow the job, as soon as somebody looks."""
        if self.view.visible:
            self._refresh()

    def put_drawn(self) -> None:
        """Put a plot in its place, if the next one is drawn: the page has other things to do."""
        if self._drawings and self._drawings[0][1].done():
            box, drawing = self._drawings.popleft()
            # Made here and not where it is drawn, as its theme is that of the page.
            box.append(pn.pane.Bokeh(drawing.result(), sizing_mode="stretch_width"))

    def acting(self) -> Collection[str]:
        """Give the names of the settings that do something here."""
        return ()

    def _ask(self) -> None:
        raise NotImplementedError

    def _choices(self) -> list[Any]:
        return []

    def _refusal(self) -> str:
        """Say why it cannot be asked for at present, if so."""
        return ""

    def _differs(self, found: Found) -> str:
        """Say in what a report is not of the present settings; nothing if it is."""
        return ""

    def _found(self) -> list[Found]:
        """Give the reports that are whole, oldest first."""
        return list(self._job.found)

    def _title(self, found: Found) -> str:
        """Say what stands above a report that is whole (HTML)."""
        return ""

    def _made(self) -> list[Any]:
        """Make what stands on the tab: what asks for a report, and the card that it is read on."""
        self._progress, self._older = _words(role="progress"), _words(role="progress")
        self._heading, self._sheet = _words(), column(role="paper")
        self._past = select("Shown", [], self._put, width=260, visible=False)
        self._files = row(margin=(0, 6, 8, 6))
        self._start = button("Start", "play_arrow", self._on_start, color="primary")
        self._cancel = button("Cancel", "stop", self._on_cancel, variant="outlined")
        again = button("Do it again", "replay", self._on_start, variant="outlined")
        self._again = row(self._older, again, align_items="center", visible=False, margin=(0, 6))
        words = _words(f"<h2>{escape(self.title)}</h2><p>{escape(self.words)}</p>")
        bar = self._start, self._cancel, *self._choices(), self._past
        asked = words, row(*bar, align_items="center", margin=(0, 6)), self._progress
        parts = self._again, self._heading, self._sheet, self._files
        self._card = column(*parts, role="card paper", visible=False)
        return [column(*asked, role="card paper", margin=(0, 0, 12, 0)), self._card]

    def _on_start(self) -> None:
        self._ask()
        self._refresh()

    def _on_cancel(self) -> None:
        self._job.cancel()
        self._refresh()

    def _refresh(self) -> None:
        job, refusal = self._job, self._refusal()
        self._start.disabled = job.is_busy or bool(refusal)
        self._cancel.visible = job.is_busy
        waiting = f"<b>{escape(refusal)}</b>" if refusal and not job.is_busy else ""
        self._progress.object = waiting or progress(job)
        found = self._found()
        options = {f"{number}: {one.title}": one for number, one in enumerate(found, start=1)}
        if found and options != self._past.options:
            self._past.param.update(options=options, value=found[-1], visible=len(found) > 1)
        newest = job.growing if job.is_busy or not found else found[-1]
        if newest.sections and (newest is self._shown[0] or newest is not self._newest):
            self._newest = newest
            self._put(newest)
        self._mark()

    def _mark(self) -> None:
        """Tell a report of other settings from one of those present."""
        shown, *_ = self._shown
        differs = "" if shown is None or self._job.is_busy else self._differs(shown)
        self._older.object = f"<b>{escape(differs)}</b>"
        self._again.visible = bool(differs)

    def _put(self, found: Found) -> None:
        """Show what there is of a report; of the same one, what is drawn already stays."""
        before, self._shown = self._shown, (found, found.sections, found.files)
        if self._shown == before:
            return
        if found is not before[0]:
            self._sheet[:] = []
            while self._drawings:
                self._drawings.pop()[1].cancel()
        for pane, section in zip(self._sheet, found.sections, strict=False):
            if isinstance(section, str):
                pane.param.update(object=explained(section))
        self._sheet.extend(map(self._pane, found.sections[len(self._sheet) :]))
        is_whole = found in self._found()
        self._heading.object = self._title(found) if is_whole else ""
        self._files[:] = downloads(found.files) if is_whole else []
        self._mark()
        self._card.visible = True

    def _pane(self, section: Section) -> Any:
        """Give what shows a section; a plot is put into it once it is drawn."""
        if isinstance(section, str):
            return _words(explained(section), self._role)
        # A `FlexBox` would not do: what is put into it later misses the theme.
        box = column(_words(legend(section.charts), role="legend"), role="panels")
        for chart in section.charts:
            self._drawings.append((box, drawing := drawn(chart)))
            drawing.add_done_callback(lambda drawing: self._soon(self.put_drawn))
        return box


def _words(html: str = "", role: str = "report") -> pn.pane.HTML:
    return text(html, role=role, margin=(6, 14))


def downloads(files: Mapping[str, bytes]) -> list[Any]:
    """Give a button for each file."""
    return [
        pmui.FileDownload(label=name, filename=name, size="small", callback=partial(BytesIO, data))
        for name, data in files.items()
    ]


def progress(job: ReportJob) -> str:
    """Say how far a report is, or why it came to nothing (HTML)."""
    if job.is_busy:
        bar = f'<progress value="{job.share:.3f}"></progress>'
        return f"{bar} {escape(job.doing)} <small>({escape(job.title)})</small>"
    return f"<b>{escape(job.notice)}</b>" if job.notice else ""
