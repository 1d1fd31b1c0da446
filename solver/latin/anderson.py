"""Anderson acceleration of the iteration.

Source: Walker and Ni, SIAM J. Numer. Anal. 49, 2011.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.linear import LinearStage

MEMORY = 15
"""Largest number of differences that are remembered; from 5 to 50 the number of
iterations hardly changes (measured)."""
GROWTH_ON_SUPPORT = 2.0
"""Growth of the residual from which the memory is given up, in contact with a rigid
support: with 1 the rocking of a block that tilts until it lifts off takes thousands of
iterations, not 50."""
GROWTH_BETWEEN_BODIES = 1.1
"""Growth of the residual from which the memory is given up, in contact between bodies.
Thin layers: 1e-6 takes 120 iterations with it, 140 with 2, 300 with 1."""
MOST_VALUES = 50_000_000
"""Largest count of numbers in the remembered images; a larger field is remembered for
fewer iterations: on 384 x 192 elements 1e-4 takes 38 with 15 differences, 41 with 5
(measured)."""
SAMPLE = 300_000
"""Values of a residual that give the weights of the mixture, or all if it has no more.
On 384 x 192 elements 1e-4 takes as many iterations with the sample as with all
(measured)."""
REGULAR = 1e-10
"""Regularisation: added to the diagonal of the small normal equations, which is scaled
to 1."""


@dataclass(frozen=True)
class Anderson:
    """Acceleration by mixtures of the last iterates that minimise the residual.

    One iteration maps the state y to g(y) with residual f = g(y) - y. The mixture g_n -
    sum_j gamma_j (g_j - g_{j-1}), where gamma makes f_n - sum_j gamma_j (f_j - f_{j-1})
    smallest, has weights that add up to one, so it is admissible whenever its parts
    are. When the residual grows too far beyond the smallest, the memory is given up:
    the plain iteration continues from there, which does not diverge. Separated bases
    are not mixed.
    """


class AndersonState:
    """Stored states of a run, as full fields, and their mixture.

    The images g are kept whole, of large residuals no more than a sample. Residuals are
    measured by k over boundary and time.

    Parameters
    ----------
    problem, stage
        The problem, and its linear stage, whose state is mixed in place.
    motion
        Motion of the rows that the local stage chooses again at every instant, shape
        (n_rows,), or None. Residuals along it count for nothing.
    blocks
        Blocks of instants.
    """

    def __init__(
        self, problem: Problem, stage: LinearStage, motion: Array | None, blocks: Blocks
    ) -> None:
        self._growth = _allowed_growth(problem)
        self._groups = stage.groups
        self._blocks = blocks
        size = sum(group.target.size for group in self._groups)
        self._memory = max(1, min(MEMORY, MOST_VALUES // size - 1))
        # Steps of the sample may not skip a row at all instants, so groups differ.
        smallest_step = -(-size // SAMPLE)
        self._steps = [_step(smallest_step, group.rows.size) for group in self._groups]
        weights = []
        for group in self._groups:
            of_group = group.k[:, None, None] * problem.time_weights
            weights.append(np.broadcast_to(of_group, group.target.shape))
        self._root = np.sqrt(self._sampled(weights))
        self._free_motion = None
        if motion is not None:
            self._free_motion = self._free(motion, problem.n_instants)
        # Memory that nothing was written to costs nothing yet; an instant is in one
        # piece.
        self._images = []
        for group in self._groups:
            shape = (self._memory + 1, *group.target.T.shape)
            self._images.append(np.zeros(shape))
        self._residuals = np.zeros((self._memory, len(self._root)))
        self._products = np.zeros((self._memory, self._memory))
        self._wanted = np.zeros(self._memory)
        self._start = np.zeros(len(self._root))
        self._before = self._start
        self._forget()

    def _free(self, motion: Array, n_instants: int) -> _FreeMotion:
        """Motion of the rows, (n_rows,), that has no weight in the residual."""
        times = np.arange(float(n_instants))
        by_group = []
        instants = []
        for group in self._groups:
            shape = group.target.shape
            by_group.append(np.broadcast_to(motion[group.rows][:, :, None], shape))
            instants.append(np.broadcast_to(times, shape))
        return _FreeMotion(
            self._root * self._sampled(by_group), self._sampled(instants).astype(int)
        )

    def _forget(self) -> None:
        """Forget all images and differences."""
        self._count = 0
        self._smallest = np.inf

    def start(self) -> None:
        """Store the state y before an iteration."""
        self._start = self._sampled([group.state for group in self._groups])

    def mix(self) -> None:
        """Replace the state g(y) after an iteration by a mixture, if possible."""
        residual = self._residual()
        size = float(np.sqrt(residual @ residual))
        if not size > 0.0 or not np.isfinite(size):
            return
        # Before the mixture, which would use misleading differences.
        if size > self._growth * self._smallest:
            self._forget()
        if np.isfinite(self._smallest):  # there is an image before
            self._remember(residual)
        self._smallest = min(self._smallest, size)
        self._keep_image()
        self._before = residual
        if self._count:
            self._mix()

    def _residual(self) -> Array:
        """Sampled residual g(y) - y, times the root of the weights, (n_sample,)."""
        residual = self._sampled([group.state for group in self._groups])
        np.subtract(residual, self._start, out=residual)
        np.multiply(residual, self._root, out=residual)
        if self._free_motion is not None:
            self._free_motion.remove_from(residual)
        return residual

    def _keep_image(self) -> None:
        """Store the state g(y) among the images."""
        slot = self._slot_of(self._count)

        def keep(instants: slice) -> None:
            for group, images in zip(self._groups, self._images, strict=True):
                images[slot, instants] = group.state.T[instants]

        self._blocks.each(keep)

    def _remember(self, residual: Array) -> None:
        """Store the difference of a residual, (n_sample,), to the previous one."""
        slot = self._count % self._memory
        newest = self._residuals[slot]
        np.subtract(residual, self._before, out=newest)
        self._count += 1
        used = min(self._count, self._memory)
        row = self._residuals[:used] @ newest
        self._products[slot, :used] = row
        self._products[:used, slot] = row
        # The products with the residual change by those with its newest difference.
        self._wanted[:used] += row
        self._wanted[slot] = newest @ residual

    def _mix(self) -> None:
        """Write the mixture of the images into the state."""
        used = min(self._count, self._memory)
        gram = self._products[:used, :used]
        # Differences shrink by orders of magnitude in a run: scaled, all count alike.
        scale = 1.0 / np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        scaled = gram * scale * scale[:, None]
        scaled[np.diag_indices(used)] += REGULAR
        _, gamma, failed = dposv(scaled, scale * self._wanted[:used])
        # The plain iterate stands, as if there were no memory.
        if failed:
            return
        shares = self._shares(scale * gamma)

        def mix(instants: slice) -> None:
            for group, images in zip(self._groups, self._images, strict=True):
                part = images[: used + 1, instants].reshape(used + 1, -1)
                np.matmul(shares, part, out=group.state.T[instants].reshape(-1))

        self._blocks.each(mix)

    def _shares(self, gamma: Array) -> Array:
        """Weights of the images, which add up to one, shape (n_used + 1,).

        `gamma` are the weights of the differences between images, shape (n_used,).
        """
        shares = np.zeros(len(gamma) + 1)
        shares[self._slot_of(self._count)] = 1.0
        # A difference adds its share to one image and takes it from the next.
        for number in range(self._count - len(gamma), self._count):
            share = gamma[number % self._memory]
            shares[self._slot_of(number + 1)] -= share
            shares[self._slot_of(number)] += share
        return shares

    def _slot_of(self, number: int) -> int:
        """Slot of an image by its index since the memory began."""
        return number % (self._memory + 1)

    def _sampled(self, fields: list[Array]) -> Array:
        """Values of fields of the groups at the sample, shape (n_sample,).

        Each field has shape (n_boundary, n_substructures, n_instants).
        """
        values = []
        for field, step in zip(fields, self._steps, strict=True):
            values.append(field.reshape(-1, order="F")[::step])
        return np.concatenate(values)


class _FreeMotion:
    """Motion at every instant along which residuals have no weight.

    Parameters
    ----------
    motion
        Weighted motion at the values of the sample, shape (n_sample,).
    instants
        Index of the instant of every value, same shape.
    """

    def __init__(self, motion: Array, instants: Indices) -> None:
        self._motion = motion
        self._instants = instants
        squares = np.bincount(instants, motion**2)
        self._dual = motion / np.where(squares > 0.0, squares, 1.0)[instants]

    def remove_from(self, residual: Array) -> None:
        """Project a weighted residual, (n_sample,), in place, across the motion."""
        share = np.bincount(self._instants, self._dual * residual)
        residual -= self._motion * share[self._instants]


def _allowed_growth(problem: Problem) -> float:
    """Growth of the residual over its minimum at which the memory is cleared."""
    if not problem.opens:
        # Where the bound of friction is known 1 is best; twice as much takes up to a
        # third more iterations to 1e-6.
        return 1.0
    if any(law.is_on_support for law in problem.contacts.laws.values()):
        return GROWTH_ON_SUPPORT
    return GROWTH_BETWEEN_BODIES


def _step(smallest: int, n_rows: int) -> int:
    """Smallest step of the sample that includes every row at some instant."""
    step = smallest
    while math.gcd(step, n_rows) > 1:
        step += 1
    return step
