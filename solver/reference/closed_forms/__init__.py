"""Closed forms, which need no mesh, and the curves that plots draw of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from solver.arrays import Array

Of = Literal["friction", "pressure", "axial force", "front", "loop"]


@dataclass(frozen=True, eq=False)
class ExactCurve:
    """The closed form of one quantity, without a mesh along the body.

    Attributes
    ----------
    of
        The quantity: friction on the body above and pressure, of the interface that all
        of it is about; axial force in a rod; how far slip has spread; or the loop that
        the scene shows.
    across
        Places, shape (n_places,), m; of a front where it is, of a loop what it is over,
        shape (n_instants,).
    up
        Shape (n_places, n_instants), N/m or Pa of tractions, N of an axial force; of a
        front the instants, s, of a loop its force, shape (n_instants,).
    """

    of: Of
    across: Array
    up: Array
