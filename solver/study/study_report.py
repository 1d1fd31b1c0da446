"""A study as tables, charts, CSV files and one HTML page: who is first where, and by how much."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

import numpy as np

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
    Section,
    bullets,
    html_table,
    text_of,
    write_csv,
    write_page,
)
from solver.study.sweep.executors import machine

FILES = "curves.csv", "levels.csv", "map.csv", "study.html"
Row = list[str]
TABLE_NOTE = (
    "In brackets: iterations of LATIN; a star: the first. The last row is the time of LATIN's best "
    "form over that of the incremental solver: below 1, LATIN is quicker."
)
CURVES = "Error against run time, set-up included"
CAPTION = (
    "A line is a form of LATIN, iteration by iteration; the dashed line is when the incremental "
    "solver is done. Errors below the lower edge are drawn on it."
)
TIMES = "LATIN / incremental solver"
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
"""Errors that are shown; smaller ones are drawn at SMALLEST, just above the lower
edge."""
SMALLEST = 2e-9


def conditions(settings: Settings, repeats: int) -> list[str]:
    """Under which conditions a study was measured, in sentences."""
    changed = settings.changed()
    values = (
        ", ".join(f"{name} = {value}" for name, value in changed.items()) or "defaults"
    )
    return [
        f"Scene: {settings.scene} ({values}).",
        f"Machine: {machine()}.",
        f"All methods in one process, in turns; medians of {repeats} passes.",
        *BILLED,
    ]


def table(curves: Sequence[ErrorCurve]) -> list[Row]:
    """Time to each level, with the iterations in brackets and a star at the first method.

    The last row is of the best form of LATIN over the incremental solver.
    """
    rows = [["friction force error", *LEVELS, "ms/iteration", "least error"]]
    reached = {
        curve.method: [
            curve.reached(level) or (math.inf, 0.0) for level in LEVELS.values()
        ]
        for curve in curves
    }
    times = np.array([[seconds for seconds, _ in own] for own in reached.values()])
    for curve, is_first in zip(curves, times == times.min(axis=0), strict=True):
        cells = []
        for (seconds, step), star in zip(reached[curve.method], is_first, strict=True):
            if curve.is_latin:
                number = f" ({step:.0f})"
            else:
                number = ""
            text = f"{1e3 * seconds:.3g} ms{number}{' *' * bool(star)}"
            cells.append(text if math.isfinite(seconds) else "not reached")
        each = curve.seconds_per_iteration
        if each is not None:
            cost = f"{1e3 * each:.3f}"
        else:
            cost = "-"
        rows.append([curve.method, *cells, cost, f"{curve.error_force.min():.1e}"])
    is_latin = np.array([curve.is_latin for curve in curves])
    ratios = times[is_latin].min(axis=0) / times[~is_latin].min(axis=0)
    texts = (f"{ratio:.2g}" if math.isfinite(ratio) else "-" for ratio in ratios)
    return [*rows, [f"best {TIMES}", *texts, "-", "-"]]


def sizes_table(settings: Settings, measured: Sequence[TimesAtSize]) -> list[Row]:
    """Times of both solvers at every size, or why they have none."""
    rows = [
        [_titles(settings)[0], "instants", "LATIN, s", f"{INCREMENTAL}, s", TIMES, ""]
    ]
    for times in measured:
        numbers = (
            text_of(number) for number in (times.latin, times.incremental, times.ratio)
        )
        rows.append([str(times.size), str(times.instants), *numbers, times.message])
    return rows


def notes(settings: Settings, measured: Sequence[TimesAtSize]) -> list[str]:
    """What the sizes show, in sentences."""
    ratios = np.array([times.ratio for times in measured if not times.message])
    return [
        f"LATIN is ahead (below 1) at {int((ratios < 1.0).sum())} of {ratios.size} sizes. From "
        "settings to a certified or accurate end, in seconds of the processor, medians of up to "
        "three runs in turns.",
        f"What grows, each by the same factor: {' and '.join(_titles(settings)).lower()}.",
    ]


def _titles(settings: Settings) -> list[str]:
    """Titles of the settings that grow together."""
    definitions = settings.definitions()
    return [title_of(definitions[name]) for name in settings.GROWS]


def error_panels(curves: Sequence[ErrorCurve]) -> list[Panel]:
    """Errors of displacement and of friction force over time, a curve for each method."""
    panels = []
    for name, title in (
        ("error_displacement", "Displacement"),
        ("error_force", "Friction force"),
    ):
        *latin, other = (
            PanelCurve(
                own.method, own.seconds, np.maximum(getattr(own, name), SMALLEST), hue
            )
            for hue, own in enumerate(curves, start=1)
        )
        # The solver that is the reference itself is a vertical line.
        line = PanelCurve(
            other.label, np.repeat(other.x, 2), np.array(SPAN), 0, "dashed"
        )
        axes = (
            PanelAxis("Time", "s", logarithmic=True),
            PanelAxis("Relative error", logarithmic=True, limits=SPAN),
        )
        panels.append(Panel(title, *axes, (*latin, line)))
    return panels


def write_curves(curves: Sequence[ErrorCurve], folder: Path) -> None:
    """Write `curves.csv` and `levels.csv` (s; errors as fractions)."""
    points = []
    levels = []
    for curve in curves:
        which = curve.method, "latin" if curve.is_latin else "incremental"
        columns = (
            curve.steps,
            curve.seconds,
            curve.error_displacement,
            curve.error_force,
        )
        points += [(*which, *map(float, point)) for point in zip(*columns, strict=True)]
        for level in LEVELS.values():
            reached = curve.reached(level) or ("", "")
            levels.append((*which, level, *reached, curve.seconds_per_iteration))
    head = ["method", "kind"]
    columns_of_points = [*head, "step", "seconds", "error_displacement", "error_force"]
    write_csv(folder / "curves.csv", columns_of_points, points)
    more = ["level", "seconds", "step", "seconds_per_iteration"]
    write_csv(folder / "levels.csv", [*head, *more], levels)


def write_study(
    settings: Settings,
    repeats: int,
    curves: Sequence[ErrorCurve],
    measured: Sequence[TimesAtSize],
    folder: Path,
) -> None:
    """Write `map.csv` and `study.html`."""
    head = ["setting", "size", "instants", "latin", "incremental", "said"]
    rows = ((settings.GROWS[0], *astuple(times)) for times in measured)
    write_csv(folder / "map.csv", head, rows)
    sections: list[Section] = [
        f"<h2>Time to an error of the friction force</h2>\n{html_table(table(curves))}\n"
        f"<p>{TABLE_NOTE}</p>\n<h2>{CURVES}</h2>",
        PlotSection(CURVES, error_panels(curves)),
        f"<p>{CAPTION}</p>\n<h2>Who is first where</h2>\n"
        f"{html_table(sizes_table(settings, measured))}\n{bullets(notes(settings, measured))}",
        f"<h2>How it was measured</h2>\n{bullets(conditions(settings, repeats))}",
    ]
    write_page(folder / FILES[-1], "Error against run time", sections)
