"""Quantities of compact fields: separated bases, singular vectors, clips."""

from __future__ import annotations

import math

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin import Iterate
from solver.reduction.clips import Clips, clips_of
from solver.reduction.sizes import Sizes, of_clips, of_products
from solver.reduction.svd import decompose, decompositions
from solver.settings.scene import Settings
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantity import WITHIN, Quantity, quantity

LOADED = "right x"
"""Side and direction of the load that pulls rods."""


def can_be_clipped(settings: Settings) -> bool:
    """Check whether friction bounds are known, and an end load drives all slip.

    The wires of a bent strand are driven by its curvature, not by a force at an end.
    """
    return settings.kind in ("rod", "wires")


def clips_in(settings: Settings, iterate: Iterate) -> Clips:
    """Clips with memory, fitted to the friction of an iterate of rods at all points.

    The clips are driven by the load, or without a load by the sum of the friction
    forces, which a moving support has to overcome.
    """
    problem = iterate.problem
    # Per length, so that a finer mesh has the same field.
    laws = problem.contacts.laws.values()
    lengths = problem.contacts.of_points([law.by_point(law.weights) for law in laws])
    return clips_of(
        iterate.friction_force / lengths[:, None],
        _friction_bounds(problem) / lengths[:, None],
        _driving_load(settings, iterate),
        lengths,
        problem.time_weights * problem.scales.time,
    )


def _friction_bounds(problem: Problem) -> Array:
    """Friction bounds of all points, (n_points, n_instants) or (n_points, 1), N."""
    bounds = []
    for law in problem.contacts.laws.values():
        bounds.append(law.by_point(law.tangential.largest_bound) * problem.scales.force)
    return problem.contacts.of_points(bounds)


def _driving_load(settings: Settings, iterate: Iterate) -> Array:
    """Load at the loaded side, or else the sum of the friction, (n_instants,), N."""
    for act in settings.structure().description().acts:
        # The force at the end that is pulled drives all slip.
        if act.where == LOADED:
            return act.values
    return np.asarray(iterate.friction_force.sum(axis=0))


def products_in(clips: Clips) -> Sizes:
    """Sizes of singular vectors of the field to which clips were fitted."""
    return of_products(decompose(clips.given, clips.space_weights, clips.time_weights))


@quantity(
    "Modes of the largest separated basis",
    reads="course",
    applies=lambda settings: settings.applies("pgd_modes"),
)
def modes(run: FinishedRun) -> float:
    """Modes of the largest separated basis of any substructure; NaN without bases."""
    return max((basis.n_modes for basis in run.iterate.bases), default=math.nan)


def _svd_modes(field: str, words: str) -> Quantity:
    """Largest number of singular vectors of any substructure for an error."""

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
    """Number of values to store for singular vectors within an error."""
    return products_in(clips_in(run.settings, run.iterate)).within(at)


@quantity(
    "Numbers of the friction force, as clips, for an error of",
    parameter=WITHIN,
    applies=can_be_clipped,
)
def clip_numbers(run: FinishedRun, at: float) -> float:
    """Number of values to store for clips within an error.

    Singular vectors of the residual of the clips are counted, too.
    """
    return of_clips(clips_in(run.settings, run.iterate)).within(at)


@quantity("Error of the friction force as clips", is_share=True, applies=can_be_clipped)
def clip_error(run: FinishedRun) -> float:
    """Relative error of clips alone, without singular vectors of their residual."""
    return float(clips_in(run.settings, run.iterate).errors[0])
