"""Anderson acceleration of the iteration (Walker and Ni, SIAM J. Numer. Anal. 49, 2011)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.discrete.problem import Problem
from solver.latin.acceleration.mixing import Mixing
from solver.latin.blocks import Blocks
from solver.latin.linear.stage import LinearStage
from solver.latin.local.slide import slide_of
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


@dataclass(frozen=True)
class Anderson:
    """Mixes the last iterates, so that both stages agree best.

    Separated bases are not mixed: there the iteration stays plain.

    Attributes
    ----------
    memory
        Differences that are remembered at most.
    """

    memory: int = MEMORY

    def __post_init__(self) -> None:
        check_range(self, "memory", 1, 1000)

    def at_work(
        self, problem: Problem, stage: LinearStage[Any], blocks: Blocks | None = None
    ) -> Mixing | None:
        """Prepare the acceleration of a linear stage; None where its states are not to be mixed."""
        weights = stage.weights(problem.time_weights)
        if weights is None:
            return None
        growth = 1.0
        if problem.opens:
            is_held = any(law.is_on_support for law in problem.rubbing.values())
            growth = GROWTH_ON_SUPPORT if is_held else GROWTH_BETWEEN_BODIES
        way = slide_of(problem)
        free = None
        if way is not None:
            rows = way[problem.row_dofs]
            free = [
                np.broadcast_to(rows[group.rows][:, :, None], group.target.shape)
                for group in stage.groups
            ]
        return Mixing(weights, self.memory, growth, blocks, free)
