"""The numbers that test what the paper says of its Figs. 3 to 8.

The paper's words name no limits, so those from which a claim counts as borne out are set here, and
a finding's sentence gives the number itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from solver.arrays import Array
from solver.latin import Record
from solver.reduction.svd import Decomposition, against_front
from solver.reference.distance import Fields
from solver.study.figures.figure_data import Finding
from solver.study.figures.paper_runs import EARLY, PaperRun

GAIN = 2.0
"""Factor from which the multiscale version counts as much better."""
EQUAL_RATE = 0.2
"""Relative difference up to which two rates of convergence count as equal."""
ALIKE = 0.9
"""Correlation from which two modes count as alike."""
SHARES = (0.1, 0.01, 0.001)
"""Errors for which modes are counted."""
QUANTITIES = {
    "indicator": "η",
    "error_displacement": "the error of the displacement",
    "error_force": "the error of the friction force",
}


def column(records: Sequence[Record], name: str) -> Array:
    """Give one scalar of all records, shape (n_iterations,)."""
    return np.array([getattr(entry, name) for entry in records])


def gain(multi: Sequence[Record], mono: Sequence[Record], name: str, level: float) -> Finding:
    """Count the iterations until a quantity passes a level."""
    first, second = (
        next(entry.iteration for entry in records if getattr(entry, name) <= level)
        for records in (multi, mono)
    )
    return Finding(
        f"It takes {first} iterations multiscale, {second} monoscale to bring {QUANTITIES[name]} "
        f"below {level:g}: a gain of {second / first:.1f}.",
        {f"{name}_multi": first, f"{name}_mono": second},
        second / first >= GAIN,
    )


def first_iterations(multi: Sequence[Record], mono: Sequence[Record]) -> Finding:
    """Compare the indicator, and what it does not see, after the first iterations."""
    one, other = multi[EARLY - 1], mono[EARLY - 1]
    return Finding(
        f"After {EARLY} iterations η hardly tells the two apart ({one.indicator:.1e} multiscale, "
        f"{other.indicator:.1e} monoscale), while the displacement is {one.error_displacement:.0%} "
        f"and {other.error_displacement:.0%} wrong.",
        {
            "early_indicator_multi": one.indicator,
            "early_indicator_mono": other.indicator,
            "early_error_displacement_multi": one.error_displacement,
            "early_error_displacement_mono": other.error_displacement,
        },
        other.indicator >= GAIN * one.indicator,
    )


def rates(
    multi: Sequence[Record],
    mono: Sequence[Record],
    window: tuple[int, int],
    names: Sequence[str] = tuple(QUANTITIES),
) -> Finding:
    """Compare the rates of convergence, fitted to logarithms over a window of iterations."""
    ratios = {name: _slope(multi, name, window) / _slope(mono, name, window) for name in names}
    words = ", ".join(f"{ratio:.2f} for {QUANTITIES[name]}" for name, ratio in ratios.items())
    start, end = window
    return Finding(
        f"From iteration {start} to {end}, the rate of convergence multiscale over that monoscale "
        f"is {words}.",
        {f"rate_{start}_{end}_{name}": ratio for name, ratio in ratios.items()},
        all(abs(ratio - 1.0) <= EQUAL_RATE for ratio in ratios.values()),
    )


def balance(solutions: Mapping[str, Fields], moment: int) -> Finding:
    """Add up the friction force along the bar, which a load of zero must find balanced."""
    totals = {
        label: float(fields.contact_force[1:, moment].sum()) for label, fields in solutions.items()
    }
    exact = totals["reference"]
    size = float(np.abs(solutions["reference"].contact_force[1:, moment]).sum())
    words = ", ".join(f"{round(total, 1) + 0.0:.1f} N {label}" for label, total in totals.items())
    return Finding(
        f"Friction force added up along the bar at t = 0.5 s: {words}; its size adds up to "
        f"{size:.0f} N.",
        {f"total_{label}": total for label, total in totals.items()} | {"size": size},
        abs(totals["multiscale"] - exact) <= 0.01 * size <= abs(totals["monoscale"] - exact),
    )


def distances(
    name: str, words: str, solutions: Mapping[str, Array], moments: Mapping[float, int]
) -> Finding:
    """Compare distances to the reference along the bar.

    Parameters
    ----------
    name, words
        What is compared.
    solutions
        Fields by label, shape (n_points, n_instants), weighted for L2 along the bar.
    moments
        Index of every instant compared, by its time, s.
    """
    values: dict[str, float] = {}
    sentences = []
    exact = solutions["reference"]
    for instant, moment in moments.items():
        size = np.linalg.norm(exact[:, moment])
        multi, mono = (
            float(np.linalg.norm((solutions[label] - exact)[:, moment]) / size)
            for label in ("multiscale", "monoscale")
        )
        values |= {f"{name}_multi_{instant:g}": multi, f"{name}_mono_{instant:g}": mono}
        sentences.append(f"{multi:.0%} multiscale, {mono:.0%} monoscale at t = {instant:g} s")
    held = all(
        values[f"{name}_mono_{instant:g}"] >= GAIN * values[f"{name}_multi_{instant:g}"]
        for instant in moments
    )
    return Finding(f"Error of {words}: {'; '.join(sentences)}.", values, held)


def mode_counts(found: Sequence[Decomposition], noise: float) -> Finding:
    """Count modes per substructure; a field below the solution's error counts as zero."""
    largest = max(each.values[0] for each in found)
    counts = [
        [each.modes_for(share) if each.values[0] > noise * largest else 0 for share in SHARES]
        for each in found
    ]
    words = ", ".join(
        f"{'/'.join(map(str, row))} in substructure {number}"
        for number, row in enumerate(counts, start=1)
    )
    names = [f"{share:g}" for share in SHARES]
    one_percent = [row[1] for row in counts]
    return Finding(
        f"Modes that leave at most 10/1/0.1 % of a substructure's friction force: {words}. All "
        f"would be {len(found[0].values)}.",
        {
            f"modes_{number}_{name}": count
            for number, row in enumerate(counts, start=1)
            for name, count in zip(names, row, strict=True)
        },
        3 * max(one_percent[:2]) <= min(one_percent[2:]),
    )


def decay(found: Sequence[Decomposition]) -> Finding:
    """Compare the fifth singular value of every substructure with the largest of all."""
    largest = max(each.values[0] for each in found)
    shares = [float(each.values[4] / largest) for each in found]
    words = ", ".join(f"{share:.1g}" for share in shares)
    return Finding(
        f"Fifth singular value over the largest of all, substructures 1 to 5: {words}.",
        {f"fifth_{number}": share for number, share in enumerate(shares, start=1)},
        1000.0 * max(shares[:2]) <= min(shares[2:]),
    )


def as_a_front(found: Sequence[Decomposition]) -> Finding:
    """Compare the decay in the swept substructures with that of a constant-speed front."""
    ratios = np.array([against_front(each.values)[:5] for each in found])
    low, high = float(ratios.min()), float(ratios.max())
    return Finding(
        f"In substructures 3 to 5 the singular values 1 to 5, over the first, are {low:.2f} to "
        f"{high:.2f} times 1/(2n − 1), that of a front of constant speed.",
        {"front_low": low, "front_high": high},
        low >= 0.5 and high <= 1.5,
    )


def likeness(one: Decomposition, other: Decomposition, pair: tuple[int, int]) -> Finding:
    """Correlate the modes 1, 3, 5 of two substructures of the same size."""
    found = np.abs(one.correlations(other.space_modes))
    values = {order: float(found[order - 1]) for order in (1, 3, 5)}
    words = ", ".join(f"{value:.3f}" for value in values.values())
    return Finding(
        f"Correlation of modes 1, 3, 5 of substructures {pair[0]} and {pair[1]}: {words}.",
        {f"likeness_{pair[0]}_{pair[1]}_{order}": value for order, value in values.items()},
        min(values.values()) >= ALIKE,
    )


def sign_changes(one: Decomposition, other: Decomposition) -> Finding:
    """Count the sign changes along modes 1, 3, 5: how local they are."""
    counts = [
        [int(np.count_nonzero(np.diff(np.sign(each.space_modes[:, order])))) for order in (0, 2, 4)]
        for each in (one, other)
    ]
    words = " and ".join(", ".join(map(str, row)) for row in counts)
    return Finding(
        f"Modes 1, 3, 5 change sign {words} times (substructures 4 and 5): later modes are more "
        "local.",
        {
            f"sign_changes_{number}_{order}": count
            for number, row in zip((4, 5), counts, strict=True)
            for order, count in zip((1, 3, 5), row, strict=True)
        },
        all(row[0] < row[1] < row[2] for row in counts),
    )


def rank_errors(displacement: Decomposition, force: Decomposition) -> Finding:
    """Give what the first modes leave of the displacement, and what the friction force takes."""
    left = {rank: float(displacement.errors[rank]) for rank in (1, 2, 3)}
    counts = displacement.modes_for(0.01), force.modes_for(0.01)
    return Finding(
        f"The first 1, 2, 3 modes leave {left[1]:.1%}, {left[2]:.2%}, {left[3]:.2%} of the "
        f"displacement; 1 % takes {counts[0]} modes, where the friction force takes {counts[1]} of "
        f"its {len(force.values)}.",
        {f"left_by_{rank}": share for rank, share in left.items()}
        | {"modes_displacement": counts[0], "modes_force": counts[1]},
        left[3] <= 0.01,
    )


def correlation(exact: Decomposition, modes: Array, name: str, words: str) -> Finding:
    """Correlate modes, shape (n_points, n), with the SVD modes of the same place in the order."""
    values = np.abs(exact.correlations(modes))
    shown = ", ".join(f"{value:.3f}" for value in values)
    return Finding(
        f"Correlation of PGD with SVD modes 1, 2, 3, {words}: {shown}.",
        {f"{name}_{order}": float(value) for order, value in enumerate(values, start=1)},
        bool(values.min() >= ALIKE),
    )


def reduced_errors(run: PaperRun, displacement: Decomposition, force: Decomposition) -> Finding:
    """Give the size of the bases, and what they miss, at the end of a run with PGD.

    The decompositions are those of the last substructure, to compare its basis with.
    """
    last = run.records[-1]
    modes = [each.n_modes for each in run.last.bases]
    best, best_force = (
        "/".join(str(each.modes_for(share)) for share in SHARES) for each in (displacement, force)
    )
    return Finding(
        f"The PGD keeps {', '.join(map(str, modes))} modes in substructures 1 to {len(modes)}; the "
        f"displacement is then {last.error_displacement:.1%} wrong, the friction force "
        f"{last.error_force:.1%}. In substructure {len(modes)} an SVD takes {best} modes for "
        f"10/1/0.1 % of the displacement alone, {best_force} for the friction force alone.",
        {
            "largest_basis": max(modes),
            "error_displacement": last.error_displacement,
            "error_force": last.error_force,
        },
        last.error_displacement <= 0.01,
    )


def _slope(records: Sequence[Record], name: str, window: tuple[int, int]) -> float:
    start, end = window
    values = np.log(column(records, name)[start - 1 : end])
    return float(np.polyfit(np.arange(len(values)), values, 1)[0])
