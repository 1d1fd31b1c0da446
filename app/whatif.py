"""The tab What if: a question over a range of settings, and its chart, which fills as runs end."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import holoviews as hv
import numpy as np
import panel as pn
import panel_material_ui as pmui
import param
from bokeh.events import Tap

from app.charts import form, in_units, keys, overlay
from app.jobs import SETTINGS, Job
from app.questions import (
    READY,
    Question,
    as_watched,
    bathtub,
    quantities,
    quantity_with,
    variable,
)
from app.refusals import message_of
from app.spans import FIELD, Span
from app.state import PageState, answer
from app.sweeps import Sweep
from app.units import number, sizes_of, unit_for
from solver.checked import dump
from solver.definitions import SettingError
from solver.settings import Settings
from solver.study.chart import Chart, Map, PanelAxis
from solver.study.mesh import decides
from solver.study.quantities.quantities import QUANTITIES, reading
from solver.study.sweep import Plan, Varied
from solver.study.sweep.chart import chart_of, is_map, ordered
from solver.study.sweep.report import counts
from solver.study.sweep.table import csv_of

LOOK = 500
"""Milliseconds between two looks at a job."""
MESH = "Is the mesh fine enough?"
NEAR = 0.04
"""Share of the axes up to which a tap hits a point."""


class WhatIf(param.Parameterized):
    """The tab.

    Parameters
    ----------
    state
        Of the page: all that does not vary is as there.
    open_run
        Opens the run of some settings on the live tab.

    Attributes
    ----------
    question
        What is asked; an address says it by `Question.pairs`.
    sweep
        Its runs; None before there are any.
    spans, mesh
        Fields of the settings that vary, and the button that asks of meshes.
    view
        What stands on the page.
    """

    question = param.ClassSelector(class_=Question, doc="What is asked.")

    def __init__(
        self,
        state: PageState,
        open_run: Callable[[Settings], None],
        question: Question | None = None,
    ) -> None:
        super().__init__(question=question or bathtub(state.settings))
        self.state, self._open_run = state, open_run
        self._document = pn.state.curdoc
        self.sweep: Sweep | None = None
        self._job: Job | None = None
        self._looking: Any = None
        self._is_updating = False
        self._form: tuple[Any, ...] = ()
        self._pipe = hv.streams.Pipe(data=None)
        self._make_fields()
        self._chart = pn.pane.HoloViews(None, sizing_mode="stretch_width", margin=(0, 6))
        self.view = pn.Column(
            pn.FlexBox(*self._ready, self._help),
            *(span.view for span in self.spans),
            pn.FlexBox(self._of, self._at, self._start, self._cancel),
            self._message,
            self._keys,
            self._chart,
            pn.FlexBox(self._table, self.mesh, self._meshed),
            sizing_mode="stretch_width",
            css_classes=["what-if"],
        )
        self.param.watch(lambda event: self._show(), "question")
        state.param.watch(lambda event: self._follow_page(), ["settings", "tab"])
        if self._document is not None and self._document.session_context is not None:
            self._document.on_session_destroyed(lambda context: self.end())
        self._show()
        self.start()

    def _make_fields(self) -> None:
        changed = self._change
        self.spans = (
            Span("Vary", changed, is_optional=False),
            Span("and", changed, is_optional=True),
        )
        self._of = pmui.Select(label="See what happens to", width=386, **FIELD)
        self._at = pmui.TextInput(label="at", width=110, **FIELD)
        for field in (self._of, self._at):
            field.param.watch(lambda event: self._change(), "value")
        self._start = _button("Draw", "play_arrow", self.start, variant="contained")
        self._cancel = _button("Cancel", "stop", self._on_cancel)
        self.mesh = _button(MESH, "grid_on", self._on_mesh)
        self._ready = [
            _button(title, "", lambda title=title: self._on_ready(title)) for title in READY
        ]
        self._table = pmui.FileDownload(
            label="Table (.csv)", callback=self.table, filename="what-if.csv", **FIELD
        )
        self._table.variant = "outlined"
        self._help = pmui.Typography("", variant="body2", margin=(2, 8))
        self._message = pmui.Typography("", variant="body2", margin=(2, 8))
        self._meshed = pmui.Typography("", variant="body2", margin=(10, 8))
        self._keys = pn.pane.HTML("", margin=(4, 8))

    @property
    def message(self) -> str:
        """How far the runs are, or what is refused."""
        return str(self._message.object)

    def start(self) -> None:
        """Have the question answered, in place of the one before."""
        refusal = self.question.refusal(self.state.settings)
        if refusal:
            self._message.object = refusal
            return
        self._on_cancel()
        plan = self.question.plan(self.state.settings)
        self._form = ()
        self.sweep = Sweep(plan, self._soon)
        self._follow()

    def end(self) -> None:
        """End what is under way."""
        self._on_cancel()
        if self._job is not None:
            self._job.close()

    def table(self) -> io.StringIO:
        """Rows of the sweep so far, as CSV in SI, with all settings."""
        sweep = self.sweep
        rows = sorted(sweep.rows, key=lambda row: row.number) if sweep is not None else []
        return io.StringIO(csv_of(sweep.plan, rows) if sweep is not None else "")

    def chart(self) -> Chart | None:
        """What has come so far, in the units that are read."""
        sweep = self.sweep
        if sweep is None:
            return None
        return in_units(chart_of(sweep.plan, list(sweep.rows), 0, _measured))

    # Fields

    def _show(self) -> None:
        """Show the question in the fields."""
        settings, question = self.state.settings, self.question
        self._is_updating = True
        first, second, *_ = (*question.vary, "", "")
        self.spans[0].show(settings, first)
        self.spans[1].show(settings, second)
        name, _, at = question.of.partition("@")
        options = {quantity.title: key for key, quantity in quantities(settings).items()}
        self._of.param.update(options=options, value=name)
        parameter = QUANTITIES[name].parameter if name in QUANTITIES else None
        self._at.param.update(value=at, visible=parameter is not None)
        if parameter is not None:
            self._at.label = parameter.words.replace("{:g}", "").strip() or "at"
        for button, (_, make) in zip(self._ready, READY.values(), strict=True):
            button.visible = make(settings) is not None
        self._tell_mesh()
        self._is_updating = False

    def _change(self) -> None:
        """Take the question from the fields."""
        if self._is_updating:
            return
        try:
            vary = tuple(text for span in self.spans if (text := span.text))
        except ValueError as problem:
            self._message.object = f"{problem}."
            return
        at = self._at.value if self._at.visible else ""
        self.question = Question(vary, quantity_with(self._of.value, at))
        self._message.object = self.question.refusal(self.state.settings)
        self._start.disabled, self._help.object = bool(self._message.object), ""

    def _on_ready(self, title: str) -> None:
        question = READY[title][1](self.state.settings)
        if question is not None:
            self.question, self._help.object = question, READY[title][0]
            self.start()

    def _on_cancel(self) -> None:
        if self.sweep is not None:
            self.sweep.cancel()

    def _follow_page(self) -> None:
        """Offer what the present settings have; another scene may know nothing of the question."""
        if self.state.tab != "What if":
            return
        settings = self.state.settings
        if not set(self.question.names) <= variable(settings).keys():
            self.question = bathtub(settings)
        self._show()
        self._follow()

    # Chart

    def _soon(self) -> None:
        """Follow the sweep on the document's own thread."""
        if self._document is None:
            self._follow()
        elif self._document.session_context is not None:
            self._document.add_next_tick_callback(self._follow)

    def _follow(self) -> None:
        """Show what has come."""
        sweep, chart = self.sweep, self.chart()
        if sweep is None or chart is None:
            return
        self._cancel.visible = not sweep.is_over
        words = counts(sweep.plan, sweep.rows)
        if not sweep.is_over:
            rest = f", {sweep.left:.0f} s left" if sweep.rows else ""
            words = f"{len(sweep.rows)} of {sweep.plan.size} runs{rest}"
        elif not _is_of(sweep.plan, self.question.asked(self.state.settings)):
            words += " These are runs of other settings: draw them again."
        self._message.object = " ".join(filter(None, (sweep.message, words)))
        here = _place_of(sweep.plan, chart, self.state.settings)
        if form(chart) == self._form:
            self._pipe.send((chart, here))
            return
        self._form, self._keys.object = form(chart), keys([chart])
        self._pipe = hv.streams.Pipe(data=(chart, here))
        look = {"hooks": [self._listen]}
        self._chart.object = hv.DynamicMap(
            lambda data: overlay(*data).opts(**look), streams=[self._pipe]
        )

    def _listen(self, plot: Any, _element: Any) -> None:
        """Listen to taps, as HoloViews' own stream does not on overlays."""
        if not plot.handles.get("is_tapped"):
            plot.handles["is_tapped"] = True
            plot.state.on_event(Tap, lambda event: self.open_at(event.x, event.y))

    def open_at(self, x: float, y: float) -> None:
        """Open the run of the point at a place on the chart, if there is one."""
        chart = self.chart()
        place = nearest(chart, x, y) if chart is not None and chart.runs is not None else None
        if place is None:
            return
        plan = self.sweep.plan
        try:
            settings = plan.settings_at(int(chart.runs.numbers[place]))
        except SettingError as refusal:
            self.state.refusal = message_of(refusal, self.state.settings)
            return
        varied = [axis.name for axis in plan.axes]
        self._open_run(as_watched(settings, self.state.settings, varied))

    # Mesh

    def _on_mesh(self) -> None:
        """Have the quantity taken on three meshes and three numbers of instants, or no more."""
        if self._job is not None and not self._job.is_over:
            self._job.cancel()
            return
        if self._job is not None:
            self._job.close()
        settings = dump(answer(self.state.settings))
        self._job = Job(["mesh", SETTINGS, "--of", self.question.of], settings)
        self.mesh.label = "No more"
        self._look()
        if self._document is not None:
            self._looking = self._document.add_periodic_callback(self._look, LOOK)

    def _look(self) -> None:
        job = self._job
        if job is None:
            return
        self._meshed.object = job.progress or "  \n".join(map(str.strip, job.lines))
        if job.is_over:
            self.mesh.label = MESH
            if self._looking is not None:
                self._document.remove_periodic_callback(self._looking)
                self._looking = None

    def _tell_mesh(self) -> None:
        try:
            can = decides(self.state.settings, reading(self.question.of))
        except SettingError:
            can = False
        self.mesh.visible = can


def nearest(chart: Chart, x: float, y: float) -> int | None:
    """Number in the chart of the run that is meant by a place on it; None where there is none."""
    assert chart.runs is not None
    ways = []
    for axis, values, at in ((chart.x, chart.runs.x, x), (chart.y, chart.runs.y, y)):
        if axis.logarithmic:
            values, at = np.log(values), np.log(at)
        known = values[np.isfinite(values)]
        ways.append((values - at) / ((np.ptp(known) if len(known) else 0.0) or 1.0))
    far = np.hypot(*ways)
    if not np.isfinite(far).any():
        return None
    place = int(np.nanargmin(far))
    return place if isinstance(chart, Map) or far[place] < NEAR else None


def _measured(value: float, unit: str) -> str:
    return unit_for(abs(value), unit)(value, 4) if unit != "%" else f"{number(value, 4)} %"


def _is_of(plan: Plan, settings: Settings) -> bool:
    """Whether a plan fixes what settings say."""
    if settings.scene != plan.settings.scene:
        return False
    varied = {axis.name for axis in plan.axes}
    before, after = plan.settings.values(), settings.values()
    return all(before[name] == after[name] for name in before if name not in varied)


def _place_of(plan: Plan, chart: Chart, settings: Settings) -> tuple[float, float]:
    """Where settings stand on a chart; NaN off its axes, and above where there is no run."""
    if settings.scene != plan.settings.scene:
        return np.nan, np.nan
    across, *up = ordered(plan)
    x = _along(across, settings, plan.unit(across), chart.x)
    if is_map(plan):
        return x, _along(up[0], settings, plan.unit(up[0]), chart.y)
    y, runs = np.nan, chart.runs
    point = {axis.name: getattr(settings, axis.name) for axis in plan.axes}
    for run, value in zip(runs.numbers, runs.y, strict=True) if runs is not None else ():
        y = value if plan.point(int(run)) == point else y
    return x, y


def _along(axis: Varied, settings: Settings, unit: str, shown: PanelAxis) -> float:
    """Where a value stands on an axis, in the unit that is shown; NaN off it."""
    value = getattr(settings, axis.name)
    if axis.is_numeric:
        is_on = min(axis.values) <= value <= max(axis.values)
        return float(value) / sizes_of(unit).get(shown.unit, 1.0) if is_on else np.nan
    return float(axis.values.index(value)) if value in axis.values else np.nan


def _button(label: str, icon: str, act: Callable[[], object], **more: Any) -> pmui.Button:
    look = {"variant": "outlined", **FIELD, **more, **({"icon": icon} if icon else {})}
    return pmui.Button(label=label, on_click=lambda event: act(), **look)
