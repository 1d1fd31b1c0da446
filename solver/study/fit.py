"""Settings under which a run comes nearest to a measured loop, and what the loop cannot tell.

    fitted = fit(settings, measured, ["friction", "contact_stiffness"])

The differences of `solver.study.measured_loop` are minimised in the sum of their
squares, over z: the logarithm of a setting over its start, where it is positive and
spans decades, else its change over its size. From the best of some values of each
setting alone a trust-region method (SciPy's `least_squares`) goes on within their
bounds; every run starts from what stuck and slipped in the one before. Then the valley
is followed along its weakest direction, both ways, and along each setting: where a run
is nearer, the method goes on from there.

What is known of a setting is what its profile says (`solver.study.valley`): the values
beyond which no run is as near, whatever the others are, by two standard errors of the
noise. A setting is not determined if that goes farther than a factor of 1.5. It stays
as near to where it began as the loop allows. What may still be known is a combination
of such settings: a product of powers, across the direction in which the valley goes,
with the margin that its own profile has.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr

from solver.arrays import Array, Flags
from solver.settings.definitions import SettingError
from solver.settings.scene import Settings
from solver.study.compared_runs import ComparedRun, ComparedRuns, fittable
from solver.study.measured_loop import MeasuredLoop
from solver.study.valley import BROAD, LIMIT, SILENT, WALK, LowerPlace, Profile, Valley

MOST = 4
"""Settings that are fitted at once."""
LOOSE = 1e-4
"""Pull towards the start at first, so that what is not determined does not drift."""
SHARE = 0.1
"""Power in a combination below which a setting has no part in it."""
NEAR = 0.02
"""Difference to a tenth below which a power is that."""
ROUNDS = 8
"""How often the method goes on from a lower place, at most."""
WEAKER = 0.1
"""Factor on the pull to the start, as often as it pulls a run too far from the loop."""
PULLS = 4
"""How many pulls are tried."""


@dataclass(frozen=True)
class Combination:
    """A product of powers of settings that is known where they are not.

    Attributes
    ----------
    powers
        Of the settings by name.
    value, lower, upper
        The product in SI, and the ends of what is within two standard errors; NaN where
        some setting has no logarithm.
    factor
        So far from its value each setting is looked at: a product of powers may not be
        what is known farther away.
    """

    powers: dict[str, float]
    value: float
    lower: float
    upper: float
    factor: float

    @property
    def error(self) -> float:
        """Standard error, as a share of the value: half of the distance to the farther end."""
        return max(self.upper - self.value, self.value - self.lower) / (
            2.0 * self.value
        )


@dataclass(frozen=True, eq=False)
class Fit:
    """What a loop tells of some settings: those of the nearest run, and the runs at start and end.

    Attributes
    ----------
    lower, upper
        Ends of what is within two standard errors of the p settings that were fitted,
        shape (p,), in SI; infinite where the loop gives none.
    correlation
        Of the values, shape (p, p); NaN where there is none.
    together
        Combinations that are known of settings that are not.
    for_the_mesh
        Whether a setting would be known if it were not for the mesh, shape (p,).
    mesh
        Change of the loop on elements of half the size, as a share of the measured
        range.
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
        """Standard errors, (p,): half of the distance to the farther end, infinite if open."""
        values = self.nearest.values
        return np.asarray(np.maximum(self.upper - values, values - self.lower) / 2.0)


def fit(
    settings: Settings,
    measured: MeasuredLoop,
    names: Sequence[str],
    watch: Callable[[int, ComparedRun], object] = lambda runs, nearest: None,
) -> Fit:
    """Find the settings under which a run comes nearest to a measured loop.

    It begins at the settings; of these one to four are fitted. `watch` is called after
    each run with how many there were, and the nearest one.

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
    rows = len(runs.first.differences)
    count = len(names)
    if rows <= count + 1:
        can = f"at least {count + 2} rows for {count} settings"
        raise SettingError(
            "the measured loop", measured.source, can, f"{rows} are in the run"
        )
    valley, profiles = _explored(runs)
    is_known = np.array([profile.is_known for profile in profiles])
    blind = _blind(valley, is_known)
    z = _near_start(valley, blind)
    combinations: list[Combination] = []
    for reach in (WALK, LIMIT):
        if not combinations and 0 < len(blind) < (~is_known).sum():
            combinations = _combinations(
                valley.around(z, reach), reach, blind, is_known
            )
    return Fit(
        settings=settings.replace(**runs.changes(z)),
        names=runs.names,
        **_margins(valley, profiles),
        correlation=_correlation(runs.jacobian(z, BROAD), blind, is_known),
        together=combinations,
        for_the_mesh=~is_known & [profile.is_known_to_noise for profile in profiles],
        mesh=valley.mesh,
        first=runs.first,
        nearest=runs.run(z),
        runs=runs.count,
    )


def _explored(runs: ComparedRuns) -> tuple[Valley, list[Profile]]:
    """The valley of the nearest run that is found, and the profiles of all settings there."""
    settings = np.eye(len(runs.names))
    z = runs.solve(runs.coarse(), LOOSE * settings)
    for rest in reversed(range(ROUNDS)):
        valley = Valley(runs, z, seeks=rest > 0)
        try:
            valley.walk()
            return valley, [valley.profile(along) for along in settings]
        except LowerPlace as lower:
            z = runs.solve(lower.z, LOOSE * settings)
    raise AssertionError("the last round seeks no lower place")


def _blind(valley: Valley, is_known: Flags) -> Array:
    """Directions in which a valley goes on, orthonormal, shape (n, p)."""
    if is_known.all():
        return np.empty((0, len(is_known)))
    moves = valley.moves
    # Farther away a valley may bend, which makes it no wider.
    moves = moves[np.abs(moves).max(axis=1) <= LIMIT * (1.0 + SILENT)]
    # What is known moves a little with the rest, which makes it no part of a direction.
    moves[:, is_known] = 0.0
    ways = np.linalg.svd(moves)[2]
    reaches = np.abs(moves @ ways.T).max(axis=0)
    return np.asarray(ways[reaches > LIMIT / 2.0])


def _near_start(valley: Valley, blind: Array) -> Array:
    """Place on the floor of a valley that is nearest to the start, along directions, (n, p)."""
    runs = valley.runs
    pull = max(float(np.linalg.norm(valley.jacobian, 2)), 1.0) * blind
    for _ in range(PULLS):
        z = runs.solve(valley.z, pull)
        if not len(blind) or runs.misfit(z) - valley.least <= valley.doubt / 4.0:
            return z
        pull = WEAKER * pull
    return valley.z


def _margins(valley: Valley, profiles: list[Profile]) -> dict[str, Array]:
    """Lower and upper ends of settings by their profiles, as `Fit` has them."""
    below, above = np.array([profile.ends() for profile in profiles]).T
    with np.errstate(invalid="ignore"):
        lower = valley.runs.values(valley.z - below)
        upper = valley.runs.values(valley.z + above)
    return {
        "lower": np.where(np.isfinite(below), lower, -np.inf),
        "upper": np.where(np.isfinite(above), upper, np.inf),
    }


def _combinations(
    valley: Valley, reach: float, blind: Array, is_known: Flags
) -> list[Combination]:
    """Combinations that are determined of settings that are not, so far around a place."""
    is_open = np.flatnonzero(~is_known)
    floor = [*blind]
    if len(blind) > 1:
        floor += [*np.eye(len(is_known))[is_open]]
    for along in floor:
        valley.profile(along, reach)
    moves = valley.moves
    ways = np.linalg.svd(moves[:, is_open])[2]
    combinations = []
    for row in _echelon(ways[len(blind) :]):
        powers = np.zeros(len(is_known))
        powers[is_open] = row
        if np.count_nonzero(powers) == 1:
            # A setting by itself has been asked for, and is not known.
            continue
        combination = _combination(valley, reach, moves, powers)
        if combination is not None:
            combinations.append(combination)
    return combinations


def _combination(
    valley: Valley, reach: float, moves: Array, powers: Array
) -> Combination | None:
    """A combination, of powers (p,), if it is known along the moves of a floor, (n, p)."""
    profile = valley.profile(powers)
    # A floor is bent, and no product of powers is the same all along it.
    along = moves @ powers
    below, above = profile.ends()
    below -= float(along.min())
    above += float(along.max())
    if max(below, above) >= LIMIT:
        return None
    runs = valley.runs
    places = np.flatnonzero(powers)
    value = math.nan
    if runs.in_decades[places].all():
        value = float(np.prod(runs.values(valley.z) ** powers))
    return Combination(
        powers={runs.names[place]: float(powers[place]) for place in places},
        value=value,
        lower=value * math.exp(-below),
        upper=value * math.exp(above),
        factor=math.exp(reach),
    )


def _correlation(jacobian: Array, blind: Array, is_known: Flags) -> Array:
    """Correlation of settings that are known, (p, p), of the derivatives, (n_rows, p)."""
    known = np.eye(len(is_known))
    if len(blind):
        known = null_space(blind)
    covariance = (
        known @ np.linalg.pinv(known.T @ jacobian.T @ jacobian @ known) @ known.T
    )
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(deviations, deviations)
    is_told = np.outer(is_known, is_known)
    return np.asarray(np.where(is_told, correlation, np.nan))


def _echelon(rows: Array) -> Array:
    """The same space by rows of which each has 1 where no other has anything, rounded."""
    pivots = np.sort(qr(rows, mode="r", pivoting=True)[1][: len(rows)])
    reduced = np.linalg.solve(rows[:, pivots], rows)
    tenths = np.round(reduced, 1)
    rounded = np.where(np.abs(reduced - tenths) < NEAR, tenths, np.round(reduced, 2))
    return np.asarray(np.where(np.abs(reduced) < SHARE, 0.0, rounded))
