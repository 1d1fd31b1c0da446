"""Closed forms of rods and of bodies in the plane, as curves for their plots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.rigid_stack import rigid_slide, wrench
from solver.discrete.plane.stack import Stack
from solver.discrete.problem import Problem
from solver.discrete.rods.rods import Rods
from solver.discrete.structure import LoopFields
from solver.laws import FrictionLaw, Strength
from solver.reference.closed_forms import ExactCurve
from solver.reference.closed_forms.elastic_bodies import (
    HalfPlane,
    TwoLeaves,
    cantilever,
    leaf_spring,
)
from solver.reference.closed_forms.masing import masing
from solver.reference.closed_forms.pulled_bar import (
    closed_form,
    pulled_changing_bar,
    pulled_compliant_bar,
)

SMALL = 0.12
"""Largest half-width of a contact, over the length and the height of its body, that is
still that of a half-plane: to some 2 % (tests/reference/test_hertz_and_cattaneo.py)."""
UNCOUPLED = 0.49
"""Poisson's ratio from which on pressure and friction leave each other alone on a rigid
support."""
RIGID = 50.0
"""Slide of a body over its largest deformation, from which on that is left out: 2 % of
it."""
STEADY = 0.01
"""Change of the pressing force, as a share, that is none."""


def exact_bar(bar: Rods, problem: Problem) -> Iterator[ExactCurve]:
    """Friction along the bar, and the loop of its end."""
    # What a known pressure makes and what needs none are one bound.
    law = replace(bar.friction_law, cohesion=0.0, cap=np.inf)
    bar = replace(bar, bound=bar.friction_law.without_slip(bar.bound), friction_law=law)
    closed = closed_form(bar)
    if closed is not None:
        friction = problem.friction
        density = closed.friction_force / friction.by_point(friction.weights)[:, None]
        yield ExactCurve("friction", bar.nodes, density)
        yield ExactCurve("loop", closed.end_displacement, bar.load)
    elif _is_even(bar) and law == FrictionLaw(stiffness=law.stiffness):
        given = bar.length, bar.stiffness, float(bar.bound[0]), law.stiffness
        grown = masing(bar.load, lambda force: pulled_compliant_bar(force, *given)[0])
        yield ExactCurve("loop", grown, bar.load)
    elif _is_even(bar) and law.strength and law == FrictionLaw(strength=law.strength):
        yield from _grown(bar, law.strength)


def _grown(bar: Rods, strength: Strength) -> Iterator[ExactCurve]:
    """Loop under a load that grows, as long as friction changes at every slipping point.

    Where friction softens that ends where the load would be more than the bar can take.
    """
    (_, slip_length, *_) = strength.slips
    (_, ratio, *_) = strength.factors
    bound = float(bar.bound[0])
    slope = abs(ratio - 1.0) / slip_length
    if not slope or np.any(np.diff(bar.load, prepend=0.0) < 0.0):
        return
    gamma = np.sqrt(bound * slope / bar.stiffness)
    share = float(bar.load[-1]) * gamma / bound
    if ratio > 1.0:
        zone = np.arcsinh(share)
    else:
        zone = np.arcsin(min(share, 1.0))
    if (share >= 1.0 and ratio < 1.0) or zone > gamma * bar.length:
        return
    given = bar.stiffness, bound, ratio, slip_length
    end = np.array([pulled_changing_bar(force, *given) for force in bar.load.tolist()])
    if end[-1] <= slip_length:
        yield ExactCurve("loop", end, bar.load)


def _is_even(bar: Rods) -> bool:
    """Return whether nothing but a force at its end moves the bar, which is the same throughout."""
    is_uniform = bar.section is None and bar.bound.ndim == 1 and not np.ptp(bar.bound)
    return bar.is_only_pulled and is_uniform


def _is_coulombs(body: Stack) -> bool:
    """Return whether friction on the support is mu N and no more, with one mu."""
    assert body.support is not None
    return body.friction_law == FrictionLaw() and not np.ptp(body.support.friction)


def exact_parabola(
    body: Stack, radius: float, problem: Problem, solution: LoopFields
) -> Iterator[ExactCurve]:
    """Pressure and friction of Hertz, Cattaneo and Mindlin, for the forces that are found."""
    law = problem.rubbing["support"]
    contact = solution.contact("support")
    assert contact.normal_force is not None
    assert body.support is not None
    total = contact.normal_force.sum(axis=0)
    most = float(total.max())
    friction = float(np.max(body.support.friction))
    if most <= 0.0 or not _is_coulombs(body) or (friction and body.poisson < UNCOUPLED):
        return
    if body.state == "strain":
        wide = body.poisson**2
    else:
        wide = 0.0
    modulus = body.young / (1.0 - wide)
    if HalfPlane(most, radius, modulus).half_width > SMALL * min(
        body.length, body.height
    ):
        return
    pressed = np.maximum(total, most * np.finfo(float).eps)
    place = law.positions[:, None] - law.positions @ contact.normal_force / pressed
    pressure = np.stack(
        [
            HalfPlane(float(force), radius, modulus).pressure(own)
            for force, own in zip(pressed, place.T, strict=True)
        ],
        axis=1,
    )
    yield ExactCurve("pressure", law.positions, pressure)
    shear = contact.tangential_force.sum(axis=0)
    begins = _begins(shear, total, friction)
    if begins is not None:
        held = float(total[begins:].mean())
        middle = float(law.positions @ contact.normal_force[:, -1] / total[-1])
        exact = HalfPlane(held, radius, modulus)
        traction = exact.traction_over(law.positions - middle, friction, shear)
        yield ExactCurve("friction", law.positions, traction)


def _begins(shear: Array, total: Array, friction: float) -> int | None:
    """Last instant before any shear, if a steady force presses from then on."""
    acts = np.flatnonzero(np.abs(shear) > STEADY * friction * total.max())
    if not friction or not len(acts):
        return None
    first = max(int(acts[0]) - 1, 0)
    return first if np.ptp(total[first:]) <= STEADY * total.max() else None


def exact_on_spring(body: Stack) -> Iterator[ExactCurve]:
    """Shear force of a block that a spring pulls back, where it slides like a rigid one.

    It does where it slides much farther than it is deformed, and no side holds it.
    """
    held = any(given.prescribed for side in body.sides.values() for given in side)
    if held or body.spring is None or not _is_coulombs(body):
        return
    slide = rigid_slide(body, body.spring)
    pushed, pressed, _ = wrench(body)
    stress = max(
        np.abs(pushed).max() / body.height, np.abs(pressed).max() / body.length
    )
    if np.abs(slide).max() < RIGID * stress / body.young * max(
        body.length, body.height
    ):
        return
    pull = body.spring.stiffness * np.maximum(-slide - body.spring.slack, 0.0)
    yield ExactCurve("loop", slide, pushed + pull)


def exact_layers(
    body: Stack, problem: Problem, solution: LoopFields | None
) -> Iterator[ExactCurve]:
    """Force that bends beams, apart without friction, or as one where nothing slips."""
    given = body.sides["right"].y
    if body.state != "stress" or (
        body.stiffness is not None and np.ptp(body.stiffness)
    ):
        return
    if not given.prescribed and not np.any(given.mean):
        return
    leaves = _two_leaves(body)
    if leaves is not None:
        if given.prescribed:
            yield ExactCurve("loop", given.mean, masing(given.mean, leaves.force))
        else:
            grown = masing(body.end_force, leaves.deflection)
            yield ExactCurve("loop", grown, body.end_force)
        return
    law = body.friction_law
    apart = law == replace(FrictionLaw(), strength=law.strength) and not np.any(
        body.friction
    )
    if not apart:
        if solution is None or np.isfinite([law.stiffness, law.normal_stiffness]).any():
            return
        if any(solution.contact(name).status.any() for name in problem.rubbing):
            return
    if apart:
        beams = 1.0 * len(body.reach)
        height = body.height
    else:
        beams = 1.0
        height = body.size[1]
    if np.any(body.reach < 1.0):
        if apart:
            graduated = _leaves(body)
        else:
            graduated = None
        if graduated is None:
            return
        beams = graduated
    stiffness = beams * cantilever(body.length, height, body.young, body.poisson)
    if given.prescribed:
        yield ExactCurve("loop", given.mean, stiffness * given.mean)
    else:
        yield ExactCurve("loop", body.end_force / stiffness, body.end_force)


def _two_leaves(body: Stack) -> TwoLeaves | None:
    """Closed form of two equal leaves under a pressure that stays while they are bent."""
    bent = body.sides["right"].y.mean
    given = body.sides["top"].y
    acts = np.flatnonzero(bent)
    is_plain = (
        body.friction_law == FrictionLaw()
        and np.any(body.friction)
        and not given.prescribed
    )
    if not np.array_equal(body.reach, [1.0, 1.0]) or not is_plain or not len(acts):
        return None
    pressure = -given.mean[max(acts[0] - 1, 0) :]
    mu = np.asarray(body.friction)
    if np.ptp(pressure) or np.ptp(mu) or pressure[0] <= 0.0:
        return None
    size = body.length, body.height, body.young, body.poisson
    return TwoLeaves(*size, float(mu.flat[0] * pressure[0]))


def _leaves(body: Stack) -> float | None:
    """Stiffness of a leaf spring over that of its longest leaf; None where no closed form is known.

    Leaves grow shorter the way they are bent, and nothing else presses them together.
    """
    bent = body.sides["right"].y.mean
    steps = np.diff(body.reach)
    grows = np.all(steps < 0.0) and np.all(bent >= 0.0)
    falls = np.all(steps > 0.0) and np.all(bent <= 0.0)
    pressed = any(not body.sides[side].y.is_zero for side in ("top", "bottom"))
    if pressed or not (grows or falls):
        return None
    return leaf_spring(np.sort(body.length * body.reach)[::-1])
