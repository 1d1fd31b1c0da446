"""The tab Fit: settings under which a run is nearest to a measured loop, and what that tells."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from html import escape
from typing import Any

import holoviews as hv
import numpy as np
import pandas as pd
import panel as pn
import panel_material_ui as pmui

from app.charts import in_units, keys, overlay
from app.columns_dialog import TableOpener
from app.frame import Frame
from app.jobs import OUT, SETTINGS, Job, follow
from app.state import PageState
from app.tables import TABLES, axes_on
from app.units import number, unit_of
from app.widgets import button, changing_text, download
from solver.checked import dump
from solver.definitions import about
from solver.files import scene_settings
from solver.settings import Settings
from solver.study.chart import Panel, PanelAxis, PanelCurve
from solver.study.compared_runs import fittable
from solver.study.fit import MOST
from solver.study.fit_report import LOOP, PAGE
from solver.study.measured_loop import MeasuredLoop
from solver.study.page import html_table

FIELD: dict[str, Any] = {"size": "small", "margin": (5, 6)}
MEASURED = "measured.csv"
TABLE = """
th, td { padding: 2px 14px 2px 0; text-align: left; white-space: nowrap; font: 14px sans-serif }
"""
NO_LOOP = (
    "Open a table of displacement and force, with time if you have it. It is drawn beside the run, "
    "here and on the loop of the tab Live."
)
READY = f"Tick up to {MOST} settings. They begin as they are set."


class FitTab:
    """The tab: the state has the measured loop and where the settings begin.

    `open_run` opens the run of some settings on the live tab.
    """

    def __init__(self, state: PageState, open_run: Callable[[Settings], None]) -> None:
        self.state, self._open_run = state, open_run
        self.job: Job | None = None
        self.found: dict[str, Any] | None = None
        self._nearest: pd.DataFrame | None = None
        self._page = b""
        opener = TableOpener(state, "Open a measured loop", TABLES, 230)
        self.chosen = pmui.CheckBoxGroup(label="", inline=True, margin=(5, 6))
        self.start_button = button("Start", self.start, icon="play_arrow", **FIELD)
        look = {"variant": "outlined", **FIELD}
        self._cancel = button("Cancel", self.cancel, icon="stop", **look)
        self.use_button = button("Use these settings", self.use, icon="check", **FIELD)
        self._take_away = download("Take away (.html)", "fit.html", lambda: self._page, **FIELD)
        self.message = changing_text(margin=(2, 8))
        self.table = pn.pane.HTML("", margin=(4, 8), stylesheets=[TABLE])
        self._keys = pn.pane.HTML("", margin=(4, 8))
        self._pipe = hv.streams.Pipe(data=None)
        self._chart = pn.pane.HoloViews(None, sizing_mode="stretch_width", margin=(0, 6))
        self.view = pn.Column(
            opener.view,
            self.chosen,
            pn.FlexBox(self.start_button, self._cancel, self.use_button, self._take_away),
            self.message,
            self.table,
            self._keys,
            self._chart,
            sizing_mode="stretch_width",
            css_classes=["fit"],
        )
        state.param.watch(lambda event: self._show(), ["settings", "tab", "brought"])
        state.param.watch(lambda event: self._on_frame(event.new), "frame")
        follow(self.look, self.end)
        self._show()

    @property
    def measured(self) -> MeasuredLoop | None:
        """The loop, if one was brought that is of these quantities."""
        brought = self.state.brought
        if not isinstance(brought, MeasuredLoop):
            return None
        units = tuple(unit for _, unit in axes_on(self.state))
        return brought if brought.units == units else None

    def start(self) -> None:
        """Look for the settings that are ticked, in place of those before."""
        measured, names = self.measured, self.chosen.value
        if measured is None or not names:
            self.message.object = NO_LOOP if measured is None else READY
            return
        self._close()
        self.found, self._nearest, self._page = None, None, b""
        arguments = ["fit", SETTINGS, "--with", MEASURED, "--vary", ",".join(names), "--out", OUT]
        self.job = Job([*arguments, "--json"], dump(self.state.settings))
        (self.job.folder / MEASURED).write_text(measured.csv(), encoding="utf-8")
        self._show()

    def cancel(self) -> None:
        """End it; the loop that it had come to stays in sight."""
        if self.job is not None:
            self.job.cancel()
            self.look()

    def end(self) -> None:
        """Leave nothing behind."""
        self._close()

    def _close(self) -> None:
        if self.job is not None:
            self.job.close()
            self.job = None

    def look(self) -> None:
        """Show how far it is, and the nearest loop so far."""
        job = self.job
        if job is None:
            return
        file = job.folder / OUT / LOOP
        if file.exists():
            self._nearest = pd.read_csv(file)
        with suppress(ValueError, IndexError):
            found = json.loads(job.lines[-1])
            self.found = found if isinstance(found, dict) else None
        if self.found is None:
            self.message.object = job.progress.removeprefix("slipfront: ")
        else:
            found = self.found
            near, far = (number(100.0 * found[name]) for name in ("distance", "distance_before"))
            head = f"{near} % away, before {far} %; {found['runs']} runs."
            sentences = [self._in_titles(sentence) for sentence in found["messages"]]
            self.message.object = "  \n".join([head, *sentences])
        if job.is_over:
            self._page = job.files.get(PAGE, b"")
            self._close()
        self._show()

    def use(self) -> None:
        """Have the page run with what was found."""
        if self.found is not None:
            self._open_run(self._settings())

    def _settings(self) -> Settings:
        """Settings of the nearest run; those that were found with as many digits as one reads."""
        values = dict(self.found["settings"]) if self.found else {}
        names = self.found["parameters"] if self.found else []
        values |= {name: float(f"{values[name]:.6g}") for name in names}
        return scene_settings(values.pop("scene", None)).checked(values)

    def _in_titles(self, text: str) -> str:
        """A sentence with titles for the names of settings."""
        definitions = self._settings().definitions()
        for name in self.found["parameters"] if self.found else []:
            text = re.sub(rf"\b{name}\b", about(definitions[name]).title, text)
        return text

    def _on_frame(self, frame: Frame | None) -> None:
        if frame is not None and frame.status is not None:
            self._show()

    def _show(self) -> None:
        """Bring fields, table and chart up to date."""
        state = self.state
        if state.tab != "Fit":
            return
        settings, measured = state.settings, self.measured
        definitions = settings.definitions()
        titles = {f"{about(definitions[n]).title}": n for n in fittable(settings)}
        kept = [name for name in self.chosen.value if name in titles.values()]
        if self.chosen.options != titles or self.chosen.value != kept:
            self.chosen.param.update(options=titles, value=kept)
        if self.message.object in ("", NO_LOOP, READY):
            self.message.object = NO_LOOP if measured is None else READY
        self.start_button.disabled = measured is None or self.job is not None
        self._cancel.visible, self.use_button.visible = self.job is not None, bool(self.found)
        self._take_away.visible = bool(self._page)
        self.table.object = html_table(self._rows()) if self.found else ""
        chart = self._panel(measured)
        self._keys.object = keys([chart]) if chart is not None else ""
        self._chart.visible = chart is not None
        if chart is None:
            return
        self._pipe.send(in_units(chart))
        if self._chart.object is None:
            self._chart.object = hv.DynamicMap(lambda data: overlay(data), streams=[self._pipe])

    def _rows(self) -> list[list[str]]:
        """Settings that were found, with standard errors and correlations, in units."""
        found, settings = self.found or {}, self._settings()
        names = list(found["parameters"])
        titles = {name: about(settings.definitions()[name]).title for name in names}
        several = names if len(names) > 1 else []
        table = [
            ["", "value", "standard error", "began at", *(f"with {titles[n]}" for n in several)]
        ]
        entries = zip(found["parameters"].items(), found["correlation"], strict=True)
        for (name, entry), correlation in entries:
            unit, error = unit_of(settings.definitions()[name]), entry["standard_error"]
            margin = "not known alone" if error is None else f"± {unit(error, 2)}"
            cells = [unit(entry["value"], 5), margin, unit(entry["start"], 4)]
            with_others = ["–" if c is None else f"{c + 0.0:.2f}" for c in correlation]
            table.append([titles[name], *cells, *(with_others if several else [])])
        return table

    def _panel(self, measured: MeasuredLoop | None) -> Panel | None:
        """The measured loop, the run of the page, and the nearest one so far."""
        frame, curves = self.state.frame, []
        if measured is None:
            return None
        curves.append(PanelCurve("measured", measured.displacement, measured.force, 5, "points"))
        if frame is not None and frame.run.settings.scene == self.state.settings.scene:
            loop = np.asarray(frame.loop, dtype=float)
            curves.append(PanelCurve("run of the page", *loop, 0, "dotted"))
        if self._nearest is not None:
            _, across, up = (self._nearest[name].to_numpy() for name in self._nearest)
            curves.append(PanelCurve("nearest run", across, up, 1))
        x, y = (PanelAxis(title, unit) for title, unit in axes_on(self.state))
        return Panel(escape(measured.source), x, y, tuple(curves))
