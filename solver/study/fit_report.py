"""What a fit found, for people and scripts: lines, a CSV file, a page, settings, the loop."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from solver.definitions import about
from solver.disk import write
from solver.files import dump
from solver.scenes.shared import listed
from solver.study.fit import Fit
from solver.study.measured_loop import MeasuredLoop, csv_of
from solver.study.page import (
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    Section,
    aligned,
    bullets,
    html_table,
    write_csv,
    write_page,
)
from solver.study.quantities.finished import FinishedRun

PARAMETERS, LOOP, SETTINGS, PAGE = "parameters.csv", "loop.csv", "settings.toml", "fit.html"
FILES = PARAMETERS, LOOP, SETTINGS, PAGE


def lines(fit: Fit, measured: MeasuredLoop) -> list[str]:
    """What was found, a sentence or a row of a table a line."""
    return [*aligned(_rows(fit)).splitlines(), *messages(fit), _distances(fit, measured)]


def messages(fit: Fit) -> list[str]:
    """What the loop cannot tell, and what else there is to know, in sentences."""
    lost = [name for name, error in zip(fit.names, fit.errors, strict=True) if math.isinf(error)]
    values = dict(zip(fit.names, fit.nearest.values, strict=True))
    sentences = []
    for powers, margin in fit.together:
        if math.isnan(margin):
            sentences.append(f"Only a combination of {listed(list(powers))} is known.")
            continue
        product = math.prod(float(values[name]) ** power for name, power in powers.items())
        factors = (n if power == 1.0 else f"{n}^{power:g}" for n, power in powers.items())
        known = f"{' * '.join(factors)} is known: {product:.6g} in SI units"
        sentences.append(f"Only {known}, with a standard error of {100.0 * margin:.2g} %.")
    if lost and fit.together:
        sentences.append(
            f"The loop does not tell {listed(lost)} apart: they stay as near to where they began "
            "as that allows."
        )
    elif lost:
        sentences.append(
            f"The loop says nothing of {listed(lost)}: what is given here is where it began."
        )
    nearest = fit.nearest
    given = nearest.beside.figures(nearest.run.iterate)["distance_given"]
    sentences += [f"{message}." for message in nearest.beside.drive_messages(given)]
    if not nearest.run.solution.is_certified:
        sentences.append("The nearest run is not certified, so that values may be less exact.")
    return sentences


def _distances(fit: Fit, measured: MeasuredLoop) -> str:
    near, far = (f"{100.0 * run.distance:.4g} %" for run in (fit.nearest, fit.first))
    rows = f"{len(fit.nearest.differences)} of {len(measured.force)} rows"
    quantity = fit.nearest.beside.quantity
    return f"{quantity}: {near} from {measured.source}, {far} before; {fit.runs} runs, {rows}"


def _rows(fit: Fit) -> list[list[str]]:
    """Table of the settings: value, standard error and correlations."""
    others = fit.names if len(fit.names) > 1 else ()
    table = [["setting", "value", "standard error", "start", *(f"with {name}" for name in others)]]
    for name, unit, start, value, error, *correlation in _entries(fit):
        shown = f"{error:.2g}" if math.isfinite(error) else "not known alone"
        with_others = ["-" if math.isnan(c) else f"{c + 0.0:.2f}" for c in correlation]
        cells = [name, f"{value:.6g} {unit}".strip(), shown, f"{start:.6g}"]
        table.append([*cells, *with_others[: len(others)]])
    return table


def _entries(fit: Fit) -> list[list[Any]]:
    """Setting, unit, start, value, standard error and correlations, a row for each."""
    units = [about(fit.settings.definitions()[name]).unit for name in fit.names]
    columns = fit.names, units, fit.first.values, fit.nearest.values, fit.errors
    rows = zip(*columns, strict=True)
    return [[*row, *more] for row, more in zip(rows, fit.correlation, strict=True)]


def as_json(fit: Fit) -> dict[str, Any]:
    """The same for scripts."""
    figures = fit.nearest.beside.figures(fit.nearest.run.iterate)
    return {
        **{name: figures[name] for name in ("quantity", "distance", "rows", "rows_compared")},
        "distance_before": fit.first.distance,
        "runs": fit.runs,
        "parameters": {
            name: {"start": float(start), "value": float(value), "standard_error": float(error)}
            for name, _, start, value, error, *_ in _entries(fit)
        },
        "correlation": fit.correlation.tolist(),
        "messages": messages(fit),
        "settings": {"scene": fit.settings.scene, **fit.settings.values()},
    }


def write_loop(run: FinishedRun, folder: Path) -> None:
    """Write the loop of a run as CSV, with time, in SI."""
    across, up = (f"{name} [{unit}]" for name, unit in run.loop.axes)
    columns = {"time [s]": run.problem.instants, across: run.displacement, up: run.force}
    write(folder / LOOP, csv_of(columns))


def write_fit(fit: Fit, measured: MeasuredLoop, folder: Path) -> None:
    """Write all files."""
    head = ["setting", "unit", "start", "value", "standard_error"]
    write_csv(folder / PARAMETERS, [*head, *(f"correlation_{n}" for n in fit.names)], _entries(fit))
    write_loop(fit.nearest.run, folder)
    write(folder / SETTINGS, dump(fit.settings))
    sentences = [
        *messages(fit),
        _distances(fit, measured),
        f"{measured.source}: {measured.message}",
    ]
    sections: list[Section] = [
        bullets(sentences),
        html_table(_rows(fit)),
        PlotSection("Loop and differences", _panels(fit, measured)),
        f"<h2>Settings</h2>\n<pre>{escape(dump(fit.settings))}</pre>",
    ]
    write_page(folder / PAGE, f"{fit.settings.scene.capitalize()} fitted to a loop", sections)


def _panels(fit: Fit, measured: MeasuredLoop) -> list[Panel]:
    nearest, beside, first = fit.nearest, fit.nearest.beside, fit.first.run
    x, y = (PanelAxis(title, unit) for title, unit in nearest.run.loop.axes)
    curves = (
        PanelCurve("measured", measured.displacement, measured.force, 5, "points"),
        PanelCurve("before", first.displacement, first.force, 0, "dotted"),
        PanelCurve("fitted", nearest.run.displacement, nearest.run.force, 1),
    )
    numbers = np.arange(1.0, len(beside.counted) + 1.0)[beside.counted]
    left = PanelCurve("difference", numbers, 100.0 * nearest.differences, 1, "points")
    share = PanelAxis(f"{beside.quantity}: fitted less measured", "% of its range")
    return [
        Panel("Force over displacement", x, y, curves),
        Panel("What is left", PanelAxis("row of the table", whole=True), share, (left,)),
    ]
