"""Unilateral contact (Signorini): sides press or open, and never overlap or pull.

A compliance 1 / k_n may be in series: with the opening g and the pressing force N, g +
N / k_n >= 0, N >= 0, and one of the two is zero. In the local stage the spring k_n and
the search direction's spring share an overlap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.checks import Numbers, check
from solver.laws.friction import Friction
from solver.laws.interface import Component, Springs
from solver.laws.play import Play, follow


@dataclass(frozen=True, kw_only=True)
class Unilateral:
    """Normal law at the pairs of an interface.

    Attributes
    ----------
    component
        Rows of the pairs.
    gap
        Opening between the undeformed bodies, shape (n_pairs,), scaled; negative where
        they overlap.
    compliance
        Compression per pressing force of each pair, shape (n_pairs,), scaled; None if
        there is none.
    """

    component: Component
    gap: Array
    compliance: Array | None = None

    def __post_init__(self) -> None:
        size = len(self.component.above)
        check(
            self,
            gap=Numbers(((size,),)),
            compliance=Numbers(((size,),), low=0.0, above=True),
        )

    def opening(self, displacement: Array, force: Array) -> Array:
        """Opening plus the spring's compression, (n_pairs, n_instants), scaled.

        From W and F of all rows, (n_rows, n_instants), scaled.
        """
        opening = self.component.jump(displacement) + self.gap[:, None]
        if self.compliance is not None:
            opening = opening + self.compliance[:, None] * force[self.component.above]
        return np.asarray(opening)


class ContactRule:
    """Local stage of a contact for one k, (n_rows,): pressing first, then friction."""

    def __init__(
        self, normal: Unilateral | None, along: Friction, k: Array, n_instants: int
    ) -> None:
        self._normal = normal
        self._along = along
        self._springs = Springs(along.component, k)
        if normal is not None:
            self._across = Springs(normal.component, k)
            self._closed = -normal.gap[:, None]
            self._pressed = _share(self._across.soft, normal.compliance)
            # Openings are needed only where they may break a bond.
            self._bonds = bool(along.bound.any())
        soft = self._springs.soft
        # The slider stays behind z by the friction force over both springs in series;
        # the jump by the share of the search direction's spring in that.
        if along.compliance is None:
            self._lag = soft
        else:
            self._lag = soft + along.compliance[:, None]
        self._share = _share(soft, along.compliance)
        if along.cap is not None:
            self._known_slack = None
        else:
            self._known_slack = np.asarray(along.bound * self._lag)
        self._grows = along.friction[:, None] * self._lag
        self._play = Play(len(along.bound), n_instants, along.start)

    def __call__(self, incoming: Array, displacement: Array, _instants: slice) -> None:
        """Write W^ of the rows, as `Rule`."""
        pressing = None
        opening = None
        if self._normal is not None:
            pressing, opening = self._press(incoming, displacement)
        jump = self._springs.jump(incoming)
        slack = self._slack(pressing, opening)
        slip_factor = self._along.slip_factor
        if slip_factor:
            slider = follow(jump, slack, slip_factor)
        else:
            slider = self._play(jump, slack)
        if self._share is None:
            held = slider
        else:
            held = jump + self._share * (slider - jump)
        self._springs.close(incoming, jump, held, displacement)

    def _press(
        self, incoming: Array, displacement: Array
    ) -> tuple[Array, Array | None]:
        """Write W^ across; return the pressing force, and the opening for bonds.

        Shape (n_pairs, n_instants) both, scaled.
        """
        jump = self._across.jump(incoming)
        # Rows that do not overlap stay at z, and so carry no force.
        held = np.maximum(jump, self._closed)
        if self._bonds:
            opening = held - self._closed
        else:
            opening = None
        if self._pressed is not None:
            held = jump + self._pressed * (held - jump)
        self._across.close(incoming, jump, held, displacement)
        return (held - jump) / self._across.soft, opening

    def _slack(self, pressing: Array | None, opening: Array | None) -> Array:
        """Largest distance of the slider from z, scaled.

        Shape (n_pairs, n_instants), as that of both parameters, or (n_pairs, 1).
        """
        if self._known_slack is not None and opening is None:
            if pressing is None:
                return self._known_slack
            return self._known_slack + self._grows * pressing
        return np.asarray(self._along.bound_before_slip(pressing, opening) * self._lag)


def _share(soft: Array, compliance: Array | None) -> Array | None:
    """Share of the search direction's compliance in that of both springs, (n_pairs, 1).

    `soft` is its 1 / k, (n_pairs, 1), `compliance` the law's compliance, (n_pairs,), or
    None, as is the share then.
    """
    if compliance is None:
        return None
    return np.asarray(soft / (soft + compliance[:, None]))
