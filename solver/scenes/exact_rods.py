"""Closed forms of bar and strand, as curves for their plots."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from solver.discrete.problem import Problem
from solver.discrete.rods import Rods
from solver.laws import FrictionLaw, Strength
from solver.reference.closed_forms.broken_wire import broken_wire
from solver.reference.closed_forms.changing_friction_bar import pulled_changing_bar
from solver.reference.closed_forms.compliant_bar import pulled_compliant_bar
from solver.reference.closed_forms.exact_curve import ExactCurve
from solver.reference.closed_forms.masing import masing
from solver.reference.closed_forms.pulled_bar import closed_form


def exact_bar(bar: Rods, problem: Problem) -> Iterator[ExactCurve]:
    """Give friction along the bar, and the loop of its end."""
    closed = closed_form(bar)
    if closed is not None:
        friction = problem.friction
        density = closed.friction_force / friction.by_point(friction.weights)[:, None]
        yield ExactCurve("friction", bar.nodes, density)
        yield ExactCurve("loop", closed.end_displacement, bar.load)
    elif _is_even(bar):
        law = bar.friction_law
        if law == FrictionLaw(stiffness=law.stiffness):
            given = bar.length, bar.stiffness, float(bar.bound[0]), law.stiffness
            yield _loop(bar, lambda force: pulled_compliant_bar(force, *given)[0])
        elif law.strength is not None and law == FrictionLaw(strength=law.strength):
            yield from _grown(bar, law.strength)


def _grown(bar: Rods, strength: Strength) -> Iterator[ExactCurve]:
    """Give the loop under a load that grows, as long as friction changes at every slipping point.

    Where friction softens that ends where the load would be more than the bar can take.
    """
    (_, slip_length, *_), (_, ratio, *_) = strength.slips, strength.factors
    bound, slope = float(bar.bound[0]), abs(ratio - 1.0) / slip_length
    if not slope or np.any(np.diff(bar.load, prepend=0.0) < 0.0):
        return
    gamma = np.sqrt(bound * slope / bar.stiffness)
    share = float(bar.load[-1]) * gamma / bound
    zone = np.arcsinh(share) if ratio > 1.0 else np.arcsin(min(share, 1.0))
    if (share >= 1.0 and ratio < 1.0) or zone > gamma * bar.length:
        return
    given = bar.stiffness, bound, ratio, slip_length
    end = np.array([pulled_changing_bar(force, *given) for force in bar.load.tolist()])
    if end[-1] <= slip_length:
        yield ExactCurve("loop", end, bar.load)


def exact_strand(strand: Rods) -> Iterator[ExactCurve]:
    """Give the forces of the broken wire and of each neighbour."""
    exact = broken_wire(strand)
    if exact is not None:
        for force in (exact.force, exact.neighbour_force):
            yield ExactCurve("axial force", strand.nodes, force)


def _is_even(bar: Rods) -> bool:
    """Tell whether nothing but a force at its end moves the bar, which is the same throughout."""
    absent = bar.support, bar.body_force, bar.section
    return all(one is None for one in absent) and bar.bound.ndim == 1 and not np.ptp(bar.bound)


def _loop(bar: Rods, grown: Callable[[float], float]) -> ExactCurve:
    return ExactCurve("loop", masing(bar.load, grown), bar.load)
