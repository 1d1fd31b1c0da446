"""Equilibrium of a rigid body on its support: loss, rest, and sliding."""

from __future__ import annotations

from collections.abc import Iterable
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array, Indices
from solver.discrete.plane.rectangles.sides import SideComponent, Spring
from solver.discrete.plane.rectangles.stack import Stack

SLACK = 1e-9
"""Largest rounding of the loads, as a share of them."""
BEDDING = 7.0
"""Stiffness of the support per area, times the body's length over E: that of the
contact itself, as the automatic search direction estimates it."""
STEPS = 50
"""Largest number of Newton steps; a few suffice."""
SETTLED = 1e-9
"""Share of the load that the support need not hold when Newton's steps end."""
FREE = 1e-9
"""Stiffness, as a share of the largest, up to which a motion is free; and share of the
load beyond which it pushes a free motion."""


def wrench(stack: Stack) -> tuple[Array, Array, Array]:
    """Resultants of tractions and body forces on a single body.

    Forces along x and y, N, and the counter-clockwise moment about the lower left
    corner, N m; shape (n_instants,) each.
    """
    length = stack.length
    height = stack.height
    force = np.zeros((2, len(stack.instants)))
    moment = np.zeros(len(stack.instants))
    for name, side in stack.sides.items():
        size = height if name in ("left", "right") else length
        along_x, first_x = _resultant(side.x, size)
        along_y, first_y = _resultant(side.y, size)
        force += [along_x, along_y]
        # Along a side the moment is that about its first end, across it the force has
        # the distance of the side as its arm.
        if name in ("left", "right"):
            arm = length if name == "right" else 0.0
            moment += arm * along_y
            moment -= first_x
        else:
            arm = height if name == "top" else 0.0
            moment += first_y
            moment -= arm * along_x
    if stack.body_force is not None:
        weight = stack.body_force * length * height
        force += weight
        moment += 0.5 * (length * weight[1] - height * weight[0])
    return force[0], force[1], moment


def _resultant(given: SideComponent, size: float) -> tuple[Array, Array]:
    """Resultant of a traction, N, and its moment about the first end of the side, N m.

    Shape (n_instants,) both; `size` is the length of the side, m. A prescribed
    displacement has none.
    """
    if given.prescribed:
        zero = np.zeros_like(given.mean)
        return zero, zero
    total = size * given.mean
    return total, 0.5 * size * total + size**2 / 6.0 * given.slope


def is_held_up(stack: Stack) -> bool:
    """Check whether the vertical displacement of a side is prescribed."""
    return any(side.y.prescribed for side in stack.sides.values())


def is_upright(stack: Stack) -> bool:
    """Check whether a side prevents rotation of the body."""
    sides = stack.sides
    return (
        sides["top"].y.prescribed
        or sides["left"].x.prescribed
        or sides["right"].x.prescribed
        or (sides["left"].y.prescribed and sides["right"].y.prescribed)
    )


def loss_of_equilibrium(stack: Stack) -> tuple[float, str] | None:
    """Time, s, and reason of the first loss of equilibrium on a support, or None.

    A rigid body can rest only where the support holds all that no side holds: it
    presses and does not pull, friction carries no more than its law allows, and the
    pressure's resultant acts on the base. A spring at the foot holds against all that
    pushes to the left; it does not keep the body from tipping. Of two losses at the
    same instant, the one that more friction does not mend is returned.
    """
    assert stack.support is not None
    x, y, moment = wrench(stack)
    size = np.abs([x, y]).max() + np.abs(moment).max() / stack.length
    slack = SLACK * size
    # A side that holds the body up may press it with any force.
    held_y = is_held_up(stack)
    pressing = np.where(held_y, np.inf, np.maximum(-y, 0.0))
    friction = _bound_before_slip(stack, pressing) * stack.friction_law.largest_factor
    # In the order in which losses at the same instant count.
    losses = list[tuple[NDArray[np.bool_], str]]()
    if not held_y:
        losses.append((y > slack, "the loads lift it off its support"))
    if not held_y and not is_upright(stack):
        tips = _tipping(stack, friction) > slack * stack.length
        losses.append((tips, "it tips over an end of its base"))
    if held_y and not is_upright(stack):
        turns = _turning(stack, friction) > slack * stack.length
        reason = "it turns about the side that holds it up, away from its support"
        losses.append((turns, reason))
    if not any(side.x.prescribed for side in stack.sides.values()):
        if stack.spring is not None:
            pushed = x
        else:
            pushed = np.abs(x)
        losses.append((pushed > friction + slack, "friction cannot hold it"))
    return _first_of(losses, stack.instants)


def _first_of(
    losses: Iterable[tuple[NDArray[np.bool_], str]], instants: Array
) -> tuple[float, str] | None:
    """Time, s, and reason of the earliest of losses; the first reason at equal times.

    A loss is at which instants it is so, (n_instants,), and its reason.
    """
    first = list[tuple[float, str]]()
    for is_lost, reason in losses:
        if is_lost.any():
            first.append((float(instants[np.argmax(is_lost)]), reason))
    return min(first, key=itemgetter(0), default=None)


def _tipping(stack: Stack, friction: Array) -> Array:
    """Moment that the pressure on the base cannot balance, (n_instants,), N m.

    Below 0 the pressure balances all moments. `friction` is the largest friction force,
    (n_instants,), N.
    """
    x, y, moment = wrench(stack)
    if not stack.sides["top"].x.prescribed:
        return np.maximum(moment, stack.length * y - moment)
    # The top is dragged with any force that friction can answer, which may hold the
    # body upright.
    middle = moment + stack.height * x
    answered = stack.height * friction
    return np.asarray(
        np.maximum(middle - answered, stack.length * y - middle - answered)
    )


def _turning(stack: Stack, friction: Array) -> Array:
    """Moment that turns the body off its support about a side, (n_instants,), N m.

    The left or the right side alone holds the body up; where its top is held along x,
    too, the body is a hinge at that corner. Below 0 the support balances the moment by
    pressing. `friction` is the largest friction force, (n_instants,), N; where it grows
    with the pressing, the body may be wedged between side and support.
    """
    x, y, moment = wrench(stack)
    answered = np.zeros_like(moment)
    if stack.sides["top"].x.prescribed:
        moment = moment + stack.height * x
        answered = stack.height * friction
    if stack.sides["left"].y.prescribed:
        return np.asarray(moment - answered)
    return np.asarray(stack.length * y - moment - answered)


def _bound_before_slip(stack: Stack, pressing: Array) -> Array:
    """Largest friction force on the body before slip, N, by the pressing force, N.

    Both have the shape (n_instants,).
    """
    assert stack.support is not None
    mu = float(np.max(stack.support.friction))
    # The pressing force may be infinite, and zero times that is no number.
    if mu:
        rubbed = mu * pressing
    else:
        rubbed = np.zeros_like(pressing)
    return stack.friction_law.bound_before_slip(rubbed, stack.length)


def rigid_rest(stack: Stack) -> Array | None:
    """Rigid motion that brings the body onto its support, shape (2, n_instants).

    Displacement upwards of the lower left corner, m, and counter-clockwise rotation
    about it; None where a side holds the body up, or where the body rests already. The
    body is rigid, the support an elastic bedding (Winkler), so that a curved side rests
    on a patch and not on a point. While nothing presses, the body stays where it is.
    """
    if stack.support is None or len(stack.rectangles) > 1 or is_held_up(stack):
        return None
    length = stack.length
    middle = 0.5 * length
    gap = stack.support.gap
    x = np.linspace(0.0, length, len(gap))
    _, force, moment = wrench(stack)
    # Taken about the middle and over the length, the rotation is a motion like the
    # other.
    n_motions = 1 if is_upright(stack) else 2
    shapes = np.stack([np.ones_like(x), (x - middle) / length])[:n_motions]
    wrenches = np.stack([force, (moment - middle * force) / length])[:n_motions]
    presses = np.flatnonzero(force < 0.0)
    bedding = BEDDING * stack.young / len(gap)
    settled = np.zeros((2, len(force)))
    wanted = -wrenches[:, presses] / bedding
    settled[:n_motions, presses] = _settled(gap, shapes, wanted)
    # From the middle to the corner.
    settled[1] /= length
    settled[0] -= middle * settled[1]
    rest = _since_last(settled, presses)
    return rest if rest.any() else None


def _since_last(values: Array, known: Indices) -> Array:
    """Values at the last known instant up to each instant; zero before the first.

    `values` are (n, n_instants), `known` the numbers of instants, ascending.
    """
    last = np.full(values.shape[1], -1)
    last[known] = known
    last = np.maximum.accumulate(last)
    return np.where(last >= 0, values[:, last], 0.0)


def rigid_slide(stack: Stack, spring: Spring) -> Array:
    """Displacement to the right of the rigid body that slides, (n_instants,), m.

    The body moves no farther than it must: until friction and the spring together hold
    it.
    """
    assert stack.support is not None
    pushed, pressed, _ = wrench(stack)
    bounds = _bound_before_slip(stack, np.maximum(-pressed, 0.0))
    slid = np.zeros_like(pushed)
    position = 0.0
    for instant, (load, bound) in enumerate(zip(pushed, bounds, strict=True)):
        pull = spring.stiffness * max(-position - spring.slack, 0.0)
        # Pull of the spring, at least and at most, with which friction can do the rest.
        lowest = -load - bound
        highest = bound - load
        wanted = min(max(pull, lowest), highest)
        if wanted != pull:
            position = -spring.slack - max(wanted, 0.0) / spring.stiffness
        slid[instant] = position
    return slid


def _settled(gap: Array, shapes: Array, wanted: Array) -> Array:
    """Rigid motions for which the bedding balances the loads, (n_motions, n_instants).

    Motions a with sum over points of shape * max(-(gap + shape' a), 0) = wanted. They
    minimise a convex energy; Newton's step goes as far as that falls. Where the points
    that press leave a motion free, as one point leaves a rotation, and the loads push
    that way, the body moves on until other points touch.

    `gap` is (n_points,), `shapes` the opening by each motion, (n_motions, n_points),
    `wanted` the loads over the bedding's stiffness, (n_motions, n_instants).
    """
    products = shapes[:, None] * shapes[None]
    sizes = np.abs(wanted).max(axis=0)
    # Begin with all points pressing.
    motion = np.linalg.solve(products.sum(axis=-1), -wanted - (shapes @ gap)[:, None])
    for _ in range(STEPS):
        opening = gap[:, None] + shapes.T @ motion
        missing = wanted - shapes @ np.maximum(-opening, 0.0)
        if np.all(np.abs(missing).max(axis=0) <= SETTLED * sizes):
            break
        matrix = np.moveaxis(products @ (opening < 0.0), -1, 0)
        inverse = np.linalg.pinv(matrix, rcond=FREE, hermitian=True)
        step = -np.einsum("tij,jt->it", inverse, missing)
        unheld = missing + np.einsum("tij,jt->it", matrix, step)
        is_free = np.abs(unheld).max(axis=0) > FREE * sizes
        step[:, is_free] = -unheld[:, is_free]
        work = (wanted * step).sum(axis=0)
        motion += step * _step_length(opening, shapes.T @ step, work)
    return motion


def _step_length(opening: Array, step: Array, work: Array) -> Array:
    """Step length that minimises the energy of bedding and loads, (n_instants,).

    `opening` and its change by the whole `step` are (n_points, n_instants), the `work`
    of the loads on it (n_instants,). The slope of the energy over the factor t is the
    work plus the sum of step (opening + t step) over the points that touch. It grows by
    straight lines between the factors at which points begin or end to touch.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        changes = -opening / step
    changes[~(changes > 0.0)] = np.inf
    order = np.argsort(changes, axis=0)
    opening = np.take_along_axis(opening, order, 0)
    step = np.take_along_axis(step, order, 0)
    changes = np.take_along_axis(changes, order, 0)
    touches = (opening < 0.0) | ((opening == 0.0) & (step < 0.0))
    # A point that touches lets go at its change, another one begins to touch.
    turn = np.where(np.isfinite(changes), np.where(touches, -1.0, 1.0), 0.0)
    offset = _sums_between(step * opening, touches, turn)
    growth = _sums_between(step * step, touches, turn)
    ends = np.vstack([changes, np.full(len(work), np.inf)])
    with np.errstate(divide="ignore", invalid="ignore"):
        rises = work + offset + growth * ends >= 0.0
        zeros = np.where(rises, -(work + offset) / growth, 0.0)
    first = rises.argmax(axis=0)[None]
    factor = np.take_along_axis(zeros, first, axis=0)[0]
    return np.where(np.isfinite(factor), factor, 0.0)


def _sums_between(terms: Array, touches: NDArray[np.bool_], turn: Array) -> Array:
    """Sums of terms over the points that touch, (n_points + 1, n_instants).

    Before the first change, then after each: `touches` says which points do at first,
    and `turn`, 1 or -1, whether a point comes or goes at its change; (n_points,
    n_instants) all.
    """
    at_first = (touches * terms).sum(axis=0)
    return np.asarray(np.vstack([at_first, turn * terms]).cumsum(axis=0))
