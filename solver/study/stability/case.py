"""Stiff and extreme cases: what one is, and loads and sections that many share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from solver.definitions import Pairs
from solver.study.stability.verdict import RIGHT, Trial

PRECISE = {"accuracy": 1e-6, "tolerance": 1e-20, "max_iterations": 1500}
"""Tight, so that whoever is called converged has to be right; enough for most cases."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}


@dataclass(frozen=True)
class Case:
    """A run of a scene, by any method.

    Attributes
    ----------
    group, name
        What is extreme, and how much.
    changes
        Settings that differ from the scene's own, beside `PRECISE`.
    expected
        `RIGHT`; `UNSOLVED` where the method is known to be slow or beyond its digits; `MUST_REFUSE`
        where there is no solution; `UNCLEAR` where friction is so large that there may be several.
    quick
        Whether it is one of the few for a short check.
    """

    group: str
    name: str
    changes: Mapping[str, object] = field(default_factory=dict)
    expected: str = RIGHT
    quick: bool = False
    scene: str = "bar"

    def trial(self, method: str) -> Trial:
        """Its run by one of `METHODS`."""
        values = {**PRECISE, **METHODS[method], **self.changes}
        what = self.scene, method, self.group, self.name
        return Trial(*what, values, self.expected, RIGHT_UP_TO, RIGHT_UP_TO)


def cases_with(scene: str, usual: Mapping[str, object]) -> Callable[..., Case]:
    """A function that makes cases of a scene which have some settings in common."""

    def case(
        group: str,
        name: str,
        changes: Mapping[str, object],
        expected: str = RIGHT,
        quick: bool = False,
    ) -> Case:
        return Case(group, name, {**usual, **changes}, expected, quick, scene)

    return case


def reversals(instants: int, peak: float) -> Pairs:
    """A load of full size that turns at every instant of a second, (s, N)."""
    step = 1.0 / (instants - 1)
    return tuple((number * step, peak * (-1.0) ** number) for number in range(instants))


JUMP_WIDTH = 1e-9
"""Share of an element beside its ends, within which a section changes to that of the next."""


def graded(contrast: float, elements: int) -> Pairs:
    """A section that grows by equal factors from element to element of a bar of 1 m.

    Parameters
    ----------
    contrast
        Last over first section; their geometric mean stays what it was.
    elements
        Number of elements.
    """
    factors = contrast ** np.linspace(-0.5, 0.5, elements)
    return tuple(
        ((i + end) / elements, float(factor))
        for i, factor in enumerate(factors)
        for end in (JUMP_WIDTH, 1.0 - JUMP_WIDTH)
    )


JUMP: Pairs = ((0.0, 0.0), (0.5, 0.0), (0.51, 900.0), (1.0, 900.0))
PLATEAUS: Pairs = (
    (0.0, 0.0),
    (0.2, 800.0),
    (0.4, 800.0),
    (0.6, -400.0),
    (0.8, -400.0),
    (1.0, 700.0),
)
