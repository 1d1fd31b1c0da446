"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.linear import LinearStage

MEMORY = 15
"""Differences that are remembered at most; from 5 to 50 iterations hardly differ
(measured)."""
GROWTH_ON_SUPPORT = 2.0
"""Growth of the residual from which the memory is given up, in contact with a rigid
support: with 1 the rocking of a block that tilts until it lifts off takes thousands of
iterations, not 50."""
GROWTH_BETWEEN_BODIES = 1.1
"""The same between bodies. Thin layers: 1e-6 takes 120 iterations, 140 with 2, 300 with
1."""
MOST_VALUES = 50_000_000
"""Numbers that the remembered images may hold; a larger field is remembered for fewer
iterations: on 384 x 192 elements 1e-4 takes 38 with 15 differences, 41 with 5
(measured)."""
SAMPLE = 300_000
"""Values of a residual that the weights of the mixture are found from; all, if it has
no more. On 384 x 192 elements 1e-4 takes as many iterations with that as with all
(measured)."""
REGULAR = 1e-10
"""Added to the diagonal of the small normal equations, whose own diagonal is scaled to
1."""


@dataclass(frozen=True)
class Anderson:
    """Mixes the last iterates, so that both stages agree best.

    One iteration maps the state y to g(y) with residual f = g(y) - y. The mixture g_n -
    sum_j gamma_j (g_j - g_{j-1}), where gamma makes f_n - sum_j gamma_j (f_j - f_{j-1})
    least, has weights that add up to one, so it is admissible whenever its parts are.
    When the residual grows too far beyond the smallest, the memory is given up: the
    plain iteration goes on from there, which does not diverge. Separated bases are not
    mixed.
    """


class AndersonState:
    """What a run remembers of its states, which are in full, and the mixture of them.

    The images g are kept whole; of large residuals no more than a sample is. Residuals
    are measured by k over boundary and time. They count for nothing along a motion of
    the rows, (n_rows,), which the local stage chooses anew at every instant, whatever
    the state is.
    """

    def __init__(
        self, problem: Problem, stage: LinearStage, motion: Array | None, blocks: Blocks
    ) -> None:
        # Where the bound of friction is known 1 is best; twice as much takes up to a
        # third more iterations to 1e-6.
        self._growth = 1.0
        if problem.opens:
            is_held = any(law.is_on_support for law in problem.rubbing.values())
            if is_held:
                self._growth = GROWTH_ON_SUPPORT
            else:
                self._growth = GROWTH_BETWEEN_BODIES
        groups = self._groups = stage.groups
        self._blocks = blocks
        size = sum(group.target.size for group in groups)
        self._steps = [_step(-(-size // SAMPLE), group.rows.size) for group in groups]
        weights = [group.k[:, None, None] * problem.time_weights for group in groups]
        self._root = np.sqrt(self._sampled(weights))
        self._way = None
        if motion is not None:
            ways = [motion[group.rows][:, :, None] for group in groups]
            self._way = self._root * self._sampled(ways)
            instants = np.arange(float(problem.n_instants))
            self._instants = self._sampled([instants for _ in groups]).astype(int)
            squares = np.bincount(self._instants, self._way**2)
            self._dual = (
                self._way / np.where(squares > 0.0, squares, 1.0)[self._instants]
            )
        self._memory = max(1, min(MEMORY, MOST_VALUES // size - 1))
        # Memory that nothing was written to costs nothing yet; an instant is in one
        # piece.
        shapes = [(self._memory + 1, *group.target.T.shape) for group in groups]
        self._images = [np.zeros(shape) for shape in shapes]
        self._residuals = np.zeros((self._memory, len(self._root)))
        self._products = np.zeros((self._memory, self._memory))
        self._wanted = np.zeros(self._memory)
        self._start = self._before = np.zeros(len(self._root))
        self._forget()

    def _forget(self) -> None:
        self._count = 0
        self._smallest = np.inf

    def start(self) -> None:
        """Read y, before the iteration that makes g(y) of it."""
        self._start = self._sampled([group.state for group in self._groups])

    def mix(self) -> None:
        """Replace g(y) by the mixture, in place, once there is one."""
        residual = self._sampled([group.state for group in self._groups])
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
            self._remember(residual)
        self._smallest = min(self._smallest, size)
        place = self._place_of(self._count)

        def keep(instants: slice) -> None:
            for group, images in zip(self._groups, self._images, strict=True):
                images[place, instants] = group.state.T[instants]

        self._blocks.each(keep)
        self._before = residual
        if self._count:
            self._mix()

    def _remember(self, residual: Array) -> None:
        place = self._count % self._memory
        newest = self._residuals[place]
        np.subtract(residual, self._before, out=newest)
        self._count += 1
        used = min(self._count, self._memory)
        row = self._residuals[:used] @ newest
        self._products[place, :used] = row
        self._products[:used, place] = row
        # The products with the residual change by those with its newest difference.
        self._wanted[:used] += row
        self._wanted[place] = newest @ residual

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
            for group, images in zip(self._groups, self._images, strict=True):
                part = images[: used + 1, instants].reshape(used + 1, -1)
                np.matmul(shares, part, out=group.state.T[instants].reshape(-1))

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

    def _sampled(self, fields: list[Array]) -> Array:
        """Fields of the groups at the places of the sample, in a row."""
        return np.concatenate(
            [
                np.broadcast_to(field, group.target.shape).reshape(-1, order="F")[
                    ::step
                ]
                for field, group, step in zip(
                    fields, self._groups, self._steps, strict=True
                )
            ]
        )


def _step(step: int, rows: int) -> int:
    """The next larger step that leaves out none of so many rows at all instants."""
    while math.gcd(step, rows) > 1:
        step += 1
    return step
