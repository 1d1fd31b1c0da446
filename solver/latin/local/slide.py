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
from solver.latin.local.balance import Balance
from solver.laws import Contact, SlackSpring
from solver.laws.compliant import CompliantSliders
from solver.laws.frictionless import Frictionless
from solver.laws.sliders import Sliders

KNOWN_BOUND = (Sliders, CompliantSliders, Frictionless)
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
    if type(law.tangential) not in KNOWN_BOUND:
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

    With the pressing forces known friction falls with the shift, as the spring does.

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
        self._bound, self._friction = along.bound, along.friction[:, None]
        soft = 1.0 / k[rubs] + (0.0 if along.softness is None else along.softness)
        self._soft = soft[:, None]
        stop = float(1.0 / (1.0 / k[pulls] + spring.softness)[0])
        self._slack = float(spring.gap[0])
        self._way = way[problem.row_dofs, None]
        parts = problem.substructures
        loads = [way[one.dofs] @ one.body_force for one in parts if one.body_force is not None]
        load = np.sum(loads, axis=0) if loads else np.zeros(problem.n_instants)
        self._balance = Balance(1.0 / soft, stop, load)

    def balanced(self, incoming: Array) -> Array:
        """Shift z = W - F/k of all rows, shape (n_rows, n_instants), instant by instant."""
        found = np.empty_like(incoming)
        np.multiply(self._way, self.shifts(incoming), out=found)
        return np.add(found, incoming, out=found)

    def shifts(self, incoming: Array) -> Array:
        """Give the shift of every instant, shape (n_instants,), scaled."""
        held = incoming[self._across]
        pressing = self._k * (np.maximum(held, self._closed) - held)
        reach = (self._bound + self._friction * pressing) * self._soft
        targets = np.ascontiguousarray(incoming[self._along].T)
        ends = -self._slack - incoming[self._end][0]
        return self._balance(targets, np.ascontiguousarray(reach.T), ends)
