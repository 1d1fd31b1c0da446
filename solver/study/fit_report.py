"""Reports of a fit for people and scripts: lines, CSV files, a page, settings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from solver.arrays import Flags
from solver.files.amounts import Unit, unit_of
from solver.files.disk import write
from solver.files.saved import dump
from solver.scenes.shared import listed
from solver.settings.definitions import properties_of, title_of
from solver.study.fit import Combination, Fit
from solver.study.measured_loop import MeasuredLoop, csv_of
from solver.study.page import (
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    aligned,
    write_csv,
    write_page,
)
from solver.study.profile_likelihood import FACTOR
from solver.study.quantities.finished import FinishedRun

PARAMETERS = "parameters.csv"
LOOP = "loop.csv"
SETTINGS = "settings.toml"
PAGE = "fit.html"
ROUNDING = 1e-5
"""Distance of a loop below which its digits tell nothing."""
FILES = PARAMETERS, LOOP, SETTINGS, PAGE


def lines(fit: Fit, measured: MeasuredLoop) -> list[str]:
    """Lines on a fit: the rows of its table, then sentences."""
    return [
        *aligned(_rows(fit, _keys(fit))).splitlines(),
        *messages(fit),
        _distances(fit, measured),
    ]


@dataclass(frozen=True)
class Called:
    """Name of a setting for a reader, and the unit in which its values are given."""

    name: str
    unit: Unit

    def amount(self, value: float, digits: int) -> str:
        """Text of a value in SI, with the unit."""
        return f"{self.figure(value, digits)} {self.unit.name}".rstrip()

    def figure(self, value: float, digits: int = 6) -> str:
        """Text of a value in SI, in the unit but without it."""
        return f"{value / self.unit.factor:.{digits}g}"


def _keys(fit: Fit) -> dict[str, Called]:
    """Keys and SI units of the fitted settings, as commands have them, by key."""
    definitions = fit.settings.definitions()
    called = {}
    for name in fit.names:
        called[name] = Called(name, Unit(properties_of(definitions[name]).unit))
    return called


def _titles(fit: Fit) -> dict[str, Called]:
    """Titles and units of the fitted settings, as the page has them, by key."""
    definitions = fit.settings.definitions()
    called = {}
    for name in fit.names:
        called[name] = Called(title_of(definitions[name]), unit_of(definitions[name]))
    return called


def messages(fit: Fit, called: Mapping[str, Called] | None = None) -> list[str]:
    """Sentences on settings that are not determined, and on the nearest run.

    `called` has the names and units of settings for a reader, by their keys; by default
    these keys and SI.
    """
    called = called or _keys(fit)
    sentences = [known(combination, called) for combination in fit.together]
    sentences += _lost(fit, called)
    sentences += _bounds(fit, called)
    sentences += _for_the_mesh(fit, called)
    nearest = fit.nearest
    # A loop fitted under another path than the measured one says little.
    given = nearest.beside.figures(nearest.run.iterate)["distance_given"]
    sentences += [f"{message}." for message in nearest.beside.drive_messages(given)]
    if not nearest.run.solution.is_certified:
        sentences.append(
            "The nearest run is not certified, so that values may be less exact."
        )
    return sentences


def _lost(fit: Fit, called: Mapping[str, Called]) -> list[str]:
    """Sentence on settings that are not determined, if any."""
    names = _named(fit, np.isinf(fit.errors), called)
    if not names:
        return []
    if fit.together:
        return [
            f"The loop does not tell {names} apart: they stay as near to where they "
            "began as that allows."
        ]
    return [
        f"The loop does not tell {names}: what is given here is as near to where it "
        "began as the loop allows."
    ]


def _for_the_mesh(fit: Fit, called: Mapping[str, Called]) -> list[str]:
    """Sentence on settings that errors of the mesh hide, if any."""
    hidden = _named(fit, fit.for_the_mesh, called)
    if not hidden:
        return []
    return [
        f"With elements of half the size the loop changes by {100.0 * fit.mesh:.2g} % "
        f"of its range, and {hidden} may change by more than a factor of "
        f"{FACTOR:g} for that: more elements may tell more."
    ]


def _named(fit: Fit, are_meant: Flags, called: Mapping[str, Called]) -> str:
    """List of the settings that are meant, by a mask of shape (p,); "" of none."""
    if not are_meant.any():
        return ""
    names = np.array([called[name].name for name in fit.names])
    return listed(names[are_meant].tolist())


def known(combination: Combination, called: Mapping[str, Called]) -> str:
    """Sentence on a determined combination of undetermined settings."""
    if math.isnan(combination.value):
        parts = [called[name].name for name in combination.powers]
        return f"Only a combination of {listed(parts)} is known."
    margin = 100.0 * combination.error
    size = 1.0
    for name, power in combination.powers.items():
        size *= called[name].unit.factor ** power
    ends = f"from {combination.lower / size:.4g} to {combination.upper / size:.4g}"
    return (
        f"Only {_product(combination, called)} is known: "
        f"{combination.value / size:.6g} {_units(combination, called)}, "
        f"with a standard error of {margin:.2g} % ({ends} with two), as long as each "
        f"stays within a factor of {combination.factor:g} of its value here."
    )


def _product(combination: Combination, called: Mapping[str, Called]) -> str:
    """Text of a product of powers of settings."""
    factors = []
    for name, power in combination.powers.items():
        if power == 1.0:
            factors.append(called[name].name)
        else:
            factors.append(f"{called[name].name}^{power:g}")
    return " * ".join(factors)


def _units(combination: Combination, called: Mapping[str, Called]) -> str:
    """Words on the units in which the parts of a combination are given."""
    units = [called[name].unit for name in combination.powers]
    if all(unit.factor == 1.0 for unit in units):
        return "in SI units"
    named = []
    for name in combination.powers:
        setting = called[name]
        if setting.unit.name:
            named.append(f"{setting.name} in {setting.unit.name}")
    return f"with {listed(named)}"


def _bounds(fit: Fit, called: Mapping[str, Called]) -> list[str]:
    """Sentences on settings of which only one end is known."""
    sentences = []
    for name, lower, upper in zip(fit.names, fit.lower, fit.upper, strict=True):
        setting = called[name]
        if math.isfinite(lower) and math.isinf(upper):
            bound = setting.amount(lower, 3)
            sentences.append(f"{setting.name} is at least {bound}.")
        elif math.isfinite(upper) and math.isinf(lower):
            bound = setting.amount(upper, 3)
            sentences.append(f"{setting.name} is at most {bound}.")
    return sentences


def _distances(fit: Fit, measured: MeasuredLoop) -> str:
    """Line on the distances of the nearest and of the first run to the loop."""
    near = _percent(fit.nearest.distance)
    far = _percent(fit.first.distance)
    rows = f"{len(fit.nearest.differences)} of {len(measured.force)} rows"
    quantity = fit.nearest.beside.quantity
    return (
        f"{quantity}: {near} from {measured.source}, {far} before; "
        f"{fit.runs} runs, {rows}"
    )


def _percent(distance: float) -> str:
    """Text of a distance in per cent, without digits of rounding."""
    if 0.0 < distance < ROUNDING:
        return f"less than {100.0 * ROUNDING:g} %"
    return f"{100.0 * distance:.4g} %"


def _rows(fit: Fit, called: Mapping[str, Called]) -> list[list[str]]:
    """Table of the settings: value, standard error, ends and correlations."""
    others: tuple[str, ...] = ()
    if len(fit.names) > 1:
        others = fit.names
    head = ["setting", "value", "standard error", "two of them: from", "to", "start"]
    table = [head + [f"with {called[name].name}" for name in others]]
    for name, _, start, value, error, lower, upper, *correlation in _entries(fit):
        setting = called[name]
        shown = "not known alone"
        if math.isfinite(error):
            shown = setting.figure(error, 2)
        cells = [
            setting.name,
            setting.amount(value, 6),
            shown,
            _end(lower, setting),
            _end(upper, setting),
            setting.figure(start),
        ]
        if others:
            cells += [_correlation(value) for value in correlation]
        table.append(cells)
    return table


def _correlation(value: float) -> str:
    """Text of a correlation."""
    if math.isnan(value):
        return "-"
    # A sum with 0 has no negative zero.
    return f"{value + 0.0:.2f}"


def _end(value: float, setting: Called) -> str:
    """Text of a value at two standard errors."""
    if math.isinf(value):
        return "-"
    return setting.figure(value)


def _entries(fit: Fit) -> list[list[Any]]:
    """Rows of setting, unit, start, value, standard error, ends and correlations."""
    units = [properties_of(fit.settings.definitions()[name]).unit for name in fit.names]
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
    """Numbers and messages of a fit for scripts."""
    figures = fit.nearest.beside.figures(fit.nearest.run.iterate)
    return {
        "quantity": figures["quantity"],
        "distance": figures["distance"],
        "rows": figures["rows"],
        "rows_compared": figures["rows_compared"],
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
    """Numbers of a fitted setting for scripts, from its row of `_entries`."""
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
    (across, across_unit), (up, up_unit) = run.loop.axes
    columns = {
        "time [s]": run.problem.instants,
        f"{across} [{across_unit}]": run.displacement,
        f"{up} [{up_unit}]": run.force,
    }
    write(folder / LOOP, csv_of(columns))


def write_fit(fit: Fit, measured: MeasuredLoop, folder: Path) -> None:
    """Write all `FILES` of a fit into a folder."""
    head = ["setting", "unit", "start", "value", "standard_error", "lower", "upper"]
    correlations = [f"correlation_{name}" for name in fit.names]
    write_csv(folder / PARAMETERS, [*head, *correlations], _entries(fit))
    write_loop(fit.nearest.run, folder)
    write(folder / SETTINGS, dump(fit.settings))
    sentences = [
        *messages(fit, _titles(fit)),
        _distances(fit, measured),
        f"{measured.source}: {measured.message}",
    ]
    panels = [_loops(fit, measured), _differences(fit)]
    write_page(
        folder / PAGE,
        "fit.html",
        [PlotSection("Loop and differences", panels)],
        title=f"{fit.settings.scene.capitalize()} fitted to a loop",
        sentences=sentences,
        rows=_rows(fit, _titles(fit)),
        settings=dump(fit.settings),
    )


def _loops(fit: Fit, measured: MeasuredLoop) -> Panel:
    """Panel of the measured loop, the first run and the nearest one."""
    first = fit.first.run
    nearest = fit.nearest.run
    curves = (
        PanelCurve("measured", measured.displacement, measured.force, 5, "points"),
        PanelCurve("before", first.displacement, first.force, 0, "dotted"),
        PanelCurve("fitted", nearest.displacement, nearest.force, 1),
    )
    across, up = nearest.loop.axes
    x = PanelAxis(*across)
    y = PanelAxis(*up)
    return Panel("Force over displacement", x, y, curves)


def _differences(fit: Fit) -> Panel:
    """Panel of the differences of the nearest run, row by row."""
    beside = fit.nearest.beside
    numbers = np.arange(1.0, len(beside.counted) + 1.0)[beside.counted]
    percent = 100.0 * fit.nearest.differences
    curve = PanelCurve("difference", numbers, percent, 1, "points")
    row = PanelAxis("row of the table", whole=True)
    share = PanelAxis(f"{beside.quantity}: fitted less measured", "% of its range")
    return Panel("What is left", row, share, (curve,))
