"""How far settings may go from the nearest run before the misfit rises: the profile likelihood.

The misfit is |r(z)|^2, r the differences to a measured loop, (n_rows,), and z the
settings on their scales, (p,). Along a direction w, a setting alone or a combination,
its profile is

    m(c) = least misfit of all z with w . z = c,

found from one c to the next by least squares over what is left free. With the least
misfit m0 and the noise s^2 = m0 / (n - p), all c with

    m(c) - m0 <= F s^2

are within two standard errors (F is the quantile of the F distribution with 1 and n - p
degrees of freedom that belongs to them: 4 of many rows). The slope of r at the nearest
run, which is all that (J^T J)^-1 knows, tells that only where r is straight. Here it is
not: a node of the mesh slips or it does not, and the floor of a valley has a dent for
each.

These dents tell of the mesh and not of the loop. So whether a setting is known at all
is judged with the change d of the loop on elements of half the size as one more source
of noise:

    m(c) - m0 <= F (s^2 + |d|^2)

must end on both sides before `FACTOR`. Once it is known its margins are those of the
noise.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.stats import f as f_distribution
from scipy.stats import norm

from solver.arrays import Array
from solver.study.compared_runs import ComparedRuns

FACTOR = 1.5
"""Change of a setting that is not determined if it is within two standard errors."""
LIMIT = math.log(FACTOR)
"""The same in z."""
WALK = math.log(3.0)
"""How far from a place the floor of its valley is searched for a lower one, in z."""
TWO = float(2.0 * norm.cdf(2.0) - 1.0)
"""Probability of what is within two standard errors."""
BROAD = 1e-2
"""Step, in z, of the differences that tell where a valley goes."""
SILENT = 1e-6
"""Noise, as a share of the measured range, below which runs have errors of their
own."""
LOWER = 0.1
"""Share of F s^2 by which a place has to be lower to be another one."""
GROWTH = 0.5, 2.0
"""Between which a step along a profile is, over the distance so far."""
MARGIN = 1.1
SMALL = 1e-3
"""How far beyond a level it aims, and the share of the level below which a rise is
none."""
PLACES = 16
"""Places on one side of a profile, at most."""


class LowerPlace(Exception):  # noqa: N818
    """A place with a lower misfit than that from which the valley goes."""

    def __init__(self, z: Array) -> None:
        super().__init__("there is a lower place")
        self.z = z


@dataclass(frozen=True)
class Side:
    """One side of a profile.

    Attributes
    ----------
    distances, rises
        How far its places are from the nearest run, and by how much the misfit is
        larger there; shape (n_places,). The first is the nearest run.
    places
        The z of these, shape (n_places, p).
    is_at_bound
        Whether there is nothing beyond the last place, as the setting has a bound
        there.
    """

    distances: Array
    rises: Array
    places: Array
    is_at_bound: bool

    def end(self, level: float) -> float:
        """Distance at which the misfit has risen to a level for good; infinite if that is not seen.

        Between two places the root of the rise is taken as straight.
        """
        inside = int(np.flatnonzero(self.rises <= level)[-1])
        if inside == len(self.rises) - 1:
            if self.is_at_bound:
                return float(self.distances[-1])
            return math.inf
        ends = self.distances[inside : inside + 2]
        roots = np.sqrt(np.maximum(self.rises[inside : inside + 2], 0.0))
        if not np.isfinite(roots[1]):
            return float(ends[1])
        return float(np.interp(math.sqrt(level), roots, ends))


@dataclass(frozen=True)
class Profile:
    """Both sides of the profile along a direction, and what they tell at the levels of a valley."""

    below: Side
    above: Side
    noise: float
    doubt: float

    @property
    def is_known(self) -> bool:
        """Whether it ends on both sides before the factor, the mesh taken into account."""
        return max(self.below.end(self.doubt), self.above.end(self.doubt)) < LIMIT

    @property
    def is_known_to_noise(self) -> bool:
        """Whether it would be known if the mesh were right."""
        return max(self.ends(self.noise)) < LIMIT

    def ends(self, level: float | None = None) -> tuple[float, float]:
        """Distances to both ends of what is within two standard errors, infinite where open.

        Those of the noise where it is known, and else those of noise and mesh.
        """
        if level is None:
            level = self.noise if self.is_known else self.doubt
        sides = (self.below.end(level), self.above.end(level))
        below, above = (end if end < LIMIT else math.inf for end in sides)
        return below, above


class Valley:
    """The misfit around a place of least squares, or another one on the floor around it.

    Where a run has a lower misfit, `LowerPlace` is raised with it, if it is asked for.

    Attributes
    ----------
    z, least
        The place that is looked from, (p,), and the least misfit, there or elsewhere.
    noise, doubt
        Rises of the misfit that are within two standard errors: of the noise, and of
        noise and mesh.
    deviation
        Standard deviation of the noise, as a share of the measured range.
    mesh
        Root of the mean square by which the loop changes on elements of half the size,
        as a share of the measured range.
    jacobian
        Derivatives of the differences over a broad step, shape (n_rows, p).
    """

    def __init__(self, runs: ComparedRuns, z: Array, *, seeks: bool) -> None:
        self.runs = runs
        self.z = z
        self.least = runs.misfit(z)
        self._seeks = seeks
        self._bounds = runs.bounds
        rows = len(runs.first.differences)
        free = rows - len(z)
        self.deviation = max(math.sqrt(self.least / free), SILENT)
        quantile = float(f_distribution.ppf(TWO, 1, free))
        change = runs.of_mesh(z)
        self.mesh = change / math.sqrt(rows)
        self.noise = quantile * self.deviation**2
        self.doubt = self.noise + quantile * change**2
        self._look()

    def around(self, z: Array, reach: float) -> Valley:
        """The same valley from another place on its floor, and so far from it in all settings."""
        moved = copy(self)
        moved.z = z
        moved.least = self.runs.misfit(z)
        moved._seeks = False
        moved._bounds = np.clip(z + reach * np.array([[-1.0], [1.0]]), *self._bounds)
        moved._look()
        return moved

    def _look(self) -> None:
        self.jacobian = self.runs.jacobian(self.z, BROAD)
        # Where the slope tells nothing, a step is as long as the search.
        weak = np.eye(len(self.z)) / WALK**2
        precision = 4.0 / self.noise * self.jacobian.T @ self.jacobian
        self._covariance = np.linalg.inv(precision + weak)
        self._inside = [self.z]

    @property
    def moves(self) -> Array:
        """Moves from here that were seen to be within doubt, shape (n_places, p)."""
        return np.array(self._inside) - self.z

    def walk(self) -> None:
        """Go along the weakest direction, both ways, in search of a lower place."""
        if len(self.z) > 1:
            weakest = np.linalg.svd(self.jacobian)[2][-1]
            for along in (-weakest, weakest):
                self._side(along, WALK)

    def profile(self, along: Array, limit: float = LIMIT) -> Profile:
        """Profile along a direction, shape (p,), no farther than a limit."""
        below = self._seen(-along, limit) or self._side(-along, limit)
        above = self._seen(along, limit) or self._side(along, limit)
        return Profile(below, above, self.noise, self.doubt)

    def _seen(self, along: Array, limit: float) -> Side | None:
        """A side that is known to be open, by a place beyond the limit that was within doubt."""
        distances = self.moves @ along
        farthest = int(distances.argmax())
        if distances[farthest] < limit:
            return None
        places = [self.z, self._inside[farthest]]
        rises = [self.runs.misfit(place) - self.least for place in places]
        return Side(np.array([0.0, limit]), np.array(rises), np.array(places), False)

    def _side(self, along: Array, limit: float) -> Side:
        """One side of a profile, until the misfit has risen above the doubt or a limit is met."""
        room = self._room(along)
        limit = min(room, limit)
        variance = float(along @ self._covariance @ along)
        # By a distance of 1 along the direction the settings move so far, if all is
        # straight.
        course = self._covariance @ along / variance
        distances = [0.0]
        rises = [self.runs.misfit(self.z) - self.least]
        places = [self.z]
        step = min(2.0 * math.sqrt(variance), limit)
        while distances[-1] < limit and rises[-1] <= self.doubt and len(rises) < PLACES:
            stop = limit
            if distances[-1] < LIMIT < limit:
                stop = LIMIT
            distances.append(min(distances[-1] + step, stop))
            ahead = places[-1] + course * (distances[-1] - distances[-2])
            places.append(self._place(along, distances[-1], ahead, places[-1]))
            rises.append(self.runs.misfit(places[-1]) - self.least)
            if rises[-1] <= self.doubt:
                self._inside.append(places[-1])
            if self._seeks and rises[-1] < -LOWER * self.noise:
                raise LowerPlace(places[-1])
            course = (places[-1] - places[-2]) / (distances[-1] - distances[-2])
            step = distances[-1] * self._growth(rises[-1])
        is_at_bound = distances[-1] == room
        return Side(np.array(distances), np.array(rises), np.array(places), is_at_bound)

    def _growth(self, rise: float) -> float:
        """Next step over the distance so far, by which a level is passed if the rise is square."""
        level = self.noise if rise <= self.noise else self.doubt
        farther = MARGIN * math.sqrt(level / max(rise, SMALL * level))
        return float(np.clip(farther - 1.0, *GROWTH))

    def _room(self, along: Array) -> float:
        """How far a setting may go within its bounds; infinite for a combination."""
        moving = np.flatnonzero(along)
        if len(moving) > 1:
            return math.inf
        pivot = int(moving[0])
        end = self._bounds[int(along[pivot] > 0.0), pivot]
        return float(abs(end - self.z[pivot]) / abs(along[pivot]))

    def _place(self, along: Array, distance: float, ahead: Array, last: Array) -> Array:
        """Lowest place so far along a direction, found from one that is about there.

        Where that is out, and two or more are left free, it is tried from the last
        place, too: a floor that bends leads astray.
        """
        found = self._lowest(along, distance, ahead)
        is_within = self.runs.misfit(found) - self.least <= self.noise
        if is_within or len(self.z) < 3:
            return found
        other = self._lowest(along, distance, last)
        return min(found, other, key=self.runs.misfit)

    def _lowest(self, along: Array, distance: float, start: Array) -> Array:
        start = np.clip(start, *self._bounds)
        pivot = int(np.abs(along).argmax())
        # The setting that counts most brings it as far along as asked.
        start[pivot] += (distance - along @ (start - self.z)) / along[pivot]
        return self.runs.across(start, along, self._bounds)
