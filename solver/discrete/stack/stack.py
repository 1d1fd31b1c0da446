"""Rectangular bodies in the plane, one on a support or several stacked on each other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.discrete.problem import Problem
from solver.discrete.stack.data import Given, Side, StackData
from solver.discrete.stack.loops import loop_of_stack
from solver.discrete.stack.problem import discretise_stack
from solver.discrete.structure import OUTWARD, Act, Description, Hold, Loop, ends_of


class Stack(StackData):
    """Bodies in the plane as a structure; the attributes are those of `StackData`."""

    def discretise(self) -> Problem:
        """Make the discrete problem."""
        return discretise_stack(self)

    def loop(self, problem: Problem) -> Loop:
        """Give the force that answers what drives it."""
        return loop_of_stack(self, problem)

    def described(self) -> Description:
        """Say what there is, for whoever draws it."""
        return Description(
            bodies=self.bodies,
            length=self.length,
            height=self.bodies * self.height,
            instants=self.instants,
            acts=tuple(act for act in self._acts() if np.any(act.values)),
            holds=tuple(self._holds()),
            tilt=self.tilt,
        )

    def _acts(self) -> Iterator[Act]:
        for name, side in self.sides.items():
            if name == "bottom" and self.support is not None:
                continue
            for component, given in enumerate((side.x, side.y)):
                yield _given(given, name, component)
        if self.body_force is not None:
            size = np.hypot(*self.body_force)
            towards = self.body_force / np.where(size > 0.0, size, 1.0)
            weight = size * self.length * (self.bodies * self.height)
            yield Act("body", "W", np.array([[0.5, 0.5]]), towards, (1.0, 0.0), weight, "N")

    def _holds(self) -> Iterator[Hold]:
        if self.support is not None:
            yield Hold("support", "bottom", gap=self.support.gap)
        for name, side in self.sides.items():
            is_still = _is_still(side)
            if all(is_still):
                yield Hold("clamp", name)
            elif any(is_still):
                yield Hold("rollers", name)
        if self.spring is not None:
            yield Hold("spring", "right")


def _given(given: Given, side: str, component: int) -> Act:
    """Show what is given along a side: evenly in the middle, unevenly at both ends."""
    towards, away = ((1.0, 0.0), (0.0, 1.0))[component], OUTWARD[side]
    first, last = ends_of(side)
    unit = "m" if given.prescribed else "Pa"
    is_normal = away[component] != 0.0
    along = "xy"[component]
    symbol = f"u_{along}" if given.prescribed else "σ" if is_normal else "τ"
    where = f"{side} {along}"
    if np.any(given.slope):
        values = np.stack([given.mean - given.slope, given.mean + given.slope])
        return Act(where, symbol, np.stack([first, last]), towards, away, values, unit)
    several = is_normal and not given.prescribed
    share = np.array([0.15, 0.5, 0.85] if several else [0.7 if is_normal else 0.3])
    places = first + share[:, None] * (last - first)
    return Act(where, symbol, places, towards, away, given.mean, unit)


def _is_still(side: Side) -> list[bool]:
    """Tell which components of a side are held at rest."""
    return [
        given.prescribed and not np.any(given.mean) and not np.any(given.slope)
        for given in (side.x, side.y)
    ]
