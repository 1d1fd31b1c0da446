"""Figs. 5 to 8 of the paper, drawn again: how few modes in space and time hold which field."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solver.arrays import Array
from solver.reduction.svd import Decomposition, front_decay
from solver.study.page import Panel, PanelAxis, PanelCurve
from solver.study.paper_convergence import figure_3, figure_4
from solver.study.paper_runs import Finding, PaperFigure, PaperRuns, paper_figure

ALIKE = 0.9
"""Correlation from which two modes count as alike."""
SHARES = (0.1, 0.01, 0.001)
"""Errors for which modes are counted."""
PLACE = PanelAxis("Position x", "m")
MODE = PanelAxis("Space mode", "1/√m")


def paper_figures(runs: PaperRuns) -> list[PaperFigure]:
    """Figs. 3 to 8."""
    return [make(runs) for make in (figure_3, figure_4, figure_5, figure_6, figure_7, figure_8)]


def figure_5(runs: PaperRuns) -> PaperFigure:
    """Singular values of the friction force in every substructure."""
    parts = runs.friction_forces
    largest = max(part.values[0] for part in parts)
    noise = runs.five.records[-1].error_force
    orders = np.arange(1.0, len(parts[-1].values) + 1.0)
    curves = [
        PanelCurve(f"substructure {number}", orders, part.values / largest, number, "points")
        for number, part in enumerate(parts, start=1)
    ]
    front = PanelCurve("1/(2n − 1)", orders, front_decay(len(orders)), 0, "dotted")
    error = PanelCurve("error of the solution", orders, np.full(len(orders), noise), 0, "dashed")
    panels = tuple(
        Panel(
            title,
            PanelAxis("Mode n", whole=True),
            PanelAxis("Singular value / largest", logarithmic=True, limits=limits),
            (*shown, front, *below),
        )
        for title, limits, shown, below in (
            ("All, numbered from the clamp", (1e-11, 3.0), curves, [error]),
            ("Those that the front sweeps", (1e-2, 1.5), curves[2:], []),
        )
    )
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
    top = 1.1 * float(np.abs([fourth.space_modes[:, :5], turned[:, :5]]).max())
    panels = tuple(
        Panel(
            f"Mode {order}",
            PanelAxis("Position in the substructure", "m"),
            PanelAxis(MODE.quantity, MODE.unit, limits=(-top, top)),
            (
                PanelCurve("substructure 4", inside, fourth.space_modes[:, order - 1], 4),
                PanelCurve("substructure 5", inside, turned[:, order - 1], 5, "dashed"),
            ),
        )
        for order in (1, 3, 5)
    )
    values = [float(np.abs(alike[order - 1])) for order in (1, 3, 5)]
    words = ", ".join(f"{value:.3f}" for value in values)
    likeness = Finding(
        f"Correlation of modes 1, 3, 5 of substructures 4 and 5: {words}.",
        min(values) >= ALIKE,
    )
    return paper_figure(6, panels, likeness, _sign_changes(fourth, fifth))


def _sign_changes(*parts: Decomposition) -> Finding:
    """Numbers of sign changes along modes 1, 3, 5: how local they are."""
    counts = [
        np.count_nonzero(np.diff(np.sign(part.space_modes[:, :5:2]), axis=0), axis=0).tolist()
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
    displacement, force = runs.displacements[-1], runs.friction_forces[-1]
    curves = tuple(
        PanelCurve(
            f"mode {order}", displacement.positions, displacement.space_modes[:, order - 1], order
        )
        for order in (1, 2, 3)
    )
    left = {rank: float(displacement.errors[rank]) for rank in (1, 2, 3)}
    counts = displacement.modes_for(0.01), force.modes_for(0.01)
    reducible = Finding(
        f"The first 1, 2, 3 modes leave {left[1]:.1%}, {left[2]:.2%}, {left[3]:.2%} of the "
        f"displacement; 1 % takes {counts[0]} modes, where the friction force takes {counts[1]} of "
        f"its {len(force.values)}.",
        left[3] <= 0.01,
    )
    panel = Panel("SVD of the converged displacement", PLACE, MODE, curves)
    return paper_figure(7, [panel], reducible)


def figure_8(runs: PaperRuns) -> PaperFigure:
    """The first three displacement modes of the PGD in substructure 5."""
    exact, last = runs.displacements[-1], runs.five_reduced.iterate
    rubs = np.isin(last.problem.substructures[-1].rows, last.problem.friction.tangent.above)
    kept = last.bases[-1].displacement_modes[rubs, :3]
    root = np.sqrt(exact.space_weights)[:, None]
    sorted_ = np.linalg.qr(kept * root)[0] / root
    panels = tuple(
        Panel(title, PLACE, MODE, tuple(_beside_svd(exact, modes)))
        for title, modes in (
            ("PGD modes, orthonormalised in order", sorted_),
            ("PGD modes as the iteration keeps them", kept),
        )
    )
    return paper_figure(
        8,
        panels,
        _correlation(exact, sorted_, "orthonormalised in order"),
        _correlation(exact, kept, "as the iteration keeps them"),
        last=last.number,
    )


def _beside_svd(exact: Decomposition, modes: Array) -> list[PanelCurve]:
    """Modes at length one, turned to the side of the SVD modes that are dotted."""
    turned = modes * np.sign(exact.correlations(modes)) / np.sqrt(exact.space_weights @ modes**2)
    curves = []
    for order, (pgd, svd) in enumerate(zip(turned.T, exact.space_modes.T, strict=False), start=1):
        curves += [
            PanelCurve(f"PGD {order}", exact.positions, pgd, order),
            PanelCurve(f"SVD {order}", exact.positions, svd, order, "dotted"),
        ]
    return curves


def _correlation(exact: Decomposition, modes: Array, words: str) -> Finding:
    """Correlation of modes, shape (n_points, n), with the SVD modes of the same order."""
    values = np.abs(exact.correlations(modes))
    shown = ", ".join(f"{value:.3f}" for value in values)
    return Finding(
        f"Correlation of PGD with SVD modes 1, 2, 3, {words}: {shown}.",
        bool(values.min() >= ALIKE),
    )
