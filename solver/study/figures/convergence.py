"""Figs. 3 and 4 of the paper, drawn again: what the multiscale version gains, and where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from solver.arrays import Array
from solver.latin import Record
from solver.reference.distance import Fields
from solver.study.chart import Line, Panel, PanelAxis, PanelCurve
from solver.study.figures.figure import LOAD, Finding, PaperFigure
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
Records = Sequence[Record]


def figure_3(runs: PaperRuns) -> PaperFigure:
    """The LATIN indicator, mono- and multiscale, with the true errors beside it."""
    multi, mono = runs.multiscale.records, runs.monoscale.records
    iterations = PanelAxis("Iteration")

    def curves(name: str, word: str, line: Line) -> list[PanelCurve]:
        numbers = np.arange(1.0, SHOWN + 1.0)
        return [
            PanelCurve(f"{word}, {version}", numbers, _column(records, name)[:SHOWN], hue, line)
            for hue, (version, records) in enumerate(
                {"multiscale": multi, "monoscale": mono}.items(), start=1
            )
        ]

    indicator = Panel(
        "What the method computes",
        iterations,
        PanelAxis("LATIN indicator η", logarithmic=True),
        tuple(curves("indicator", "η", "dashed")),
    )
    errors = Panel(
        "What is true",
        iterations,
        PanelAxis("Relative error", logarithmic=True),
        (
            *curves("error_force", "friction force", "solid"),
            *curves("error_displacement", "displacement", "dotted"),
        ),
    )
    return PaperFigure(
        3,
        "LATIN indicator, monoscale and multiscale",
        (indicator, errors),
        "The multiscale version gains hugely in the first iterations; after that both converge at "
        "the same rate.",
        (
            _gain(multi, mono, "indicator", 1e-4),
            _gain(multi, mono, "error_displacement", 1e-2),
            _rates(multi, mono, (30, 200)),
            _rates(multi, mono, (LONG // 2, LONG)),
        ),
        f"10 substructures, the indicator of eq. 2 (squared norms) and, as it is no error, the "
        f"distance to the incremental solution in L2 over space and time. {LOAD}",
    )


def _column(records: Records, name: str) -> Array:
    """One scalar of all records, shape (n_iterations,)."""
    return np.array([getattr(entry, name) for entry in records])


def _gain(multi: Records, mono: Records, name: str, level: float) -> Finding:
    """Iterations until a quantity passes a level."""
    first, second = (
        int(np.argmax(_column(records, name) <= level)) + 1 for records in (multi, mono)
    )
    return Finding(
        f"It takes {first} iterations multiscale, {second} monoscale to bring {QUANTITIES[name]} "
        f"below {level:g}: a gain of {second / first:.1f}.",
        second / first >= GAIN,
    )


def _rates(multi: Records, mono: Records, window: tuple[int, int]) -> Finding:
    """Rates of convergence, fitted to logarithms over a window of iterations."""
    start, end = window

    def slope(records: Records, name: str) -> float:
        values = np.log(_column(records, name)[start - 1 : end])
        return float(np.polyfit(np.arange(len(values)), values, 1)[0])

    ratios = {name: slope(multi, name) / slope(mono, name) for name in QUANTITIES}
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
    root = np.sqrt(lengths)
    moments = {time: int(np.argmin(np.abs(problem.instants - time))) for time in INSTANTS}
    forces = {label: fields.contact_force[1:] for label, fields in solutions.items()}
    panels = tuple(
        Panel(
            f"t = {instant:g} s",
            PanelAxis("Position x", "m"),
            PanelAxis("Friction force per length", "N/m"),
            tuple(
                PanelCurve(label, law.positions[1:], force[:, moment] / lengths, hue)
                for hue, (label, force) in enumerate(forces.items())
            ),
        )
        for instant, moment in moments.items()
    )
    early = moments[INSTANTS[0]]
    displacements = {
        label: fields.displacement[1:, early] * root for label, fields in solutions.items()
    }
    forces_then = {label: force[:, early] for label, force in forces.items()}
    return PaperFigure(
        4,
        f"Friction force after {EARLY} iterations",
        panels,
        "After a few iterations the multiscale version captures the global behaviour very well, "
        "while the monoscale one is far from the reference, the load not fully propagated.",
        (
            _balance(forces_then),
            _distance("the displacement", displacements),
            _distance(
                "the friction force", {label: force / root for label, force in forces_then.items()}
            ),
        ),
        "10 substructures. The clamped node is left out: its friction force is part of the "
        "reaction. Here the load is zero at both instants, so that t = 1 s is t = 0.5 s with "
        f"the sign changed. {LOAD}",
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
