"""Where a body that contact alone holds would come to rest on its support, if it were rigid."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.discrete.equilibrium import is_held_up, is_upright, wrench
from solver.discrete.stack import Spring, Stack

BEDDING = 7.0
"""Stiffness of the support per area, times the body's length over E: that of the contact itself,
as the automatic search direction estimates it."""
STEPS = 50
"""Newton steps; a few suffice."""


def rigid_rest(scene: Stack) -> Array | None:
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
    bedding = BEDDING * scene.young / scene.length * scene.length / len(gap)
    shapes = np.stack([np.ones_like(x), x])[: 1 if is_upright(scene) else 2]
    presses = np.flatnonzero(force < 0.0)
    wanted = -np.stack([force, moment])[: len(shapes), presses] / bedding
    settled = np.zeros((2, len(force)))
    settled[: len(shapes), presses] = _settled(gap, shapes, wanted)
    # The last instant that pressed says where the body is; before the first it is where it began.
    last = np.full(len(force), -1)
    last[presses] = presses
    last = np.maximum.accumulate(last)
    settled = np.where(last >= 0, settled[:, last], 0.0)
    return settled if settled.any() else None


def rigid_slide(scene: Stack, spring: Spring) -> Array:
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

    Parameters
    ----------
    gap, shapes
        At every point: the opening before, and what each motion adds to it, shape (n, n_points).
    wanted
        Shape (n, n_instants).
    """
    touching = np.ones((len(gap), wanted.shape[1]), dtype=bool)
    motion = np.zeros_like(wanted)
    products = shapes[:, None] * shapes[None]
    for _ in range(STEPS):
        matrix = np.moveaxis(products @ touching, -1, 0)
        right = -wanted - (shapes * gap) @ touching
        # A body on one point can turn without resistance: the least rotation will do.
        motion = np.einsum("tij,jt->it", np.linalg.pinv(matrix, hermitian=True), right)
        now = gap[:, None] + shapes.T @ motion < 0.0
        if np.array_equal(now, touching):
            break
        touching = now
    return motion
