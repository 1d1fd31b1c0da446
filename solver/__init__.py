"""Slipfront's engine: frictional contact by the multiscale LATIN method.

>>> from solver import End, Latin, Rods, Stack, iterations, solve
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

HOMES = {
    "End": "solver.discrete",
    "Latin": "solver.latin",
    "Problem": "solver.discrete",
    "Rods": "solver.discrete",
    "Stack": "solver.discrete",
    "iterations": "solver.latin",
    "solve": "solver.latin",
}
"""Where the names stand that are given here: loaded when asked for, as NumPy is told beforehand how
many threads it may use (`solver/__main__.py`)."""

__all__ = ["End", "Latin", "Problem", "Rods", "Stack", "iterations", "solve"]


def __getattr__(name: str) -> Any:
    """Load a name when it is first asked for."""
    if name not in HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(HOMES[name]), name)
