"""Figs. 3 and 4 of the paper, drawn again: what the multiscale version gains, and where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from solver.arrays import Array
from solver.latin import Record
from solver.reference.distance import Fields
from solver.study.chart import Line, Panel, PanelAxis, PanelCurve
from solver.study.figures.figure import Finding, PaperFigure, paper_figure
from solver.study.figures.paper_runs import EARLY, LONG, PaperRuns

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
Histories = Mapping[str, Sequence[Record]]


def figure_3(runs: PaperRuns) -> PaperFigure:
    """The LATIN indicator, mono- and multiscale, with the true errors beside it."""
    both = {"multiscale": runs.multiscale.records, "monoscale": runs.monoscale.records}

    def curves(name: str, word: str, line: Line) -> list[PanelCurve]:
        numbers = np.arange(1.0, SHOWN + 1.0)
        return [
            PanelCurve(f"{word}, {version}", numbers, values[:SHOWN], hue, line)
            for hue, (version, values) in enumerate(_columns(both, name).items(), start=1)
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
        *(_gain(both, "indicator", 1e-4), _gain(both, "error_displacement", 1e-2)),
        *(_rates(both, (30, 200)), _rates(both, (LONG // 2, LONG))),
    )


def _columns(both: Histories, name: str) -> dict[str, Array]:
    """One scalar of all records by version, each of shape (n_iterations,)."""
    return {
        version: np.array([getattr(entry, name) for entry in records])
        for version, records in both.items()
    }


def _gain(both: Histories, name: str, level: float) -> Finding:
    """Iterations until a quantity passes a level."""
    first, second = (
        int(np.argmax(values <= level)) + 1 for values in _columns(both, name).values()
    )
    return Finding(
        f"It takes {first} iterations multiscale, {second} monoscale to bring {QUANTITIES[name]} "
        f"below {level:g}: a gain of {second / first:.1f}.",
        second / first >= GAIN,
    )


def _rates(both: Histories, window: tuple[int, int]) -> Finding:
    """Rates of convergence, fitted to logarithms over a window of iterations."""
    start, end = window
    ratios = {}
    for name in QUANTITIES:
        tails = [np.log(values[start - 1 : end]) for values in _columns(both, name).values()]
        multi, mono = np.polyfit(np.arange(end - start + 1), np.transpose(tails), 1)[0]
        ratios[name] = float(multi / mono)
    words = ", ".join(f"{ratio:.2f} for {QUANTITIES[name]}" for name, ratio in ratios.items())
    return Finding(
        f"From iteration {start} to {end}, the rate of convergence multiscale over that monoscale "
        f"is {words}.",
        all(abs(ratio - 1.0) <= EQUAL_RATE for ratio in ratios.values()),
    )


def figure_4(runs: PaperRuns) -> PaperFigure:
    """The friction force after ten iterations at two instants, against the reference."""
    problem = runs.multiscale.early.problem
    solutions: dict[str, Fields] = {
        "reference": runs.reference,
        "multiscale": runs.multiscale.early,
        "monoscale": runs.monoscale.early,
    }
    law = problem.friction
    lengths = law.by_point(law.weights)[1:]
    forces = {label: fields.contact_force[1:] for label, fields in solutions.items()}
    panels = []
    for instant in INSTANTS:
        moment = int(np.argmin(np.abs(problem.instants - instant)))
        curves = tuple(
            PanelCurve(label, law.positions[1:], force[:, moment] / lengths, hue)
            for hue, (label, force) in enumerate(forces.items())
        )
        axes = PanelAxis("Position x", "m"), PanelAxis("Friction force per length", "N/m")
        panels.append(Panel(f"t = {instant:g} s", *axes, curves))
    early = int(np.argmin(np.abs(problem.instants - INSTANTS[0])))
    root = np.sqrt(lengths)
    displacements = {
        label: fields.displacement[1:, early] * root for label, fields in solutions.items()
    }
    then = {label: force[:, early] for label, force in forces.items()}
    weighted = {label: force / root for label, force in then.items()}
    return paper_figure(
        *(4, panels, _balance(then), _distance("the displacement", displacements)),
        _distance("the friction force", weighted),
        early=EARLY,
    )


def _balance(forces: Mapping[str, Array]) -> Finding:
    """Sum of the friction force along the bar, which a load of zero must find balanced."""
    totals = {label: float(force.sum()) for label, force in forces.items()}
    size = float(np.abs(forces["reference"]).sum())
    words = ", ".join(f"{round(total, 1) + 0.0:.1f} N {label}" for label, total in totals.items())
    multi, mono = (abs(totals[name] - totals["reference"]) for name in ("multiscale", "monoscale"))
    return Finding(
        f"Friction force added up along the bar at t = 0.5 s: {words}; its size adds up to "
        f"{size:.0f} N.",
        multi <= 0.01 * size <= mono,
    )


def _distance(words: str, solutions: Mapping[str, Array]) -> Finding:
    """Distances to the reference at t = 0.5 s, of fields with the weights of L2 along the bar."""
    exact = solutions["reference"]
    multi, mono = (
        float(np.linalg.norm(solutions[label] - exact) / np.linalg.norm(exact))
        for label in ("multiscale", "monoscale")
    )
    return Finding(
        f"Error of {words} at t = 0.5 s: {multi:.0%} multiscale, {mono:.0%} monoscale.",
        mono >= GAIN * multi,
    )
