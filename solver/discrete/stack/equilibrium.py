"""Whether the loads on a body that contact alone holds can be in equilibrium at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.stack.data import Given, StackData

SLACK = 1e-9
"""Share of the loads that rounding may add to them."""


TIPS = "it tips over an end of its base"


@dataclass(frozen=True)
class Loss:
    """Why no equilibrium exists, and from which instant on, s."""

    reason: str
    instant: float

    @property
    def remedy(self) -> str:
        """What helps beside less load and more pressure."""
        return "take a longer or lower body" if self.reason == TIPS else "raise friction"


def wrench(scene: StackData) -> tuple[Array, Array, Array]:
    """Give the resultants of tractions and body forces on a single body.

    Returns
    -------
    Forces along x and y, N, and the counter-clockwise moment about the lower left corner, N m,
    shape (n_instants,) each.
    """
    length, height = scene.length, scene.height
    force, moment = np.zeros((2, len(scene.instants))), np.zeros(len(scene.instants))
    for name, side in scene.sides.items():
        size = height if name in ("left", "right") else length
        x = {"left": 0.0, "right": length}.get(name)
        y = {"bottom": 0.0, "top": height}.get(name)
        loads = [_resultant(given, size) for given in (side.x, side.y)]
        force += [total for total, _ in loads]
        (along_x, first_x), (along_y, first_y) = loads
        moment += first_y if x is None else x * along_y
        moment -= first_x if y is None else y * along_x
    if scene.body_force is not None:
        weight = scene.body_force * length * height
        force += weight
        moment += 0.5 * (length * weight[1] - height * weight[0])
    return force[0], force[1], moment


def _resultant(given: Given, size: float) -> tuple[Array, Array]:
    """Give a traction's resultant, and its moment about the first end of the side."""
    if given.prescribed:
        none = np.zeros_like(given.mean)
        return none, none
    total = size * given.mean
    return total, 0.5 * size * total + size**2 / 6.0 * given.slope


def is_held_up(scene: StackData) -> bool:
    """Tell whether a side prescribes a displacement upwards."""
    return any(side.y.prescribed for side in scene.sides.values())


def is_upright(scene: StackData) -> bool:
    """Tell whether a side keeps the body from turning."""
    sides = scene.sides
    return sides["top"].y.prescribed or any(sides[name].x.prescribed for name in ("left", "right"))


def loss_of_equilibrium(scene: StackData) -> Loss | None:
    """Find why a body on a support cannot rest under its loads, or None if nothing forbids it.

    Nothing but the support can hold what no side holds: it presses and does not pull, friction
    carries at most mu times the pressing force, and the pressure's resultant acts on the base. A
    spring holds against all that pushes to the left; at the foot, it does not keep from tipping.
    What is lost first counts; of two at once, what friction does not mend.
    """
    assert scene.support is not None
    x, y, moment = wrench(scene)
    sides = scene.sides
    held_x = any(side.x.prescribed for side in sides.values())
    held_y, upright = is_held_up(scene), is_upright(scene)
    pushed = np.abs(x) if scene.spring is None else x
    mu, size = scene.support.friction, np.abs([x, y]).max() + np.abs(moment).max() / scene.length
    slack = SLACK * size
    checks = []
    if not held_y:
        checks.append((y > slack, "the loads lift it off its support"))
    if not upright and not held_y:
        beyond = np.maximum(moment, scene.length * y - moment)
        if sides["top"].x.prescribed:
            # The top is dragged with any force that friction can answer, which may hold it upright.
            middle, reach = moment + scene.height * x, mu * scene.height * np.maximum(-y, 0.0)
            beyond = np.maximum(middle - reach, scene.length * y - middle - reach)
        checks.append((beyond > slack * scene.length, TIPS))
    if not held_x and not held_y:
        checks.append((pushed > mu * np.maximum(-y, 0.0) + slack, "friction cannot hold it"))
    if not held_x and held_y and mu == 0.0:
        checks.append((np.abs(x) > slack, "there is no friction, and no side holds it"))
    losses = [
        Loss(reason, float(scene.instants[np.argmax(lost)]))
        for lost, reason in checks
        if lost.any()
    ]
    return min(losses, key=lambda loss: loss.instant, default=None)
