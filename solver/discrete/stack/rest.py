"""Where a body that contact alone holds would come to rest on its support, if it were rigid."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.stack.data import Spring, StackData
from solver.discrete.stack.equilibrium import is_held_up, is_upright, wrench

BEDDING = 7.0
"""Stiffness of the support per area, times the body's length over E: that of the contact itself,
as the automatic search direction estimates it."""
STEPS = 50
"""Newton steps; a few suffice."""
SETTLED = 1e-9
"""Share of the load that need not be held when the body is at rest."""
FREE = 1e-9
"""Stiffness, as a share of the largest, of a motion that is free; and share of the load that says
that a free motion is pushed."""


def rigid_rest(scene: StackData) -> Array | None:
    """Give the rigid motion that brings the body onto its support.

    The body is rigid, the support an elastic bedding (Winkler), so that a curved side rests on a
    patch and not on a point. While nothing presses the body stays where it is.

    Returns
    -------
    Displacement upwards of the lower left corner, m, and counter-clockwise rotation about it, shape
    (2, n_instants); None where a side holds the body up, or where it rests already.
    """
    if scene.support is None or is_held_up(scene):
        return None
    gap = scene.support.gap
    x = np.linspace(0.0, scene.length, len(gap))
    _, force, moment = wrench(scene)
    bedding = BEDDING * scene.young / len(gap)
    # Taken about the middle and over the length, the rotation is a motion like the other.
    middle, length = 0.5 * scene.length, scene.length
    shapes = np.stack([np.ones_like(x), (x - middle) / length])[: 1 if is_upright(scene) else 2]
    presses = np.flatnonzero(force < 0.0)
    wrenches = np.stack([force, (moment - middle * force) / length])[: len(shapes), presses]
    settled = np.zeros((2, len(force)))
    settled[: len(shapes), presses] = _settled(gap, shapes, -wrenches / bedding)
    settled[1] /= length
    settled[0] -= middle * settled[1]
    # The last instant that pressed says where the body is; before the first it is where it began.
    last = np.full(len(force), -1)
    last[presses] = presses
    last = np.maximum.accumulate(last)
    settled = np.where(last >= 0, settled[:, last], 0.0)
    return settled if settled.any() else None


def rigid_slide(scene: StackData, spring: Spring) -> Array:
    """Give how far the body would slide if it were rigid, to the right, (n_instants,), m.

    It moves no farther than it must: until friction and the spring together hold it.
    """
    assert scene.support is not None
    pushed, pressed, _ = wrench(scene)
    bound = scene.support.friction * np.maximum(-pressed, 0.0)
    found, place = np.zeros_like(pushed), 0.0
    for instant, (load, most) in enumerate(zip(pushed, bound, strict=True)):
        pull = spring.stiffness * max(-place - spring.slack, 0.0)
        # What the spring has to pull at least, and at most, for friction to do the rest.
        wanted = min(max(pull, -load - most), most - load)
        if wanted != pull:
            place = -spring.slack - max(wanted, 0.0) / spring.stiffness
        found[instant] = place
    return found


def _settled(gap: Array, shapes: Array, wanted: Array) -> Array:
    """Find motions a with sum over points of shape * max(-(gap + shape' a), 0) = wanted.

    They make a convex energy least. Newton's step goes as far as that falls. Where the points that
    press leave a motion free, as one point leaves a rotation, and the loads push that way, the body
    moves on until others touch.

    Parameters
    ----------
    gap, shapes
        At every point: the opening before, and what each motion adds to it, shape (n, n_points).
    wanted
        Shape (n, n_instants).
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
    """Give how far the energy of the bedding and of the loads falls along a way, (n_instants,).

    Its slope grows with the distance t, by straight lines between the places where points begin or
    end to touch: work + sum over those that do of way (opening + t way).

    Parameters
    ----------
    opening, way
        Of the points at t = 0, and what t adds to it, shape (n_points, n_instants).
    work
        Of the loads, against the way, (n_instants,).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        changes = -opening / way
    changes[~(changes > 0.0)] = np.inf
    order = np.argsort(changes, axis=0)
    opening, way, changes = (np.take_along_axis(one, order, 0) for one in (opening, way, changes))
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
    found = np.take_along_axis(least, rises.argmax(axis=0)[None], axis=0)[0]
    return np.where(np.isfinite(found), found, 0.0)
