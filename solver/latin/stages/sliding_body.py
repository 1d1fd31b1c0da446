"""Slide of a body against a slack spring: a rigid motion in the local stage.

A rigid motion costs no force, so the linear stage leaves it free and E+ alone holds it:
with all contacts slipping, an iteration moves the body by about (spring over k) of the
distance that is missing. So here k is taken as zero along that motion: at every instant
the local stage shifts the whole body to where its own forces and the load balance
(MATHEMATICS.md, 2). What remains is the same iteration between both stages, for the
deformation, whatever the spring.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.laws import Contact, Unilateral

SAME = 1e-9
"""Largest difference of a motion from a slide of unit size along the support."""
BALANCED = 1e-14
"""Share of the largest friction and load that may be left over where they balance."""
TRIALS = 8
"""Largest number of straight lines that are followed to their zero, before the zero is
sought between two shifts."""


def slide_of(problem: Problem, k: Array) -> Slide | None:
    """Slide of a body along its support up to a slack spring, or None.

    None where there is no such body, or something else holds it. `k` is the search
    direction of the rows, shape (n_rows,), scaled.
    """
    if problem.user_laws or problem.prescribed_forces or problem.rigid_motions is None:
        return None
    if len(problem.contacts) != 2:
        return None
    laws = problem.contacts.values()
    springs = [law.normal for law in laws if law.is_spring]
    ground = [law for law in laws if not law.is_spring]
    if len(ground) != 1 or len(springs) != 1:
        return None
    law = ground[0]
    spring = springs[0]
    if law.normal is None or spring is None or not law.is_on_support:
        return None
    if law.tangential.slip_factor is not None or law.tangential.cap is not None:
        return None
    motion = _motion_along(problem, law.tangent.above, law.normal.component.above)
    if motion is None:
        return None
    return Slide(problem, motion, k, law, spring)


def _motion_along(problem: Problem, along: Indices, across: Indices) -> Array | None:
    """Rigid motion by 1 along the support and 0 across it, shape (n_dofs,), or None.

    `along` and `across` are the rows of the body's contact points.
    """
    assert problem.rigid_motions is not None
    wanted = np.concatenate([np.ones(len(along)), np.zeros(len(across))])
    moved = problem.rigid_motions[problem.row_dofs[np.concatenate([along, across])]]
    shares = np.linalg.lstsq(moved, wanted, rcond=None)[0]
    if np.abs(moved @ shares - wanted).max() > SAME:
        return None
    return np.asarray(problem.rigid_motions @ shares)


class Slide:
    """Shift of a body to the position of balanced forces in a local stage.

    With the pressing forces known, all points that rub move by one shift. Their forces
    and the spring's fall with it, in straight lines between the shifts at which a point
    begins to slip or the spring to pull, so that there is one zero. A point that sticks
    remembers where it came to rest, which ties each instant to the one before.

    Parameters
    ----------
    problem
        The problem to be solved.
    motion
        Rigid motion by 1 along the support, shape (n_dofs,).
    k
        Search direction of the rows, shape (n_rows,), scaled.
    ground, spring
        Contact of the body with its support, and its slack spring.

    Attributes
    ----------
    motion
        The same motion of the rows, shape (n_rows,).
    """

    def __init__(
        self,
        problem: Problem,
        motion: Array,
        k: Array,
        ground: Contact,
        spring: Unilateral,
    ) -> None:
        across = ground.normal
        along = ground.tangential
        assert across is not None
        assert spring.compliance is not None
        self._across = across.component.above
        self._along = along.component.above
        self._end = spring.component.above
        self._closed = -across.gap[:, None]
        self._k = k[self._across, None]
        self._bound = along.bound
        self._friction = along.friction[:, None]
        if along.compliance is None:
            contact_compliance: Array | float = 0.0
        else:
            contact_compliance = along.compliance
        compliance = 1.0 / k[self._along] + contact_compliance
        self._compliance = compliance[:, None]
        # A point that sticks pulls the body back with its stiffness.
        self._stiffness = 1.0 / compliance
        if along.start is None:
            self._start = np.zeros(len(compliance))
        else:
            self._start = along.start
        self._spring = float(1.0 / (1.0 / k[self._end] + spring.compliance)[0])
        self._slack = float(spring.gap[0])
        self.motion: Array = motion[problem.row_dofs]
        self._load = _load_along(problem, motion)

    def balanced(self, incoming: Array) -> Array:
        """Shift z = W - F/k of all rows, instant by instant.

        Both z have shape (n_rows, n_instants), scaled.
        """
        # Pressing forces do not depend on a slide along the support, so they are known.
        held = incoming[self._across]
        pressing = self._k * (np.maximum(held, self._closed) - held)
        slack = (self._bound + self._friction * pressing) * self._compliance
        targets = np.ascontiguousarray(incoming[self._along].T)
        ends = -self._slack - incoming[self._end][0]
        shifts = self._shifts(targets, np.ascontiguousarray(slack.T), ends)
        shifted = np.empty_like(incoming)
        np.multiply(self.motion[:, None], shifts, out=shifted)
        return np.add(shifted, incoming, out=shifted)

    def _shifts(self, targets: Array, slack: Array, ends: Array) -> Array:
        """Shift of the body at every instant, shape (n_instants,), scaled.

        Parameters
        ----------
        targets
            Positions of the points without friction or shift, shape (n_instants,
            n_points), scaled.
        slack
            Distance by which a point can be behind before it slips, same shape.
        ends
            Shift up to which the spring pulls, shape (n_instants,), scaled.
        """
        enough = BALANCED * (slack @ self._stiffness + np.abs(self._load))
        # Points are seen from the body, where the digits of how far they are behind
        # stay.
        retreats = -np.diff(targets, axis=0, prepend=0.0)
        behind = self._start
        shift = 0.0
        steps = []
        instants = zip(
            retreats,
            -slack,
            slack,
            ends.tolist(),
            self._load.tolist(),
            enough.tolist(),
            strict=True,
        )
        for retreat, lower, upper, end, load, allowed in instants:
            behind = behind + retreat
            rest = end - shift
            found = self._followed(behind, lower, upper, rest, load, allowed)
            if found is None:
                found = self._between(behind, lower, upper, rest, load)
            step, behind = found
            shift += step
            steps.append(step)
        return np.cumsum(steps)

    def _followed(
        self,
        behind: Array,
        lower: Array,
        upper: Array,
        end: float,
        load: float,
        enough: float,
    ) -> tuple[float, Array] | None:
        """Step to the balance of forces at an instant, by straight lines.

        Parameters
        ----------
        behind
            Distance of the points behind the body before the step, shape (n_points,).
        lower, upper
            Bounds on that distance, at which a point slips, same shape.
        end
            Step up to which the spring pulls.
        load
            Load along the motion.
        enough
            Unbalanced force that counts as balance.

        Returns
        -------
        The step, and the distance behind after it, shape (n_points,); None where no
        line leads to a balance. All are scaled.
        """
        # The nearer the iteration is to its end, the less is left to shift.
        pulled = self._stiffness.dot
        wanted = behind
        step = 0.0
        for trial in range(TRIALS):
            held = np.minimum(np.maximum(wanted, lower), upper)
            unbalanced = float(pulled(held)) + load
            if end > step:
                unbalanced += self._spring * (end - step)
            is_balanced = abs(unbalanced) <= enough
            # A step that a line has led to is where that line ends; no step at all may
            # be a flat.
            if trial and is_balanced:
                return step, held
            # Points at a bound slip, and their friction does not change with the step.
            slope = float(pulled(held == wanted))
            if end > step:
                slope += self._spring
            if not slope > 0.0:
                return None
            if is_balanced:
                return step, held
            step += unbalanced / slope
            wanted = behind - step
        return None

    def _between(
        self, behind: Array, lower: Array, upper: Array, end: float, load: float
    ) -> tuple[float, Array]:
        """Step to the balance of forces at an instant, by interpolation.

        The unbalanced forces are computed at all steps at which a point begins to slip
        or the spring to pull. Arguments and result are those of `_followed`, with
        shapes (n_points,).
        """
        turns = np.sort(np.concatenate([behind - upper, behind - lower, [end]]))
        steps = np.append(turns, behind.mean())
        held = np.clip(behind[:, None] - steps, lower[:, None], upper[:, None])
        pulled = self._spring * np.maximum(end - steps, 0.0)
        *unbalanced, at_mean = self._stiffness @ held + pulled + load
        if at_mean == 0.0:
            step = float(steps[-1])
        # Before the first turn all points slip, and the spring alone changes its force.
        elif unbalanced[0] <= 0.0:
            step = float(turns[0] + unbalanced[0] / self._spring)
        else:
            step = float(np.interp(0.0, unbalanced[::-1], turns[::-1]))
        return step, np.clip(behind - step, lower, upper)


def _load_along(problem: Problem, motion: Array) -> Array:
    """Load of body forces along a motion, (n_dofs,), of shape (n_instants,), scaled."""
    loads = []
    for part in problem.substructures:
        if part.body_force is not None:
            loads.append(motion[part.dofs] @ part.body_force)
    if loads:
        return np.asarray(np.sum(loads, axis=0))
    return np.zeros(problem.n_instants)
