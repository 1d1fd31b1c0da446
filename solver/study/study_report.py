"""Reports of a study of run times: tables, charts, CSV files and one HTML page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

import numpy as np

from solver.arrays import Array, Flags
from solver.settings.definitions import title_of
from solver.settings.scene import Settings
from solver.study.measured_times import (
    GOAL,
    INCREMENTAL,
    LEVELS,
    MOST_ITERATIONS,
    ErrorCurve,
    TimesAtSize,
)
from solver.study.page import (
    Panel,
    PanelAxis,
    PanelCurve,
    PlotSection,
    text_of,
    write_csv,
    write_page,
)
from solver.study.sweep.executors import machine

FILES = "curves.csv", "levels.csv", "map.csv", "study.html"
Row = list[str]
CURVES = "Error against run time, set-up included"
TIMES = "LATIN / incremental solver"
BILLED = (
    "The time of a method is all that it takes from settings to result: "
    "discretisation, factorisation, the coarser mesh, iterations. Imports and the "
    "computation of errors are not counted.",
    f"The forms of LATIN end at a friction force error of {GOAL:g}, or after "
    f"{MOST_ITERATIONS} iterations.",
    "Errors are relative L2 distances over space and time to the result of the "
    "incremental solver on the same mesh and instants, whose own error is therefore 0.",
)
SPAN = (1e-9, 2.0)
"""Range of the errors that are shown."""
SMALLEST = 2e-9
"""Value, just above the lower edge, at which smaller errors are drawn."""


def conditions(settings: Settings, repeats: int) -> list[str]:
    """Sentences on the conditions of the measurement."""
    changes = [f"{name} = {value}" for name, value in settings.changed().items()]
    passes = "one pass"
    if repeats > 1:
        passes = f"medians of {repeats} passes"
    return [
        f"Scene: {settings.scene} ({', '.join(changes) or 'defaults'}).",
        f"Machine: {machine()}.",
        f"All methods in one process, in turns; {passes}.",
        *BILLED,
    ]


def table(curves: Sequence[ErrorCurve]) -> list[Row]:
    """Time of each method to each level, and its iterations in brackets.

    A star marks the first method. The last row is of the best form of LATIN over the
    incremental solver.
    """
    rows = [["friction force error", *LEVELS, "ms/iteration", "least error"]]
    # Who is first is decided at each level, not in all.
    times = np.array([_times_to_levels(curve) for curve in curves])
    for curve, is_first in zip(curves, times == times.min(axis=0), strict=True):
        rows.append(_row(curve, is_first))
    is_latin = np.array([curve.is_latin for curve in curves])
    # The best form of LATIN at each level, whichever it is.
    ratios = times[is_latin].min(axis=0) / times[~is_latin].min(axis=0)
    texts = []
    for ratio in ratios:
        if math.isfinite(ratio):
            texts.append(f"{ratio:.2g}")
        else:
            texts.append("-")
    return [*rows, [f"best {TIMES}", *texts, "-", "-"]]


def _times_to_levels(curve: ErrorCurve) -> list[float]:
    """Time to each level, s; infinite where a method does not reach it."""
    times = []
    for level in LEVELS.values():
        seconds, _ = curve.reached(level) or (math.inf, 0.0)
        times.append(seconds)
    return times


def _row(curve: ErrorCurve, is_first: Flags) -> Row:
    """Row of a method; `is_first`, (n_levels,), marks levels where it is fastest."""
    cells = []
    for level, star in zip(LEVELS.values(), is_first, strict=True):
        reached = curve.reached(level)
        if reached is None:
            cells.append("not reached")
            continue
        seconds, step = reached
        text = f"{1e3 * seconds:.3g} ms"
        if curve.is_latin:
            text += f" ({step:.0f})"
        if star:
            text += " *"
        cells.append(text)
    cost = "-"
    if curve.seconds_per_iteration is not None:
        cost = f"{1e3 * curve.seconds_per_iteration:.3f}"
    return [curve.method, *cells, cost, f"{curve.error_force.min():.1e}"]


def sizes_table(settings: Settings, measured: Sequence[TimesAtSize]) -> list[Row]:
    """Times of both solvers at every size, or the reason why they have none."""
    head = [
        _titles(settings)[0],
        "instants",
        "LATIN, s",
        f"{INCREMENTAL}, s",
        TIMES,
        "",
    ]
    rows = [head]
    for times in measured:
        row = [
            str(times.size),
            str(times.instants),
            text_of(times.latin),
            text_of(times.incremental),
            text_of(times.ratio),
            times.message,
        ]
        rows.append(row)
    return rows


def notes(settings: Settings, measured: Sequence[TimesAtSize]) -> list[str]:
    """Sentences on the times at all sizes."""
    ratios = np.array([times.ratio for times in measured if not times.message])
    ahead = int((ratios < 1.0).sum())
    titles = " and ".join(_titles(settings)).lower()
    return [
        f"LATIN is ahead (below 1) at {ahead} of {ratios.size} sizes. From settings to "
        "a certified or accurate end, in seconds of the processor, medians of up to "
        "three runs in turns.",
        f"What grows, each by the same factor: {titles}.",
    ]


def _titles(settings: Settings) -> list[str]:
    """Titles of the settings that grow together."""
    definitions = settings.definitions()
    return [title_of(definitions[name]) for name in settings.GROWS]


def error_panels(curves: Sequence[ErrorCurve]) -> list[Panel]:
    """Errors of displacement and of friction force over time, a curve per method."""
    displacements = [curve.error_displacement for curve in curves]
    forces = [curve.error_force for curve in curves]
    return [
        _error_panel("Displacement", curves, displacements),
        _error_panel("Friction force", curves, forces),
    ]


def _error_panel(
    title: str, curves: Sequence[ErrorCurve], errors: Sequence[Array]
) -> Panel:
    """Panel of the errors of all methods, (n,) each; the last one is incremental."""
    *latin, incremental = curves
    lines = []
    for hue, curve in enumerate(latin, start=1):
        # An error of zero has no place on a logarithmic axis.
        y = np.maximum(errors[hue - 1], SMALLEST)
        lines.append(PanelCurve(curve.method, curve.seconds, y, hue))
    # The solver that is the reference itself is a vertical line.
    at = np.repeat(incremental.seconds, 2)
    lines.append(PanelCurve(incremental.method, at, np.array(SPAN), 0, "dashed"))
    time = PanelAxis("Time", "s", logarithmic=True)
    error = PanelAxis("Relative error", logarithmic=True, limits=SPAN)
    return Panel(title, time, error, tuple(lines))


def write_curves(curves: Sequence[ErrorCurve], folder: Path) -> None:
    """Write `curves.csv` and `levels.csv` (s; errors as fractions)."""
    points: list[tuple[object, ...]] = []
    levels: list[tuple[object, ...]] = []
    for curve in curves:
        kind = "incremental"
        if curve.is_latin:
            kind = "latin"
        columns = (
            curve.steps,
            curve.seconds,
            curve.error_displacement,
            curve.error_force,
        )
        for point in zip(*columns, strict=True):
            points.append((curve.method, kind, *map(float, point)))
        for level in LEVELS.values():
            reached = curve.reached(level) or ("", "")
            cost = curve.seconds_per_iteration
            levels.append((curve.method, kind, level, *reached, cost))
    head = ["method", "kind"]
    of_points = [*head, "step", "seconds", "error_displacement", "error_force"]
    write_csv(folder / "curves.csv", of_points, points)
    of_levels = [*head, "level", "seconds", "step", "seconds_per_iteration"]
    write_csv(folder / "levels.csv", of_levels, levels)


def write_study(
    settings: Settings,
    repeats: int,
    curves: Sequence[ErrorCurve],
    measured: Sequence[TimesAtSize],
    folder: Path,
) -> None:
    """Write `map.csv` and `study.html`."""
    head = ["setting", "size", "instants", "latin", "incremental", "said"]
    rows = [(settings.GROWS[0], *astuple(times)) for times in measured]
    write_csv(folder / "map.csv", head, rows)
    write_page(
        folder / FILES[-1],
        "study.html",
        [PlotSection(CURVES, error_panels(curves))],
        title="Error against run time",
        heading=CURVES,
        times=table(curves),
        sizes=sizes_table(settings, measured),
        notes=notes(settings, measured),
        conditions=conditions(settings, repeats),
    )
