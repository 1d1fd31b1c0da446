"""Fit of settings to a measured loop, with margins.

    fitted = fit(settings, measured, ["friction", "contact_stiffness"])

The differences of `solver.study.measured_loop` are minimised in the sum of their
squares, over z: the logarithm of a setting over its start, where the setting is
positive and spans decades, else its change over its size. From the best of some values
of each setting alone a trust-region method (SciPy's `least_squares`) continues within
their bounds; every run starts from the states of the run before. Then the valley is
followed along its weakest direction, both ways, and along each setting: where a run is
nearer, the method continues from there.

The profile likelihood of a setting shows how well the loop determines it
(`solver.study.profile_likelihood`): beyond its two ends no run is as near, whatever the
other settings are, by two standard errors of the noise. A setting is not determined if
its ends are farther away than a factor of 1.5. It stays as near to its start as the
loop allows. A combination of such settings may still be determined: a product of
powers, across the direction of the valley, with the margin of its own profile.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr

from solver.arrays import Array, Flags
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.compared_runs import ComparedRun, ComparedRuns
from solver.study.fitted_settings import fittable
from solver.study.measured_loop import MeasuredLoop
from solver.study.profile_likelihood import LIMIT, LikelihoodProfile
from solver.study.valley import BROAD, SILENT, WALK, LowerPlace, Valley

MOST = 4
"""Largest number of settings that are fitted at once."""
LOOSE = 1e-4
"""First pull towards the start: settings that are not determined do not drift."""
SHARE = 0.1
"""Power below which a setting has no part in a combination."""
NEAR = 0.02
"""Difference from a tenth below which a power is rounded to it."""
ROUNDS = 8
"""Largest number of searches, each from a lower place than the one before."""
WEAKER = 0.1
"""Factor on the pull to the start after it has pulled a run too far from the loop."""
PULLS = 4
"""Number of pulls that are tried."""


@dataclass(frozen=True)
class Combination:
    """A product of powers of settings, determined although the settings are not.

    Attributes
    ----------
    powers
        Powers of the settings by name.
    value, lower, upper
        The product in SI, and its values at two standard errors; NaN where some setting
        has no logarithm.
    factor
        Factor on each setting within which the combination holds: farther away the
        valley may bend.
    """

    powers: dict[str, float]
    value: float
    lower: float
    upper: float
    factor: float

    @property
    def error(self) -> float:
        """Relative standard error: half the distance to the farther end."""
        farther = max(self.upper - self.value, self.value - self.lower)
        return farther / (2.0 * self.value)


@dataclass(frozen=True, eq=False)
class Fit:
    """Settings fitted to a loop, with their margins, and the runs at start and end.

    Attributes
    ----------
    settings
        Settings of the nearest run.
    names
        Names of the p settings that were fitted.
    lower, upper
        Values of the fitted settings at two standard errors, shape (p,), in SI;
        infinite where the loop sets no limit.
    correlation
        Correlation of the values, shape (p, p); NaN where it is not known.
    together
        Known combinations of settings that are not known by themselves.
    for_the_mesh
        Whether a setting would be known if the mesh were exact, shape (p,).
    mesh
        Change of the loop on elements of half the size, as a share of the measured
        range.
    first, nearest
        Run at the start, and the nearest run.
    runs
        Number of runs.
    """

    settings: Settings
    names: tuple[str, ...]
    lower: Array
    upper: Array
    correlation: Array
    together: list[Combination]
    for_the_mesh: Flags
    mesh: float
    first: ComparedRun
    nearest: ComparedRun
    runs: int

    @property
    def errors(self) -> Array:
        """Standard errors, shape (p,), in SI: half the distance to the farther end.

        Infinite where an end is open.
        """
        values = self.nearest.values
        farther = np.maximum(self.upper - values, values - self.lower)
        return np.asarray(farther / 2.0)


def fit(
    settings: Settings,
    measured: MeasuredLoop,
    names: Sequence[str],
    watch: Callable[[int, ComparedRun], object] = lambda runs, nearest: None,
) -> Fit:
    """Find the settings whose run is nearest to a measured loop.

    Parameters
    ----------
    settings
        Settings at which the fit begins.
    measured
        The measured loop.
    names
        Names of one to four settings that are fitted.
    watch
        Called after each run with the number of runs so far, and the nearest one.

    Raises
    ------
    RefusedError
        For settings that cannot be fitted, a loop that is none of this scene or too
        short, and a first run that does not converge.
    """
    if not 1 <= len(set(names)) == len(names) <= MOST:
        can = f"one to {MOST} settings, each once, of {', '.join(fittable(settings))}"
        raise SettingError("fitted settings", ",".join(names), can, "name these")
    runs = ComparedRuns(settings, measured, names, watch)
    _check_rows(runs, measured)
    valley, profiles = _explored(runs)
    is_known = np.array([profile.is_known for profile in profiles])
    blind = _blind(valley, is_known)
    ends = np.array([profile.ends() for profile in profiles]).T
    z = _near_start(valley, blind, ends)
    lower, upper = _margins(valley, ends)
    return Fit(
        settings=settings.replace(**runs.scales.changes(z)),
        names=runs.scales.names,
        lower=lower,
        upper=upper,
        correlation=_correlation(runs.jacobian(z, BROAD), blind, is_known),
        together=_known_combinations(valley, z, blind, is_known),
        for_the_mesh=~is_known & [profile.is_known_to_noise for profile in profiles],
        mesh=valley.mesh,
        first=runs.first,
        nearest=runs.run(z),
        runs=runs.count,
    )


def _check_rows(runs: ComparedRuns, measured: MeasuredLoop) -> None:
    """Refuse a loop with fewer rows during the run than settings need."""
    rows = len(runs.first.differences)
    count = len(runs.scales.names)
    if rows <= count + 1:
        can = f"at least {count + 2} rows for {count} settings"
        remedy = f"{rows} are in the run"
        raise SettingError("the measured loop", measured.source, can, remedy)


def _explored(runs: ComparedRuns) -> tuple[Valley, list[LikelihoodProfile]]:
    """Valley of the nearest run, and the profiles of all settings."""
    settings = np.eye(len(runs.scales.names))
    # A slight pull, so that the least squares have one solution.
    z = runs.solve(runs.coarse(), LOOSE * settings)
    # The last round seeks no lower place, so that it ends.
    for rest in reversed(range(ROUNDS)):
        valley = Valley(runs, z, seeks=rest > 0)
        try:
            valley.walk()
            return valley, valley.profiles(settings)
        except LowerPlace as lower:
            z = runs.solve(lower.z, LOOSE * settings)
    raise AssertionError("the last round seeks no lower place")


def _blind(valley: Valley, is_known: Flags) -> Array:
    """Directions without a limit in a valley, orthonormal, shape (n, p).

    `is_known`, (p,), says which settings are known.
    """
    if is_known.all():
        return np.empty((0, len(is_known)))
    moves = valley.moves
    # Farther away a valley may bend, which makes it no wider.
    moves = moves[np.abs(moves).max(axis=1) <= LIMIT * (1.0 + SILENT)]
    # A known setting moves a little with the rest, but is no part of a direction.
    moves[:, is_known] = 0.0
    # The directions of the moves, the widest first.
    directions = np.linalg.svd(moves)[2]
    distances = np.abs(moves @ directions.T).max(axis=0)
    return np.asarray(directions[distances > LIMIT / 2.0])


def _near_start(valley: Valley, blind: Array, ends: Array) -> Array:
    """Point z, (p,), on the floor of a valley, nearest to the start z = 0.

    The place moves along the directions `blind`, (n, p), in which the valley continues,
    and in no setting beyond the ends below and above of its profile, (2, p).
    """
    runs = valley.runs
    below, above = ends
    # The pull is as strong as the loop is, so that it decides where the loop does not.
    pull = max(float(np.linalg.norm(valley.jacobian, 2)), 1.0) * blind
    for _ in range(PULLS):
        z = runs.solve(valley.z, pull)
        is_near = runs.misfit(z) - valley.minimum <= valley.doubt / 4.0
        moves = z - valley.z
        is_within = ((-below <= moves) & (moves <= above)).all()
        if not len(blind) or (is_near and is_within):
            return z
        pull = WEAKER * pull
    return valley.z


def _margins(valley: Valley, ends: Array) -> tuple[Array, Array]:
    """Lower and upper values of settings, (p,) each, in SI, by ends in z, (2, p)."""
    below, above = ends
    with np.errstate(invalid="ignore"):
        lower = valley.runs.scales.values(valley.z - below)
        upper = valley.runs.scales.values(valley.z + above)
    return (
        np.where(np.isfinite(below), lower, -np.inf),
        np.where(np.isfinite(above), upper, np.inf),
    )


def _known_combinations(
    valley: Valley, z: Array, blind: Array, is_known: Flags
) -> list[Combination]:
    """Determined combinations around z, in a wide box or else in a smaller one.

    Parameters
    ----------
    valley
        Valley of the nearest run.
    z
        Place on its floor, shape (p,).
    blind
        Directions in which the valley continues, shape (n, p).
    is_known
        Whether a setting is known by itself, shape (p,).
    """
    if not 0 < len(blind) < (~is_known).sum():
        return []
    # A wide box shows more; where the floor bends in it, a smaller one may not.
    for distance in (WALK, LIMIT):
        around = valley.around(z, distance)
        combinations = _combinations(around, distance, blind, is_known)
        if combinations:
            return combinations
    return []


def _combinations(
    valley: Valley, distance: float, blind: Array, is_known: Flags
) -> list[Combination]:
    """Determined combinations of undetermined settings, up to a distance in z.

    `blind`, (n, p), are the directions in which the valley continues, and `is_known`,
    (p,), says which settings are known.
    """
    is_open = np.flatnonzero(~is_known)
    floor = [*blind]
    if len(blind) > 1:
        floor += [*np.eye(len(is_known))[is_open]]
    # Each profile adds to the moves of the valley.
    for along in floor:
        valley.profile(along, distance)
    moves = valley.moves
    directions = np.linalg.svd(moves[:, is_open])[2]
    combinations = []
    for row in _echelon(directions[len(blind) :]):
        powers = np.zeros(len(is_known))
        powers[is_open] = row
        if np.count_nonzero(powers) == 1:
            # The profile of that setting alone has shown that it is not known.
            continue
        combination = _combination(valley, distance, moves, powers)
        if combination is not None:
            combinations.append(combination)
    return combinations


def _combination(
    valley: Valley, distance: float, moves: Array, powers: Array
) -> Combination | None:
    """A combination of powers, (p,), if moves on the floor, (n, p), determine it."""
    profile = valley.profile(powers)
    # A floor is bent, and no product of powers is the same all along it.
    along = moves @ powers
    below, above = profile.ends()
    # What the bend of the floor adds widens the margin to both sides.
    below -= float(along.min())
    above += float(along.max())
    if max(below, above) >= LIMIT:
        return None
    runs = valley.runs
    parts = np.flatnonzero(powers)
    value = math.nan
    if runs.scales.in_decades[parts].all():
        value = float(np.prod(runs.scales.values(valley.z) ** powers))
    return Combination(
        powers={runs.scales.names[part]: float(powers[part]) for part in parts},
        value=value,
        lower=value * math.exp(-below),
        upper=value * math.exp(above),
        factor=math.exp(distance),
    )


def _correlation(jacobian: Array, blind: Array, is_known: Flags) -> Array:
    """Correlation of the determined settings, shape (p, p); NaN of others.

    Parameters
    ----------
    jacobian
        Derivatives of the differences, shape (n_rows, p).
    blind
        Directions in which the valley continues, shape (n, p): they have no variance.
    is_known
        Whether a setting is known, shape (p,).
    """
    # Directions without an end have no variance, and are taken out first.
    known = np.eye(len(is_known))
    if len(blind):
        known = null_space(blind)
    precision = known.T @ jacobian.T @ jacobian @ known
    covariance = known @ np.linalg.pinv(precision) @ known.T
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(deviations, deviations)
    # Up to rounding it is so already.
    correlation = np.clip(correlation, -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    are_both_known = np.outer(is_known, is_known)
    return np.asarray(np.where(are_both_known, correlation, np.nan))


def _echelon(rows: Array) -> Array:
    """Reduced row echelon form of rows, shape (n, p), rounded.

    Each row has 1 in a column in which all other rows have 0.
    """
    # Pivoting finds the columns in which the rows differ most.
    pivots = np.sort(qr(rows, mode="r", pivoting=True)[1][: len(rows)])
    # A product of few powers is read more easily than an orthonormal row.
    reduced = np.linalg.solve(rows[:, pivots], rows)
    tenths = np.round(reduced, 1)
    rounded = np.where(np.abs(reduced - tenths) < NEAR, tenths, np.round(reduced, 2))
    return np.asarray(np.where(np.abs(reduced) < SHARE, 0.0, rounded))
