"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

import numpy as np

from solver.discrete.problem import Array

GROWTH = 2.0
"""Growth of the residual, over the smallest so far, at which the memory is given up."""
MOST_VALUES = 40_000_000
"""Numbers that the memory may hold; a larger field is remembered for fewer iterations."""
REGULAR = 1e-12
"""Share added to the diagonal of the small normal equations."""


class Anderson:
    """Mixes the newest state with those before, so that the residual would be least if linear.

    One iteration maps the state y to g(y) with residual f = g(y) - y. The mixture
    g_n - sum_j gamma_j (g_j - g_{j-1}), where gamma makes f_n - sum_j gamma_j (f_j - f_{j-1})
    least, has weights that add up to one, so it is admissible whenever its parts are. When the
    residual grows beyond `GROWTH` times the smallest, the memory is given up: the plain iteration
    goes on from there, which does not diverge.

    Parameters
    ----------
    weights
        Squared weights of the inner product, one array for each part of the state, broadcast to
        its shape.
    shapes
        Shapes of the parts.
    memory
        Differences that are remembered.

    Attributes
    ----------
    seen, count, smallest
        States and differences since the memory was last given up, and the smallest residual.
    """

    def __init__(self, weights: list[Array], shapes: list[tuple[int, ...]], memory: int) -> None:
        self._roots = [np.sqrt(part) for part in weights]
        size = sum(int(np.prod(shape)) for shape in shapes)
        self._memory = max(1, min(memory, MOST_VALUES // (2 * size)))
        self._residuals = np.zeros((self._memory, size))
        self._images = np.zeros((self._memory, size))
        self._products = np.zeros((self._memory, self._memory))
        self._residual, self._image = np.zeros(size), np.zeros(size)
        self._before = np.zeros((2, size))
        self.seen, self.count, self.smallest = 0, 0, np.inf

    @property
    def remembered(self) -> int:
        """States whose images shape what comes next."""
        return min(self.seen, self._memory + 1)

    def __call__(self, before: list[Array], after: list[Array]) -> None:
        """Replace g(y), the parts `after`, by the mixture, in place; `before` is y."""
        if self.observe(before, after) and self.seen > 1:
            self._mix(after)

    def observe(self, before: list[Array], after: list[Array]) -> bool:
        """Take in a state y, the parts `before`, and its image; tell whether to mix."""
        first = 0
        for own, image, root in zip(before, after, self._roots, strict=True):
            some = slice(first, first := first + own.size)
            self._image[some] = image.ravel(order="F")
            self._residual[some] = ((image - own) * root).ravel(order="F")
        size = float(np.linalg.norm(self._residual))
        if not size > 0.0 or not np.isfinite(size):
            return False
        if size > GROWTH * self.smallest:
            self.seen, self.count, self.smallest = 0, 0, np.inf
        self.smallest = min(self.smallest, size)
        if self.seen:
            self._remember()
        self._before[0], self._before[1] = self._residual, self._image
        self.seen += 1
        return True

    def _remember(self) -> None:
        place = self.count % self._memory
        np.subtract(self._residual, self._before[0], out=self._residuals[place])
        np.subtract(self._image, self._before[1], out=self._images[place])
        self.count += 1
        used = min(self.count, self._memory)
        row = self._residuals[:used] @ self._residuals[place]
        self._products[place, :used] = row
        self._products[:used, place] = row

    def _mix(self, after: list[Array]) -> None:
        used = min(self.count, self._memory)
        gram = self._products[:used, :used].copy()
        gram[np.diag_indices(used)] *= 1.0 + REGULAR
        wanted = self._residuals[:used] @ self._residual
        gamma = np.linalg.lstsq(gram, wanted, rcond=None)[0]
        mixed = self._image - gamma @ self._images[:used]
        first = 0
        for image in after:
            some = slice(first, first := first + image.size)
            image[...] = mixed[some].reshape(image.shape, order="F")
