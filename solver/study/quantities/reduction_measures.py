"""Quantities of how compactly a field is kept: separated bases, singular vectors, clips."""

from __future__ import annotations

import math

import numpy as np

from solver.latin import Iterate
from solver.reduction.clips import Clips, clips_of
from solver.reduction.sizes import Sizes, of_clips, of_products
from solver.reduction.svd import decompose, decompositions
from solver.settings.scene import Settings
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import WITHIN, Quantity, quantity

LOADED = "right x"
"""The side at which rods are pulled."""


def can_be_clipped(settings: Settings) -> bool:
    """Whether friction bounds are known, and what is pulled drives all slip: on rods.

    Wires of a strand that is bent slip as its curvature has them, which is no force at
    an end.
    """
    return settings.kind in ("rod", "wires")


def clips_in(settings: Settings, iterate: Iterate) -> Clips:
    """Clips with memory fitted to the friction of an iterate of rods, at all points that rub.

    What drives it is the load, or without any all friction together, which a support
    that moves has to overcome.
    """
    problem = iterate.problem
    laws = problem.rubbing.values()
    lengths = np.concatenate([law.by_point(law.weights) for law in laws])
    bounds = [
        law.by_point(law.tangential.highest) * problem.scales.force for law in laws
    ]
    widest = max(bound.shape[1] for bound in bounds)
    bound = np.concatenate([np.broadcast_to(own, (len(own), widest)) for own in bounds])
    acts = settings.structure().described().acts
    pulls = (act.values for act in acts if act.where == LOADED)
    load = next(pulls, iterate.friction_force.sum(axis=0))
    return clips_of(
        iterate.friction_force / lengths[:, None],
        bound / lengths[:, None],
        load,
        lengths,
        problem.time_weights * problem.scales.time,
    )


def products_in(clips: Clips) -> Sizes:
    """Sizes of the field that clips were fitted to, as singular vectors."""
    return of_products(decompose(clips.given, clips.space_weights, clips.time_weights))


@quantity(
    "Modes of the largest separated basis",
    reads="course",
    applies=lambda settings: settings.applies("pgd_modes"),
)
def modes(run: FinishedRun) -> float:
    """Modes of the largest separated basis of a substructure at the end; NaN without bases."""
    return max((basis.n_modes for basis in run.iterate.bases), default=math.nan)


def _svd_modes(field: str, words: str) -> Quantity:
    """Singular vectors that leave an error, in the substructure that needs most."""

    def of(run: FinishedRun, at: float) -> float:
        values = getattr(run.iterate, f"boundary_{field}")
        parts = decompositions(run.problem, values, is_force=field == "force")
        return max(part.modes_for(at) for part in parts)

    def applies(settings: Settings) -> bool:
        return settings.kind != "plane"  # where most substructures do not rub

    title = f"Singular vectors of the {words} for an error of"
    return Quantity(
        f"svd_modes_{field}", title, "", of, parameter=WITHIN, applies=applies
    )


svd_modes_displacement = _svd_modes("displacement", "displacement")
svd_modes_force = _svd_modes("force", "friction force")


@quantity(
    "Numbers of the friction force, as singular vectors, for an error of",
    parameter=WITHIN,
    applies=can_be_clipped,
)
def svd_numbers(run: FinishedRun, at: float) -> float:
    """How many numbers singular vectors within an error are."""
    return products_in(clips_in(run.settings, run.iterate)).within(at)


@quantity(
    "Numbers of the friction force, as clips, for an error of",
    parameter=WITHIN,
    applies=can_be_clipped,
)
def clip_numbers(run: FinishedRun, at: float) -> float:
    """How many numbers clips and singular vectors of what they leave are, within an error."""
    return of_clips(clips_in(run.settings, run.iterate)).within(at)


@quantity("Error of the friction force as clips", is_share=True, applies=can_be_clipped)
def clip_error(run: FinishedRun) -> float:
    """Error of clips alone."""
    return float(clips_in(run.settings, run.iterate).errors[0])
