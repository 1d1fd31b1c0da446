"""The curves of a study as plain data: errors over time, and growth with the size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array
from solver.study.chart import Line, Panel, PanelAxis, PanelCurve
from solver.study.speed.error_against_time import FORMS, INCREMENTAL, ErrorCurve, Study
from solver.study.speed.growth import MEASURED, Growth

SPAN = (1e-9, 2.0)
"""Errors that are shown; smaller ones are drawn at SMALLEST, just above the lower edge."""
SMALLEST = 2e-9
CURVES = "Error against run time, set-up included"
CAPTION = (
    "A line is a form of LATIN, iteration by iteration; points are runs of a public solver at "
    "several tolerances; the dashed line is when the incremental solver is done. Errors below the "
    "lower edge are drawn on it."
)
GROWTH = "Growth with the size of the problem"


def error_panels(study: Study) -> list[Panel]:
    """Draw errors of displacement and of friction force over time, a curve for each method."""
    panels = []
    for name, title in (
        ("error_displacement", "Displacement"),
        ("error_force", "Friction force"),
    ):
        numbers = {"latin": 0, "peer": len(FORMS)}
        curves = []
        for course in study.courses:
            if course.kind != "incremental":
                numbers[course.kind] += 1
            curves.append(_curve(course, getattr(course, name), numbers.get(course.kind, 0)))
        panels.append(
            Panel(
                title,
                PanelAxis("Time", "s", logarithmic=True),
                PanelAxis("Relative error", logarithmic=True, limits=SPAN),
                tuple(curves),
            )
        )
    return panels


def _curve(course: ErrorCurve, errors: Array, hue: int) -> PanelCurve:
    """Give a method's line: a vertical one where the solver itself is the reference."""
    if course.kind == "incremental":
        seconds = np.repeat(course.seconds, 2)
        return PanelCurve(course.method, seconds, np.array(SPAN), 0, "dashed")
    line: Line = "solid" if course.kind == "latin" else "points"
    return PanelCurve(course.method, course.seconds, np.maximum(errors, SMALLEST), hue, line)


def growth_panels(found: Sequence[Growth]) -> list[Panel]:
    """Draw times over sizes, a panel for each setting that changes."""
    hues = {method: hue for hue, method in enumerate((INCREMENTAL, *MEASURED))}
    return [
        Panel(
            setting.capitalize(),
            PanelAxis(f"Number of {setting}", logarithmic=True, whole=True),
            PanelAxis("Time", "s", logarithmic=True),
            tuple(
                PanelCurve(
                    one.method,
                    np.array([float(size.size) for size in one.sizes]),
                    np.array([size.seconds for size in one.sizes]),
                    hues[one.method],
                    "points",
                )
                for one in found
                if one.setting == setting
            ),
        )
        for setting in dict.fromkeys(one.setting for one in found)
    ]
