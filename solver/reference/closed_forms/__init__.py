"""Closed forms, and their curves for plots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from solver.arrays import Array

Of = Literal["friction", "pressure", "axial force", "front", "loop"]


@dataclass(frozen=True, eq=False)
class ExactCurve:
    """The closed form of one quantity as a curve, independent of the mesh.

    Attributes
    ----------
    of
        The quantity: friction on the body above, or pressure, of the scene's main
        interface; axial force in a rod; the front of slip; or the scene's loop.
    across
        Horizontal axis. Of fields the positions, shape (n_positions,), m; of a front
        its position, m, of a loop its abscissa, shape (n_instants,) both.
    up
        Vertical axis. Of tractions, N/m or Pa, and of an axial force, N, shape
        (n_positions, n_instants); of a front the instants, s, of a loop its force, N,
        shape (n_instants,) both.
    interface
        Name of the interface of tractions, where the scene has several; else "".
    """

    of: Of
    across: Array
    up: Array
    interface: str = ""
