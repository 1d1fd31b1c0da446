"""Valley of a misfit: places of about the least one, and profiles that lead to them.

The floor of a valley bends, and has places from which no slope leads on. So a place of
a profile is searched from several sides: ahead on the course, from the place before,
towards what another profile has seen, and where settings that change nothing begin to.
"""

from __future__ import annotations

import math
from copy import copy

import numpy as np
import scipy

from solver.arrays import Array
from solver.study.compared_runs import ComparedRuns
from solver.study.profile_likelihood import LIMIT, LikelihoodProfile, ProfileSide

WALK = math.log(3.0)
"""Distance in z along the floor of a valley that is searched for a lower place."""
TWO = math.erf(math.sqrt(2.0))
"""Probability of a normal value within two standard errors."""
BROAD = 1e-2
"""Step, in z, of the finite differences that tell the direction of a valley."""
SILENT = 1e-6
"""Smallest noise, as a share of the measured range: runs have errors as large."""
LOWER = 0.1
"""Share of F s^2 by which the misfit of another place has to be lower to count."""
GROWTH = (0.5, 9.0)
"""Smallest and largest step along a profile, over the distance so far.

Only where the noise is far below what the mesh hides, as in a loop that was computed,
is a place ten times as far as the one before."""
MARGIN = 1.1
"""Factor on the distance to a level by which a step aims beyond it."""
SMALL = 1e-3
"""Share of a level below which a rise of the misfit counts as zero."""
PLACES = 16
"""Largest number of places on one side of a profile."""


class LowerPlace(Exception):  # noqa: N818
    """Signal: z, shape (p,), has a lower misfit than the nearest run so far."""

    def __init__(self, z: Array) -> None:
        super().__init__("there is a lower place")
        self.z = z


class Valley:
    """Misfit around a minimum of least squares.

    Parameters
    ----------
    runs
        Runs beside the measured loop.
    z
        Place of least squares, shape (p,).
    seeks
        Whether to raise `LowerPlace` where a run has a lower misfit.

    Attributes
    ----------
    z
        Centre from which the valley is explored, shape (p,).
    minimum
        Misfit of the centre.
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
        self.minimum = runs.misfit(z)
        self._seeks = seeks
        self._bounds = runs.scales.bounds
        # The noise is what the fit leaves of the differences.
        rows = len(runs.first.differences)
        free = rows - len(z)
        self.deviation = max(math.sqrt(self.minimum / free), SILENT)
        quantile = float(scipy.special.fdtri(1, free, TWO))
        change = runs.of_mesh(z)
        self.mesh = change / math.sqrt(rows)
        self.noise = quantile * self.deviation**2
        self.doubt = self.noise + quantile * change**2
        self._look()

    def around(self, z: Array, distance: float) -> Valley:
        """The valley from another centre on its floor, within a box around the centre.

        The centre has shape (p,); the box reaches a distance in z in all settings.
        """
        moved = copy(self)
        moved.z = z
        moved.minimum = self.runs.misfit(z)
        moved._seeks = False
        box = z + distance * np.array([[-1.0], [1.0]])
        moved._bounds = np.clip(box, *self._bounds)
        moved._look()
        return moved

    def _look(self) -> None:
        """Compute the Jacobian and the covariance at the centre."""
        self.jacobian = self.runs.jacobian(self.z, BROAD)
        # Where the slope tells nothing, a step is as long as the search.
        weak = np.eye(len(self.z)) / WALK**2
        precision = 4.0 / self.noise * self.jacobian.T @ self.jacobian
        self._covariance = np.linalg.inv(precision + weak)
        self._inside = [self.z]

    @property
    def moves(self) -> Array:
        """Moves from the centre to points of about equal misfit, (n_points, p)."""
        return np.array(self._inside) - self.z

    def walk(self) -> None:
        """Search for a lower place along the weakest direction, both ways."""
        # A single setting has its profile, and no other direction.
        if len(self.z) > 1:
            weakest = np.linalg.svd(self.jacobian)[2][-1]
            for along in (-weakest, weakest):
                self._side(along, WALK)

    def profiles(self, directions: Array) -> list[LikelihoodProfile]:
        """Profiles along directions, (n, p), none of which another one contradicts.

        A profile that leads round a bend may come to places that the one along another
        setting has missed: that is searched again, with these as starts.
        """
        found = [self.profile(along) for along in directions]
        for _ in directions:
            for number, along in enumerate(directions):
                if self._contradicts(found[number], along):
                    found[number] = self.profile(along)
        return found

    def _contradicts(self, profile: LikelihoodProfile, along: Array) -> bool:
        """Check whether a place was seen within a level beyond the end of a profile."""
        distances = self.moves @ along
        rises = self._rises()
        for level in (self.noise, self.doubt):
            below, above = profile.ends(level)
            within = distances[rises <= level]
            if -float(within.min()) > below * MARGIN:
                return True
            if float(within.max()) > above * MARGIN:
                return True
        return False

    def _rises(self) -> Array:
        """Misfits of the points that were seen within doubt, less the minimum, (n,)."""
        return (
            np.array([self.runs.misfit(place) for place in self._inside]) - self.minimum
        )

    def profile(self, along: Array, limit: float = LIMIT) -> LikelihoodProfile:
        """Profile along a direction, shape (p,), up to a distance `limit` in z."""
        below = self._seen(-along, limit) or self._side(-along, limit)
        above = self._seen(along, limit) or self._side(along, limit)
        return LikelihoodProfile(below, above, self.noise, self.doubt)

    def _seen(self, along: Array, limit: float) -> ProfileSide | None:
        """Side along a direction, (p,), if it is already known to be open.

        It is open if a place beyond the limit has been seen within doubt. None
        otherwise.
        """
        distances = self.moves @ along
        farthest = int(distances.argmax())
        if distances[farthest] < limit:
            return None
        places = self.z, self._inside[farthest]
        rises = [self.runs.misfit(place) - self.minimum for place in places]
        return ProfileSide(np.array([0.0, limit]), np.array(rises), False)

    def _side(self, along: Array, limit: float) -> ProfileSide:
        """Side of a profile along a direction, (p,), up to a distance `limit` in z.

        The side ends where the misfit has risen above the doubt.
        """
        room = self._room(along)
        limit = min(room, limit)
        variance = float(along @ self._covariance @ along)
        # Settings move so far by a distance of 1, if the valley is straight.
        course = self._covariance @ along / variance
        distances = [0.0]
        rises = [self.runs.misfit(self.z) - self.minimum]
        before = self.z
        step = min(2.0 * math.sqrt(variance), limit)
        while distances[-1] < limit and rises[-1] <= self.doubt and len(rises) < PLACES:
            last = distances[-1]
            # `LIMIT` is a place of its own, as the ends are compared with it.
            stop = limit
            if last < LIMIT < limit:
                stop = LIMIT
            distance = min(last + step, stop)
            ahead = before + course * (distance - last)
            place = self._place(along, distance, ahead, before)
            rise = self._rise(place)
            # The floor bends: the next place is sought along the last step.
            course = (place - before) / (distance - last)
            step = distance * self._growth(rise)
            distances.append(distance)
            rises.append(rise)
            before = place
        is_at_bound = distances[-1] == room
        return ProfileSide(np.array(distances), np.array(rises), is_at_bound)

    def _rise(self, place: Array) -> float:
        """Misfit at a point, (p,), less the minimum; stores points of about equal one.

        Raises
        ------
        LowerPlace
            If the misfit is lower than the least one, and a lower place is sought.
        """
        rise = self.runs.misfit(place) - self.minimum
        if rise <= self.doubt:
            self._inside.append(place)
        if self._seeks and rise < -LOWER * self.noise:
            raise LowerPlace(place)
        return rise

    def _growth(self, rise: float) -> float:
        """Factor on the distance to pass the next level, if misfit is quadratic."""
        if rise <= self.noise:
            level = self.noise
        else:
            level = self.doubt
        farther = MARGIN * math.sqrt(level / max(rise, SMALL * level))
        return float(np.clip(farther - 1.0, *GROWTH))

    def _room(self, along: Array) -> float:
        """Distance in z along a direction, (p,), to a bound of its setting.

        Infinite for a direction that combines settings.
        """
        moving = np.flatnonzero(along)
        if len(moving) > 1:
            return math.inf
        pivot = int(moving[0])
        end = self._bounds[int(along[pivot] > 0.0), pivot]
        return float(abs(end - self.z[pivot]) / abs(along[pivot]))

    def _place(self, along: Array, distance: float, ahead: Array, last: Array) -> Array:
        """Point of lowest misfit at a distance along a direction, shape (p,).

        Parameters
        ----------
        along
            Direction, shape (p,).
        distance
            Distance from the centre in z.
        ahead
            Place to search from, as the course so far leads there, shape (p,).
        last
            Place before, shape (p,). Where the search from `ahead` ends out of the
            noise and two or more settings are left free, the search starts from there,
            and from elsewhere, too: a floor that bends leads astray.
        """
        # The course so far is the better guess, and one search is enough within noise.
        found = self._lowest(along, distance, ahead)
        is_within = self.runs.misfit(found) - self.minimum <= self.noise
        if is_within or len(self.z) < 3:
            return found
        starts = [last, *self._towards_seen(along, distance), *self._awake(found)]
        others = [self._lowest(along, distance, start) for start in starts]
        return min([found, *others], key=self.runs.misfit)

    def _towards_seen(self, along: Array, distance: float) -> list[Array]:
        """Place at a distance along a direction, (p,), towards the next one seen there.

        One within noise, which lies on the floor, and at least half as far; none if
        there is none.
        """
        moves = self.moves
        distances = moves @ along
        is_there = (distances > 0.5 * distance) & (self._rises() <= self.noise)
        if not is_there.any():
            return []
        apart = np.where(is_there, np.abs(distances - distance), np.inf)
        next_one = int(apart.argmin())
        return [self.z + moves[next_one] * distance / distances[next_one]]

    def _awake(self, place: Array) -> list[Array]:
        """Places beside one, (p,), where settings that change nothing here begin to.

        Of a cap and a sum below it only the lower counts: no slope leads to the other.
        """
        sizes = np.linalg.norm(self.jacobian, axis=0)
        silent = sizes <= SILENT * sizes.max()
        if not silent.any():
            return []
        # Each alone, and all together.
        groups = np.unique([*np.diag(silent)[silent], silent], axis=0)
        edges = []
        for group in groups:
            for far in (-WALK, WALK):
                edges += self._edge(place, far * group)
        return edges

    def _edge(self, place: Array, along: Array) -> list[Array]:
        """Place just beyond the one, both (p,), up to which a move changes no misfit.

        None if all of the move, (p,), changes nothing.
        """
        misfit = self.runs.misfit(place)
        still = 0.0
        changed = 1.0
        if self._is_same(misfit, place + along):
            return []
        while changed - still > BROAD:
            middle = 0.5 * (still + changed)
            if self._is_same(misfit, place + middle * along):
                still = middle
            else:
                changed = middle
        return [place + changed * along]

    def _is_same(self, misfit: float, place: Array) -> bool:
        """Check whether a place, (p,), or the bound next to it, has a misfit."""
        there = self.runs.misfit(np.clip(place, *self._bounds))
        return math.isclose(misfit, there, rel_tol=SILENT)

    def _lowest(self, along: Array, distance: float, start: Array) -> Array:
        """Point of lowest misfit at a distance along a direction; all of shape (p,)."""
        start = np.clip(start, *self._bounds)
        pivot = int(np.abs(along).argmax())
        # The setting that counts most brings the start to the distance.
        start[pivot] += (distance - along @ (start - self.z)) / along[pivot]
        return self.runs.across(start, along, self._bounds)
