"""Runs compared with a measured loop, as functions of the fitted settings' z."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from solver.arrays import Array
from solver.latin import Ending
from solver.latin.end.status_step import states_of
from solver.reference.rules import States
from solver.refusal import RefusedError
from solver.settings.scene import Settings
from solver.study.fitted_settings import FittedScales
from solver.study.measured_loop import LoopComparison, MeasuredLoop, rms
from solver.study.quantities.finished import FinishedRun
from solver.study.scene_run import finished_run

COARSE = math.log(3.0)
"""Step in z by which each setting is first tried alone."""
FAR = math.log(1e3)
"""Largest distance in z of these steps from the start."""
SAME = 1e-6
"""Relative difference up to which two misfits count as equal."""
ACCURACY = 1e-4
"""Accuracy of runs that are not certified."""
FINE = 1e-7
"""Tolerance of the least squares in z and in the misfit."""
MOST_STEPS = 40
"""Largest number of evaluations of the least squares."""
ROUGH = 1e-3
"""Tolerance of the misfit where only the misfit is asked for."""
FEW_STEPS = 10
"""Largest number of evaluations where only the misfit is asked for."""
STEP = 1e-4
"""Step in z of the finite differences of the method."""


@dataclass(frozen=True, eq=False)
class ComparedRun:
    """A run compared with a measured loop.

    Attributes
    ----------
    values
        Values of the fitted settings, shape (p,), in SI.
    run
        The finished run.
    beside
        Comparison of the run with the measured loop.
    differences
        Quantity that the run finds less the measured one, for every row that is
        compared, shape (n_rows,), as shares of the measured range.
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
    """Runs over z compared with a measured loop, each started from the last one.

    Parameters
    ----------
    settings
        Settings of the first run, at z = 0.
    measured
        The measured loop.
    names
        Names of the p settings that are fitted.
    watch
        Called after each run with the number of runs so far, and the nearest one.

    Attributes
    ----------
    scales
        Scales z of the settings.
    first, nearest
        First run, and the nearest one so far.
    count
        Number of runs so far.
    """

    def __init__(
        self,
        settings: Settings,
        measured: MeasuredLoop,
        names: Sequence[str],
        watch: Callable[[int, ComparedRun], object],
    ) -> None:
        self.scales = FittedScales(settings, names)
        # Differences of runs must not be those of their stop rules.
        accuracy = min(settings.accuracy, ACCURACY)
        self._settings = settings.replace(finish="at-once", accuracy=accuracy)
        self._measured = measured
        self._watch = watch
        self._before: States | None = None
        self._known: dict[bytes, Array] = {}
        self.count = 0
        self.first = self.nearest = self.run(np.zeros(len(names)))

    def run(self, z: Array) -> ComparedRun:
        """Run at z, shape (p,).

        Raises
        ------
        RefusedError
            Where the settings do not fit together, or the run does not converge.
        """
        changes = self.scales.changes(z)
        settings = self._settings.replace(**changes)
        finished = finished_run(
            settings, errors=False, indicators=False, before=self._before
        )
        self.count += 1
        status = finished.solution.status
        if status.ending is not Ending.CONVERGED:
            text = ", ".join(f"{name}={value:.6g}" for name, value in changes.items())
            raise RefusedError("the run", text, "one that converges", status.advice)
        # The next run is near: it may start from these states.
        self._before = states_of(finished.iterate)
        beside = LoopComparison(self._measured, finished.loop, finished.problem)
        differences, _ = beside.differences(finished.displacement, finished.force)
        values = np.array(list(changes.values()))
        return ComparedRun(values, finished, beside, differences)

    def differences(self, z: Array) -> Array:
        """Differences at z, (p,), over the range of the loop, shape (n_rows,).

        NaN where there is no run, so that no step goes there.
        """
        key = z.tobytes()
        if key not in self._known:
            # Places without a run are remembered, too.
            self._known[key] = np.full(len(self.first.differences), np.nan)
            with contextlib.suppress(RefusedError):
                run = self.run(z)
                self._known[key] = run.differences
                self.nearest = min(self.nearest, run, key=lambda each: each.distance)
            self._watch(self.count, self.nearest)
        return self._known[key]

    def jacobian(
        self, z: Array, step: float = STEP, directions: Array | None = None
    ) -> Array:
        """Derivatives of the differences along directions, shape (n_rows, q).

        Parameters
        ----------
        z
            Place, shape (p,).
        step
            Step in z, both ways where bounds let it; the default one goes one way.
        directions
            Directions in z, shape (q, p); by default those of the settings.
        """
        if directions is None:
            directions = np.eye(len(z))
        columns = [self._derivative(z, step, along) for along in directions]
        return np.array(columns).reshape(len(directions), -1).T

    def _derivative(self, z: Array, step: float, along: Array) -> Array:
        """Derivative of differences, (n_rows,), at z, (p,), along a direction, (p,)."""
        moves = [move for move in (step, -step) if self.scales.holds(z + move * along)]
        # A tiny step is straight enough one way, and one run fewer.
        if step == STEP:
            moves = moves[:1]
        # A difference across z where there are runs on both sides, else from z.
        known = {0.0: self.differences(z)}
        for move in moves:
            tried = self.differences(z + move * along)
            if np.isfinite(tried).all():
                known[move] = tried
        first = min(known)
        last = max(known)
        return (known[last] - known[first]) / ((last - first) or 1.0)

    def misfit(self, z: Array) -> float:
        """Sum of the squared differences at z, (p,); infinite without a run."""
        found = float(np.sum(self.differences(z) ** 2))
        if math.isfinite(found):
            return found
        return math.inf

    def of_mesh(self, z: Array) -> float:
        """Norm of the change of differences at z, (p,), with elements of half the size.

        0 where no such run converges.
        """
        settings = self._settings.replace(**self.scales.changes(z))
        with contextlib.suppress(RefusedError):
            # Half the size: what changes is what the mesh hides of the loop.
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
        """Initial z, shape (p,): by large steps in one setting after another."""
        best = np.zeros(len(self.scales.names))
        for setting in range(len(best)):
            middle = best
            # Both ways from the middle, as one side may fall first and rise later.
            for step in (-COARSE, COARSE):
                best = self._stepped(best, middle, setting, step)
        return best

    def _stepped(self, best: Array, middle: Array, setting: int, step: float) -> Array:
        """Best z, shape (p,), of equal steps of a setting from the middle.

        Steps continue while the misfit falls, and at first where it does not change, as
        where the start lets nothing slip.

        Parameters
        ----------
        best
            Best place so far, shape (p,).
        middle
            Place before any step of this setting, shape (p,).
        setting
            Index of the setting.
        step
            Step in z.
        """
        low, high = self.scales.bounds[:, setting]
        moved = middle
        while best is middle or moved is best:
            at = moved[setting] + step
            if abs(at) > FAR or not low <= at <= high:
                break
            moved = np.where(np.arange(len(best)) == setting, at, moved)
            misfit = np.sum(self.differences(moved) ** 2)
            lowest = np.sum(self.differences(best) ** 2)
            if misfit < (1.0 - SAME) * lowest:
                best = moved
            elif not misfit <= (1.0 + SAME) * lowest:
                break
        return best

    def solve(self, z: Array, pull: Array) -> Array:
        """Least-squares z, shape (p,), with a pull to the start.

        Parameters
        ----------
        z
            Place to search from, shape (p,).
        pull
            Matrix whose product with z is added to the differences, shape (n, p).
        """
        found = scipy.optimize.least_squares(
            lambda at: np.concatenate([self.differences(at), pull @ at]),
            z,
            jac=lambda at: np.concatenate([self.jacobian(at), pull]),
            bounds=self.scales.bounds,
            xtol=FINE,
            ftol=FINE,
            gtol=FINE**2,
            max_nfev=MOST_STEPS,
        )
        return np.asarray(found.x)

    def across(self, z: Array, along: Array, bounds: Array) -> Array:
        """Least-squares z across a direction, shape (p,).

        Parameters
        ----------
        z
            Place to search from, shape (p,); all places are as far along the direction.
        along
            Direction, shape (p,). The setting that counts most in it follows from the
            others.
        bounds
            Smallest and largest z, shape (2, p).
        """
        # Where one setting follows from the others there is nothing to constrain.
        pivot = int(np.abs(along).argmax())
        free = np.delete(np.arange(len(z)), pivot)
        if not len(free):
            return z
        directions = np.eye(len(z))[free]
        directions[:, pivot] = -along[free] / along[pivot]

        def place(moves: Array) -> Array:
            """Place, shape (p,), after moves of the free settings, (p - 1,)."""
            return z + moves @ directions

        def differences(moves: Array) -> Array:
            """Differences, (n_rows,), after moves, (p - 1,); NaN beyond a bound."""
            at = place(moves)
            if not self.scales.holds(at):
                return np.full(len(self.first.differences), np.nan)
            return self.differences(at)

        # Least squares cannot begin where there is no run.
        if not np.isfinite(differences(np.zeros(len(free)))).all():
            return z
        found = scipy.optimize.least_squares(
            differences,
            np.zeros(len(free)),
            jac=lambda moves: self.jacobian(place(moves), directions=directions),
            bounds=bounds[:, free] - z[free],
            ftol=ROUGH,
            xtol=ROUGH * STEP,
            gtol=FINE**2,
            max_nfev=FEW_STEPS,
        )
        return place(found.x)
