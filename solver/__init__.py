"""Slipfront's engine: frictional contact by the multiscale LATIN method.

>>> from solver import End, Latin, Rods, Stack, iterations, solve
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = [
    "End",
    "Latin",
    "Problem",
    "Rods",
    "Stack",
    "discretise",
    "iterations",
    "solve",
]


def __getattr__(name: str) -> Any:
    """Import the module of a public name when the name is first used.

    NumPy is told beforehand how many threads it may use (`solver/__main__.py`).
    """
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = "latin" if name in ("Latin", "iterations", "solve") else "discrete"
    return getattr(import_module(f"solver.{home}"), name)
