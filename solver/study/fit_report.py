"""What a fit found, for people and scripts: lines, a CSV file, a page, settings, the loop."""

from __future__ import annotations

import math
from dataclasses import asdict
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from solver.files.disk import write
from solver.files.saved import dump
from solver.scenes.shared import listed
from solver.settings.definitions import about
from solver.study.fit import Combination, Fit
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
from solver.study.valley import FACTOR

PARAMETERS = "parameters.csv"
LOOP = "loop.csv"
SETTINGS = "settings.toml"
PAGE = "fit.html"
FILES = PARAMETERS, LOOP, SETTINGS, PAGE


def lines(fit: Fit, measured: MeasuredLoop) -> list[str]:
    """What was found, a sentence or a row of a table a line."""
    return [
        *aligned(_rows(fit)).splitlines(),
        *messages(fit),
        _distances(fit, measured),
    ]


def messages(fit: Fit) -> list[str]:
    """What the loop cannot tell, and what else there is to know, in sentences."""
    lost = [
        name
        for name, error in zip(fit.names, fit.errors, strict=True)
        if math.isinf(error)
    ]
    sentences = [_known(combination) for combination in fit.together]
    if lost and fit.together:
        sentences.append(
            f"The loop does not tell {listed(lost)} apart: they stay as near to where they began "
            "as that allows."
        )
    elif lost:
        sentences.append(
            f"The loop does not tell {listed(lost)}: what is given here is as near to where it "
            "began as the loop allows."
        )
    sentences += _bounds(fit)
    if fit.for_the_mesh.any():
        names = listed(
            [
                n
                for n, is_lost in zip(fit.names, fit.for_the_mesh, strict=True)
                if is_lost
            ]
        )
        sentences.append(
            f"With elements of half the size the loop changes by {100.0 * fit.mesh:.2g} % of its "
            f"range, and {names} may change by more than a factor of {FACTOR:g} for that: more "
            "elements may tell more."
        )
    nearest = fit.nearest
    given = nearest.beside.figures(nearest.run.iterate)["distance_given"]
    sentences += [f"{message}." for message in nearest.beside.drive_messages(given)]
    if not nearest.run.solution.is_certified:
        sentences.append(
            "The nearest run is not certified, so that values may be less exact."
        )
    return sentences


def _known(combination: Combination) -> str:
    """Sentence on a combination that is known of settings that are not."""
    if math.isnan(combination.value):
        return f"Only a combination of {listed(list(combination.powers))} is known."
    margin = 100.0 * combination.error
    ends = f"from {combination.lower:.4g} to {combination.upper:.4g}"
    return (
        f"Only {_product(combination)} is known: {combination.value:.6g} in SI units, with a "
        f"standard error of {margin:.2g} % ({ends} with two), while each is within a factor of "
        f"{combination.factor:g} of its value."
    )


def _product(combination: Combination) -> str:
    """Powers of settings, as one writes them."""
    factors = []
    for name, power in combination.powers.items():
        if power == 1.0:
            factors.append(name)
        else:
            factors.append(f"{name}^{power:g}")
    return " * ".join(factors)


def _bounds(fit: Fit) -> list[str]:
    """Sentences on settings of which one end alone is known."""
    sentences = []
    for name, lower, upper in zip(fit.names, fit.lower, fit.upper, strict=True):
        unit = about(fit.settings.definitions()[name]).unit
        if math.isfinite(lower) and math.isinf(upper):
            sentences.append(f"{name} is at least {lower:.3g} {unit}".rstrip() + ".")
        elif math.isfinite(upper) and math.isinf(lower):
            sentences.append(f"{name} is at most {upper:.3g} {unit}".rstrip() + ".")
    return sentences


def _distances(fit: Fit, measured: MeasuredLoop) -> str:
    near, far = (f"{100.0 * run.distance:.4g} %" for run in (fit.nearest, fit.first))
    rows = f"{len(fit.nearest.differences)} of {len(measured.force)} rows"
    quantity = fit.nearest.beside.quantity
    return f"{quantity}: {near} from {measured.source}, {far} before; {fit.runs} runs, {rows}"


def _rows(fit: Fit) -> list[list[str]]:
    """Table of the settings: value, standard error, ends and correlations."""
    others: tuple[str, ...] = ()
    if len(fit.names) > 1:
        others = fit.names
    head = ["setting", "value", "standard error", "two of them: from", "to", "start"]
    table = [[*head, *(f"with {name}" for name in others)]]
    for name, unit, start, value, error, lower, upper, *correlation in _entries(fit):
        shown = "not known alone"
        if math.isfinite(error):
            shown = f"{error:.2g}"
        cells = [
            name,
            f"{value:.6g} {unit}".strip(),
            shown,
            _end(lower),
            _end(upper),
            f"{start:.6g}",
        ]
        with_others = ["-" if math.isnan(c) else f"{c + 0.0:.2f}" for c in correlation]
        table.append([*cells, *with_others[: len(others)]])
    return table


def _end(value: float) -> str:
    """An end of what is within two standard errors."""
    if math.isinf(value):
        return "-"
    return f"{value:.6g}"


def _entries(fit: Fit) -> list[list[Any]]:
    """Setting, unit, start, value, standard error, ends and correlations, a row for each."""
    units = [about(fit.settings.definitions()[name]).unit for name in fit.names]
    columns = (
        fit.names,
        units,
        fit.first.values,
        fit.nearest.values,
        fit.errors,
        fit.lower,
        fit.upper,
    )
    rows = zip(*columns, strict=True)
    return [[*row, *more] for row, more in zip(rows, fit.correlation, strict=True)]


def as_json(fit: Fit) -> dict[str, Any]:
    """The same for scripts."""
    figures = fit.nearest.beside.figures(fit.nearest.run.iterate)
    return {
        **{
            name: figures[name]
            for name in ("quantity", "distance", "rows", "rows_compared")
        },
        "distance_before": fit.first.distance,
        "runs": fit.runs,
        "parameters": {row[0]: _parameter(row) for row in _entries(fit)},
        "combinations": [asdict(combination) for combination in fit.together],
        "mesh": fit.mesh,
        "correlation": fit.correlation.tolist(),
        "messages": messages(fit),
        "settings": {"scene": fit.settings.scene, **fit.settings.values()},
    }


def _parameter(row: list[Any]) -> dict[str, float]:
    """A fitted setting for scripts, of its row of the table."""
    _, _, start, value, error, lower, upper, *_ = row
    return {
        "start": float(start),
        "value": float(value),
        "standard_error": float(error),
        "lower": float(lower),
        "upper": float(upper),
    }


def write_loop(run: FinishedRun, folder: Path) -> None:
    """Write the loop of a run as CSV, with time, in SI."""
    across, up = (f"{name} [{unit}]" for name, unit in run.loop.axes)
    columns = {
        "time [s]": run.problem.instants,
        across: run.displacement,
        up: run.force,
    }
    write(folder / LOOP, csv_of(columns))


def write_fit(fit: Fit, measured: MeasuredLoop, folder: Path) -> None:
    """Write all files."""
    head = ["setting", "unit", "start", "value", "standard_error", "lower", "upper"]
    write_csv(
        folder / PARAMETERS,
        [*head, *(f"correlation_{n}" for n in fit.names)],
        _entries(fit),
    )
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
    write_page(
        folder / PAGE, f"{fit.settings.scene.capitalize()} fitted to a loop", sections
    )


def _panels(fit: Fit, measured: MeasuredLoop) -> list[Panel]:
    nearest = fit.nearest
    beside = fit.nearest.beside
    first = fit.first.run
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
        Panel(
            "What is left", PanelAxis("row of the table", whole=True), share, (left,)
        ),
    ]
