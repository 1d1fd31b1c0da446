"""What runs are compared with, where that is quick enough to be found beside them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np

from app.worker.shown import has_reference
from solver.discrete import Problem
from solver.reference.choice import reference_of
from solver.reference.condensation import NotHeldError
from solver.reference.fingerprint import fingerprint
from solver.reference.incremental import Reference
from solver.settings import Settings


class References:
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
        self._kept: OrderedDict[bytes, _Kept] = OrderedDict()

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
        kept = self._kept.pop(key, None)
        if kept is None:
            found = _find(problem, stop)
            if found is None:
                return None
            kept = _Kept(found)
        self._kept[key] = kept
        while len(self) > self._entries or self._size > self._budget:
            self._kept.popitem(last=False)
        return kept.of(problem)

    @property
    def _size(self) -> int:
        return sum(kept.size for kept in self._kept.values())


class _Kept:
    """A reference without its problem, and the bytes of its fields."""

    def __init__(self, found: Reference) -> None:
        names = [one.name for one in fields(found) if one.name != "problem"]
        self._values: dict[str, Any] = {name: getattr(found, name) for name in names}
        arrays = [value for value in self._values.values() if isinstance(value, np.ndarray)]
        self.size = sum(value.nbytes for value in arrays)

    def of(self, problem: Problem) -> Reference:
        """Give it back its problem, or one that is solved alike."""
        return Reference(problem, **self._values)


def _find(problem: Problem, stop: Callable[[], bool]) -> Reference | None:
    try:
        found = reference_of(problem, stop)
    except NotHeldError:
        return None
    return found if found.converged.all() else None
