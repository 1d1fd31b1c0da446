"""The loop that stacked bodies show: of the force that answers what drives them."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array, without_residue
from solver.discrete.probes import constant, end_rotation, reaction, side_mean
from solver.discrete.problem import Problem
from solver.discrete.stack.data import Side, StackData
from solver.discrete.structure import Loop, LoopFields

DRIVEN = "top", "left", "right"
"""Sides of a body on a support, in the order in which one looks for what drives it."""


def loop_of_stack(scene: StackData, problem: Problem) -> Loop:
    """Give a spring's force on a slope, the shear force on a support, or what bends the end."""
    if scene.tilt is not None and scene.spring is not None:
        return _spring_over_angle(scene.tilt)
    if scene.support is not None:
        return _shear(scene, problem)
    if scene.sides["right"].y.prescribed:
        return _deflection(problem)
    return Loop(
        ("Rotation of the end", "rad"), ("Moment", "N·m"), end_rotation(problem), _moment(scene)
    )


def _spring_over_angle(tilt: Array) -> Loop:
    """Give the spring's force over the angle: it lags behind on the way back."""
    return Loop(
        ("Angle of the slope", "°"),
        ("Spring force", "N"),
        constant(np.degrees(tilt)),
        lambda fields: np.asarray(fields.contact("spring").normal_force)[0],
    )


def _shear(scene: StackData, problem: Problem) -> Loop:
    """Give the shear force on the support over the horizontal displacement of the driven side."""
    side = next((name for name in DRIVEN if _drives(scene.sides[name])), DRIVEN[0])
    return Loop(
        (f"Displacement of the {side}", "m"),
        ("Shear force", "N"),
        side_mean(problem, side, 0),
        _shear_force,
    )


def _shear_force(fields: LoopFields) -> Array:
    force = -fields.contact("support").tangential_force
    return without_residue(force.sum(axis=0), np.abs(force).sum(axis=0))


def _drives(side: Side) -> bool:
    return any(np.any(given.mean) or np.any(given.slope) for given in (side.x, side.y))


def _deflection(problem: Problem) -> Loop:
    held = reaction(problem, "right")
    return Loop(
        ("Deflection of the end", "m"),
        ("Transverse force", "N"),
        side_mean(problem, "right", 1),
        lambda fields: held(fields.displacement),
    )


def _moment(scene: StackData) -> Array:
    """Give the moment of the traction on the right end, counter-clockwise, (n_instants,), N m.

    A linear traction of an extreme over a height h has the moment extreme h^2 / 6.
    """
    given = scene.sides["right"].x
    several = scene.bodies * scene.height**2
    size = several if given.each_body else scene.bodies * several
    return np.broadcast_to(-size / 6.0 * given.slope, scene.instants.shape)
