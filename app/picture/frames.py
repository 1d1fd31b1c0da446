"""The fields of an iterate or a reference as views see them, and what they stand on."""

from __future__ import annotations

from dataclasses import dataclass

from app.picture.portrait import Portrait
from app.picture.shown import Axes, Bytes, Floats, Mesh, Wires
from app.picture.strands import Strand
from solver.reference.closed_forms.exact_curve import ExactCurve, Of


@dataclass(frozen=True)
class Stand:
    """What the fields of a run stand on, thinned to `LARGEST_SIDE`, in SI.

    Attributes
    ----------
    interface, interfaces
        The one that is looked at, and all with friction.
    positions, instants
        Of the field's points and columns, m and s.
    cuts
        Positions where substructures meet, m.
    bound
        Friction bound mu p at the positions, N/m, shape (n_positions, n_instants), or
        (n_positions, 1) where it stays the same; None where it depends on the pressure.
    coefficient
        Coefficient of friction at the positions there; else None.
    loop
        What `load` and `end_displacement` are.
    load
        Force at the loaded end, shape (n_curve,), N; None where frames tell it.
    all_instants
        The instants of `load` and of end displacements, thinned to `LONGEST_CURVE`, s.
    exact
        Closed forms, thinned as the fields are; none where there is none, or not yet.
    portrait
        What a picture of the scene shows of every iterate alike.
    mesh
        Of plane bodies.
    wires
        Of a strand.
    strand
        One that is bent.
    words
        What the scene is, and what acts on it, in a sentence.
    is_idle
        Whether nothing acts on the structure, so that nothing moves.
    """

    interface: str
    interfaces: tuple[str, ...]
    positions: Floats
    instants: Floats
    cuts: Floats
    bound: Floats | None
    coefficient: Floats | None
    loop: Axes
    load: Floats | None
    all_instants: Floats
    portrait: Portrait
    words: str
    mesh: Mesh | None = None
    wires: Wires | None = None
    strand: Strand | None = None
    is_idle: bool = False
    exact: tuple[ExactCurve, ...] = ()

    def known(self, of: Of) -> list[ExactCurve]:
        """Give what is known of a quantity without a mesh."""
        return [one for one in self.exact if one.of == of]

    @property
    def length(self) -> float | None:
        """Of the chosen wire along the strand, m, where one is bent alike all along."""
        if self.strand is None or self.strand.is_clamped:
            return None
        return float(self.strand.lengths[self.interfaces.index(self.interface)])


@dataclass(frozen=True)
class DrawnFields:
    """What is drawn of an iterate and of a reference alike, thinned, in SI.

    Attributes
    ----------
    interface
        The one whose fields these are.
    friction
        Friction force on the body above, shape (n_positions, n_instants), N/m, or Pa.
    pressure
        Same shape, Pa; None where the bound is known.
    status
        -1, 0, +1, or `STATUS_OPEN`, same shape.
    end_displacement
        Displacement of the loaded end or side, m, or its rotation, shape (n_curve,).
    load
        Force that it takes, N, same shape; None where the stand tells it.
    """

    interface: str
    friction: Floats
    pressure: Floats | None
    status: Bytes
    end_displacement: Floats
    load: Floats | None
