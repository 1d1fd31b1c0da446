"""A run's friction kept as singular vectors and as clips; NaN where no bound is known."""

from __future__ import annotations

import math

import numpy as np

from solver.latin import Iterate
from solver.reduction.clips import Clips, clips_of
from solver.reduction.sizes import Sizes, of_clips, of_products
from solver.reduction.svd import decompose
from solver.scenes import kind_of, structure_of
from solver.settings import Settings
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import WITHIN, Quantity

LOADED = "right x"
"""The side at which rods are pulled."""


def can_be_clipped(settings: Settings) -> bool:
    """Tell whether friction bounds are known, and what is pulled drives all slip: on rods.

    Wires of a strand that is bent slip as its curvature has them, which is no force at an end.
    """
    return kind_of(settings) in ("rod", "wires")


def clips_in(settings: Settings, iterate: Iterate) -> Clips:
    """Fit clips with memory to the friction of an iterate of rods, at all points that rub.

    What drives it is the load, or without any all friction together, which a support that moves
    has to overcome.
    """
    problem = iterate.problem
    laws = problem.rubbing.values()
    lengths = np.concatenate([law.by_point(law.weights) for law in laws])
    bounds = [law.by_point(law.tangential.highest) * problem.scales.force for law in laws]
    widest = max(bound.shape[1] for bound in bounds)
    bound = np.concatenate([np.broadcast_to(one, (len(one), widest)) for one in bounds])
    acts = structure_of(settings).described().acts
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
    """Keep the field that clips were fitted to as singular vectors."""
    places = np.arange(len(clips.given), dtype=float)
    return of_products(decompose(clips.given, clips.space_weights, clips.time_weights, places))


def clip_numbers(run: FinishedRun, at: float | None) -> float:
    """Count the numbers of clips, and of singular vectors of what they leave, within an error."""
    clips = _clips(run)
    return of_clips(clips).within(at or 0.0) if clips else math.nan


def clip_error(run: FinishedRun, at: float | None) -> float:
    """Give the error of clips alone."""
    clips = _clips(run)
    return float(clips.errors[0]) if clips else math.nan


def product_numbers(run: FinishedRun, at: float | None) -> float:
    """Count the numbers of singular vectors within an error."""
    clips = _clips(run)
    return products_in(clips).within(at or 0.0) if clips else math.nan


def _clips(run: FinishedRun) -> Clips | None:
    return clips_in(run.settings, run.iterate) if can_be_clipped(run.settings) else None


OF_CLIPS = (
    Quantity(
        "svd_numbers",
        "Numbers of the friction force, as singular vectors, for an error of",
        "",
        product_numbers,
        WITHIN,
        applies=can_be_clipped,
    ),
    Quantity(
        "clip_numbers",
        "Numbers of the friction force, as clips, for an error of",
        "",
        clip_numbers,
        WITHIN,
        applies=can_be_clipped,
    ),
    Quantity(
        "clip_error",
        "Error of the friction force as clips",
        "",
        clip_error,
        is_share=True,
        applies=can_be_clipped,
    ),
)
"""Quantities of a run."""
