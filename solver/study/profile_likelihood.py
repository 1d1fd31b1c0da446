"""Profile likelihood: ranges of settings that are compatible with a measured loop.

The misfit is |r(z)|^2, r the differences to a measured loop, (n_rows,), and z the
settings on their scales, (p,). Along a direction w, a setting alone or a combination,
its profile is

    m(c) = least misfit of all z with w . z = c,

found from one c to the next by least squares over the free directions. With the least
misfit m0 and the noise s^2 = m0 / (n - p), all c with

    m(c) - m0 <= F s^2

are within two standard errors (F is the quantile of the F distribution with 1 and n - p
degrees of freedom that belongs to two standard errors: 4 for many rows). The slope of r
at the nearest run, which is all that (J^T J)^-1 knows, tells that only where r is
straight. Here r is not straight: a node of the mesh slips or sticks, and the floor of a
valley has a dent for each node.

These dents tell of the mesh and not of the loop. So whether a setting is known at all
is judged with the change d of the loop on elements of half the size as one more source
of noise:

    m(c) - m0 <= F (s^2 + |d|^2)

must end on both sides before `FACTOR`. The margins of a setting that is known are those
of the noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array

FACTOR = 1.5
"""Factor on a setting within two standard errors from which on it is not determined."""
LIMIT = math.log(FACTOR)
"""The same distance in z."""


@dataclass(frozen=True)
class ProfileSide:
    """Side of a profile: points along a direction, and the misfit there.

    Attributes
    ----------
    distances
        Distances of the places from the nearest run, in z, shape (n_places,). The first
        place is the nearest run.
    rises
        Misfit of the places less the least one, same shape.
    is_at_bound
        Whether the last place is at a bound of the setting.
    """

    distances: Array
    rises: Array
    is_at_bound: bool

    def end(self, level: float) -> float:
        """Distance beyond which the misfit stays above a level; infinite if not found.

        Between two places the root of the rise is taken as straight.
        """
        # The last place below the level: a dent before it does not end the margin.
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
class LikelihoodProfile:
    """Both sides of the profile along a direction, and the levels of their valley.

    Attributes
    ----------
    below, above
        Sides of the profile.
    noise, doubt
        Rises of the misfit that are within two standard errors: of the noise, and of
        noise and mesh.
    """

    below: ProfileSide
    above: ProfileSide
    noise: float
    doubt: float

    @property
    def is_known(self) -> bool:
        """Check whether both ends are nearer than `LIMIT`, also for mesh errors."""
        return max(self.below.end(self.doubt), self.above.end(self.doubt)) < LIMIT

    @property
    def is_known_to_noise(self) -> bool:
        """Check whether both ends are nearer than `LIMIT` for an exact mesh."""
        return max(self.ends(self.noise)) < LIMIT

    def ends(self, level: float | None = None) -> tuple[float, float]:
        """Distances to both ends of two standard errors, infinite where a side is open.

        Without a level they are those of the noise where the direction is known, and
        otherwise those of noise and mesh.
        """
        if level is None and self.is_known:
            level = self.noise
        elif level is None:
            level = self.doubt
        return _or_open(self.below.end(level)), _or_open(self.above.end(level))


def _or_open(end: float) -> float:
    """Distance to an end; infinite beyond `LIMIT`."""
    if end < LIMIT:
        return end
    return math.inf
