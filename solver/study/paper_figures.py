"""Figs. 3 to 8 of the paper, drawn again: gains of the multiscale version, modes of the fields."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array
from solver.reduction.svd import Decomposition, front_decay
from solver.reference.distance import Fields
from solver.study.page import Line, Panel, PanelAxis, PanelCurve
from solver.study.paper_runs import (
    EARLY,
    LONG,
    Finding,
    PaperFigure,
    PaperRuns,
    paper_figure,
)

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
ALIKE = 0.9
"""Correlation from which two modes count as alike."""
SHARES = (0.1, 0.01, 0.001)
"""Errors for which modes are counted."""
PLACE = PanelAxis("Position x", "m")
MODE = PanelAxis("Space mode", "1/√m")


def paper_figures(runs: PaperRuns) -> list[PaperFigure]:
    """Figs. 3 to 8."""
    return [
        make(runs)
        for make in (figure_3, figure_4, figure_5, figure_6, figure_7, figure_8)
    ]


def figure_3(runs: PaperRuns) -> PaperFigure:
    """The LATIN indicator, mono- and multiscale, with the true errors beside it."""
    computed = _over_iterations(runs, "indicator", "η", "dashed")
    true = [
        *_over_iterations(runs, "error_force", "friction force", "solid"),
        *_over_iterations(runs, "error_displacement", "displacement", "dotted"),
    ]
    panels = [
        Panel(
            title,
            PanelAxis("Iteration"),
            PanelAxis(axis, logarithmic=True),
            tuple(curves),
        )
        for title, axis, curves in (
            ("What the method computes", "LATIN indicator η", computed),
            ("What is true", "Relative error", true),
        )
    ]
    return paper_figure(
        3,
        panels,
        _gain(runs, "indicator", 1e-4),
        _gain(runs, "error_displacement", 1e-2),
        _rates(runs, (30, 200)),
        _rates(runs, (LONG // 2, LONG)),
    )


def _over_iterations(
    runs: PaperRuns, name: str, word: str, line: Line
) -> list[PanelCurve]:
    """Curves of a scalar of the records of both versions."""
    numbers = np.arange(1.0, SHOWN + 1.0)
    both = zip(VERSIONS, _both(runs, name), strict=True)
    return [
        PanelCurve(f"{word}, {version}", numbers, values[:SHOWN], hue, line)
        for hue, (version, values) in enumerate(both, start=1)
    ]


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
    words = ", ".join(
        f"{ratio:.2f} for {QUANTITIES[name]}" for name, ratio in ratios.items()
    )
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
    panels = []
    moments = [int(np.abs(problem.instants - at).argmin()) for at in INSTANTS]
    for instant, moment in zip(INSTANTS, moments, strict=True):
        shown = zip(("reference", *VERSIONS), force[..., moment] / lengths, strict=True)
        curves = tuple(
            PanelCurve(label, law.positions[1:], values, hue)
            for hue, (label, values) in enumerate(shown)
        )
        axes = (
            PanelAxis("Position x", "m"),
            PanelAxis("Friction force per length", "N/m"),
        )
        panels.append(Panel(f"t = {instant:g} s", *axes, curves))
    early = moments[0]
    root = np.sqrt(lengths)
    return paper_figure(
        4,
        panels,
        _balance(force[..., early]),
        _distance("the displacement", moved[..., early] * root),
        _distance("the friction force", force[..., early] / root),
        early=EARLY,
    )


def _balance(forces: Array) -> Finding:
    """Sum of the friction force along the bar, which a load of zero must find balanced."""
    totals = forces.sum(axis=1)
    size = float(np.abs(forces[0]).sum())
    labels = zip(("reference", *VERSIONS), totals, strict=True)
    words = ", ".join(
        f"{round(total, 1) + 0.0:.1f} N {label}" for label, total in labels
    )
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


def figure_5(runs: PaperRuns) -> PaperFigure:
    """Singular values of the friction force in every substructure."""
    parts = runs.friction_forces
    largest = max(part.values[0] for part in parts)
    noise = runs.five.records[-1].error_force
    orders = np.arange(1.0, len(parts[-1].values) + 1.0)
    curves = [
        PanelCurve(
            f"substructure {number}", orders, part.values / largest, number, "points"
        )
        for number, part in enumerate(parts, start=1)
    ]
    front = PanelCurve("1/(2n − 1)", orders, front_decay(len(orders)), 0, "dotted")
    error = PanelCurve(
        "error of the solution", orders, np.full(len(orders), noise), 0, "dashed"
    )
    panels = []
    for title, limits, shown in (
        ("All, numbered from the clamp", (1e-11, 3.0), (*curves, front, error)),
        ("Those that the front sweeps", (1e-2, 1.5), (*curves[2:], front)),
    ):
        share = PanelAxis("Singular value / largest", logarithmic=True, limits=limits)
        panels.append(Panel(title, PanelAxis("Mode n", whole=True), share, shown))
    return paper_figure(5, panels, _mode_counts(parts, noise * largest), noise=noise)


def _mode_counts(parts: Sequence[Decomposition], noise: float) -> Finding:
    """Numbers of modes by substructure; a field below the solution's error counts as zero."""
    counts = [
        [part.modes_for(share) if part.values[0] > noise else 0 for share in SHARES]
        for part in parts
    ]
    words = ", ".join(
        f"{'/'.join(map(str, row))} in substructure {number}"
        for number, row in enumerate(counts, start=1)
    )
    one_percent = [row[1] for row in counts]
    return Finding(
        f"Modes that leave at most 10/1/0.1 % of a substructure's friction force: {words}. All "
        f"would be {len(parts[0].values)}.",
        3 * max(one_percent[:2]) <= min(one_percent[2:]),
    )


def figure_6(runs: PaperRuns) -> PaperFigure:
    """The friction force's space modes 1, 3 and 5 in substructures 4 and 5."""
    fourth, fifth = runs.friction_forces[3:]
    alike = fourth.correlations(fifth.space_modes)
    turned = fifth.space_modes * np.sign(alike)
    inside = fourth.positions - fourth.positions[0]
    panels = []
    across = PanelAxis("Position in the substructure", "m")
    for order in (1, 3, 5):
        both = (
            PanelCurve("substructure 4", inside, fourth.space_modes[:, order - 1], 4),
            PanelCurve("substructure 5", inside, turned[:, order - 1], 5, "dashed"),
        )
        panels.append(Panel(f"Mode {order}", across, MODE, both))
    likeness = _correlation(
        "of modes 1, 3, 5 of substructures 4 and 5", alike[[0, 2, 4]]
    )
    return paper_figure(6, panels, likeness, _sign_changes(fourth, fifth))


def _sign_changes(*parts: Decomposition) -> Finding:
    """Numbers of sign changes along modes 1, 3, 5: how local they are."""
    counts = [
        np.count_nonzero(
            np.diff(np.sign(part.space_modes[:, :5:2]), axis=0), axis=0
        ).tolist()
        for part in parts
    ]
    words = " and ".join(", ".join(map(str, row)) for row in counts)
    return Finding(
        f"Modes 1, 3, 5 change sign {words} times (substructures 4 and 5): later modes are more "
        "local.",
        all(row[0] < row[1] < row[2] for row in counts),
    )


def figure_7(runs: PaperRuns) -> PaperFigure:
    """The first three SVD modes of the displacement of substructure 5."""
    displacement = runs.displacements[-1]
    force = runs.friction_forces[-1]
    curves = tuple(
        PanelCurve(f"mode {order}", displacement.positions, mode, order)
        for order, mode in enumerate(displacement.space_modes.T[:3], start=1)
    )
    left = displacement.errors
    counts = displacement.modes_for(0.01), force.modes_for(0.01)
    reducible = Finding(
        f"The first 1, 2, 3 modes leave {left[1]:.1%}, {left[2]:.2%}, {left[3]:.2%} of the "
        f"displacement; 1 % takes {counts[0]} modes, where the friction force takes {counts[1]} of "
        f"its {len(force.values)}.",
        bool(left[3] <= 0.01),
    )
    panel = Panel("SVD of the converged displacement", PLACE, MODE, curves)
    return paper_figure(7, [panel], reducible)


def figure_8(runs: PaperRuns) -> PaperFigure:
    """The first three displacement modes of the PGD in substructure 5."""
    exact = runs.displacements[-1]
    last = runs.five_reduced.iterate
    rubs = np.isin(
        last.problem.substructures[-1].rows, last.problem.friction.tangent.above
    )
    kept = last.bases[-1].displacement_modes[rubs, :3]
    root = np.sqrt(exact.space_weights)[:, None]
    sorted_ = np.linalg.qr(kept * root)[0] / root
    panels = []
    findings = []
    both = {"orthonormalised in order": sorted_, "as the iteration keeps them": kept}
    for how, modes in both.items():
        panels.append(
            Panel(f"PGD modes, {how}", PLACE, MODE, tuple(_beside_svd(exact, modes)))
        )
        words = f"of PGD with SVD modes 1, 2, 3, {how}"
        findings.append(_correlation(words, exact.correlations(modes)))
    return paper_figure(8, panels, *findings, last=last.number)


def _beside_svd(exact: Decomposition, modes: Array) -> list[PanelCurve]:
    """Modes at length one, turned to the side of the SVD modes that are dotted."""
    turned = (
        modes
        * np.sign(exact.correlations(modes))
        / np.sqrt(exact.space_weights @ modes**2)
    )
    curves = []
    for order, (pgd, svd) in enumerate(
        zip(turned.T, exact.space_modes.T, strict=False), start=1
    ):
        curves += [
            PanelCurve(f"PGD {order}", exact.positions, pgd, order),
            PanelCurve(f"SVD {order}", exact.positions, svd, order, "dotted"),
        ]
    return curves


def _correlation(words: str, signed: Array) -> Finding:
    """Correlation of modes of the same order, shape (n,)."""
    values = np.abs(signed)
    shown = ", ".join(f"{value:.3f}" for value in values)
    return Finding(f"Correlation {words}: {shown}.", bool(values.min() >= ALIKE))
