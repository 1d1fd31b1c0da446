"""A study as tables, charts, CSV files and one HTML page: who is first where, and by how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

import numpy as np

from solver.arrays import Array
from solver.study.chart import Map, Panel, PanelAxis, PanelCurve, Runs
from solver.study.page import PlotSection, Section, bullets, plain_table, write_csv, write_page
from solver.study.speed.error_against_time import (
    GOAL,
    INCREMENTAL,
    LEVELS,
    MOST_ITERATIONS,
    ErrorCurve,
    Study,
)
from solver.study.speed.sizes import MEASURED, Crossover, Growth

Row = list[str]
WINNERS_NOTE = (
    "The last column is the time of the best form of LATIN over that of the incremental solver: "
    "below 1, LATIN is quicker."
)
CURVES = "Error against run time, set-up included"
CAPTION = (
    "A line is a form of LATIN, iteration by iteration; the dashed line is when the incremental "
    "solver is done. Errors below the lower edge are drawn on it."
)
GROWTH = "Growth with the size of the problem"
GROWTH_NOTE = (
    "Time of one iteration of LATIN, and of the whole solution by increments. Twice the size takes "
    "2 to the power of the exponent as long (a least-squares fit over all sizes, with its margin "
    "at 95 %)."
)
MAP, TIMES = "Who is first where", "LATIN / incremental solver"
BILLED = (
    "The time of a method is all that it takes from settings to result: discretisation, "
    "factorisation, the coarser mesh, iterations. Imports and the computation of errors are not "
    "counted.",
    f"The forms of LATIN end at a friction force error of {GOAL:g}, or after {MOST_ITERATIONS} "
    "iterations.",
    "Errors are relative L2 distances over space and time to the result of the incremental solver "
    "on the same mesh and instants, whose own error is therefore 0.",
)
SPAN = (1e-9, 2.0)
"""Errors that are shown; smaller ones are drawn at SMALLEST, just above the lower edge."""
SMALLEST = 2e-9


def conditions(study: Study) -> list[str]:
    """Under which conditions the study was measured, in sentences."""
    changed = study.settings.changed()
    values = ", ".join(f"{name} = {value}" for name, value in changed.items()) or "defaults"
    return [
        f"Scene: {study.settings.scene} ({values}).",
        f"Machine: {study.machine}.",
        f"All methods in one process, in turns; medians of {study.repeats} passes.",
        *BILLED,
    ]


def winners(study: Study) -> list[Row]:
    """Which method is first at each level, and how the best form of LATIN compares."""
    head = ["to an error of", "first", "ms", "best form of LATIN", "ms", f"LATIN / {INCREMENTAL}"]
    rows = [head]
    for name, level in LEVELS.items():
        reached = {curve.method: curve.reached(level) for curve in study.curves}
        times = {method: point[0] for method, point in reached.items() if point is not None}
        first = min(times, key=times.__getitem__)
        best = min(times.keys() - {INCREMENTAL}, key=times.__getitem__, default="")
        cells = ["none gets there", "-", "-"]
        if best:
            cells = [best, _ms(times[best]), f"{times[best] / times[INCREMENTAL]:.2g}"]
        rows.append([name, first, _ms(times[first]), *cells])
    return rows


def table(study: Study) -> list[Row]:
    """Time to each level, with the iterations in brackets, and what an iteration costs."""
    rows = [["friction force error", *LEVELS, "ms/iteration", "least error"]]
    for curve in study.curves:
        cells = []
        for level in LEVELS.values():
            reached = curve.reached(level)
            number = f" ({reached[1]:.0f})" if reached and curve.kind == "latin" else ""
            cells.append(f"{_ms(reached[0])} ms{number}" if reached else "not reached")
        each = curve.seconds_per_iteration
        cost = f"{1e3 * each:.3f}" if each is not None else "-"
        rows.append([curve.method, *cells, cost, f"{curve.error_force.min():.1e}"])
    return rows


def growth_table(growths: Sequence[Growth]) -> list[Row]:
    """Fitted exponents, and the iterations to 1 %, with the sizes they come from."""
    rows = [["growth with", "method", "exponent", "sizes", "ms", "iterations to 1 %"]]
    for curve in growths:
        whole = curve.method == INCREMENTAL
        rows.append(
            [
                curve.setting,
                f"{curve.method} ({'whole' if whole else 'an iteration'})",
                str(curve.exponent or "-"),
                " ".join(map(str, curve.sizes)),
                " ".join(f"{1e3 * seconds:.2g}" for seconds in curve.seconds),
                "-" if whole else " ".join(str(number or ">300") for number in curve.iterations),
            ]
        )
    return rows


def ratio_table(measured: Crossover) -> list[Row]:
    """Time of LATIN over that of the other, a row for each number of instants."""
    rows = [[TIMES, *(f"{measured.setting} {size}" for size in measured.sizes)]]
    for instants, ratios in zip(measured.instants, measured.ratios, strict=True):
        cells = ("-" if np.isnan(ratio) else f"{ratio:.2g}" for ratio in ratios)
        rows.append([f"{instants} instants", *cells])
    return rows


def notes(measured: Crossover) -> list[str]:
    """What the map shows, and what it leaves out, in sentences."""
    ratios = measured.ratios[np.isfinite(measured.ratios)]
    grows = " and ".join(title.lower() for title in (measured.title, *measured.others))
    return [
        f"LATIN is ahead (below 1) at {int((ratios < 1.0).sum())} of {ratios.size} sizes. From "
        "settings to a certified or accurate end, in seconds of the processor, medians of up to "
        "three runs in turns.",
        *([f"What grows along the axis: {grows}."] if measured.others else []),
        *(measured.message(times) for times in measured.comparisons if times.message),
    ]


def error_panels(study: Study) -> list[Panel]:
    """Errors of displacement and of friction force over time, a curve for each method."""
    columns = {"error_displacement": "Displacement", "error_force": "Friction force"}
    return [
        Panel(
            title,
            PanelAxis("Time", "s", logarithmic=True),
            PanelAxis("Relative error", logarithmic=True, limits=SPAN),
            tuple(
                _curve(curve, getattr(curve, name), n) for n, curve in enumerate(study.curves, 1)
            ),
        )
        for name, title in columns.items()
    ]


def _curve(curve: ErrorCurve, errors: Array, hue: int) -> PanelCurve:
    """A method's line: a vertical one where the solver itself is the reference."""
    if curve.kind == "incremental":
        return PanelCurve(curve.method, np.repeat(curve.seconds, 2), np.array(SPAN), 0, "dashed")
    return PanelCurve(curve.method, curve.seconds, np.maximum(errors, SMALLEST), hue)


def growth_panels(growths: Sequence[Growth]) -> list[Panel]:
    """Times over sizes, a panel for each setting that changes."""
    hues = {method: hue for hue, method in enumerate((INCREMENTAL, *MEASURED))}
    curves: dict[str, list[PanelCurve]] = {}
    for curve in growths:
        points = np.array(curve.sizes, dtype=float), np.array(curve.seconds)
        line = PanelCurve(curve.method, *points, hues[curve.method], "points")
        curves.setdefault(curve.setting, []).append(line)
    return [
        Panel(
            setting.capitalize(),
            PanelAxis(f"Number of {setting}", logarithmic=True, whole=True),
            PanelAxis("Time", "s", logarithmic=True),
            tuple(own),
        )
        for setting, own in curves.items()
    ]


def crossover_map(measured: Crossover) -> Map:
    """The ratio of times over size and instants, with the line where both take as long."""
    comparisons = measured.comparisons
    sizes, instants, ratios = np.array(
        [(times.size, times.instants, times.ratio) for times in comparisons], dtype=float
    ).T
    return Map(
        f"Time of {TIMES}",
        PanelAxis(measured.title, logarithmic=True, whole=True),
        PanelAxis("Instants", logarithmic=True, whole=True),
        np.array(measured.sizes, dtype=float),
        np.array(measured.instants, dtype=float),
        PanelAxis(TIMES, logarithmic=True),
        measured.ratios,
        Runs(
            np.arange(len(comparisons)),
            sizes,
            instants,
            ratios,
            np.ones(len(comparisons), dtype=int),
            np.isfinite(ratios),
            list(map(measured.message, comparisons)),
        ),
        level=1.0,
    )


def write_curves(study: Study, folder: Path) -> list[Path]:
    """Write `curves.csv` and `levels.csv` (s; errors as fractions).

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    columns = ("steps", "seconds", "error_displacement", "error_force")
    curves = (
        (curve.method, curve.kind, *map(float, point))
        for curve in study.curves
        for point in zip(*(getattr(curve, name) for name in columns), strict=True)
    )
    levels = (
        (
            *(curve.method, curve.kind, level),
            *(curve.reached(level) or ("", "")),
            curve.seconds_per_iteration,
        )
        for curve in study.curves
        for level in LEVELS.values()
    )
    head = ["method", "kind", "step", *columns[1:]]
    level_head = ["method", "kind", "level", "seconds", "step", "seconds_per_iteration"]
    return [
        write_csv(folder / "curves.csv", head, curves),
        write_csv(folder / "levels.csv", level_head, levels),
    ]


def write_growth(growths: Sequence[Growth], folder: Path) -> list[Path]:
    """Write `growth.csv`, if there is any; raises as `write_curves`."""
    head = ["setting", "exponent", "margin", "method", "size", "seconds"]
    head += ["iterations_to_1_percent", "seconds_to_1_percent"]
    rows = [
        (curve.setting, *margin, curve.method, *row)
        for curve in growths
        for margin in [astuple(curve.exponent) if curve.exponent else ("", "")]
        for row in zip(curve.sizes, curve.seconds, curve.iterations, curve.totals, strict=True)
    ]
    return [write_csv(folder / "growth.csv", head, rows)] if growths else []


def write_study(
    study: Study, growths: Sequence[Growth], crossover: Crossover, folder: Path
) -> tuple[list[Path], str]:
    """Write the tables and `study.html` into an existing folder.

    Returns
    -------
    The files, and what whoever asked for them is to be told, if anything.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    growth: list[Section] = [
        f"<h2>{GROWTH}</h2>\n<p>{GROWTH_NOTE}</p>",
        PlotSection(GROWTH, growth_panels(growths)),
        plain_table(growth_table(growths)),
    ]
    sections = [
        f"<h2>Who is first</h2>\n{plain_table(winners(study))}\n<p>{WINNERS_NOTE}</p>",
        f"<h2>{CURVES}</h2>",
        PlotSection(CURVES, error_panels(study)),
        f"<p>{CAPTION}</p>\n<h2>Time to an error of the friction force</h2>\n"
        f"<p>In brackets: iterations of LATIN.</p>\n{plain_table(table(study))}",
        *(growth if growths else []),
        f"<h2>{MAP}</h2>",
        PlotSection(MAP, [crossover_map(crossover)]),
        f"{plain_table(ratio_table(crossover))}\n{bullets(notes(crossover))}",
        f"<h2>How it was measured</h2>\n{bullets(conditions(study))}",
    ]
    page = folder / "study.html"
    message = write_page(page, "Error against run time", sections)
    head = ["setting", "size", "instants", "latin", "incremental", "said"]
    rows = ((crossover.setting, *astuple(times)) for times in crossover.comparisons)
    sizes = write_csv(folder / "map.csv", head, rows)
    files = [*write_curves(study, folder), *write_growth(growths, folder), sizes, page]
    return files, message


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3g}"
