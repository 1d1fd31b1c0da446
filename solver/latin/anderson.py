"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import Blocks, in_a_row
from solver.latin.linear_stage import LinearStage
from solver.refusal import check_range

MEMORY = 15
"""Differences that are remembered at most. From 5 to 50, 1 % of the contact force takes the same
number of iterations but for two on bar, strand, block and layers, and 1e-4 from 55 to 63 on layers,
39 to 45 on strands (measured)."""
GROWTH_ON_SUPPORT = 2.0
"""Growth of the residual from which the memory is given up, in contact with a rigid support: with 1
the rocking of a block that tilts until it lifts off takes thousands of iterations, not 50."""
GROWTH_BETWEEN_BODIES = 1.1
"""The same in contact between two bodies. Layers 200 times as long as thick: 1e-6 of the contact
force takes 120 iterations, 140 with 1.5 and 2, more than 300 with 1 (measured)."""
MOST_VALUES = 50_000_000
"""Numbers that the remembered images may hold; a larger field is remembered for fewer iterations.
On 384 x 192 elements 1e-4 takes 38 iterations with 15 differences, 39 with 8, 41 with 5
(measured)."""
SAMPLE = 300_000
"""Values of a residual that the weights of the mixture are found from; all, if it has no more. On
384 x 192 elements 1e-4 takes 38 iterations with that and with all, 40 with 20 000 (measured)."""
REGULAR = 1e-10
"""Added to the diagonal of the small normal equations, whose own diagonal is scaled to 1."""


@dataclass(frozen=True)
class Anderson:
    """Mixes the last iterates, so that both stages agree best.

    One iteration maps the state y to g(y) with residual f = g(y) - y. The mixture
    g_n - sum_j gamma_j (g_j - g_{j-1}), where gamma makes f_n - sum_j gamma_j (f_j - f_{j-1})
    least, has weights that add up to one, so it is admissible whenever its parts are. When the
    residual grows too far beyond the smallest, the memory is given up: the plain iteration goes on
    from there, which does not diverge. Separated bases are not mixed.

    Attributes
    ----------
    memory
        Differences that are remembered at most.
    """

    memory: int = MEMORY

    def __post_init__(self) -> None:
        check_range(self, "memory", 1, 1000)


class AndersonState:
    """What a run remembers of its states, which are in full, and the mixture of them.

    The images g are kept whole; of large residuals no more than a sample is. Residuals are measured
    by k over boundary and time. They count for nothing along a motion of the rows, (n_rows,), which
    the local stage chooses anew at every instant, whatever the state is.
    """

    def __init__(
        self,
        problem: Problem,
        stage: LinearStage,
        memory: int,
        motion: Array | None,
        blocks: Blocks,
    ) -> None:
        # Where the bound of friction is known 1 is best; twice as much takes up to a third more
        # iterations to 1e-6.
        self._growth = 1.0
        if problem.opens:
            is_held = any(law.is_on_support for law in problem.rubbing.values())
            self._growth = GROWTH_ON_SUPPORT if is_held else GROWTH_BETWEEN_BODIES
        groups = self._groups = stage.groups
        self._blocks = blocks
        sizes = [group.target.size for group in groups]
        self._places = in_a_row(sizes)
        step = -(-sum(sizes) // SAMPLE)
        self._chosen = [_every(group.target.size, group.rows.size, step) for group in groups]
        weights = [group.k[:, None, None] * problem.time_weights for group in groups]
        sampled = self._sampled(weights)
        self._samples = in_a_row([len(part) for part in sampled])
        self._root = np.sqrt(np.concatenate(sampled))
        self._way = None
        if motion is not None:
            ways = self._sampled([motion[group.rows][:, :, None] for group in groups])
            instants = self._sampled([np.arange(float(problem.n_instants)) for _ in groups])
            self._instants = np.concatenate(instants).astype(int)
            self._way = self._root * np.concatenate(ways)
            size = np.bincount(self._instants, self._way**2)
            self._dual = self._way / np.where(size > 0.0, size, 1.0)[self._instants]
        self._memory = max(1, min(memory, MOST_VALUES // sum(sizes) - 1))
        # Memory that nothing was written to costs nothing yet.
        self._images = np.zeros((self._memory + 1, sum(sizes)))
        self._residuals = np.zeros((self._memory, len(self._root)))
        self._products = np.zeros((self._memory, self._memory))
        self._wanted = np.zeros(self._memory)
        self._start, self._residual, self._residual_before = np.zeros((3, len(self._root)))
        self._forget()

    def _forget(self) -> None:
        self._count, self._smallest = 0, np.inf

    def start(self) -> None:
        """Read y, before the iteration that makes g(y) of it."""
        self._take(self._start)

    def mix(self) -> None:
        """Replace g(y) by the mixture, in place, once there is one."""
        residual = self._residual
        self._take(residual)
        np.subtract(residual, self._start, out=residual)
        np.multiply(residual, self._root, out=residual)
        if self._way is not None:
            share = np.bincount(self._instants, self._dual * residual)
            residual -= self._way * share[self._instants]
        size = float(np.sqrt(residual @ residual))
        if not size > 0.0 or not np.isfinite(size):
            return
        if size > self._growth * self._smallest:
            self._forget()
        if np.isfinite(self._smallest):  # there is an image before
            self._remember()
        self._smallest = min(self._smallest, size)
        image = self._images[self._place_of(self._count)]

        def keep(instants: slice) -> None:
            for group, place in zip(self._groups, self._places, strict=True):
                part = group.state
                image[_within(place, part, instants)] = _flat(part[..., instants])

        self._blocks.each(keep)
        self._residual, self._residual_before = self._residual_before, residual
        if self._count:
            self._mix()

    def _remember(self) -> None:
        place = self._count % self._memory
        newest = self._residuals[place]
        np.subtract(self._residual, self._residual_before, out=newest)
        self._count += 1
        used = min(self._count, self._memory)
        row = self._residuals[:used] @ newest
        self._products[place, :used] = row
        self._products[:used, place] = row
        # The products with the residual change by those with its newest difference.
        self._wanted[:used] += row
        self._wanted[place] = newest @ self._residual

    def _mix(self) -> None:
        used = min(self._count, self._memory)
        gram = self._products[:used, :used]
        scale = 1.0 / np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        scaled = gram * scale * scale[:, None]
        scaled[np.diag_indices(used)] += REGULAR
        _, gamma, failed = dposv(scaled, scale * self._wanted[:used])
        if failed:
            return
        shares = self._shares(scale * gamma)

        def mix(instants: slice) -> None:
            for group, place in zip(self._groups, self._places, strict=True):
                part = group.state
                images = self._images[: used + 1, _within(place, part, instants)]
                np.matmul(shares, images, out=_flat(part[..., instants]))

        self._blocks.each(mix)

    def _shares(self, gamma: Array) -> Array:
        """The weights of the images, which add up to one, from those of their differences."""
        shares = np.zeros(len(gamma) + 1)
        shares[self._place_of(self._count)] = 1.0
        for number in range(self._count - len(gamma), self._count):
            share = gamma[number % self._memory]
            shares[self._place_of(number + 1)] -= share
            shares[self._place_of(number)] += share
        return shares

    def _place_of(self, number: int) -> int:
        return number % (self._memory + 1)

    def _take(self, out: Array) -> None:
        for group, chosen, place in zip(self._groups, self._chosen, self._samples, strict=True):
            out[place] = _flat(group.state)[chosen]

    def _sampled(self, fields: list[Array]) -> list[Array]:
        """Fields of the groups at the places of the sample."""
        return [
            _flat(np.broadcast_to(field, group.target.shape))[chosen]
            for field, group, chosen in zip(fields, self._groups, self._chosen, strict=True)
        ]


def _within(place: slice, part: Array, instants: slice) -> slice:
    """Where some instants of a part stand, which itself stands at a place."""
    each = part.size // part.shape[-1]
    first, last, _ = instants.indices(part.shape[-1])
    return slice(place.start + first * each, place.start + last * each)


def _every(size: int, instant: int, wanted: int) -> slice:
    """One place out of so many, no rows of an instant left out for ever."""
    step = wanted
    while math.gcd(step, instant) > 1:
        step += 1
    return slice(0, size, step)


def _flat(part: Array) -> Array:
    """The numbers of a part in a row, without a copy where it is contiguous in space."""
    return part.reshape(-1, order="F")
