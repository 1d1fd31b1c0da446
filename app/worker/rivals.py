"""What runs are compared with, where that is quick enough to be found beside them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from app.picture.shown import has_reference
from solver.discrete import Problem
from solver.reference.choice import reference_of
from solver.reference.condensation import NoReferenceError
from solver.reference.fingerprint import fingerprint
from solver.reference.solution import Reference
from solver.settings import Settings


class KeptReferences:
    """The references last used, by what they depend on.

    They are kept without their problems, whose matrices take many times as much.

    Parameters
    ----------
    entries, budget
        How many are kept at most, and how many bytes they may take together.
    """

    def __init__(self, entries: int = 8, budget: int = 200_000_000) -> None:
        self._entries = entries
        self._budget = budget
        self._kept: OrderedDict[bytes, Reference] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    def of(
        self, settings: Settings, problem: Problem, stop: Callable[[], bool]
    ) -> Reference | None:
        """Give the reference of a problem, if it has one, computed only if it is not at hand.

        Raises
        ------
        Interrupted
            As soon as `stop` gives True.
        """
        if not has_reference(settings):
            return None
        key = fingerprint(problem)
        found = self._kept.pop(key, None) or _find(problem, stop)
        if found is None:
            return None
        without: Any = None
        self._kept[key] = replace(found, problem=without)
        while len(self) > self._entries or sum(map(_size, self._kept.values())) > self._budget:
            self._kept.popitem(last=False)
        # That of a problem that is solved alike has to be given this one.
        return replace(found, problem=problem)


def _size(found: Reference) -> int:
    """Give the bytes of a reference's fields."""
    arrays = [getattr(found, one.name) for one in fields(found)]
    return sum(one.nbytes for one in arrays if isinstance(one, np.ndarray))


def _find(problem: Problem, stop: Callable[[], bool]) -> Reference | None:
    try:
        found = reference_of(problem, stop)
    except NoReferenceError:
        return None
    return found if found.converged.all() else None
