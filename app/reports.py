"""The tab Reports: what the long commands of the command line write, made and read on the page."""

from __future__ import annotations

from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.jobs import OUT, SETTINGS, Job, follow
from app.questions import PLAIN
from app.state import PageState
from app.widgets import button, changing_text, download
from app.worker.references import has_reference
from solver.checked import dump
from solver.study.proof.report import PAGE

FIGURES, STUDY, STABILITY, PROOF = "The paper's figures", "Study", "Stability", "Proof"
WORDS = {
    FIGURES: "The paper's Figs. 3 to 8, computed anew for its bar (Table 1): each with what the "
    "paper says of it, and the numbers that bear it out or do not. Takes some seconds.",
    STUDY: "Error against run time: every form of LATIN and the incremental solver solve the "
    "present settings in turn. The run of this page stands still meanwhile, to leave the clock "
    "alone.",
    STABILITY: "Stiff and extreme cases of every scene, whatever the settings of the page: does "
    "each end with the right answer, or say that it has none?",
    PROOF: "Closed forms and published numbers, each beside what LATIN and the incremental solver "
    "find. A name that is a link opens that run.",
}
NO_REFERENCE = (
    "The reference to measure errors by would take too long here: choose fewer bodies or "
    "elements, or the command line."
)
LOOKS: dict[str, Any] = {"size": "small", "margin": (10, 6)}
KEPT = 12
"""Reports that a server keeps for all of its pages."""
FRAME = (
    '<iframe title="{title}" srcdoc="{page}" '
    'style="width: 100%; height: calc(100vh - 240px); min-height: 300px; border: 0"></iframe>'
)
DONE: dict[tuple[tuple[str, ...], str], dict[str, bytes]] = {}
"""Files of finished reports, by the command and the settings that it had."""


class Reports:
    """The tab.

    `job` is the report that is being made, and `title` its kind; `kind` is what is chosen, and
    `page` and `files` are what is shown of it.
    """

    def __init__(self, state: PageState) -> None:
        self.state = state
        self.job: Job | None = None
        self.title = ""
        self.kind = pmui.RadioButtonGroup(
            label="", options=list(WORDS), value=FIGURES, size="small", margin=(6, 6), sx=PLAIN
        )
        self.repeats = pmui.Select(
            label="Timed passes",
            options=[3, 5, 9],
            value=5,
            width=130,
            size="small",
            description="How often each method runs; its median time counts.",
        )
        self.is_quick = pmui.Switch(label="A quarter of the cases", value=True, margin=(10, 6))
        fields = (self.kind, self.repeats, self.is_quick)
        for field in fields:
            field.param.watch(lambda event: self._show(), "value")
        self._start = button("Start", self.start, icon="play_arrow", **LOOKS)
        self._cancel = button("Cancel", self.cancel, icon="stop", variant="outlined", **LOOKS)
        self._words = changing_text(margin=(0, 8))
        self._progress = changing_text(margin=(6, 8))
        self.files = pn.FlexBox()
        self.page = pn.pane.HTML("", sizing_mode="stretch_width", margin=(4, 8))
        self.view = pn.Column(
            self.kind,
            self._words,
            pn.FlexBox(*fields[1:], self._start, self._cancel, self.files),
            self._progress,
            self.page,
            sizing_mode="stretch_width",
            css_classes=["reports"],
        )
        state.param.watch(lambda event: self._show(), ["settings", "tab"])
        follow(self.look, self.end)
        self._show()
        if self.command not in DONE:
            self.start()

    @property
    def command(self) -> tuple[tuple[str, ...], str]:
        """The command that is chosen, and the settings that it has."""
        arguments = {
            FIGURES: ["figures"],
            STUDY: ["study", SETTINGS, "--repeats", str(self.repeats.value)],
            STABILITY: ["stability", *["--quick"] * self.is_quick.value],
            PROOF: ["proof"],
        }[self.kind.value]
        settings = dump(self.state.settings) if self.kind.value == STUDY else ""
        return (*arguments, "--out", OUT), settings

    def start(self) -> None:
        """Have the chosen report made."""
        self.end()
        self._running, self.title = self.command, self.kind.value
        self.job = Job(*self._running)
        state = self.state
        self._has_paused = self.title == STUDY and state.running and not state.is_over
        if self._has_paused:
            state.pause()
        self._show()
        self.look()

    def cancel(self) -> None:
        """End the report that is being made."""
        if self.job is not None:
            self.job.cancel()
            self.look()

    def end(self) -> None:
        """Leave nothing behind."""
        if self.job is not None:
            self.job.close()

    def look(self) -> None:
        """Follow the report that is being made."""
        job = self.job
        if job is None:
            return
        self._progress.object = f"{self.title}: {job.progress}" if job.progress else ""
        if not job.is_over:
            return
        if self._has_paused:
            self.state.go_on()
        if not job.failure:
            DONE[self._running] = job.files
            while len(DONE) > KEPT:
                DONE.pop(next(iter(DONE)))
        job.close()
        self.job = None
        self._show()

    def _show(self) -> None:
        """Show what is chosen: its fields, and the report if there is one."""
        if self.state.tab != "Reports":
            return
        kind, is_busy = self.kind.value, self.job is not None
        is_refused = kind == STUDY and not has_reference(self.state.settings)
        self._words.object = WORDS[kind] + f" {NO_REFERENCE}" * is_refused
        self.repeats.visible = kind == STUDY
        self.is_quick.visible = kind == STABILITY
        files = DONE.get(self.command, {})
        label = "Do it again" if files else "Start"
        self._start.param.update(disabled=is_busy or is_refused, label=label)
        self._cancel.visible = is_busy
        self.page.object = shown(files)
        self.files[:] = [
            download(name, name, lambda data=data: data, **LOOKS) for name, data in files.items()
        ]


def shown(files: dict[str, bytes]) -> str:
    """The page among a report's files, in a frame; its links to runs lead to this server (HTML)."""
    for name, data in files.items():
        if name.endswith(".html"):
            path = pn.state.location.pathname if pn.state.location is not None else ""
            text = data.decode().replace(PAGE, path or "app")
            text = text.replace("<style>", '<base target="_parent"><style>', 1)
            return FRAME.format(title=escape(name), page=escape(text))
    return ""
