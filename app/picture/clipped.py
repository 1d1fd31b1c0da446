"""How few numbers the friction of an iterate takes, as views see it."""

from __future__ import annotations

from dataclasses import dataclass

from solver.latin import Iterate
from solver.reduction.sizes import Sizes, in_pieces, of_bases, of_clips
from solver.settings import Settings
from solver.study.quantities.clip_measures import clips_in, products_in


@dataclass(frozen=True, eq=False)
class Clipped:
    """The friction force of an iterate, kept in one way or another.

    Attributes
    ----------
    table
        Numbers of all its values.
    branches, pieces
        Times that the load goes one way; substructures.
    products
        As singular vectors.
    separated
        As modes of the run's separated bases; without any, as singular vectors of each
        substructure; None where there is but one.
    is_of_bases
        Which of both.
    clips
        As clips with memory, and singular vectors of what these leave.
    """

    table: int
    branches: int
    pieces: int
    products: Sizes
    separated: Sizes | None
    is_of_bases: bool
    clips: Sizes


def clipped(settings: Settings, iterate: Iterate) -> Clipped:
    """Keep the friction of an iterate of rods in all ways."""
    clips = clips_in(settings, iterate)
    bases = iterate.reduction
    pieces = len(iterate.problem.substructures)
    separated = None
    if bases is not None:
        separated = of_bases(iterate, bases)
    elif pieces > 1:
        separated = in_pieces(iterate)
    return Clipped(
        clips.given.size,
        len(clips.branches),
        pieces,
        products_in(clips),
        separated,
        bases is not None,
        of_clips(clips),
    )
