"""The tab Reports: what the long commands of the command line write, made and read on the page."""

from __future__ import annotations

import io
from collections import OrderedDict
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.jobs import OUT, SETTINGS, Job
from app.spans import FIELD, PLAIN
from app.state import PageState
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
    PROOF: "Closed forms, published numbers, and other programs on the same mesh where they are "
    "installed: each number beside what LATIN and the incremental solver find. A name that is a "
    "link opens that run.",
}
NO_REFERENCE = (
    "The reference to measure errors by would take too long here: choose fewer bodies or "
    "elements, or the command line."
)
REPEATS = (3, 5, 9)
LOOK = 500
"""Milliseconds between two looks at a job."""
KEPT = 12
"""Reports that a server keeps for all of its pages."""
FRAME = (
    '<iframe title="{title}" srcdoc="{page}" '
    'style="width: 100%; height: calc(100vh - 240px); min-height: 300px; border: 0"></iframe>'
)
Asked = tuple[tuple[str, ...], str]
DONE: OrderedDict[Asked, dict[str, bytes]] = OrderedDict()
"""Files of finished reports, by the command and the settings that it had."""


class Reports:
    """The tab.

    Parameters
    ----------
    state
        Of the page, whose settings a study has.

    Attributes
    ----------
    job, title
        The report that is being made, or was last, and its kind.
    kind, page, files
        What is chosen, and what is shown of it: a page, and files to be saved.
    view
        What stands on the page.
    """

    def __init__(self, state: PageState) -> None:
        self.state = state
        self._document = pn.state.curdoc
        self.job: Job | None = None
        self._asked: Asked = ((), "")
        self.title = ""
        self._looking: Any = None
        self._stood_still = False
        self._make()
        state.param.watch(lambda event: self._show(), ["settings", "tab"])
        if self._document is not None and self._document.session_context is not None:
            self._document.on_session_destroyed(lambda context: self.end())
        self._show()
        if self.asked not in DONE:
            self.start()

    def _make(self) -> None:
        self.kind = pmui.RadioButtonGroup(
            label="", options=list(WORDS), value=FIGURES, size="small", margin=(6, 6), sx=PLAIN
        )
        self.repeats = pmui.Select(
            label="Timed passes",
            options=list(REPEATS),
            value=REPEATS[1],
            width=130,
            description="How often each method runs; its median time counts.",
            **FIELD,
        )
        self.sizes = pmui.Switch(
            label="Growth with the size",
            description="Also measure other numbers of elements, instants and substructures; "
            "takes several times as long.",
            margin=(10, 6),
        )
        self.is_quick = pmui.Switch(label="A quarter of the cases", value=True, margin=(10, 6))
        more: dict[str, Any] = {**FIELD, "margin": (10, 6)}
        self._start = pmui.Button(
            label="Start", icon="play_arrow", on_click=lambda event: self.start(), **more
        )
        self._cancel = pmui.Button(
            label="Cancel",
            icon="stop",
            variant="outlined",
            on_click=lambda event: self.cancel(),
            **more,
        )
        for field in (self.kind, self.repeats, self.sizes, self.is_quick):
            field.param.watch(lambda event: self._show(), "value")
        self._words = pmui.Typography("", variant="body2", margin=(0, 8))
        self._progress = pmui.Typography("", variant="body2", margin=(6, 8))
        self.files = pn.FlexBox()
        self.page = pn.pane.HTML("", sizing_mode="stretch_width", margin=(4, 8))
        asked = (self.repeats, self.sizes, self.is_quick, self._start, self._cancel, self.files)
        self.view = pn.Column(
            self.kind,
            self._words,
            pn.FlexBox(*asked),
            self._progress,
            self.page,
            sizing_mode="stretch_width",
            css_classes=["reports"],
        )

    @property
    def asked(self) -> Asked:
        """The command that is chosen, and the settings that it has."""
        arguments = {
            FIGURES: ["figures"],
            STUDY: ["study", SETTINGS, "--repeats", str(self.repeats.value)]
            + ["--no-growth"] * (not self.sizes.value),
            STABILITY: ["stability", *["--quick"] * bool(self.is_quick.value)],
            PROOF: ["proof"],
        }[self.kind.value]
        settings = dump(self.state.settings) if self.kind.value == STUDY else ""
        return (*arguments, "--out", OUT), settings

    def start(self) -> None:
        """Have the chosen report made, unless one is."""
        if self.job is not None and not self.job.is_over:
            return
        if self.job is not None:
            self.job.close()
        self._asked, self.title = self.asked, self.kind.value
        self.job = Job(*self._asked)
        if self._document is not None:
            self._looking = self._document.add_periodic_callback(self.look, LOOK)
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
        """Follow the job."""
        job, state = self.job, self.state
        if job is None:
            return
        is_timed = self.title == STUDY and job.is_begun and not job.is_over
        if is_timed and not self._stood_still and state.running and not state.is_over:
            self._stood_still = True
            state.pause()
        if job.is_over:
            if self._looking is not None:
                self._document.remove_periodic_callback(self._looking)
                self._looking = None
            if self._stood_still:
                self._stood_still = False
                state.go_on()
            if not job.failure:
                DONE[self._asked] = job.files
                while len(DONE) > KEPT:
                    DONE.popitem(last=False)
        self._show()

    def _show(self) -> None:
        """Show what is chosen: its fields, its progress, and the report if there is one."""
        if self.state.tab != "Reports" and self._words.object:
            return
        kind, job = self.kind.value, self.job
        is_refused = kind == STUDY and not has_reference(self.state.settings)
        is_busy = job is not None and not job.is_over
        self._words.object = WORDS[kind] + f" {NO_REFERENCE}" * is_refused
        self.repeats.visible = self.sizes.visible = kind == STUDY
        self.is_quick.visible = kind == STABILITY
        files = DONE.get(self.asked, {})
        self._start.param.update(
            disabled=is_busy or is_refused, label="Do it again" if files else "Start"
        )
        self._cancel.visible = is_busy
        self._progress.object = f"{self.title}: {job.progress}" if job and job.progress else ""
        names = [download.filename for download in self.files]
        page = shown(files)
        if page != self.page.object or names != list(files):
            self.page.object = page
            self.files[:] = [_download(name, data) for name, data in files.items()]


def shown(files: dict[str, bytes]) -> str:
    """The page among a report's files, in a frame; its links to runs lead to this server (HTML)."""
    for name, data in files.items():
        if name.endswith(".html"):
            path = pn.state.location.pathname if pn.state.location is not None else ""
            text = data.decode().replace(PAGE, path or "app")
            text = text.replace("<style>", '<base target="_parent"><style>', 1)
            return FRAME.format(title=escape(name), page=escape(text))
    return ""


def _download(name: str, data: bytes) -> pmui.FileDownload:
    made = pmui.FileDownload(
        label=name, filename=name, callback=partial(io.BytesIO, data), size="small", margin=(10, 4)
    )
    # Its constructor warns of a variant, whatever it is.
    made.variant = "outlined"
    return made
