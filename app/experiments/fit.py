"""The tab Fit: settings for which a run is nearest to a measured loop."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import panel_material_ui as pmui

from app.charts import LiveChart
from app.experiments.jobs import OUT, SETTINGS
from app.experiments.reports import LOOKS, Command, CommandTab, Files
from app.files.opener import TableOpener
from app.files.tables import TABLES, axes_on
from app.state import TABS, PageState
from app.widgets import button
from solver.files.amounts import unit_of
from solver.files.saved import dump, settings_from_toml
from solver.settings.definitions import title_of
from solver.study.fit import MOST
from solver.study.fit_report import LOOP
from solver.study.fitted_settings import fittable
from solver.study.measured_loop import MeasuredLoop
from solver.study.page import Panel, PanelAxis, PanelCurve

DIGITS = 4
"""Digits of a value while a fit runs."""
LONGEST = 60
"""Largest number of letters of the name of a file, of up to four bytes each: systems
take 255 bytes."""
NO_LOOP = (
    "Open a measured loop: a table of {} and {}, with time if you have "
    "it. It is drawn here, and on the plot Loop of the tab Live beside the run."
)
NO_SETTING = f"Tick up to {MOST} settings. They begin as they are set."


class FitTab(CommandTab):
    """The tab Fit: measured loop and initial settings are those of the state."""

    def __init__(self, state: PageState) -> None:
        opener = TableOpener(state, "Open a measured loop", TABLES, 230)
        opener.view.margin = (0, 6)
        self.chosen = pmui.CheckBoxGroup(label="", inline=True, margin=(5, 6))
        self.use_button = button("Use these settings", self.use, icon="check", **LOOKS)
        self._chart = LiveChart()
        self._fitted = state.settings, None
        super().__init__(state, "Fit", opener.view, self.chosen)
        # Above a report: it is of the fit before while another one runs.
        self.view.insert(self.view.index(self.page), self._chart.view)
        self.buttons.insert(1, self.use_button)
        self.chosen.param.watch(lambda event: self.show(), "value")
        self.show()

    @property
    def measured(self) -> MeasuredLoop | None:
        """The opened measured loop, if it has the quantities of the scene."""
        brought = self.state.brought
        if not isinstance(brought, MeasuredLoop):
            return None
        units = tuple(unit for _, unit in axes_on(self.state))
        if brought.units != units:
            return None
        return brought

    @property
    def command(self) -> Command | None:
        """Command of the fit of ticked settings to the loop; None without either."""
        names = ",".join(self.chosen.value)
        loop = self.measured
        if loop is None or not names:
            return None
        # The report names the file as its owner does.
        stem = re.sub(r"[^\w-]+", "-", Path(loop.source).stem)
        file = f"{stem[:LONGEST]}.csv"
        # Behind a sign of equality a name may begin with a dash.
        with_file = f"--with={file}"
        arguments = ("fit", SETTINGS, with_file, "--vary", names, "--out", OUT)
        return arguments, {SETTINGS: dump(self.state.settings), file: loop.csv()}

    @property
    def written(self) -> Files:
        """Files of the last report, unless it is of another scene or loop."""
        settings, loop = self._fitted
        is_other = self.measured is not None and self.measured is not loop
        if is_other or settings.scene != self.state.settings.scene:
            return {}
        return super().written

    def start(self) -> None:
        """Start the fit, and end a running one."""
        if not self.written:
            self.forget()
        self._fitted = self.state.settings, self.measured
        super().start()

    @property
    def words(self) -> str:
        """Description of the fit, and of missing input."""
        missing = ""
        if self.measured is None:
            missing = self._missing_loop()
        elif not self.chosen.value:
            missing = NO_SETTING
        return (
            "Settings with which the run is as near to a measured loop as can be. "
            f"{missing}"
        )

    def _missing_loop(self) -> str:
        """Sentence on the loop that is missing, or of another scene."""
        brought = self.state.brought
        axes = axes_on(self.state)
        if not isinstance(brought, MeasuredLoop):
            titles = [title[0].lower() + title[1:] for title, _ in axes]
            return NO_LOOP.format(*titles)
        needed = " and ".join(f"{title} in {unit}" for title, unit in axes)
        found = " and ".join(brought.units)
        return (
            f"{brought.source} is of another scene: it has {found}, and a loop of this "
            f"scene has {needed}."
        )

    def show(self) -> None:
        """Show the settings that can be fitted, and the last fit."""
        settings = self.state.settings
        definitions = settings.definitions()
        titles = {title_of(definitions[name]): name for name in fittable(settings)}
        # Settings that do nothing any more are no longer ticked.
        kept = [name for name in self.chosen.value if name in titles.values()]
        if self.chosen.options != titles or self.chosen.value != kept:
            self.chosen.param.update(options=titles, value=kept)
        self.use_button.visible = bool(self.written)
        super().show()
        self._draw()

    def said(self, progress: str) -> str:
        """Progress with titles of settings for their keys, and values in their units.

        The settings are those of the fit: the page may show another scene by now.
        """
        definitions = self._fitted[0].definitions()
        keys = "|".join(fittable(self._fitted[0]))

        def titled(found: re.Match[str]) -> str:
            definition = definitions[found[1]]
            value = unit_of(definition)(float(found[2]), DIGITS)
            return f"{title_of(definition)} {value}"

        # A refusal may have the same words in a sentence.
        amounts = rf"(?<=[:,] )({keys}) (-?\d[\d.e+-]*)(?: [^\s,]+)?(?=,)"
        return re.sub(amounts, titled, progress)

    def look(self) -> None:
        """Show the progress of the fit, and its nearest loop so far."""
        super().look()
        if self.job is not None and self.state.tab == "Fit":
            self._draw()

    def _draw(self) -> None:
        """Draw the measured and the nearest loop until there is a report."""
        has_report = self.job is None and bool(self.written)
        chart = None
        if not has_report:
            chart = self._panel()
        self._chart.view.visible = chart is not None
        if chart is not None:
            self._chart.show(chart)

    def _panel(self) -> Panel | None:
        """Panel of the measured loop and the nearest run so far, if there is a loop."""
        measured = self.measured
        if measured is None:
            return None
        curves = [
            PanelCurve("measured", measured.displacement, measured.force, 5, "points")
        ]
        if self.job is not None and self._fitted[1] is measured:
            # The command writes it again whenever it has come nearer.
            file = self.job.folder / OUT / LOOP
            if file.exists():
                _, across, up = pd.read_csv(file).to_numpy().T
                curves.append(PanelCurve("nearest run", across, up, 1))
        across_axis, up_axis = axes_on(self.state)
        x = PanelAxis(*across_axis)
        y = PanelAxis(*up_axis)
        return Panel(measured.source, x, y, tuple(curves))

    def use(self) -> None:
        """Run the fitted settings, rounded to six digits, on the live tab."""
        found = settings_from_toml(self.written[SETTINGS].decode())
        fitted = found.changed(self._fitted[0])
        # More digits would only fill fields and addresses.
        rounded = {
            name: float(f"{fitted[name]:.6g}")
            for name in fittable(found)
            if name in fitted
        }
        self.state.tab = TABS[0]
        self.state.adopt(found.replace(**rounded))
