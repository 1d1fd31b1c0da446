"""Figs. 3 and 4 of the paper, drawn again: what the multiscale version gains, and where."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.reference.distance import Fields
from solver.study.page import Line, Panel, PanelAxis, PanelCurve
from solver.study.paper_runs import EARLY, LONG, Finding, PaperFigure, PaperRuns, paper_figure

SHOWN = 300
"""Iterations that Fig. 3 shows."""
INSTANTS = (0.5, 1.0)
"""Instants of Fig. 4, s."""
GAIN = 2.0
"""Factor from which the multiscale version counts as much better."""
EQUAL_RATE = 0.2
"""Relative difference up to which two rates of convergence count as equal."""
QUANTITIES = {
    "indicator": "η",
    "error_displacement": "the error of the displacement",
    "error_force": "the error of the friction force",
}
VERSIONS = "multiscale", "monoscale"


def figure_3(runs: PaperRuns) -> PaperFigure:
    """The LATIN indicator, mono- and multiscale, with the true errors beside it."""

    def curves(name: str, word: str, line: Line) -> list[PanelCurve]:
        numbers = np.arange(1.0, SHOWN + 1.0)
        return [
            PanelCurve(f"{word}, {version}", numbers, values[:SHOWN], hue, line)
            for hue, (version, values) in enumerate(
                zip(VERSIONS, _both(runs, name), strict=True), start=1
            )
        ]

    axes = [PanelAxis(name, logarithmic=True) for name in ("LATIN indicator η", "Relative error")]
    errors = [
        *curves("error_force", "friction force", "solid"),
        *curves("error_displacement", "displacement", "dotted"),
    ]
    panels = (
        Panel(
            "What the method computes",
            *(PanelAxis("Iteration"), axes[0], tuple(curves("indicator", "η", "dashed"))),
        ),
        Panel("What is true", PanelAxis("Iteration"), axes[1], tuple(errors)),
    )
    return paper_figure(
        *(3, panels),
        *(_gain(runs, "indicator", 1e-4), _gain(runs, "error_displacement", 1e-2)),
        *(_rates(runs, (30, 200)), _rates(runs, (LONG // 2, LONG))),
    )


def _both(runs: PaperRuns, name: str) -> Array:
    """One scalar of all records of both versions, shape (2, n_iterations)."""
    both = runs.multiscale.records, runs.monoscale.records
    return np.array([[getattr(record, name) for record in records] for records in both])


def _gain(runs: PaperRuns, name: str, level: float) -> Finding:
    """Iterations until a quantity passes a level."""
    first, second = np.argmax(_both(runs, name) <= level, axis=1) + 1
    return Finding(
        f"It takes {first} iterations multiscale, {second} monoscale to bring {QUANTITIES[name]} "
        f"below {level:g}: a gain of {second / first:.1f}.",
        bool(second / first >= GAIN),
    )


def _rates(runs: PaperRuns, window: tuple[int, int]) -> Finding:
    """Rates of convergence, fitted to logarithms over a window of iterations."""
    start, end = window
    ratios = {}
    for name in QUANTITIES:
        tails = np.log(_both(runs, name)[:, start - 1 : end])
        multi, mono = np.polyfit(np.arange(end - start + 1), tails.T, 1)[0]
        ratios[name] = float(multi / mono)
    words = ", ".join(f"{ratio:.2f} for {QUANTITIES[name]}" for name, ratio in ratios.items())
    return Finding(
        f"From iteration {start} to {end}, the rate of convergence multiscale over that monoscale "
        f"is {words}.",
        all(abs(ratio - 1.0) <= EQUAL_RATE for ratio in ratios.values()),
    )


def figure_4(runs: PaperRuns) -> PaperFigure:
    """The friction force after ten iterations at two instants, against the reference."""
    problem = runs.early[0].problem
    solutions: list[Fields] = [runs.reference, *runs.early]
    law = problem.friction
    lengths = law.by_point(law.weights)[1:]
    force = np.array([fields.contact_force[1:] for fields in solutions])
    moved = np.array([fields.displacement[1:] for fields in solutions])
    panels, moments = [], [int(np.abs(problem.instants - at).argmin()) for at in INSTANTS]
    for instant, moment in zip(INSTANTS, moments, strict=True):
        shown = zip(("reference", *VERSIONS), force[..., moment] / lengths, strict=True)
        curves = tuple(
            PanelCurve(label, law.positions[1:], values, hue)
            for hue, (label, values) in enumerate(shown)
        )
        axes = PanelAxis("Position x", "m"), PanelAxis("Friction force per length", "N/m")
        panels.append(Panel(f"t = {instant:g} s", *axes, curves))
    early, root = moments[0], np.sqrt(lengths)
    return paper_figure(
        *(4, panels, _balance(force[..., early])),
        _distance("the displacement", moved[..., early] * root),
        _distance("the friction force", force[..., early] / root),
        early=EARLY,
    )


def _balance(forces: Array) -> Finding:
    """Sum of the friction force along the bar, which a load of zero must find balanced."""
    totals, size = forces.sum(axis=1), float(np.abs(forces[0]).sum())
    labels = zip(("reference", *VERSIONS), totals, strict=True)
    words = ", ".join(f"{round(total, 1) + 0.0:.1f} N {label}" for label, total in labels)
    multi, mono = np.abs(totals[1:] - totals[0])
    return Finding(
        f"Friction force added up along the bar at t = 0.5 s: {words}; its size adds up to "
        f"{size:.0f} N.",
        bool(multi <= 0.01 * size <= mono),
    )


def _distance(words: str, solutions: Array) -> Finding:
    """Distances to the reference at t = 0.5 s, of fields with the weights of L2 along the bar."""
    apart = np.linalg.norm(solutions - solutions[0], axis=1)
    multi, mono = apart[1:] / np.linalg.norm(solutions[0])
    return Finding(
        f"Error of {words} at t = 0.5 s: {multi:.0%} multiscale, {mono:.0%} monoscale.",
        bool(mono >= GAIN * multi),
    )
