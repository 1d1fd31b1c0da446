"""A body that slides as a whole against a slack spring: its rigid motion is the local stage's.

A rigid motion costs no force, so the linear stage leaves it free and E+ alone holds it:
with all contacts slipping, an iteration moves the body by about (spring over k) of what
is missing. So here k is taken to be nothing along that motion: at every instant the
local stage shifts the whole body to where its own forces and the load balance
(solver/README.md, 2). What remains is the same iteration between both stages, on what
deforms, whatever the spring.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.laws import Contact, Unilateral

SAME = 1e-9
"""By how much a motion may differ from a slide along the support."""
BALANCED = 1e-14
"""Share of all that friction and load may be, which is left over where they balance."""
TRIALS = 8
"""Straight lines that are followed to their zero, before it is looked for between two
shifts."""


def slide_of(problem: Problem, k: Array) -> Slide | None:
    """The slide along its support of a body that a slack spring catches, with the k of all rows.

    None where there is no such body, or something else holds it.
    """
    if problem.own_laws or problem.given_forces:
        return None
    springs = [law.normal for law in problem.rubbing.values() if _is_spring(law)]
    ground = [law for law in problem.rubbing.values() if not _is_spring(law)]
    if problem.motions is None or len(ground) != 1 or len(springs) != 1:
        return None
    (law,) = ground
    (spring,) = springs
    if law.normal is None or spring is None or not law.is_on_support:
        return None
    along = law.tangential
    if along.strength is not None or along.cap is not None:
        return None
    slides = law.tangent.above
    across = law.normal.component.above
    wanted = np.concatenate([np.ones(len(slides)), np.zeros(len(across))])
    moved = problem.motions[problem.row_dofs[np.concatenate([slides, across])]]
    shares = np.linalg.lstsq(moved, wanted, rcond=None)[0]
    is_held = np.abs(moved @ shares - wanted).max() > SAME
    way = np.asarray(problem.motions @ shares)
    if is_held:
        return None
    return Slide(problem, way, k, law, spring)


def _is_spring(law: Contact) -> bool:
    """Whether a law is that of a spring: it presses, gives way, and does not rub."""
    rubs = law.tangential.friction.any() or law.tangential.bound.any()
    return law.normal is not None and law.normal.softness is not None and not rubs


class Slide:
    """The shift of a body to where the forces of a local stage balance its load.

    With the pressing forces known, all points that rub move by one shift. Their forces
    and the spring's fall with it, in straight lines between the shifts at which a point
    begins to slip and the spring to pull, so that there is one zero. A point that
    sticks remembers where it came to rest, which ties each instant to the one before.
    The body moves by 1 along the support in the `motion` of the rows, shape (n_rows,).
    """

    def __init__(
        self,
        problem: Problem,
        way: Array,
        k: Array,
        ground: Contact,
        spring: Unilateral,
    ) -> None:
        across = ground.normal
        along = ground.tangential
        assert across is not None
        assert spring.softness is not None
        self._across = across.component.above
        self._along = along.component.above
        self._end = spring.component.above
        self._closed = -across.gap[:, None]
        self._k = k[self._across, None]
        self._bound = along.bound
        self._friction = along.friction[:, None]
        soft = 1.0 / k[self._along] + (
            0.0 if along.softness is None else along.softness
        )
        self._soft = soft[:, None]
        # A point that sticks pulls the body back with its stiffness.
        self._stiffness = 1.0 / soft
        if along.start is None:
            self._start = np.zeros(len(soft))
        else:
            self._start = along.start
        self._spring = float(1.0 / (1.0 / k[self._end] + spring.softness)[0])
        self._slack = float(spring.gap[0])
        self.motion: Array = way[problem.row_dofs]
        parts = problem.substructures
        loads = [
            way[part.dofs] @ part.body_force
            for part in parts
            if part.body_force is not None
        ]
        if loads:
            self._load = np.sum(loads, axis=0)
        else:
            self._load = np.zeros(problem.n_instants)

    def balanced(self, incoming: Array) -> Array:
        """Shift z = W - F/k of all rows, shape (n_rows, n_instants), instant by instant."""
        held = incoming[self._across]
        pressing = self._k * (np.maximum(held, self._closed) - held)
        reach = (self._bound + self._friction * pressing) * self._soft
        targets = np.ascontiguousarray(incoming[self._along].T)
        ends = -self._slack - incoming[self._end][0]
        shifts = self._shifts(targets, np.ascontiguousarray(reach.T), ends)
        shifted = np.empty_like(incoming)
        np.multiply(self.motion[:, None], shifts, out=shifted)
        return np.add(shifted, incoming, out=shifted)

    def _shifts(self, targets: Array, reach: Array, ends: Array) -> Array:
        """The shift of every instant, shape (n_instants,), scaled.

        Of points at `targets` without friction or shift, which can be behind by `reach`
        before they slip, (n_instants, n_points) both; the spring pulls up to the shifts
        `ends`.
        """
        enough = BALANCED * (reach @ self._stiffness + np.abs(self._load))
        # Points are seen from the body, where the digits of how far they are behind
        # stay.
        back = -np.diff(targets, axis=0, prepend=0.0)
        numbers = (values.tolist() for values in (ends, self._load, enough))
        held = self._start
        shift = 0.0
        steps = []
        for came, least, most, end, load, left in zip(
            back, -reach, reach, *numbers, strict=True
        ):
            given = held + came, least, most, end - shift, load
            step, held = self._followed(*given, left) or self._between(*given)
            shift += step
            steps.append(step)
        return np.cumsum(steps)

    def _followed(
        self,
        behind: Array,
        least: Array,
        most: Array,
        end: float,
        load: float,
        enough: float,
    ) -> tuple[float, Array] | None:
        """Step at which all balances, by straight lines, and how far points are behind then."""
        # The nearer the iteration is to its end, the less is left to shift.
        pulled = self._stiffness.dot
        wanted = behind
        step = 0.0
        for trial in range(TRIALS):
            held = np.minimum(np.maximum(wanted, least), most)
            left = float(pulled(held)) + load
            if end > step:
                left += self._spring * (end - step)
            # A step that a line has led to is where that line ends; no step at all may
            # be a flat.
            if trial and abs(left) <= enough:
                return step, held
            slope = float(pulled(held == wanted)) + (
                self._spring if end > step else 0.0
            )
            if not slope > 0.0:
                return None
            if abs(left) <= enough:
                return step, held
            step += left / slope
            wanted = behind - step
        return None

    def _between(
        self, behind: Array, least: Array, most: Array, end: float, load: float
    ) -> tuple[float, Array]:
        """The same, by what is left at all shifts at which anything begins to slip or pull."""
        turns = np.sort(np.concatenate([behind - most, behind - least, [end]]))
        steps = np.append(turns, behind.mean())
        held = np.clip(behind[:, None] - steps, least[:, None], most[:, None])
        *left, as_now = (
            self._stiffness @ held + self._spring * np.maximum(end - steps, 0.0) + load
        )
        if as_now == 0.0:
            step = float(steps[-1])
        elif left[0] <= 0.0:
            step = float(turns[0] + left[0] / self._spring)
        else:
            step = float(np.interp(0.0, left[::-1], turns[::-1]))
        return step, np.clip(behind - step, least, most)
