"""Runs beside a measured loop, over the settings that are fitted to it, on their scales z."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import param
from scipy.optimize import least_squares

from solver.arrays import Array
from solver.latin import Ending
from solver.latin.end.status_step import states_of
from solver.reference.rules import States
from solver.refusal import RefusedError
from solver.settings.definitions import SettingError, about, is_logarithmic
from solver.settings.scene import Settings
from solver.study.measured_loop import LoopComparison, MeasuredLoop, rms
from solver.study.quantities.finished import FinishedRun, finished_run

NOT_FITTED = "Method", "Stop", "Decomposition"
"""Groups of settings that do not change the answer."""
FARTHEST = math.log(1e6)
"""How far from its start, in z, a setting may go."""
COARSE = math.log(3.0)
FAR = math.log(1e3)
"""Steps from the start by which each setting is tried alone, and how far they go."""
SAME = 1e-6
"""Share of the misfit up to which two are the same."""
ACCURACY = 1e-4
"""Of runs that are not certified."""
FINE = 1e-7
MOST_STEPS = 40
"""Tolerance, and steps, of each."""
ROUGH = 1e-3
FEW_STEPS = 10
"""Tolerance of the misfit, and steps, where only the misfit is asked for."""
STEP = 1e-4
"""Of differences, in z, of the method."""


def fittable(settings: Settings) -> list[str]:
    """Settings that a loop may be asked for: numbers that change the answer."""
    return [name for name in settings.definitions() if not _why_not(settings, name)]


def _why_not(settings: Settings, name: str) -> str:
    """Why a setting cannot be fitted; empty where it can."""
    definition = settings.definitions().get(name)
    if definition is None:
        return "there is no such setting"
    if not isinstance(definition, param.Number):
        return "it is no number"
    if isinstance(definition, param.Integer):
        return "it counts, and has no values in between"
    if not settings.applies(name):
        return "it does nothing with the other settings as they are"
    is_answered = about(definition).group in NOT_FITTED or name == "duration"
    if is_answered:
        return "it does not change what a run finds"
    return ""


def scale_of(settings: Settings, name: str) -> tuple[float, float, float, float]:
    """Start and size of the scale on which a setting is fitted, and its bounds; size 0 of decades.

    What is no number, or does nothing to the answer, is refused.
    """
    if reason := _why_not(settings, name):
        can = ", ".join(fittable(settings))
        raise SettingError("fitted setting", name, can, f"choose another: {reason}")
    definition = settings.definitions()[name]
    value = getattr(settings, name)
    low, high = definition.bounds
    if low >= 0.0 and value > 0.0:
        return value, 0.0, low, high
    if is_logarithmic(definition):
        can = f"a value above 0, to begin with, as {definition.softbounds[0]:g}"
        raise SettingError(name, value, can, "set it")
    return value, abs(value) or float(np.ptp(definition.softbounds)), low, high


@dataclass(frozen=True, eq=False)
class ComparedRun:
    """A run beside a measured loop, with the values of the settings that are fitted, (p,), in SI.

    Differences are of what it finds to every row, as shares of the measured range.
    """

    values: Array
    run: FinishedRun
    beside: LoopComparison
    differences: Array

    @property
    def distance(self) -> float:
        """Distance to the loop."""
        return rms(self.differences)


class ComparedRuns:
    """Runs over z, each beside the measured loop and from the statuses of the one before.

    `watch` is called after each with how many there were, and the nearest one.
    """

    def __init__(
        self,
        settings: Settings,
        measured: MeasuredLoop,
        names: Sequence[str],
        watch: Callable[[int, ComparedRun], object],
    ) -> None:
        self.names = tuple(names)
        scales = np.array([scale_of(settings, name) for name in names])
        self._start, self._size, *self._ends = scales.T
        self.in_decades = self._size == 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = [
                np.where(
                    self.in_decades,
                    np.log(end / self._start),
                    (end - self._start) / self._size,
                )
                for end in self._ends
            ]
        self.bounds = np.clip(ends, -FARTHEST, FARTHEST)
        accuracy = min(settings.accuracy, ACCURACY)
        self._settings = settings.replace(finish="at-once", accuracy=accuracy)
        self._measured = measured
        self._watch = watch
        self._before: States | None = None
        self._known: dict[bytes, Array] = {}
        self.count = 0
        self.first = self.nearest = self.run(np.zeros(len(names)))

    def values(self, z: Array) -> Array:
        """Values of the settings, shape (p,), in SI."""
        with np.errstate(over="ignore"):
            values = np.where(
                self.in_decades, self._start * np.exp(z), self._start + self._size * z
            )
        return np.asarray(np.clip(values, *self._ends))

    def changes(self, z: Array) -> dict[str, float]:
        """Values of the settings by name, with as many digits as anybody writes."""
        values = self.values(z)
        return {
            name: float(f"{at:.12g}")
            for name, at in zip(self.names, values, strict=True)
        }

    def run(self, z: Array) -> ComparedRun:
        """Run at a place; `RefusedError` where settings do not fit or it does not converge."""
        changes = self.changes(z)
        settings = self._settings.replace(**changes)
        finished = finished_run(
            settings, errors=False, indicators=False, before=self._before
        )
        self.count += 1
        status = finished.solution.status
        if status.ending is not Ending.CONVERGED:
            values = ", ".join(f"{name}={value:.6g}" for name, value in changes.items())
            raise RefusedError("the run", values, "one that converges", status.advice)
        self._before = states_of(finished.iterate)
        beside = LoopComparison(self._measured, finished.loop, finished.problem)
        differences, _ = beside.differences(finished.displacement, finished.force)
        return ComparedRun(
            np.array(list(changes.values())), finished, beside, differences
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

    def jacobian(
        self, z: Array, step: float = STEP, ways: Array | None = None
    ) -> Array:
        """Derivatives of the differences along directions of z, by steps both ways in bounds.

        Directions have shape (q, p), those of the settings by themselves if there are
        none; the derivatives (n_rows, q). The smallest step is taken one way only.
        """
        if ways is None:
            ways = np.eye(len(z))
        columns = []
        for way in ways:
            moves = [move for move in (step, -step) if self.holds(z + move * way)]
            if step == STEP:
                moves = moves[:1]
            known = {0.0: self.differences(z)}
            for move in moves:
                tried = self.differences(z + move * way)
                if np.isfinite(tried).all():
                    known[move] = tried
            first = min(known)
            last = max(known)
            columns.append((known[last] - known[first]) / ((last - first) or 1.0))
        return np.array(columns).reshape(len(ways), -1).T

    def holds(self, z: Array) -> bool:
        """Whether a place lies within the bounds of all settings."""
        low, high = self.bounds
        return bool(((low <= z) & (z <= high)).all())

    def misfit(self, z: Array) -> float:
        """Sum of the squared differences at a place; infinite where there is no run."""
        found = float(np.sum(self.differences(z) ** 2))
        return found if math.isfinite(found) else math.inf

    def of_mesh(self, z: Array) -> float:
        """Root of the sum of the squared changes of the differences with elements of half the size.

        0 where no such run is to be had.
        """
        settings = self._settings.replace(**self.changes(z))
        with contextlib.suppress(RefusedError):
            finer = {name: 2 * getattr(settings, name) for name in settings.MESH}
            run = finished_run(
                settings.replace(**finer), errors=False, indicators=False
            )
            self.count += 1
            beside = LoopComparison(self._measured, run.loop, run.problem)
            differences, _ = beside.differences(run.displacement, run.force)
            if run.solution.status.ending is Ending.CONVERGED:
                return float(np.linalg.norm(differences - self.differences(z)))
        return 0.0

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
                    misfit, least = (
                        np.sum(self.differences(z) ** 2) for z in (moved, best)
                    )
                    if misfit < (1.0 - SAME) * least:
                        best = moved
                    elif not misfit <= (1.0 + SAME) * least:
                        break
        return best

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

    def across(self, z: Array, along: Array, bounds: Array) -> Array:
        """Place of the least squares among those that are as far along a direction, (p,), as z.

        It lies within bounds, (2, p). The setting that counts most in the direction
        follows from the others.
        """
        pivot = int(np.abs(along).argmax())
        free = np.delete(np.arange(len(z)), pivot)
        if not len(free):
            return z
        ways = np.eye(len(z))[free]
        ways[:, pivot] = -along[free] / along[pivot]

        def place(moves: Array) -> Array:
            return z + moves @ ways

        def left(moves: Array) -> Array:
            at = place(moves)
            if not self.holds(at):
                return np.full(len(self.first.differences), np.nan)
            return self.differences(at)

        if not np.isfinite(left(np.zeros(len(free)))).all():
            return z
        found = least_squares(
            left,
            np.zeros(len(free)),
            jac=lambda moves: self.jacobian(place(moves), ways=ways),
            bounds=bounds[:, free] - z[free],
            ftol=ROUGH,
            xtol=ROUGH * STEP,
            gtol=FINE**2,
            max_nfev=FEW_STEPS,
        )
        return place(found.x)
