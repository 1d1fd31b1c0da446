"""A body that slides as a whole against a slack spring: its rigid motion is the local stage's.

A rigid motion costs no force, so the linear stage leaves it free and E+ alone holds it: with all
contacts slipping, an iteration moves the body by about (spring over k) of what is missing. So here
k is taken to be nothing along that motion: at every instant the local stage shifts the whole body
to where its own forces and the load balance (solver/README.md, 2). What remains is the same
iteration between both stages, on what deforms, whatever the spring.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.laws import Contact, SlackSpring
from solver.laws.compliant import CompliantSliders
from solver.laws.frictionless import Frictionless
from solver.laws.sliders import Sliders

BALANCED = (Sliders, CompliantSliders, Frictionless)
"""Tangential laws whose friction falls with a shift, their bound being known from the pressure."""
SAME = 1e-9
"""By how much a motion may differ from a slide along the support."""


def slide_of(problem: Problem) -> Array | None:
    """Give the rigid motion along its support of a body that a slack spring catches.

    Returns
    -------
    Displacement of all degrees of freedom, shape (n_dofs,), 1 along the support; None where there
    is no such body, or something else holds it.
    """
    ground = [law for law in problem.rubbing.values() if not _is_spring(law)]
    if problem.motions is None or len(ground) != 1 or len(problem.rubbing) != 2:
        return None
    (law,) = ground
    if law.normal is None or not law.is_on_support:
        return None
    if type(law.tangential) not in BALANCED:
        return None
    along, across = law.tangent.above, law.normal.component.above
    wanted = np.concatenate([np.ones(len(along)), np.zeros(len(across))])
    own = problem.motions[problem.row_dofs[np.concatenate([along, across])]]
    shares = np.linalg.lstsq(own, wanted, rcond=None)[0]
    is_held = np.abs(own @ shares - wanted).max() > SAME
    return None if is_held else np.asarray(problem.motions @ shares)


def _is_spring(law: Contact) -> bool:
    return isinstance(law.normal, SlackSpring)


class Slide:
    """The shift of a body to where the forces of a local stage balance its load.

    With the pressing forces known friction falls with the shift, as the spring does; so there is
    one zero, between the shifts at which a point begins to slip and the spring to pull.

    Parameters
    ----------
    problem, way
        What is solved, and the motion, as `slide_of` gives it.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    """

    def __init__(self, problem: Problem, way: Array, k: Array) -> None:
        (ground,) = (law for law in problem.rubbing.values() if not _is_spring(law))
        (spring,) = (law.normal for law in problem.rubbing.values() if _is_spring(law))
        law, along = ground.normal, ground.tangential
        assert law is not None
        assert spring is not None
        assert spring.softness is not None
        held, pulls = law.component.above, spring.component.above
        rubs = along.component.above
        self._across, self._along, self._end = held, rubs, pulls
        self._closed, self._k = -law.gap[:, None], k[held, None]
        self._bound, self._friction = along.bound[:, None], along.friction[:, None]
        soft = 1.0 / k[rubs] + (0.0 if along.softness is None else along.softness)
        self._stiffness = 1.0 / soft
        self._spring = float(1.0 / (1.0 / k[pulls] + spring.softness)[0])
        self._slack = float(spring.gap[0])
        self._way = way[problem.row_dofs]
        parts = problem.substructures
        loads = [way[one.dofs] @ one.body_force for one in parts if one.body_force is not None]
        self._load = np.sum(loads, axis=0) if loads else np.zeros(problem.n_instants)

    def balanced(self, incoming: Array) -> Array:
        """Shift z = W - F/k of all rows, shape (n_rows, n_instants), instant by instant."""
        return np.asfortranarray(incoming + np.multiply.outer(self._way, self.shifts(incoming)))

    def shifts(self, incoming: Array) -> Array:
        """Give the shift of every instant, shape (n_instants,), scaled."""
        held = incoming[self._across]
        pressing = self._k * (np.maximum(held, self._closed) - held)
        bound = np.asfortranarray(self._bound + self._friction * pressing)
        targets = np.asfortranarray(incoming[self._along])
        ends = -self._slack - incoming[self._end][0]
        found = np.zeros(len(self._load))
        place, shift = np.zeros(len(targets)), 0.0
        for instant, load in enumerate(self._load):
            # Places are those of the points before, seen from the body: their digits stay.
            most = bound[:, instant]
            behind = place - targets[:, instant]
            step = self._zero(behind, most, float(ends[instant]) - shift, float(load))
            reach = most / self._stiffness
            place = targets[:, instant] + np.clip(behind - step, -reach, reach)
            shift += step
            found[instant] = shift
        return found

    def _zero(self, behind: Array, most: Array, end: float, load: float) -> float:
        """Find the step at which the friction of all points, the spring and the load balance."""

        def left(step: float) -> float:
            rubs = np.minimum(np.maximum(self._stiffness * (behind - step), -most), most)
            return float(rubs.sum()) + self._spring * max(end - step, 0.0) + load

        stays = float(behind.mean())
        if left(stays) == 0.0:
            return stays
        reach = most / self._stiffness
        turns = np.sort(np.concatenate([behind - reach, behind + reach, [end]]))
        first, last = 0, len(turns) - 1
        above, below = left(turns[first]), left(turns[last])
        if above <= 0.0:
            return float(turns[first] + above / self._spring)
        if below >= 0.0:
            return float(turns[last])
        while last - first > 1:
            middle = (first + last) // 2
            value = left(turns[middle])
            if value > 0.0:
                first, above = middle, value
            else:
                last, below = middle, value
        share = above / (above - below)
        return float(turns[first] + share * (turns[last] - turns[first]))
