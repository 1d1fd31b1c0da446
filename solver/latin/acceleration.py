"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dposv

from solver.discrete.problem import Array, Problem
from solver.latin.linear import FullLinearStage
from solver.laws import Contact

MOST_VALUES = 40_000_000
"""Numbers that the memory may hold; a larger field is remembered for fewer iterations."""
REGULAR = 1e-10
"""Added to the diagonal of the small normal equations, whose own diagonal is scaled to 1."""
GROWTH_ON_SUPPORT = 2.0
"""Growth of the residual from which the memory is given up, in contact with a rigid support. A
block that tilts until it lifts off needs 1.2 or more: with 1 its rocking takes thousands of
iterations, not 50."""
GROWTH_BETWEEN_BODIES = 1.1
"""The same in contact between two bodies. Layers 200 times as long as thick: 1e-6 of the contact
force takes 120 iterations, 140 with 1.5 and 2, more than 300 with 1; layers 1000 times as long
wander for hundreds with 2 before they come within 1 % (25 with 1.1; measured)."""


def anderson(problem: Problem, stage: FullLinearStage, memory: int) -> Anderson:
    """Prepare the acceleration of a linear stage, with the norm of k over boundary and time."""
    weights = [
        np.broadcast_to(group.k[:, None, None] * problem.time_weights, group.target.shape)
        for group in stage.groups
    ]
    contacts = [law for law in problem.of_law(Contact) if isinstance(law, Contact)]
    growth = 1.0
    if contacts:
        is_held = any(law.below is None for law in contacts)
        growth = GROWTH_ON_SUPPORT if is_held else GROWTH_BETWEEN_BODIES
    return Anderson(weights, memory, growth)


class Anderson:
    """Mixes the newest state with those before, so that the residual would be least if linear.

    One iteration maps the state y to g(y) with residual f = g(y) - y. The mixture
    g_n - sum_j gamma_j (g_j - g_{j-1}), where gamma makes f_n - sum_j gamma_j (f_j - f_{j-1})
    least, has weights that add up to one, so it is admissible whenever its parts are. When the
    residual grows beyond `growth` times the smallest, the memory is given up: the plain iteration
    goes on from there, which does not diverge.

    Parameters
    ----------
    weights
        Squared weights of the inner product, one array for each part of the state, of its shape.
    memory
        Differences that are remembered.
    growth
        Of the residual over the smallest so far, from which the memory is given up. Where the bound
        of friction is known 1 is best (twice as much takes up to a third more iterations to 1e-6).

    Attributes
    ----------
    seen, count, smallest
        States and differences since the memory was last given up, and the smallest residual.
    """

    def __init__(self, weights: list[Array], memory: int, growth: float = 1.0) -> None:
        self._growth = growth
        self._root = np.sqrt(np.concatenate([_flat(part) for part in weights]))
        ends = np.cumsum([part.size for part in weights])
        self._places = [
            slice(end - part.size, end) for end, part in zip(ends, weights, strict=True)
        ]
        size = len(self._root)
        self._memory = max(1, min(memory, MOST_VALUES // (2 * size)))
        self._residuals = np.zeros((self._memory, size))
        self._images = np.zeros((self._memory, size))
        self._products = np.zeros((self._memory, self._memory))
        self._wanted = np.zeros(self._memory)
        self._residual, self._image, self._residual_before, self._image_before = np.zeros((4, size))
        self.seen, self.count, self.smallest = 0, 0, np.inf

    @property
    def remembered(self) -> int:
        """States whose images shape what comes next."""
        return min(self.seen, self._memory + 1)

    @property
    def relative_residual(self) -> float:
        """Smallest residual over the newest image, in the norm of the weights."""
        size = float(np.linalg.norm(self._image_before * self._root))
        return self.smallest / size if size > 0.0 else 0.0

    def __call__(self, before: list[Array], after: list[Array]) -> None:
        """Replace g(y), the parts `after`, by the mixture, in place; `before` is y."""
        if self.observe(before, after) and self.seen > 1:
            self._mix(after)

    def observe(self, before: list[Array], after: list[Array]) -> bool:
        """Take in a state y, the parts `before`, and its image; tell whether to mix."""
        residual, whole = self._residual, self._image
        for own, image, place in zip(before, after, self._places, strict=True):
            whole[place] = _flat(image)
            np.subtract(whole[place], _flat(own), out=residual[place])
        np.multiply(residual, self._root, out=residual)
        size = float(np.sqrt(residual @ residual))
        if not size > 0.0 or not np.isfinite(size):
            return False
        if size > self._growth * self.smallest:
            self.seen, self.count, self.smallest = 0, 0, np.inf
        self.smallest = min(self.smallest, size)
        if self.seen:
            self._remember()
        self._residual, self._residual_before = self._residual_before, residual
        self._image, self._image_before = self._image_before, whole
        self.seen += 1
        return True

    def _remember(self) -> None:
        place = self.count % self._memory
        newest = self._residuals[place]
        np.subtract(self._residual, self._residual_before, out=newest)
        np.subtract(self._image, self._image_before, out=self._images[place])
        self.count += 1
        used = min(self.count, self._memory)
        row = self._residuals[:used] @ newest
        self._products[place, :used] = row
        self._products[:used, place] = row
        # The products with the residual change by those with its newest difference.
        self._wanted[:used] += row
        self._wanted[place] = newest @ self._residual

    def _mix(self, after: list[Array]) -> None:
        used = min(self.count, self._memory)
        gram = self._products[:used, :used]
        scale = 1.0 / np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        scaled = gram * scale * scale[:, None]
        scaled[np.diag_indices(used)] += REGULAR
        _, gamma, failed = dposv(scaled, scale * self._wanted[:used])
        if failed:
            return
        change = (scale * gamma) @ self._images[:used]
        for image, place in zip(after, self._places, strict=True):
            flat = _flat(image)
            np.subtract(flat, change[place], out=flat)


def _flat(part: Array) -> Array:
    """Give the numbers of a part in a row, without a copy where it is contiguous in space."""
    return part.reshape(-1, order="F")
