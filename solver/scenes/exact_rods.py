"""Closed forms of bar and strand, as curves for their plots."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.laws.compliant import Compliant
from solver.laws.slip_dependent import SlipDependent
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.broken_wire import broken_wire
from solver.reference.closed_forms.masing import masing
from solver.reference.closed_forms.pulled_bar import (
    closed_form,
    pulled_changing_bar,
    pulled_compliant_bar,
)


def exact_bar(bar: Rods, problem: Problem) -> Iterator[ExactCurve]:
    """Give friction along the bar, and the loop of its end."""
    closed = closed_form(bar)
    if closed is not None:
        law = problem.friction
        yield ExactCurve(
            "friction", bar.nodes, closed.friction_force / law.by_point(law.weights)[:, None]
        )
        yield ExactCurve("loop", closed.end_displacement, bar.load)
    elif isinstance(bar.friction_law, Compliant) and _is_even(bar):
        density = bar.friction_law.contact_stiffness * bar.stiffness / bar.length**2
        given = bar.length, bar.stiffness, float(bar.bound[0]), density
        yield _loop(bar, lambda force: pulled_compliant_bar(force, *given)[0])
    elif isinstance(bar.friction_law, SlipDependent) and _is_even(bar):
        yield from _grown(bar, bar.friction_law)


def _grown(bar: Rods, law: SlipDependent) -> Iterator[ExactCurve]:
    """Give the loop under a load that grows, as long as friction changes at every slipping point.

    Where friction softens that ends where the load would be more than the bar can take.
    """
    bound, slope = float(bar.bound[0]), abs(law.friction_ratio - 1.0) / law.slip_length
    if not slope or np.any(np.diff(bar.load, prepend=0.0) < 0.0):
        return
    gamma = np.sqrt(bound * slope / bar.stiffness)
    share = float(bar.load[-1]) * gamma / bound
    zone = np.arcsinh(share) if law.friction_ratio > 1.0 else np.arcsin(min(share, 1.0))
    if (share >= 1.0 and law.friction_ratio < 1.0) or zone > gamma * bar.length:
        return
    given = bar.stiffness, bound, law.friction_ratio, law.slip_length
    end = np.array([pulled_changing_bar(force, *given) for force in bar.load.tolist()])
    if end[-1] <= law.slip_length:
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
