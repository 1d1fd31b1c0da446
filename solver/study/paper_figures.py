"""Figs. 3 to 8 of the paper, drawn again: multiscale gains, and modes of the fields."""

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
        figure_3(runs),
        figure_4(runs),
        figure_5(runs),
        figure_6(runs),
        figure_7(runs),
        figure_8(runs),
    ]


def figure_3(runs: PaperRuns) -> PaperFigure:
    """The LATIN indicator, mono- and multiscale, with the true errors beside it."""
    computed = _over_iterations(runs, "indicator", "η", "dashed")
    true = [
        *_over_iterations(runs, "error_force", "friction force", "solid"),
        *_over_iterations(runs, "error_displacement", "displacement", "dotted"),
    ]
    return paper_figure(
        3,
        [
            _convergence("What the method computes", "LATIN indicator η", computed),
            _convergence("What is true", "Relative error", true),
        ],
        _gain(runs, "indicator", 1e-4),
        _gain(runs, "error_displacement", 1e-2),
        _rates(runs, (30, 200)),
        _rates(runs, (LONG // 2, LONG)),
    )


def _convergence(title: str, quantity: str, curves: list[PanelCurve]) -> Panel:
    """Panel of a quantity over iterations, on a logarithmic scale."""
    y = PanelAxis(quantity, logarithmic=True)
    return Panel(title, PanelAxis("Iteration"), y, tuple(curves))


def _over_iterations(
    runs: PaperRuns, name: str, word: str, line: Line
) -> list[PanelCurve]:
    """Curves of a scalar of the records of both versions, over iterations."""
    numbers = np.arange(1.0, SHOWN + 1.0)
    curves = []
    for hue, version in enumerate(VERSIONS, start=1):
        values = _of_both(runs, name)[hue - 1, :SHOWN]
        curves.append(PanelCurve(f"{word}, {version}", numbers, values, hue, line))
    return curves


def _of_both(runs: PaperRuns, name: str) -> Array:
    """Scalar of all records of both versions, shape (2, n_iterations)."""
    multiscale = [getattr(record, name) for record in runs.multiscale.records]
    monoscale = [getattr(record, name) for record in runs.monoscale.records]
    return np.array([multiscale, monoscale])


def _gain(runs: PaperRuns, name: str, level: float) -> Finding:
    """Finding on the iterations until a quantity falls below a level."""
    first, second = np.argmax(_of_both(runs, name) <= level, axis=1) + 1
    return Finding(
        f"It takes {first} iterations multiscale, {second} monoscale to bring "
        f"{QUANTITIES[name]} below {level:g}: a gain of {second / first:.1f}.",
        bool(second / first >= GAIN),
    )


def _rates(runs: PaperRuns, window: tuple[int, int]) -> Finding:
    """Finding on rates of convergence, fitted to logarithms over a window."""
    start, end = window
    ratios = []
    words = []
    for name, quantity in QUANTITIES.items():
        tails = np.log(_of_both(runs, name)[:, start - 1 : end])
        # The slope of the logarithm is the rate, which no single iteration tells.
        multi, mono = np.polyfit(np.arange(end - start + 1), tails.T, 1)[0]
        ratio = float(multi / mono)
        ratios.append(ratio)
        words.append(f"{ratio:.2f} for {quantity}")
    return Finding(
        f"From iteration {start} to {end}, the rate of convergence multiscale over "
        f"that monoscale is {', '.join(words)}.",
        all(abs(ratio - 1.0) <= EQUAL_RATE for ratio in ratios),
    )


def figure_4(runs: PaperRuns) -> PaperFigure:
    """The friction force after ten iterations at two instants, beside the reference."""
    # The first point is the clamped one.
    law = runs.early[0].problem.friction
    lengths = law.by_point(law.weights)[1:]
    positions = law.positions[1:]
    solutions: list[Fields] = [runs.reference, *runs.early]
    force = np.array([fields.contact_force[1:] for fields in solutions])
    displacement = np.array([fields.displacement[1:] for fields in solutions])
    instants = runs.early[0].problem.instants
    panels = []
    for time in INSTANTS:
        instant = int(np.abs(instants - time).argmin())
        at_instant = force[..., instant] / lengths
        panels.append(_forces_at(time, positions, at_instant))
    early = int(np.abs(instants - INSTANTS[0]).argmin())
    # Lengths turn sums over nodes into integrals: L2 of u, and of f per length.
    root = np.sqrt(lengths)
    return paper_figure(
        4,
        panels,
        _balance(force[..., early]),
        _distance("the displacement", displacement[..., early] * root),
        _distance("the friction force", force[..., early] / root),
        early=EARLY,
    )


def _forces_at(time: float, positions: Array, forces: Array) -> Panel:
    """Panel of the friction force of the reference and both versions at a time, s.

    Positions have shape (n_points,), m, and forces (3, n_points), N/m.
    """
    curves = []
    for hue, label in enumerate(("reference", *VERSIONS)):
        curves.append(PanelCurve(label, positions, forces[hue], hue))
    y = PanelAxis("Friction force per length", "N/m")
    return Panel(f"t = {time:g} s", PLACE, y, tuple(curves))


def _balance(forces: Array) -> Finding:
    """Finding on the sum of the friction force along the bar, which no load balances.

    The forces are those of the reference and both versions, shape (3, n_points), N.
    """
    totals = forces.sum(axis=1)
    size = float(np.abs(forces[0]).sum())
    words = []
    for label, total in zip(("reference", *VERSIONS), totals, strict=True):
        words.append(f"{round(total, 1) + 0.0:.1f} N {label}")
    multi, mono = np.abs(totals[1:] - totals[0])
    return Finding(
        f"Friction force added up along the bar at t = 0.5 s: {', '.join(words)}; "
        f"its size adds up to {size:.0f} N.",
        bool(multi <= 0.01 * size <= mono),
    )


def _distance(words: str, solutions: Array) -> Finding:
    """Finding on the distances of both versions to the reference at t = 0.5 s.

    The fields of the reference and both versions, shape (3, n_points), have the weights
    of L2 along the bar.
    """
    apart = np.linalg.norm(solutions - solutions[0], axis=1)
    multi, mono = apart[1:] / np.linalg.norm(solutions[0])
    return Finding(
        f"Error of {words} at t = 0.5 s: {100.0 * multi:.0f} % multiscale, "
        f"{100.0 * mono:.0f} % monoscale.",
        bool(mono >= GAIN * multi),
    )


def figure_5(runs: PaperRuns) -> PaperFigure:
    """Singular values of the friction force in every substructure."""
    parts = runs.friction_forces
    largest = max(part.values[0] for part in parts)
    noise = runs.noise
    orders = np.arange(1.0, len(parts[-1].values) + 1.0)
    curves = []
    for number, part in enumerate(parts, start=1):
        label = f"substructure {number}"
        shares = part.values / largest
        curves.append(PanelCurve(label, orders, shares, number, "points"))
    front = PanelCurve("1/(2n − 1)", orders, front_decay(len(orders)), 0, "dotted")
    level = np.full(len(orders), noise)
    error = PanelCurve("error of the solution", orders, level, 0, "dashed")
    whole = _singular_values(
        "All, numbered from the clamp", (1e-11, 3.0), [*curves, front, error]
    )
    swept = _singular_values(
        "Those that the front sweeps", (1e-2, 1.5), [*curves[2:], front]
    )
    counts = _mode_counts(parts, noise * largest)
    return paper_figure(5, [whole, swept], counts, noise=noise)


def _singular_values(
    title: str, limits: tuple[float, float], curves: list[PanelCurve]
) -> Panel:
    """Panel of singular values over the number of the mode."""
    share = PanelAxis("Singular value / largest", logarithmic=True, limits=limits)
    return Panel(title, PanelAxis("Mode n", whole=True), share, tuple(curves))


def _mode_counts(parts: Sequence[Decomposition], noise: float) -> Finding:
    """Finding on the number of modes by substructure.

    A field below the error of the solution, `noise`, counts as zero.
    """
    words = []
    one_percent = []
    for number, part in enumerate(parts, start=1):
        counts = [0] * len(SHARES)
        if part.values[0] > noise:
            counts = [part.modes_for(share) for share in SHARES]
        words.append(f"{'/'.join(map(str, counts))} in substructure {number}")
        one_percent.append(counts[1])
    return Finding(
        "Modes that leave at most 10/1/0.1 % of a substructure's friction force: "
        f"{', '.join(words)}. All would be {len(parts[0].values)}.",
        3 * max(one_percent[:2]) <= min(one_percent[2:]),
    )


def figure_6(runs: PaperRuns) -> PaperFigure:
    """The friction force's space modes 1, 3 and 5 in substructures 4 and 5."""
    fourth, fifth = runs.friction_forces[3:]
    alike = fourth.correlations(fifth.space_modes)
    # The sign of a mode is arbitrary.
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
    """Finding on the number of sign changes along modes 1, 3, 5: how local they are."""
    counts = []
    for part in parts:
        changes = np.diff(np.sign(part.space_modes[:, :5:2]), axis=0)
        counts.append(np.count_nonzero(changes, axis=0).tolist())
    words = " and ".join(", ".join(map(str, row)) for row in counts)
    return Finding(
        f"Modes 1, 3, 5 change sign {words} times (substructures 4 and 5): "
        "later modes are more local.",
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
    of_displacement = displacement.modes_for(0.01)
    of_force = force.modes_for(0.01)
    reducible = Finding(
        f"The first 1, 2, 3 modes leave {100.0 * left[1]:.1f} %, "
        f"{100.0 * left[2]:.2f} %, {100.0 * left[3]:.2f} % of the displacement; 1 % "
        f"takes {of_displacement} modes, where the friction force takes {of_force} of "
        f"its {len(force.values)}.",
        bool(left[3] <= 0.01),
    )
    panel = Panel("SVD of the converged displacement", PLACE, MODE, curves)
    return paper_figure(7, [panel], reducible)


def figure_8(runs: PaperRuns) -> PaperFigure:
    """The first three displacement modes of the PGD in substructure 5."""
    exact = runs.displacements[-1]
    last = runs.five_reduced.iterate
    rows = last.problem.substructures[-1].rows
    rubs = np.isin(rows, last.problem.friction.tangent.above)
    kept = last.bases[-1].displacement_modes[rubs, :3]
    root = np.sqrt(exact.space_weights)[:, None]
    orthonormal = np.linalg.qr(kept * root)[0] / root
    both = {
        "orthonormalised in order": orthonormal,
        "as the iteration keeps them": kept,
    }
    panels = []
    findings = []
    for how, modes in both.items():
        curves = tuple(_beside_svd(exact, modes))
        panels.append(Panel(f"PGD modes, {how}", PLACE, MODE, curves))
        words = f"of PGD with SVD modes 1, 2, 3, {how}"
        findings.append(_correlation(words, exact.correlations(modes)))
    return paper_figure(8, panels, *findings, last=last.number)


def _beside_svd(exact: Decomposition, modes: Array) -> list[PanelCurve]:
    """Curves of modes, (n_points, n_modes), and of the SVD modes (dotted).

    The modes are normalised, with the signs of the SVD modes.
    """
    # The sign of a mode is arbitrary.
    signs = np.sign(exact.correlations(modes))
    turned = modes * signs / np.sqrt(exact.space_weights @ modes**2)
    positions = exact.positions
    curves = []
    for order, pgd in enumerate(turned.T, start=1):
        svd = exact.space_modes[:, order - 1]
        curves.append(PanelCurve(f"PGD {order}", positions, pgd, order))
        curves.append(PanelCurve(f"SVD {order}", positions, svd, order, "dotted"))
    return curves


def _correlation(words: str, signed: Array) -> Finding:
    """Finding on the correlations of modes of the same order, shape (n_modes,)."""
    values = np.abs(signed)
    shown = ", ".join(f"{value:.3f}" for value in values)
    return Finding(f"Correlation {words}: {shown}.", bool(values.min() >= ALIKE))
