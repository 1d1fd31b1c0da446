"""Settings under which a run comes nearest to a measured loop, and what the loop cannot tell.

    fitted = fit(settings, measured, ["friction", "contact_stiffness"])

The differences of `solver.study.loop_comparison` are minimised in the sum of their squares, over z:
the logarithm of a setting over its start, where it is positive and spans decades, else its change
over its size. From the best of some values of each setting alone a trust-region method (SciPy's
`least_squares`) goes on within their bounds; every run starts from what stuck and slipped in the
one before. With J = dr/dz, n rows, p settings and s^2 = |r|^2 / (n - p),

    standard errors = sqrt(diag(s^2 (J^T J)^-1)).

A direction of z is not determined if its standard error s / (singular value of J) is above a fifth,
as where a change of 20 % would be lost in the noise. It stays where it began.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import least_squares

from solver.arrays import Array, Flags
from solver.definitions import SettingError
from solver.latin import Ending
from solver.reference.solution import States
from solver.refusal import RefusedError
from solver.scenes import loop_of
from solver.settings import Settings
from solver.study.fittable import fittable, scale_of
from solver.study.loop_comparison import LoopComparison, rms
from solver.study.measured_loop import MeasuredLoop
from solver.study.quantities.finished import finished_run

MOST = 4
"""Settings that are fitted at once."""
COARSE, FAR = math.log(3.0), math.log(1e3)
"""Steps from the start by which each setting is tried alone, and how far they go."""
SAME = 1e-6
"""Share of the misfit up to which two are the same."""
STEP, NARROW, WIDE = 1e-4, 1e-5, 0.1
"""Of differences, in z: where the next step of the method goes, and both for what the loop tells.
Over a narrow one the nodes that a front has just reached count for more than the loop (friction and
young of a bar, of which only the product is known: singular values 4.5 and 0.12, instead of 0.006);
over a wide one a combination that is no product seems to be known."""
LOOSE = 1e-4
"""Pull towards the start at first, so that what is not determined does not drift."""
UNSURE = 0.2
"""Standard error of a direction, in z, from which on it is not determined."""
FLAT, RIGID, EXACT, BLIND = 0.02, 1e-4, 1e-6, 1e-6
"""Singular values below which a direction is not determined: over the largest one, since meshes
tell no more, or, where the run is as near as `EXACT`, since differences do not; and at all."""
SHARE = 0.1
"""Part in a direction that is not determined from which on a setting is not known alone."""
ACCURACY = 1e-4
"""Of runs that are not certified."""
ROUNDS = 3
"""Of the least squares: with a loose pull, then with what is determined free, as often as that
changes."""
FINE, MOST_STEPS = 1e-7, 40
"""Tolerance, and steps, of each."""


@dataclass(frozen=True, eq=False)
class Fit:
    """What a loop tells of some settings.

    Attributes
    ----------
    settings
        Of the nearest run, with all that was not fitted as it was.
    names
        Settings that were fitted, p of them.
    start, values
        Of them, shape (p,), in SI.
    errors
        Standard errors, same shape; infinite where the loop does not tell a value alone.
    correlation
        Of the values, shape (p, p); NaN where there is none.
    together
        Combinations that are known of settings that are not: powers of settings by name, and the
        standard error of the logarithm of their product; NaN where some are not logarithmic.
    first, nearest
        The run at the start, and the nearest one.
    runs
        How many it took.
    """

    settings: Settings
    names: tuple[str, ...]
    start: Array
    values: Array
    errors: Array
    correlation: Array
    together: list[tuple[dict[str, float], float]]
    first: ComparedRun
    nearest: ComparedRun
    runs: int


@dataclass(frozen=True, eq=False)
class ComparedRun:
    """A run beside a measured loop.

    Attributes
    ----------
    values
        Of the settings that are fitted, shape (p,), in SI.
    instants, displacement, force
        Its loop, shape (n_instants,), in SI.
    differences, drive
        Of what it finds, and of what is given, to every row; shares of the measured range.
    beside
        The loop as it is laid beside the problem.
    is_certified
        Whether it is a solution up to rounding.
    """

    values: Array
    instants: Array
    displacement: Array
    force: Array
    differences: Array
    drive: Array
    beside: LoopComparison
    is_certified: bool

    @property
    def distance(self) -> float:
        """Distance to the loop."""
        return rms(self.differences)


class _Runs:
    """Runs over z, each beside the measured loop and from the statuses of the one before."""

    def __init__(
        self,
        settings: Settings,
        measured: MeasuredLoop,
        names: Sequence[str],
        watch: Callable[[int, ComparedRun], object],
    ) -> None:
        self.names, self.scales = tuple(names), [scale_of(settings, name) for name in names]
        self.bounds = np.array([scale.bounds() for scale in self.scales]).T
        accuracy = min(settings.accuracy, ACCURACY)
        self._settings = settings.replace(finish="at-once", accuracy=accuracy)
        self._measured, self._watch = measured, watch
        self._before: States | None = None
        self._known: dict[bytes, Array] = {}
        self.count = 0
        self.first = self.nearest = self.run(np.zeros(len(names)))

    def changes(self, z: Array) -> dict[str, float]:
        """Values of the settings by name."""
        scaled = zip(self.names, self.scales, z, strict=True)
        return {name: scale.value(float(at)) for name, scale, at in scaled}

    def run(self, z: Array) -> ComparedRun:
        """Run at a place.

        Raises
        ------
        RefusedError
            For settings that do not fit together, or a run that does not converge.
        """
        changes = self.changes(z)
        settings = self._settings.replace(**changes)
        finished = finished_run(settings, errors=False, indicators=False, before=self._before)
        self.count += 1
        status, problem, iterate = finished.solution.status, finished.problem, finished.iterate
        if status.ending is not Ending.CONVERGED:
            values = ", ".join(f"{name}={value:.6g}" for name, value in changes.items())
            raise RefusedError("the run", values, "one that converges", status.advice)
        self._before = finished.states
        beside = LoopComparison(self._measured, loop_of(settings, problem), problem)
        loop = beside.both(iterate)
        return ComparedRun(
            np.array(list(changes.values())),
            problem.instants,
            *loop,
            *beside.differences(*loop),
            beside,
            finished.solution.is_certified,
        )

    def differences(self, z: Array) -> Array:
        """Of a run, shape (n_rows,); NaN where there is none, so that no step goes there."""
        key = z.tobytes()
        if key not in self._known:
            self._known[key] = np.full(len(self.first.differences), np.nan)
            with contextlib.suppress(RefusedError):
                run = self.run(z)
                self._known[key] = run.differences
                self.nearest = min(self.nearest, run, key=lambda each: each.distance)
            self._watch(self.count, self.nearest)
        return self._known[key]

    def jacobian(self, z: Array, step: float = STEP) -> Array:
        """Derivatives of the differences, shape (n_rows, p), by steps both ways or where they go.

        The smallest step is taken one way only.
        """
        columns = []
        for way, (low, high), at in zip(np.eye(len(z)), self.bounds.T, z, strict=True):
            ends = [end for end in (at + step, at - step) if low <= end <= high]
            if step == STEP:
                ends = ends[:1]
            tried = {end - at: self.differences(z + (end - at) * way) for end in ends}
            known = {0.0: self.differences(z)} | tried
            known = {move: left for move, left in known.items() if np.isfinite(left).all()}
            first, last = min(known), max(known)
            columns.append((known[last] - known[first]) / ((last - first) or 1.0))
        return np.array(columns).T

    def coarse(self) -> Array:
        """Place to begin at: by large steps in one setting after the other, while they help.

        They go on where nothing changes, as where a start lets nothing slip.
        """
        best = np.zeros(len(self.names))
        for place, (low, high) in enumerate(self.bounds.T):
            middle = best
            for way in (-COARSE, COARSE):
                moved = middle
                while best is middle or moved is best:
                    at = moved[place] + way
                    if abs(at) > FAR or not low <= at <= high:
                        break
                    moved = np.where(np.arange(len(best)) == place, at, moved)
                    misfit, least = self._misfit(moved), self._misfit(best)
                    if misfit < (1.0 - SAME) * least:
                        best = moved
                    elif not misfit <= (1.0 + SAME) * least:
                        break
        return best

    def _misfit(self, z: Array) -> float:
        return float(np.sum(self.differences(z) ** 2))

    def solve(self, z: Array, pull: Array) -> Array:
        """Place of the least squares from a place on, with so much pull (n, p) to the start."""
        found = least_squares(
            lambda at: np.concatenate([self.differences(at), pull @ at]),
            z,
            jac=lambda at: np.concatenate([self.jacobian(at), pull]),
            bounds=self.bounds,
            xtol=FINE,
            ftol=FINE,
            gtol=FINE**2,
            max_nfev=MOST_STEPS,
        )
        return np.asarray(found.x)


def fit(
    settings: Settings,
    measured: MeasuredLoop,
    names: Sequence[str],
    watch: Callable[[int, ComparedRun], object] = lambda runs, nearest: None,
) -> Fit:
    """Find the settings under which a run comes nearest to a measured loop.

    Parameters
    ----------
    settings
        Where to begin, with all that is not fitted.
    measured
        The loop.
    names
        Settings to fit, one to four.
    watch
        Called after each run with how many there were, and the nearest one.

    Raises
    ------
    RefusedError
        For settings that cannot be fitted, a loop that is none of this scene or too short, and a
        first run that does not converge.
    """
    if not 1 <= len(set(names)) == len(names) <= MOST:
        can = f"one to {MOST} settings, each once, of {', '.join(fittable(settings))}"
        raise SettingError("--vary", ",".join(names), can, "name these")
    runs = _Runs(settings, measured, names, watch)
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


def _fitted(runs: _Runs, settings: Settings, z: Array, covariance: Array, blind: Array) -> Fit:
    """What is found at a place, where some directions, (n, p), are not determined."""
    nearest = runs.run(z)
    slopes = [s.slope(value) for s, value in zip(runs.scales, nearest.values, strict=True)]
    deviations = np.sqrt(np.diag(covariance))
    is_alone = np.abs(blind).max(axis=0, initial=0.0) < SHARE
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(deviations, deviations)
    correlation[~np.outer(is_alone, is_alone)] = np.nan
    return Fit(
        settings=settings.replace(**runs.changes(z)),
        names=runs.names,
        start=runs.first.values,
        values=nearest.values,
        errors=np.where(is_alone, np.abs(slopes) * deviations, np.inf),
        correlation=correlation,
        together=_known_together(runs, covariance, blind[:, ~is_alone], is_alone),
        first=runs.first,
        nearest=nearest,
        runs=runs.count,
    )


def _known_together(
    runs: _Runs, covariance: Array, blind: Array, is_alone: Flags
) -> list[tuple[dict[str, float], float]]:
    """Combinations that are determined of settings that are not, as `Fit` has them."""
    names = [name for name, alone in zip(runs.names, is_alone, strict=True) if not alone]
    covariance = covariance[np.ix_(~is_alone, ~is_alone)]
    is_product = all(scale.size is None for scale in np.array(runs.scales)[~is_alone])
    together = []
    for powers in echelon(null_space(blind).T if len(blind) else np.zeros((0, 0))):
        margin = math.sqrt(powers @ covariance @ powers) if is_product else math.nan
        together.append(({n: float(p) for n, p in zip(names, powers, strict=True) if p}, margin))
    return together


def echelon(rows: Array) -> Array:
    """The same space by rows that begin with 1, where no other has anything; to a digit."""
    rows, done = rows.copy(), 0
    for column in range(rows.shape[1]):
        pivot = done + int(np.abs(rows[done:, column]).argmax()) if done < len(rows) else 0
        if done < len(rows) and abs(rows[pivot, column]) > SHARE:
            rows[[done, pivot]] = rows[[pivot, done]]
            rows[done] /= rows[done, column]
            others = np.arange(len(rows)) != done
            rows[others] -= np.outer(rows[others, column], rows[done])
            done += 1
    return np.where(np.abs(rows) < SHARE, 0.0, np.round(rows, 1))
