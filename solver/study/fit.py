"""Settings under which a run comes nearest to a measured loop, and what the loop cannot tell.

    fitted = fit(settings, measured, ["friction", "contact_stiffness"])

The differences of `solver.study.measured_loop` are minimised in the sum of their squares, over z:
the logarithm of a setting over its start, where it is positive and spans decades, else its change
over its size. From the best of some values of each setting alone a trust-region method (SciPy's
`least_squares`) goes on within their bounds; every run starts from what stuck and slipped in the
one before. With J = dr/dz, n rows, p settings and s^2 = |r|^2 / (n - p),

    standard errors = sqrt(diag(s^2 (J^T J)^-1)).

A direction of z is not determined if its standard error s / (singular value of J) is above a fifth,
as where a change of 20 % would be lost in the noise. It stays where it began.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr

from solver.arrays import Array, Flags
from solver.definitions import SettingError
from solver.settings import Settings
from solver.study.compared_runs import ComparedRun, ComparedRuns, fittable
from solver.study.measured_loop import MeasuredLoop

MOST = 4
"""Settings that are fitted at once."""
NARROW, WIDE = 1e-5, 0.1
"""Steps, in z, of the differences by which it is judged what the loop tells. Over a narrow one the
nodes that a front has just reached count for more than the loop (friction and young of a bar, of
which only the product is known: singular values 4.5 and 0.12, instead of 0.006); over a wide one a
combination that is no product seems to be known."""
LOOSE = 1e-4
"""Pull towards the start at first, so that what is not determined does not drift."""
UNSURE = 0.2
"""Standard error of a direction, in z, from which on it is not determined."""
FLAT, RIGID, EXACT, BLIND = 0.02, 1e-4, 1e-6, 1e-6
"""Singular values below which a direction is not determined: over the largest one, since meshes
tell no more, or, where the run is as near as `EXACT`, since differences do not; and at all."""
SHARE = 0.1
"""Part in a direction that is not determined from which on a setting is not known alone."""
ROUNDS = 3
"""Of the least squares: with a loose pull, then with what is determined free, as often as that
changes."""


@dataclass(frozen=True, eq=False)
class Fit:
    """What a loop tells of some settings: those of the nearest run, and the runs at start and end.

    Attributes
    ----------
    errors
        Standard errors of the p settings that were fitted, shape (p,); infinite where the loop does
        not tell a value alone.
    correlation
        Of the values, shape (p, p); NaN where there is none.
    together
        Combinations that are known of settings that are not: powers of settings by name, and the
        standard error of the logarithm of their product; NaN where some are not logarithmic.
    """

    settings: Settings
    names: tuple[str, ...]
    errors: Array
    correlation: Array
    together: list[tuple[dict[str, float], float]]
    first: ComparedRun
    nearest: ComparedRun
    runs: int


def fit(
    settings: Settings,
    measured: MeasuredLoop,
    names: Sequence[str],
    watch: Callable[[int, ComparedRun], object] = lambda runs, nearest: None,
) -> Fit:
    """Find the settings under which a run comes nearest to a measured loop.

    It begins at the settings; of these one to four are fitted. `watch` is called after each run
    with how many there were, and the nearest one.

    Raises
    ------
    RefusedError
        For settings that cannot be fitted, a loop that is none of this scene or too short, and a
        first run that does not converge.
    """
    if not 1 <= len(set(names)) == len(names) <= MOST:
        can = f"one to {MOST} settings, each once, of {', '.join(fittable(settings))}"
        raise SettingError("fitted settings", ",".join(names), can, "name these")
    runs = ComparedRuns(settings, measured, names, watch)
    rows, count = len(runs.first.differences), len(names)
    if rows <= count + 1:
        can = f"at least {count + 2} rows for {count} settings"
        raise SettingError("the measured loop", measured.source, can, f"{rows} are in the run")
    z, pull, blind = runs.coarse(), LOOSE * np.eye(count), 0
    for _ in range(ROUNDS):
        z = runs.solve(z, pull)
        left = float(np.linalg.norm(runs.differences(z)))
        noise = left / math.sqrt(rows - count + blind)
        tried = [np.linalg.svd(runs.jacobian(z, step)) for step in (NARROW, WIDE)]
        _, sizes, ways = min(tried, key=lambda found: float(found.S[-1]))
        flat = FLAT if noise > EXACT else RIGID
        least = max(noise / UNSURE, BLIND, flat * float(sizes[0]))
        is_known = sizes > least
        is_done, blind = blind == (~is_known).sum(), int((~is_known).sum())
        if is_done:
            break
        pull = max(float(sizes[0]), 1.0) * ways[~is_known]
    covariance = (ways[is_known].T * (noise / sizes[is_known]) ** 2) @ ways[is_known]
    return _fitted(runs, settings, z, covariance, ways[~is_known])


def _fitted(
    runs: ComparedRuns, settings: Settings, z: Array, covariance: Array, blind: Array
) -> Fit:
    """What is found at a place, where some directions, (n, p), are not determined."""
    nearest = runs.run(z)
    slopes = runs.slopes(nearest.values)
    deviations = np.sqrt(np.diag(covariance))
    is_alone = np.abs(blind).max(axis=0, initial=0.0) < SHARE
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(deviations, deviations)
    correlation[~np.outer(is_alone, is_alone)] = np.nan
    return Fit(
        settings=settings.replace(**runs.changes(z)),
        names=runs.names,
        errors=np.where(is_alone, np.abs(slopes) * deviations, np.inf),
        correlation=correlation,
        together=_known_together(runs, covariance, blind[:, ~is_alone], is_alone),
        first=runs.first,
        nearest=nearest,
        runs=runs.count,
    )


def _known_together(
    runs: ComparedRuns, covariance: Array, blind: Array, is_alone: Flags
) -> list[tuple[dict[str, float], float]]:
    """Combinations that are determined of settings that are not, as `Fit` has them."""
    names = [name for name, alone in zip(runs.names, is_alone, strict=True) if not alone]
    covariance = covariance[np.ix_(~is_alone, ~is_alone)]
    is_product = bool(runs.in_decades[~is_alone].all())
    together = []
    known = null_space(blind).T if len(blind) else blind
    for powers in _echelon(known) if known.size else ():
        margin = math.sqrt(powers @ covariance @ powers) if is_product else math.nan
        together.append(({n: float(p) for n, p in zip(names, powers, strict=True) if p}, margin))
    return together


def _echelon(rows: Array) -> Array:
    """The same space by rows of which each has 1 where no other has anything; to a digit."""
    pivots = np.sort(qr(rows, mode="r", pivoting=True)[1][: len(rows)])
    reduced = np.linalg.solve(rows[:, pivots], rows)
    return np.where(np.abs(reduced) < SHARE, 0.0, np.round(reduced, 1))
