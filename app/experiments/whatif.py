"""The tab What if: a question over ranges of settings, and a chart of its runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import panel as pn
import panel_material_ui as pmui

from app.charts import LiveChart
from app.experiments.jobs import LIMIT, SETTINGS, Job, Sweep, follow
from app.experiments.questions import (
    READY,
    TENTH,
    TEXTS,
    Question,
    quantities,
    question_of,
)
from app.experiments.setting_range import FIELD, SettingRange
from app.refusals import in_titles, message_of
from app.state import WHAT_IF, PageState, answer
from app.widgets import PlainText, button, download, up_to
from solver.files.saved import dump
from solver.refusal import RefusedError
from solver.settings.scene import Settings
from solver.study.mesh import decides
from solver.study.page import Chart, Map
from solver.study.quantities import QUANTITIES, reading
from solver.study.sweep.charts import chart_of
from solver.study.sweep.plan import Plan, Row
from solver.study.sweep.report import counts
from solver.study.sweep.run import TOO_LONG
from solver.study.sweep.table import csv_of

MESH = "Is the mesh fine enough?"
SCALES = {"automatic": None, "linear": False, "logarithmic": True}


class WhatIf:
    """The tab What if.

    The state has the question, and the settings that do not vary.
    """

    def __init__(self, state: PageState) -> None:
        self.state = state
        self.question = Question((), "")
        self.sweep: Sweep | None = None
        self._reasons: dict[int, str] = {}
        self._seen: tuple[int, bool] = 0, False
        self._job: Job | None = None
        self._studied = "", state.settings
        self._is_updating = False
        self._make_fields()
        self._chart = LiveChart()
        table = download("Table (.csv)", "what-if.csv", self.table, **FIELD)
        spans = [span.view for span in self.spans]
        self.view = pn.Column(
            pn.FlexBox(*self._ready.values()),
            *spans,
            pn.FlexBox(self._of, self._at, self._scale, self._start, self._cancel),
            self.message,
            self._chart.view,
            pn.FlexBox(table, self.mesh, self._meshed),
            sizing_mode="stretch_width",
            css_classes=["what-if"],
        )
        state.param.watch(lambda *events: self._show(), ["settings", "tab", "question"])
        follow(self.look, self.end)
        self._show()

    def _make_fields(self) -> None:
        self.spans = (
            SettingRange("Vary", self._change, is_optional=False),
            SettingRange("and", self._change, is_optional=True),
        )
        self._of = pmui.Select(label="See what happens to", **up_to(386), **FIELD)
        self._at = pmui.TextInput(label="at", width=110, **FIELD)
        for field in (self._of, self._at):
            field.param.watch(lambda event: self._change(), "value")
        self._scale = pmui.Select(
            label="on a scale",
            options=list(SCALES),
            value=next(iter(SCALES)),
            width=150,
            **FIELD,
        )
        self._scale.param.watch(lambda event: self._on_scale(), "value")
        self._start = button("Draw", self.start, icon="play_arrow", **FIELD)
        look = {"variant": "outlined", **FIELD}
        self._cancel = button("Cancel", self.cancel, icon="stop", **look)
        self.mesh = button(MESH, self._on_mesh, icon="grid_on", **look)
        self._ready = {
            title: button(title, partial(self._on_ready, title), **look)
            for title in READY
        }
        self.message = PlainText(margin=(2, 8))
        self._meshed = PlainText(margin=(10, 8))

    def start(self) -> None:
        """Start the sweep of the question, and end a running one."""
        refusal = self.question.refusal(self.state.settings)
        if refusal:
            self.message.object = refusal
            return
        self.cancel()
        self._reasons = {}
        self.sweep = Sweep(self.question.plan(self.state.settings))
        self._draw()

    def cancel(self) -> None:
        """End the sweep; finished runs stay."""
        if self.sweep is not None:
            self.sweep.cancel()

    def end(self) -> None:
        """End the sweep and the study of meshes."""
        self.cancel()
        if self._job is not None:
            self._job.close()

    def look(self) -> None:
        """Show new runs of the sweep, and the progress of the study of meshes."""
        sweep = self.sweep
        job = self._job
        # A chart is drawn again only for rows that it does not show yet.
        if sweep is not None and self._seen != (len(sweep.rows), sweep.is_over):
            self._draw()
        if job is not None:
            self._meshed.object = job.progress or "\n".join(job.lines)
            self.mesh.label = MESH if job.is_over else "No more"
            if job.is_over:
                job.close()
                self._job = None

    def table(self) -> str:
        """CSV of the rows of the sweep so far, in SI, with all settings."""
        if self.sweep is None:
            return ""
        rows = sorted(self.sweep.rows, key=lambda row: row.number)
        return csv_of(self.sweep.plan, rows)

    def chart(self) -> Chart:
        """The chart of the runs so far."""
        plan = self.sweep.plan
        is_log = SCALES[self._scale.value]
        return chart_of(plan, self._rows_in_words(), 0, logarithmic=is_log)

    def _rows_in_words(self) -> list[Row]:
        """The rows so far, each with its reason in the words of the page."""
        rows = []
        # Its thread continues to append to them.
        for row in list(self.sweep.rows):
            if row.number not in self._reasons:
                self._reasons[row.number] = _reason(self.sweep.plan, row)
            rows.append(replace(row, reason=self._reasons[row.number]))
        return rows

    def _show(self) -> None:
        """Show and run the question, or a ready one if the scene lacks its terms.

        A question that was put together in the fields waits for the button.
        """
        if self.state.tab != WHAT_IF:
            return
        settings = self.state.settings
        before = self.question
        self.question = question_of(self.state.question, settings)
        # Fields report these changes, too, as if a person had made them.
        self._is_updating = True
        for span, text in zip(self.spans, (*self.question.vary, ""), strict=False):
            span.show(settings, text)
        self._show_quantity(settings)
        for title, ready in self._ready.items():
            ready.visible = READY[title](settings) is not None
        self.mesh.visible = decides(settings, reading(self.question.of))
        self._start.disabled = False
        self._is_updating = False
        if self._studied != (self.question.of, settings):
            self._forget_meshes()
        # Other settings alone wait for the button: their runs may take long.
        is_asked = self.sweep is not None and self.question == before
        # Two scenes may have a setting with the same name and range.
        if is_asked and self.sweep.plan.settings.scene == settings.scene:
            self._draw()
        else:
            self.start()

    def _show_quantity(self, settings: Settings) -> None:
        """Show the quantity of the question, and its parameter if any."""
        name, _, at = self.question.of.partition("@")
        options = {
            quantity.title: key for key, quantity in quantities(settings).items()
        }
        self._of.param.update(options=options, value=name)
        parameter = QUANTITIES[name].parameter
        self._at.param.update(value=at, visible=parameter is not None)
        if parameter is not None:
            self._at.label = parameter.words.replace("{:g}", "").strip() or "at"

    def _chosen_quantity(self) -> str:
        """Quantity and parameter of the fields, as text for `Question.of`."""
        name = self._of.value
        parameter = QUANTITIES[name].parameter
        if parameter is None:
            return name
        at = self._at.value.strip()
        if not at and parameter.needed:
            at = str(TENTH)
        if not at:
            return name
        return f"{name}@{at}"

    def _change(self) -> None:
        """Take the question from the fields; a refused one stays in the fields."""
        if self._is_updating:
            return
        settings = self.state.settings
        of = self._chosen_quantity()
        try:
            texts = [span.text() for span in self.spans]
            question = Question(tuple(text for text in texts if text), of)
            refusal = question.refusal(settings)
        except ValueError as problem:
            refusal = f"{problem}."
        # The state, and so the address, has only questions that can be run.
        self._start.disabled = bool(refusal)
        self.message.object = refusal
        if not refusal:
            self.question = question
            self.state.question = str(question)

    def _on_ready(self, title: str) -> None:
        self.state.question = str(READY[title](self.state.settings))

    def _on_scale(self) -> None:
        if self.sweep is not None:
            self._draw()

    def _on_mesh(self) -> None:
        """Start or end the study of three meshes and three numbers of instants."""
        if self._job is not None:
            self._job.cancel()
        else:
            texts = {SETTINGS: dump(answer(self.state.settings))}
            self._studied = self.question.of, self.state.settings
            self._job = Job(["mesh", SETTINGS, "--of", self.question.of], texts)
        self.look()

    def _forget_meshes(self) -> None:
        """End a study of meshes, and remove what it found for another question."""
        if self._job is not None:
            self._job.close()
            self._job = None
        self._meshed.object = ""
        self.mesh.label = MESH

    def _draw(self) -> None:
        """Draw the chart of the runs so far, with a message."""
        sweep = self.sweep
        settings = self.state.settings
        chart = self.chart()
        self._seen = len(sweep.rows), sweep.is_over
        self._cancel.visible = not sweep.is_over
        if sweep.is_over:
            words = counts(sweep.plan, sweep.rows)
            words += _without_value(sweep) + _off_scale(sweep, chart)
            words += _first_failure(self._rows_in_words())
        else:
            words = f"{sweep.progress}."
        if sweep.is_over and not _is_of(sweep.plan, self.question.asked(settings)):
            words += " These are runs of other settings: draw them again."
        sentences = [sweep.message, words]
        for title, text in TEXTS["questions"].items():
            if READY[title](settings) == self.question:
                sentences.append(text)
        self.message.object = " ".join(sentences).strip()
        self._chart.show(chart)


def _without_value(sweep: Sweep) -> str:
    """Sentence on converged runs whose quantity has no value, or ""."""
    values = [row.values[0] for row in sweep.rows if row.holds]
    count = sum(not math.isfinite(value) for value in values)
    if count == 0:
        return ""
    return f" Without a value: {count} of the converged; point at one for the reason."


def _off_scale(sweep: Sweep, chart: Chart) -> str:
    """Sentence on runs that the scale of their chart does not have, or ""."""
    axis = chart.y
    if isinstance(chart, Map):
        axis = chart.scale
    if not axis.logarithmic:
        return ""
    # Infinity is never reached: such runs are without a value.
    count = sum(row.values[0] <= 0.0 for row in sweep.rows)
    if count == 0:
        return ""
    return f" Not on a logarithmic scale: {count} of value 0 or less."


def _first_failure(rows: Sequence[Row]) -> str:
    """Sentence on the first run without an answer, or ""."""
    failed = [row for row in rows if not row.holds]
    if not failed:
        return ""
    first = min(failed, key=lambda row: row.number)
    return f" The first {first.ending}: {first.reason}"


def _reason(plan: Plan, row: Row) -> str:
    """Reason of a run without an answer, in the words of the page.

    The row has names and units of scripts, and advice for the command line.
    """
    if row.holds:
        return row.reason
    if row.reason == TOO_LONG:
        return f"It took longer than the {LIMIT:g} s that a run of a chart may take."
    try:
        plan.settings_at(row.number)
    except RefusedError as refusal:
        return message_of(refusal, plan.settings)
    return in_titles(plan.settings, row.reason)


def _is_of(plan: Plan, settings: Settings) -> bool:
    """Check whether a plan has given settings, apart from the varied ones."""
    if settings.scene != plan.settings.scene:
        return False
    varied = {axis.name: None for axis in plan.axes}
    return settings.values() | varied == plan.settings.values() | varied
