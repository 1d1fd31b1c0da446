"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from solver.arrays import Array, Indices
from solver.discrete.problem import Problem
from solver.latin.blocks import Blocks, at_once, in_a_row
from solver.latin.linear_stage import LinearStage
from solver.refusal import check_range

MEMORY = 15
"""Differences that are remembered at most. From 5 to 50, 1 % of the contact force takes the same
number of iterations but for two on bar, strand, block and layers, and 1e-4 from 55 to 63 on layers,
39 to 45 on strands (measured)."""
GROWTH_ON_SUPPORT = 2.0
"""Growth of the residual from which the memory is given up, in contact with a rigid support. A
block that tilts until it lifts off needs 1.2 or more: with 1 its rocking takes thousands of
iterations, not 50."""
GROWTH_BETWEEN_BODIES = 1.1
"""The same in contact between two bodies. Layers 200 times as long as thick: 1e-6 of the contact
force takes 120 iterations, 140 with 1.5 and 2, more than 300 with 1; layers 1000 times as long
wander for hundreds with 2 before they come within 1 % (25 with 1.1; measured)."""
MOST_VALUES = 50_000_000
"""Numbers that the remembered images may hold; a larger field is remembered for fewer iterations.
A block of 768 x 384 elements and 51 instants keeps 8 differences and stays below 2 GB; on 384 x 192
1e-4 of the contact force takes 38 iterations with 15 differences, 39 with 8, 41 with 5."""
SAMPLE = 300_000
"""Values of a residual that the weights of the mixture are found from; all, if it has no more. On
384 x 192 elements, a fourth of all: 38 iterations to 1e-4 of the contact force, and 67 with
tractions on top; 38 and 73 with all; 38 and 74 with 100 000, 40 and 79 with 20 000 (measured)."""
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

    def begin(
        self, problem: Problem, stage: LinearStage, motion: Array | None, blocks: Blocks
    ) -> AndersonState | None:
        """Prepare what a run remembers; None where the states of its linear stage are not mixed.

        Parameters
        ----------
        problem, stage
            What is solved, and the linear stage whose states are mixed.
        motion
            Of the rows, shape (n_rows,), which the local stage chooses anew whatever the state is.
        blocks
            Of instants, in which states are mixed.
        """
        weights = [group.weights(problem.time_weights) for group in stage.groups]
        mixable = [part for part in weights if part is not None]
        if len(mixable) < len(weights):
            return None
        growth = 1.0
        if problem.opens:
            is_held = any(law.is_on_support for law in problem.rubbing.values())
            growth = GROWTH_ON_SUPPORT if is_held else GROWTH_BETWEEN_BODIES
        free = None
        if motion is not None:
            free = [
                np.broadcast_to(motion[group.rows][:, :, None], group.target.shape)
                for group in stage.groups
            ]
        return AndersonState(mixable, self.memory, growth, blocks, free)


class AndersonState:
    """What a run remembers of its states, and the mixture of them.

    The images g are kept whole; of large residuals no more than a sample is, drawn once.

    Parameters
    ----------
    weights
        Squared weights of the inner product, one array for each part of the state, of its shape.
    memory
        Differences that are remembered.
    growth
        Of the residual over the smallest so far, from which the memory is given up. Where the bound
        of friction is known 1 is best (twice as much takes up to a third more iterations to 1e-6).
    blocks
        Of instants, the last axis of the parts, in which images are kept and mixed.
    free
        A motion, of the shapes of the weights, that the local stage chooses anew whatever the state
        is: at every instant a residual counts for nothing along it. None where there is none.

    Attributes
    ----------
    seen, count, smallest
        States and differences since the memory was last given up, and the smallest residual.
    """

    def __init__(
        self,
        weights: list[Array],
        memory: int,
        growth: float = 1.0,
        blocks: Blocks | None = None,
        free: list[Array] | None = None,
    ) -> None:
        self._growth = growth
        self._blocks = blocks or at_once(weights[0].shape[-1])
        sizes = [part.size for part in weights]
        self._places = in_a_row(sizes)
        self._chosen = _sample(sizes)
        sampled = [_flat(part)[chosen] for part, chosen in zip(weights, self._chosen, strict=True)]
        self._samples = in_a_row([len(part) for part in sampled])
        self._root = np.sqrt(np.concatenate(sampled))
        self._free = free and _Motion(free, self._chosen, self._root)
        self._memory = max(1, min(memory, MOST_VALUES // sum(sizes) - 1))
        # Memory that nothing was written to costs nothing yet.
        self._images = np.zeros((self._memory + 1, sum(sizes)))
        self._residuals = np.zeros((self._memory, len(self._root)))
        self._products = np.zeros((self._memory, self._memory))
        self._wanted = np.zeros(self._memory)
        self._start, self._residual, self._residual_before = np.zeros((3, len(self._root)))
        self.restore((0, 0, np.inf))

    @property
    def memory(self) -> tuple[int, int, float]:
        """What it counts: `seen`, `count` and `smallest`."""
        return self.seen, self.count, self.smallest

    def restore(self, memory: tuple[int, int, float]) -> None:
        """Count on from there."""
        self.seen, self.count, self.smallest = memory

    @property
    def remembered(self) -> int:
        """States whose images shape what comes next."""
        return min(self.seen, self._memory + 1)

    def start(self, state: list[Array]) -> None:
        """Read y, before the iteration that makes g(y) of it."""
        self._take(state, self._start)

    def __call__(self, state: list[Array]) -> None:
        """Replace g(y) by the mixture, in place."""
        if self.observe(state) and self.seen > 1:
            self._mix(state)

    def observe(self, state: list[Array]) -> bool:
        """Read g(y); return whether to mix."""
        residual = self._residual
        self._take(state, residual)
        np.subtract(residual, self._start, out=residual)
        np.multiply(residual, self._root, out=residual)
        if self._free:
            self._free.leave_out(residual)
        size = float(np.sqrt(residual @ residual))
        if not size > 0.0 or not np.isfinite(size):
            return False
        if size > self._growth * self.smallest:
            self.restore((0, 0, np.inf))
        self.smallest = min(self.smallest, size)
        if self.seen:
            self._remember()
        image = self._images[self._place_of(self.count)]

        def keep(instants: slice) -> None:
            for part, place in zip(state, self._places, strict=True):
                image[_within(place, part, instants)] = _flat(part[..., instants])

        self._blocks.each(keep)
        self._residual, self._residual_before = self._residual_before, residual
        self.seen += 1
        return True

    def _remember(self) -> None:
        place = self.count % self._memory
        newest = self._residuals[place]
        np.subtract(self._residual, self._residual_before, out=newest)
        self.count += 1
        used = min(self.count, self._memory)
        row = self._residuals[:used] @ newest
        self._products[place, :used] = row
        self._products[:used, place] = row
        # The products with the residual change by those with its newest difference.
        self._wanted[:used] += row
        self._wanted[place] = newest @ self._residual

    def _mix(self, state: list[Array]) -> None:
        used = min(self.count, self._memory)
        gram = self._products[:used, :used]
        scale = 1.0 / np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        scaled = gram * scale * scale[:, None]
        scaled[np.diag_indices(used)] += REGULAR
        _, gamma, failed = dposv(scaled, scale * self._wanted[:used])
        if failed:
            return
        shares = self._shares(scale * gamma)

        def mix(instants: slice) -> None:
            for part, place in zip(state, self._places, strict=True):
                images = self._images[: used + 1, _within(place, part, instants)]
                np.matmul(shares, images, out=_flat(part[..., instants]))

        self._blocks.each(mix)

    def _shares(self, gamma: Array) -> Array:
        """The weights of the images, which add up to one, from those of their differences."""
        shares = np.zeros(len(gamma) + 1)
        shares[self._place_of(self.count)] = 1.0
        for number in range(self.count - len(gamma), self.count):
            share = gamma[number % self._memory]
            shares[self._place_of(number + 1)] -= share
            shares[self._place_of(number)] += share
        return shares

    def _place_of(self, number: int) -> int:
        return number % (self._memory + 1)

    def _take(self, state: list[Array], out: Array) -> None:
        parts = zip(state, self._chosen, self._samples, strict=True)
        for part, chosen, place in parts:
            out[place] = _flat(part)[chosen]


class _Motion:
    """A motion that residuals are blind to, at the places of a sample."""

    def __init__(self, free: list[Array], chosen: list[slice | Indices], root: Array) -> None:
        places = [np.arange(part.size)[places] for part, places in zip(free, chosen, strict=True)]
        pairs = list(zip(free, places, strict=True))
        self._way = root * np.concatenate([_flat(part)[place] for part, place in pairs])
        instants = np.concatenate([place * part.shape[-1] // part.size for part, place in pairs])
        size = np.bincount(instants, self._way**2)
        self._dual = self._way / np.where(size > 0.0, size, 1.0)[instants]
        # In order of memory an instant is a run of places, in every part.
        self._first = np.flatnonzero(np.diff(instants, prepend=-1))
        self._lengths = np.diff(self._first, append=len(instants))
        self._instants = instants[self._first]

    def leave_out(self, residual: Array) -> None:
        """Remove from a weighted residual what it has of the motion, instant by instant."""
        runs = np.add.reduceat(self._dual * residual, self._first)
        share = np.bincount(self._instants, runs)[self._instants]
        residual -= self._way * np.repeat(share, self._lengths)


def _within(place: slice, part: Array, instants: slice) -> slice:
    """Where some instants of a part stand, which itself stands at a place."""
    each = part.size // part.shape[-1]
    first, last, _ = instants.indices(part.shape[-1])
    return slice(place.start + first * each, place.start + last * each)


def _sample(sizes: list[int]) -> list[slice | Indices]:
    """Draw one place out of every so many, the same whenever it is asked: a run repeats itself."""
    step = -(-sum(sizes) // SAMPLE)
    if step == 1:
        return [slice(0, size) for size in sizes]
    draw = np.random.default_rng(0)
    places: list[slice | Indices] = []
    for size in sizes:
        first = np.arange(0, size, step)
        places.append(np.minimum(first + draw.integers(0, step, len(first)), size - 1))
    return places


def _flat(part: Array) -> Array:
    """The numbers of a part in a row, without a copy where it is contiguous in space."""
    return part.reshape(-1, order="F")
