"""A stack's lowest body as if it were rigid: whether loads hold it, and where it comes to rest."""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from solver.arrays import Array

if TYPE_CHECKING:
    from solver.discrete.plane.stack import Given, Spring, Stack

SLACK = 1e-9
"""Share of the loads that rounding may add to them."""
BEDDING = 7.0
"""Stiffness of the support per area, times the body's length over E: that of the
contact itself, as the automatic search direction estimates it."""
STEPS = 50
"""Newton steps; a few suffice."""
SETTLED = 1e-9
"""Share of the load that need not be held when the body is at rest."""
FREE = 1e-9
"""Stiffness, as a share of the largest, of a motion that is free; and share of the load
that says that a free motion is pushed."""


def wrench(stack: Stack) -> tuple[Array, Array, Array]:
    """Resultants of tractions and body forces on a single body, shape (n_instants,) each.

    Forces along x and y, N, and the counter-clockwise moment about the lower left
    corner, N m.
    """
    length = stack.length
    height = stack.height
    force = np.zeros((2, len(stack.instants)))
    moment = np.zeros(len(stack.instants))
    for name, side in stack.sides.items():
        size = height if name in ("left", "right") else length
        x = {"left": 0.0, "right": length}.get(name)
        y = {"bottom": 0.0, "top": height}.get(name)
        loads = [_resultant(given, size) for given in side]
        force += [total for total, _ in loads]
        (along_x, first_x), (along_y, first_y) = loads
        if x is None:
            moment += first_y
        else:
            moment += x * along_y
        if y is None:
            moment -= first_x
        else:
            moment -= y * along_x
    if stack.body_force is not None:
        weight = stack.body_force * length * height
        force += weight
        moment += 0.5 * (length * weight[1] - height * weight[0])
    return force[0], force[1], moment


def _resultant(given: Given, size: float) -> tuple[Array, Array]:
    """A traction's resultant, and its moment about the first end of the side."""
    if given.prescribed:
        none = np.zeros_like(given.mean)
        return none, none
    total = size * given.mean
    return total, 0.5 * size * total + size**2 / 6.0 * given.slope


def is_held_up(stack: Stack) -> bool:
    """Whether a side prescribes a displacement upwards."""
    return any(side.y.prescribed for side in stack.sides.values())


def is_upright(stack: Stack) -> bool:
    """Whether a side keeps the body from turning."""
    sides = stack.sides
    return sides["top"].y.prescribed or any(
        sides[name].x.prescribed for name in ("left", "right")
    )


def loss_of_equilibrium(stack: Stack) -> tuple[float, str] | None:
    """From when on, s, and why a body on a support cannot rest under its loads.

    None if nothing forbids it.

    Nothing but the support can hold what no side holds: it presses and does not pull,
    friction carries no more than its law allows, and the pressure's resultant acts on
    the base. A spring holds against all that pushes to the left; at the foot, it does
    not keep from tipping. What is lost first counts; of two at once, what friction does
    not mend.
    """
    assert stack.support is not None
    x, y, moment = wrench(stack)
    sides = stack.sides
    held_x = any(side.x.prescribed for side in sides.values())
    held_y = is_held_up(stack)
    upright = is_upright(stack)
    if stack.spring is None:
        pushed = np.abs(x)
    else:
        pushed = x
    size = np.abs([x, y]).max() + np.abs(moment).max() / stack.length
    slack = SLACK * size
    # Whoever holds the body up may press it as hard as it takes.
    pressing = np.where(held_y, np.inf, np.maximum(-y, 0.0))
    most = _without_slip(stack, pressing) * stack.friction_law.strongest
    checks = []
    if not held_y:
        checks.append((y > slack, "the loads lift it off its support"))
    if not upright and not held_y:
        beyond = np.maximum(moment, stack.length * y - moment)
        if sides["top"].x.prescribed:
            # The top is dragged with any force that friction can answer, which may hold
            # it upright.
            middle = moment + stack.height * x
            reach = stack.height * most
            beyond = np.maximum(middle - reach, stack.length * y - middle - reach)
        checks.append(
            (beyond > slack * stack.length, "it tips over an end of its base")
        )
    if not held_x:
        checks.append((pushed > most + slack, "friction cannot hold it"))
    losses = [
        (float(stack.instants[np.argmax(lost)]), reason)
        for lost, reason in checks
        if lost.any()
    ]
    return min(losses, key=itemgetter(0), default=None)


def _without_slip(stack: Stack, pressing: Array) -> Array:
    """Friction that may hold the body before slip, N, of the shape of what presses."""
    assert stack.support is not None
    mu = float(np.max(stack.support.friction))
    if mu:
        rubbed = mu * pressing
    else:
        rubbed = np.zeros_like(pressing)
    return stack.friction_law.without_slip(rubbed, stack.length)


def rigid_rest(stack: Stack) -> Array | None:
    """Rigid motion that brings the body onto its support, shape (2, n_instants).

    Displacement upwards of the lower left corner, m, and counter-clockwise rotation
    about it; None where a side holds the body up, or where it rests already. The body
    is rigid, the support an elastic bedding (Winkler), so that a curved side rests on a
    patch and not on a point. While nothing presses the body stays where it is.
    """
    if stack.support is None or len(stack.rectangles) > 1 or is_held_up(stack):
        return None
    gap = stack.support.gap
    x = np.linspace(0.0, stack.length, len(gap))
    _, force, moment = wrench(stack)
    bedding = BEDDING * stack.young / len(gap)
    # Taken about the middle and over the length, the rotation is a motion like the
    # other.
    middle = 0.5 * stack.length
    length = stack.length
    shapes = np.stack([np.ones_like(x), (x - middle) / length])[
        : 1 if is_upright(stack) else 2
    ]
    presses = np.flatnonzero(force < 0.0)
    wrenches = np.stack([force, (moment - middle * force) / length])[
        : len(shapes), presses
    ]
    settled = np.zeros((2, len(force)))
    settled[: len(shapes), presses] = _settled(gap, shapes, -wrenches / bedding)
    settled[1] /= length
    settled[0] -= middle * settled[1]
    # The last instant that pressed says where the body is; before the first it is where
    # it began.
    last = np.full(len(force), -1)
    last[presses] = presses
    last = np.maximum.accumulate(last)
    settled = np.where(last >= 0, settled[:, last], 0.0)
    return settled if settled.any() else None


def rigid_slide(stack: Stack, spring: Spring) -> Array:
    """How far the body would slide if it were rigid, to the right, (n_instants,), m.

    It moves no farther than it must: until friction and the spring together hold it.
    """
    assert stack.support is not None
    pushed, pressed, _ = wrench(stack)
    bound = _without_slip(stack, np.maximum(-pressed, 0.0))
    slid = np.zeros_like(pushed)
    place = 0.0
    for instant, (load, most) in enumerate(zip(pushed, bound, strict=True)):
        pull = spring.stiffness * max(-place - spring.slack, 0.0)
        # What the spring has to pull at least, and at most, for friction to do the
        # rest.
        wanted = min(max(pull, -load - most), most - load)
        if wanted != pull:
            place = -spring.slack - max(wanted, 0.0) / spring.stiffness
        slid[instant] = place
    return slid


def _settled(gap: Array, shapes: Array, wanted: Array) -> Array:
    """Motions a with sum over points of shape * max(-(gap + shape' a), 0) = wanted.

    They make a convex energy least. Newton's step goes as far as that falls. Where the
    points that press leave a motion free, as one point leaves a rotation, and the loads
    push that way, the body moves on until others touch. `gap` is (n_points,), `shapes`
    what motions add to it.
    """
    products = shapes[:, None] * shapes[None]
    sizes = np.abs(wanted).max(axis=0)
    motion = np.linalg.solve(products.sum(axis=-1), -wanted - (shapes @ gap)[:, None])
    for _ in range(STEPS):
        opening = gap[:, None] + shapes.T @ motion
        missing = wanted - shapes @ np.maximum(-opening, 0.0)
        if np.all(np.abs(missing).max(axis=0) <= SETTLED * sizes):
            break
        matrix = np.moveaxis(products @ (opening < 0.0), -1, 0)
        inverse = np.linalg.pinv(matrix, rcond=FREE, hermitian=True)
        way = -np.einsum("tij,jt->it", inverse, missing)
        unheld = missing + np.einsum("tij,jt->it", matrix, way)
        is_free = np.abs(unheld).max(axis=0) > FREE * sizes
        way[:, is_free] = -unheld[:, is_free]
        motion += way * _farthest(opening, shapes.T @ way, (wanted * way).sum(axis=0))
    return motion


def _farthest(opening: Array, way: Array, work: Array) -> Array:
    """How far the energy of the bedding and of the loads falls along a way, (n_instants,).

    Its slope grows with the distance t, by straight lines between the places where
    points begin or end to touch: `work` of the loads, and the sum over those that do of
    way (opening + t way).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        changes = -opening / way
    changes[~(changes > 0.0)] = np.inf
    order = np.argsort(changes, axis=0)
    opening, way, changes = (
        np.take_along_axis(one, order, 0) for one in (opening, way, changes)
    )
    touches = (opening < 0.0) | ((opening == 0.0) & (way < 0.0))
    turn = np.where(np.isfinite(changes), np.where(touches, -1.0, 1.0), 0.0)
    offset, growth = (
        np.vstack([(touches * one).sum(axis=0), turn * one]).cumsum(axis=0)
        for one in (way * opening, way * way)
    )
    ends = np.vstack([changes, np.full(len(work), np.inf)])
    with np.errstate(divide="ignore", invalid="ignore"):
        rises = work + offset + growth * ends >= 0.0
        least = np.where(rises, -(work + offset) / growth, 0.0)
    distance = np.take_along_axis(least, rises.argmax(axis=0)[None], axis=0)[0]
    return np.where(np.isfinite(distance), distance, 0.0)
