"""What is shown of a run: the types and limits of its arrays, and the parts of a frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.languages.language import SOURCE, Language, language
from app.picture.units import BY_SIZE
from solver.reduction.basis import ReductionRecord
from solver.settings import Settings

Floats = NDArray[np.float32]
Bytes = NDArray[np.int8]
Counts = NDArray[np.int16]
Manner = tuple[str, str]
"""Units and language, in which a picture is told."""

LARGEST_SIDE = 400
"""Points and instants of a field that are sent at most; a screen shows no more."""

LONGEST_CURVE = 2000
"""Instants of a curve that are sent at most."""

MOST_SPECTRA = 60
"""Substructures whose spectra are sent at most, chosen by `thinned`."""

MOST_VALUES = 64
"""Singular values of a substructure that are sent at most."""

MOST_SIZES = 60
"""Substructures whose numbers of modes are sent at most, chosen by `thinned`."""

MOST_MODES = 5
"""Modes of the chosen substructure that are sent at most, the largest."""

MOST_JUMPS = 1000
"""Jumps up to which a reference takes no longer than a second or two; its time grows with their
cube (measured: 8 s for 1900), and meanwhile the worker obeys no order."""

STRESSES = ("von Mises", "xx", "yy", "xy")
"""Components of stress that a frame may carry."""

STATUS_OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True)
class Axes:
    """Title and unit across and up."""

    across: tuple[str, str]
    up: tuple[str, str]


@dataclass(frozen=True)
class Mesh:
    """Quadrilaterals, as many as a screen shows.

    Attributes
    ----------
    nodes
        Corners, shape (n_nodes, 2), m.
    quads
        Which of them each has, shape (n_quads, 4).
    parts
        The substructure of each, shape (n_quads,).
    """

    nodes: Floats
    quads: NDArray[np.int32]
    parts: NDArray[np.intp]


@dataclass(frozen=True)
class Wires:
    """Wires that a frame may show the axial force of.

    Attributes
    ----------
    numbers
        Of the wires, from 1.
    positions
        Where the force is given along each of them, shape (n_positions,), m.
    broken
        Number of the broken one, or 0.
    """

    numbers: tuple[int, ...]
    positions: Floats
    broken: int


@dataclass(frozen=True)
class ShownModes:
    """The largest displacement modes of one substructure's separated basis, without body forces.

    Attributes
    ----------
    positions
        Shape (n_points,), m.
    space_modes
        Shape (n_modes, n_points); the largest entry of each is 1 in size, and the last lobe that
        is at least half as large is positive.
    time_functions
        Shape (n_modes, n_instants), m, at the stand's instants; mode times function is the field.
    born
        Shape (n_modes,): whether more than half of the mode, in its energy, lies outside the modes
        of the iteration before.
    record
        What the iteration did to the basis.
    lost
        Modes that downsizing dropped.
    """

    positions: Floats
    space_modes: Floats
    time_functions: Floats
    born: NDArray[np.bool_]
    record: ReductionRecord
    lost: int


@dataclass(frozen=True)
class MeshField:
    """Displacement and stress on a `Mesh` at one instant.

    Attributes
    ----------
    displacement
        Shape (n_nodes, 2), m.
    stress
        Shape (n_quads,), Pa; a quadrilateral that stands for several elements has their mean.
    largest
        Largest displacement over the whole time, m.
    """

    displacement: Floats
    stress: Floats
    largest: float


@dataclass(frozen=True)
class Look:
    """Where one looks.

    Attributes
    ----------
    interface
        Name of an interface with friction; the first one if there is none of this name.
    phase
        The chosen instant, as a share of the interval.
    stress
        One of `STRESSES`.
    substructure
        The one whose modes are looked at, counted from 0; None is the last one, and so is a number
        that is too large.
    place
        The position along the bodies that is marked, m, or None.
    magnification
        Factor on the displacement of bodies; None leaves it to the view.
    is_held
        Whether a hand has hold of a slider: bodies keep the scale that they are drawn in.
    views
        Names of the views that are seen.
    complaint
        What the status line says about the address, or empty.
    readings
        Quantities of the run that are told in words, by their names.
    units
        One of `app.picture.units.SYSTEMS`, in which all values are told.
    language
        Of all words.
    others
        Units and languages of those who follow this page: each reads its pictures in their own.
    """

    interface: str = ""
    phase: float = 0.75
    stress: str = STRESSES[0]
    substructure: int | None = None
    place: float | None = None
    magnification: float | None = None
    is_held: bool = False
    views: tuple[str, ...] = ()
    complaint: str = ""
    readings: tuple[str, ...] = ()
    units: str = BY_SIZE
    language: str = SOURCE
    others: tuple[Manner, ...] = ()

    @property
    def manner(self) -> Manner:
        """In what values and words are told."""
        return self.units, self.language

    def told_in(self, manner: Manner) -> Look:
        """Look at the same in other units and words."""
        units, language = manner
        return replace(self, units=units, language=language)

    @property
    def say(self) -> Language:
        """What says an English text in this language."""
        return language(self.language)


def floats(values: NDArray[Any]) -> Floats:
    """Give numbers as they travel."""
    return values.astype(np.float32, order="C")


def instant_of(phase: float, count: int) -> int:
    """Give the instant, among this many, at a share of the interval."""
    return min(max(round(phase * (count - 1)), 0), count - 1)


def thinned(size: int, largest: int = LARGEST_SIDE) -> NDArray[np.intp]:
    """Give the indices that stand for a long axis, first and last included."""
    return np.unique(np.linspace(0, size - 1, min(size, largest)).round().astype(np.intp))


def has_reference(settings: Settings) -> bool:
    """Tell whether a run has a reference to measure errors by."""
    return settings.n_jumps <= MOST_JUMPS
