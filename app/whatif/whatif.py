"""The tab *What if*: a question over a range of settings, and its chart, which fills as it runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, ClassVar

import param

from app.charts.filling import Filling
from app.charts.in_units import in_units, placed, scales_of
from app.charts.keys import legend
from app.components.innards import Plain
from app.components.panes import STATIC, column, script
from app.picture.units import SYSTEMS, of_files, scale_of
from app.picture.usual import hurried
from app.session.session import Session
from app.session.studies import mesh_of_run
from app.whatif.charted import columns_of, drawn, is_comparable, is_of, is_usual, stands
from app.whatif.fields import NO_SECOND, form_of, in_si, watched
from app.whatif.question import Question, changed_quantity, changed_span
from app.whatif.ready import READY, bathtub
from solver.definitions import SettingError
from solver.settings import Settings
from solver.study.chart import Chart, Map
from solver.study.mesh import decides
from solver.study.quantities.quantities import reading
from solver.study.sweep import Plan, Row
from solver.study.sweep.columns import columns
from solver.study.sweep.report import counts
from solver.study.sweep.table import csv_of

FILE = "what-if.csv"


class Asker(Plain):
    """Fields of the question, and the chart; what the user does comes as `{kind, value}`.

    Attributes
    ----------
    form
        What can be chosen, what is, and what of it is refused.
    progress
        How far the runs are.
    mesh
        Whether one `can` ask if the mesh is fine enough, is `busy` with it, what is said of that in
        `words`, and the `found` HTML.
    chart
        The `id` of its figure, its `legend`, and a `label` for those who do not see it.
    columns
        The `names` and titles of what may be drawn, and which are: `x` and `y`.
    file
        A text that the browser is to save, its name, and a number that tells it from others.
    """

    form = param.Dict(default={})
    progress = param.Dict(default={})
    mesh = param.Dict(default={})
    chart = param.Dict(default={})
    columns = param.Dict(default={})
    file = param.List(default=[])

    _esm = script("elements.js", "exports.js", "whatif/chart.js", "whatif/whatif.js")
    _stylesheets: ClassVar[list[str]] = [(STATIC / "whatif.css").read_text(encoding="utf-8")]


class WhatIf:
    """The tab.

    Parameters
    ----------
    session
        Has the sweep made, beside its run. A question that it has already, of the address, is asked
        as soon as somebody looks; without one, one is proposed then.
    show
        Opens the run of some settings on the live tab.

    Attributes
    ----------
    view
        What stands on the page; it is empty until `open`.
    """

    def __init__(self, session: Session, show: Callable[[Settings], None]) -> None:
        self._session, self._show = session, show
        self._waits = session.question is not None
        self._asker: Asker | None = None
        self._drawn: Plan | None = None
        self._meshed: tuple[dict[str, Any], str] | None = None
        self._filling = Filling(session.turns.soon, self.put_drawn)
        self._scene = session.wanted.scene
        self._columns = "", ""
        self.view = column(role="paper what-if", margin=(4, 10), visible=False)

    def open(self) -> None:
        """Show the fields; a question that came with the address is asked."""
        is_first = self._asker is None
        if is_first:
            self._asker = Asker(sizing_mode="stretch_width")
            self._asker.on_msg(lambda message: self.hear(**message.data))
            self._session.question = self._session.question or bathtub(self._session.wanted)
        if self._waits:
            self._waits = False
            self.start()
        self._refresh()
        if is_first:
            # Not before it has its fields: the browser builds it with what it comes with.
            self.view[:] = [self._asker, self._filling.view]

    def refresh(self) -> None:
        """Follow the sweep and the sidebar, as soon as somebody looks."""
        if self.view.visible:
            self._refresh()

    def put_drawn(self) -> None:
        """Put the chart in its place, if it is drawn."""
        if self._asker is not None and self._filling.catch_up():
            self._label()

    def hear(self, kind: str, value: Any) -> None:
        """Follow what the user does."""
        does: dict[str, Callable[[], object]] = {
            "span": lambda: self._on_span(**value),
            "quantity": lambda: self._on_quantity(**value),
            "ready": lambda: self._on_ready(value),
            "start": self.start,
            "cancel": self._session.asked.inquiry.cancel,
            "mesh": self._on_mesh,
            "there": lambda: self._filling.go_on(value),
            "run": lambda: self._on_run(value),
            "table": self._on_table,
            "columns": lambda: self._on_columns(value["x"], value["y"]),
        }
        does[kind]()
        self._refresh()

    def start(self) -> None:
        """Ask what the fields say; what is refused stands beside them."""
        settings, question = self._session.wanted, self._session.question
        if question is not None and not question.refusals(settings):
            self._session.asked.inquiry.ask(question.plan(settings))

    def _on_span(self, place: int, span: dict[str, str]) -> None:
        """Follow the fields of a setting; a second one without a name is none."""
        session = self._session
        spans = [*session.question.spans, NO_SECOND][:2]
        spans[place] = changed_span(session.wanted, spans[place], in_si(session.wanted, span))
        chosen = tuple(one for one in spans if one.name)
        session.question = Question(chosen, session.question.of)

    def _on_quantity(self, name: str, at: str) -> None:
        spans = self._session.question.spans
        self._session.question = Question(spans, changed_quantity(name, at))

    def _on_ready(self, title: str) -> None:
        _, make = READY[title]
        self._session.question = make(self._session.wanted) or self._session.question
        self.start()

    def _on_columns(self, x: str, y: str) -> None:
        """Draw other columns of the table."""
        self._columns = x, y

    def _on_run(self, number: int) -> None:
        """Open the run of a point, unless its settings were refused; the page watches as it did."""
        plan, wanted = self._session.asked.inquiry.plan, self._session.wanted
        if plan is not None and 0 <= number < plan.size:
            try:
                settings = plan.settings_at(number)
            except SettingError:
                return
            self._show(watched(settings, wanted, {axis.name for axis in plan.axes}))

    def _on_mesh(self) -> None:
        """Have the quantity taken on three meshes, or no more."""
        job, settings = self._session.asked.mesh, self._session.wanted
        if job.is_busy:
            job.cancel()
        elif self._can_ask_of_meshes():
            self._meshed = settings.values(), self._session.question.of
            of = self._session.question.of
            work = partial(
                mesh_of_run,
                settings.scene,
                hurried(settings).values(),
                of,
                self._session.look.units,
            )
            job.ask(reading(of).title, work)

    def _can_ask_of_meshes(self) -> bool:
        try:
            return decides(self._session.wanted, reading(self._session.question.of))
        except SettingError:
            return False

    def _mesh(self) -> dict[str, Any]:
        job = self._session.asked.mesh
        stands = self._meshed == (self._session.wanted.values(), self._session.question.of)
        return {
            "can": self._can_ask_of_meshes(),
            "busy": job.is_busy,
            "words": job.doing if job.is_busy else job.notice if stands else "",
            "found": "".join(str(one) for one in job.growing.sections) if stands else "",
        }

    def _on_table(self) -> None:
        inquiry = self._session.asked.inquiry
        if self._asker is not None and inquiry.plan is not None:
            rows = sorted(inquiry.rows, key=lambda row: row.number)
            count = self._asker.file[2] + 1 if self._asker.file else 1
            units = of_files(self._session.look.units)
            text = csv_of(inquiry.plan, rows, partial(scale_of, 0.0, units=units), SYSTEMS[units])
            self._asker.file = [text, FILE, count]

    def _refresh(self) -> None:
        if self._asker is None:
            return
        inquiry, settings = self._session.asked.inquiry, self._session.wanted
        plan = inquiry.plan
        self._keep_to(settings)
        if plan is not None:
            if plan is not self._drawn:
                self._drawn = plan
                self._filling.clear()
                self._label()
            self._show_chart(plan, settings)
        units = self._session.look.units
        form, progress = form_of(self._session.question, settings, units), self._progress()
        self._asker.param.update(form=form, progress=progress, mesh=self._mesh())

    def _show_chart(self, plan: Plan, settings: Settings) -> None:
        """Show what has come of a plan, with the chart before, in the units of the page."""
        chart, before = self._chart(plan, self._session.asked.inquiry.rows), self._ghost(plan)
        scales = scales_of(chart, self._session.look.units)
        x, y = columns_of(plan, self._columns)
        is_there = is_usual(plan, x, y)
        here = placed(stands(plan, chart, settings), scales) if is_there else None
        found = [[name, one.title] for name, one in columns(plan).items()]
        assert self._asker is not None
        self._asker.columns = {"names": found, "x": x, "y": y}
        ghost = before and in_units(before, scales)
        self._filling.show(in_units(chart, scales), ghost, here)

    def _chart(self, plan: Plan, rows: Sequence[Row]) -> Chart:
        return drawn(plan, rows, self._columns, self._session.look.units)

    def _keep_to(self, settings: Settings) -> None:
        """Propose something else where another scene knows nothing of what is asked."""
        session = self._session
        if settings.scene != self._scene:
            self._scene = settings.scene
            if not all(one.name in settings.definitions() for one in session.question.spans):
                session.question = bathtub(settings)

    def _ghost(self, plan: Plan) -> Chart | None:
        before = self._session.asked.inquiry.before
        if before is None or not is_comparable(plan, before[0]):
            return None
        alike = columns_of(plan, self._columns) == columns_of(before[0], self._columns)
        return self._chart(*before) if alike else None

    def _label(self) -> None:
        """Say beside the chart what it shows; nothing where there is none."""
        shown, found = self._filling.shown, {}
        if shown is not None:
            chart, before, _ = shown
            axes = [chart.x, chart.y, chart.scale] if isinstance(chart, Map) else [chart.x, chart.y]
            *over, asked = axes
            words = f"{asked.label} over {' and '.join(axis.quantity for axis in over)}."
            keys = legend([chart], asked.label, has_ghost=before is not None)
            found = {"id": self._filling.figure.id, "legend": keys, "label": words}
        assert self._asker is not None
        self._asker.chart = found

    def _progress(self) -> dict[str, Any]:
        inquiry, wanted = self._session.asked.inquiry, self._session.wanted
        question, plan, done = self._session.question, inquiry.plan, len(inquiry.rows)
        if plan is None:
            return {"busy": False, "share": 0.0, "words": "", "moved": False}
        words = counts(plan, inquiry.rows)
        if inquiry.is_busy:
            rest = f", {inquiry.left:.0f} s left" if done else ""
            words = f"{done} of {plan.size} runs{rest}"
        return {
            "busy": inquiry.is_busy,
            "share": done / plan.size,
            "words": " ".join(filter(None, (inquiry.notice, words))),
            "moved": not is_of(plan, question.asked(wanted)),
        }
