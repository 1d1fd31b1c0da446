"""Tabs that run a long command and show its report; the tab Reports."""

from __future__ import annotations

from abc import ABC, abstractmethod
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.experiments.jobs import OUT, SETTINGS, Job, follow
from app.experiments.questions import TEXTS
from app.state import PageState
from app.templates import html
from app.widgets import PlainText, button, download, looks, wrapped
from solver.files.saved import dump
from solver.study import proof, stability_report
from solver.study.page import entries_of
from solver.study.proof import PAGE

WORDS: dict[str, str] = TEXTS["reports"]
COMMANDS = {
    "The paper's figures": ("figures",),
    "Study": ("study", SETTINGS),
    "Stability": ("stability", "--quick"),
    "Proof": ("proof",),
}
"""Arguments of the commands, by the titles that `WORDS` has of them."""
TABLES = {
    "Stability": (stability_report.SHOWN, ("scene", "case", "verdict")),
    "Proof": (proof.SHOWN, ("case", "quantity", "holds")),
}
"""Columns of the tables that commands print while they run, and those of them that the
page tells of the last row."""
LOOKS: dict[str, Any] = {"size": "small", "margin": (10, 6)}
SCHEMES = {
    False: "color-scheme: light; --dark: 0",
    True: "color-scheme: dark; --dark: 1",
}
"""Styles of a report (`page.html`) in a page that is light, or dark."""
Command = tuple[tuple[str, ...], dict[str, str]]
"""Arguments of a command, and contents of the files that they name."""
Files = dict[str, bytes]
"""Contents of files by their names."""


class CommandTab(ABC):
    """A tab with fields for a command, buttons to start and end it, and its report.

    `report` is the title of the chosen report; `page` shows its last result, and
    `files` has buttons that save its files. `job` is the command that is waiting or
    runs, `buttons` are all buttons. `asked` has the files that the commands of the
    last reports read.
    """

    def __init__(self, state: PageState, tab: str, *fields: Any) -> None:
        self.state = state
        self._tab = tab
        self.job: Job | None = None
        self._done: dict[str, Files] = {}
        self.asked: dict[str, dict[str, str]] = {}
        self.start_button = button("Start", self.start, icon="play_arrow", **LOOKS)
        self.cancel_button = button(
            "Cancel", self.cancel, icon="stop", variant="outlined", **LOOKS
        )
        self._words = PlainText(margin=(0, 8))
        self.progress = PlainText(margin=(6, 8))
        self.files = wrapped()
        self.buttons = wrapped(self.start_button, self.cancel_button, self.files)
        self.page = pn.pane.HTML("", sizing_mode="stretch_width", margin=(4, 8))
        self.view = pn.Column(
            self._words,
            *fields,
            self.buttons,
            self.progress,
            self.page,
            sizing_mode="stretch_width",
            css_classes=[tab.lower()],
        )
        shown = ["settings", "tab", "brought", "is_dark"]
        state.param.watch(lambda *events: self.show(), shown)
        follow(self.look, self.end)

    @property
    @abstractmethod
    def command(self) -> Command | None:
        """The command of the fields, if it can be started."""

    @property
    @abstractmethod
    def words(self) -> str:
        """Description of the command, or of missing input."""

    @property
    def report(self) -> str:
        """Title of the report."""
        return self._tab

    @property
    def written(self) -> Files:
        """Files of the last report."""
        return self._done.get(self.report, {})

    def said(self, progress: str) -> str:
        """Progress of a command, in the page's words."""
        return progress

    def start(self) -> None:
        """Start the command, and end a running one."""
        self.end()
        self._started = self.report
        arguments, texts = self.command
        self._texts = texts
        self.job = Job(arguments, texts)
        self.show()
        self.look()

    def cancel(self) -> None:
        """End the command that runs."""
        if self.job is not None:
            self.job.cancel()
            self.look()

    def forget(self) -> None:
        """Forget the last report."""
        self._done.pop(self.report, None)

    def end(self) -> None:
        """End the command and remove its files."""
        if self.job is not None:
            self.job.close()
            self.job = None

    def look(self) -> None:
        """Show the progress of the command, and its report at the end."""
        job = self.job
        if job is None:
            return
        progress = self.said(job.progress)
        if progress:
            progress = f"{self._started}: {progress}"
        self.progress.object = progress
        if not job.is_over:
            return
        # A report that failed leaves the one before in its place.
        if not job.failure:
            self._done[self._started] = job.files
            self.asked[self._started] = self._texts
        self.end()
        self.show()

    def show(self) -> None:
        """Show the command of the fields, and its report if there is one."""
        # What is hidden is shown when it is opened.
        if self.state.tab != self._tab:
            return
        is_busy = self.job is not None
        files = self.written
        self._words.object = self.words
        label = "Start"
        if files:
            label = "Do it again"
        is_disabled = is_busy or self.command is None
        self.start_button.param.update(disabled=is_disabled, label=label)
        self.cancel_button.visible = is_busy
        self.page.object = framed(files, is_dark=self.state.is_dark)
        self.files[:] = [
            download(name, name, lambda data=data: data, **LOOKS)
            for name, data in files.items()
        ]


class Reports(CommandTab):
    """The tab Reports: reports of the command line, chosen by `kind`."""

    def __init__(self, state: PageState) -> None:
        self.kind = pmui.RadioButtonGroup(
            label="",
            options=list(COMMANDS),
            value=next(iter(COMMANDS)),
            size="small",
            margin=(6, 6),
            **looks("words"),
        )
        super().__init__(state, "Reports", self.kind)
        self.kind.param.watch(lambda event: self.show(), "value")
        self.start()

    @property
    def report(self) -> str:
        """Title of the chosen report."""
        return self.kind.value

    @property
    def command(self) -> Command:
        """The command of the chosen report."""
        arguments = (*COMMANDS[self.report], "--out", OUT)
        return arguments, {SETTINGS: dump(self.state.settings)}

    def said(self, progress: str) -> str:
        """Progress; of a command that prints a table the number of its rows so far."""
        since, _, line = progress.partition(": ")
        rows = self.job.lines[1:]
        if self._started not in TABLES or line not in rows:
            return progress
        shown, names = TABLES[self._started]
        entries = entries_of(line, shown)
        last = ", ".join(entries[name] for name in names)
        return f"{since}: {len(rows)} done. The last one: {last}."

    @property
    def words(self) -> str:
        """Description of the chosen report, and whether it is of other settings."""
        words = WORDS[self.report]
        arguments, texts = self.command
        asked = self.asked.get(self.report, texts)
        if SETTINGS in arguments and asked != texts:
            words += " The one below is of other settings."
        return words


def framed(files: Files, *, is_dark: bool) -> str:
    """HTML of a report's page in a frame, light or dark, with links to this server."""
    pages = [name for name in files if name.endswith(".html")]
    if not pages:
        return ""
    name = pages[0]
    # The browser says what the path is: it must not become markup.
    path = escape(pn.state.location.pathname)
    page = files[name].decode().replace(PAGE, path)
    page = page.replace("<html", f'<html style="{SCHEMES[is_dark]}"', 1)
    return html("experiments/reports.html", title=name, page=page)
