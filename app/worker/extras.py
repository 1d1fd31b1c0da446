"""Extras: data of an iterate that only some views need."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from app.frame import Floats
from app.messages import Needs
from app.units import percent
from app.worker.cells import floats, thinned
from app.worker.geometry import MOST_POINTS
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.plane.makers.band import Band
from solver.discrete.structure import Loop
from solver.files.amounts import unit_for
from solver.latin import Iterate
from solver.reduction.sizes import Sizes, of_bases, of_clips
from solver.reduction.svd import decompositions
from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import SlipSpace, persistent_slips, slip_space
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.comparison import Comparison, OtherResults
from solver.study.measured_loop import LoopComparison, MeasuredLoop
from solver.study.quantities.cycles import (
    LAST,
    LoadCycles,
    cycle_ends,
    cycles_of,
    fate_of,
    slips_of,
)
from solver.study.quantities.reduction_measures import (
    can_be_clipped,
    clips_in,
    products_in,
)

MOST_SPECTRA = 24
MOST_VALUES = 64
"""Largest numbers of substructures, and of singular values of each, that are shown."""
MOST_MODES = 5
"""Largest number of modes that are shown."""


@dataclass(frozen=True, eq=False)
class Sampled:
    """The problem of a run, with its loop and the instants that frames show.

    `columns` are the indices of these instants among all, shape (n_shown,).
    """

    problem: Problem
    settings: Settings
    loop: Loop
    columns: Indices


def spectra(sampled: Sampled, iterate: Iterate, needs: Needs) -> list[Floats]:
    """Singular values of the friction force by substructure, over the largest shown.

    Each array has shape (n_values,), without unit. Of many substructures some are
    shown.
    """
    numbers = thinned(len(iterate.problem.substructures), MOST_SPECTRA)
    parts = decompositions(
        iterate.problem, iterate.boundary_force, numbers, is_force=True
    )
    shown = [part.values[:MOST_VALUES] for part in parts]
    largest = max((float(part.max(initial=0.0)) for part in shown), default=0.0)
    if largest == 0.0:
        largest = 1.0
    return [floats(np.asarray(part) / largest) for part in shown]


def slips(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Floats] | None:
    """Slips of two points, and the limits A w = b of sticking.

    "slip" of both, (2, n_instants), m; "matrix" A, (4, 2), N/m, and "limit" b, (4,
    n_instants), N, whose first and third lines are those of the left point; "room", the
    corners of the region in which both may stay in the whole last cycle, (n_corners,
    2), m. The result is None where contact alone holds the body: then slip says nothing
    of the pressure.
    """
    space = _slip_space(sampled)
    if space is None:
        return None
    ((stacked, slip, _),) = slips_of(iterate)
    law = stacked.law
    ends = cycle_ends(sampled.settings)
    if len(ends) > 1:
        room = persistent_slips(space, slice(ends[-2], ends[-1] + 1))
    else:
        room = np.zeros((0, 2))
    moved = np.cumsum(law.mean_by_point(slip), axis=1)
    return {
        "slip": floats(moved[:, sampled.columns]),
        "matrix": floats(space.matrix),
        "limit": floats(space.limit[:, sampled.columns]),
        "room": floats(room),
    }


@lru_cache(maxsize=1)
def _slip_space(sampled: Sampled) -> SlipSpace | None:
    problem = sampled.problem
    if problem.contacts.sizes.tolist() != [2] or problem.rigid_motions is not None:
        return None
    try:
        space = slip_space(problem)
    except NoReferenceError:
        return None
    return space if space.matrix.shape[1] == 2 else None


def cycles(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Slip and energy of an iterate in each cycle of its load; None without cycles.

    "columns" of the instants at which cycles begin, and the last one ends, (n_cycles +
    1,); "energy" that friction takes in each, (n_cycles,), J; "text", a sentence on how
    slip continues.
    """
    found = cycles_of(sampled.settings, iterate)
    if not len(found):
        return None
    # Where nothing slips, no cycle differs from the next.
    text = "nothing slips"
    if found.slip.any() or found.before.any():
        text = _fate_text(found)
    return {
        "columns": np.searchsorted(sampled.columns, found.ends),
        "energy": floats(found.energy),
        "text": text,
    }


def _fate_text(cycles: LoadCycles) -> str:
    energy = unit_for(abs(cycles.energy[-1]), "J")(cycles.energy[-1])
    most = cycles.slip.max(axis=0)
    match fate_of(cycles):
        case None if len(cycles) < LAST:
            return f"how slip goes on is told from {LAST} cycles on"
        case None if not cycles.is_repeated:
            return "the last cycles of the load differ"
        case None:
            return "not settled yet"
        case "elastic shakedown":
            since = len(np.trim_zeros(most, "b")) + 1
            return f"elastic shakedown: nothing slips from cycle {since} on"
        case "shakedown with slip that dies":
            ratio = percent(most[-1] / most[-2])
            return f"slip dies: the last cycle slips {ratio} of the one before"
        case "steady slip":
            return f"steady slip: every cycle takes {energy}"
        case _:
            left = float(np.abs(cycles.net[:, -1]).max())
            net = unit_for(left, "m")(left)
            return f"ratcheting: every cycle takes {energy} and leaves {net} of slip"


def modes(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Largest modes of the selected substructure's separated basis; None without bases.

    "x" along rods, (n_points,), m; "space", (n_modes, n_points), over the largest entry
    of each; "time", (n_modes, n_instants), m; "substructure" from 0; "text", its number
    of modes.
    """
    if not iterate.bases:
        return None
    last = len(iterate.bases) - 1
    if needs.substructure is None:
        number = last
    else:
        number = min(max(needs.substructure, 0), last)
    basis = iterate.bases[number]
    problem = sampled.problem
    # Rows of two interfaces that meet at a point move together.
    rows = problem.row_dofs[problem.substructures[number].rows]
    dofs, first = np.unique(rows, return_index=True)
    space = basis.displacement_modes[first, :MOST_MODES].T
    size = _signed_size(space)
    functions = basis.time_functions(number)[:MOST_MODES, sampled.columns]
    time = functions * problem.scales.displacement
    kept = thinned(len(dofs), MOST_POINTS)
    return {
        "x": floats(problem.positions[dofs[kept]]),
        "space": floats(space[:, kept] / size[:, None]),
        "time": floats(time * size[:, None]),
        "substructure": number,
        "text": f"substructure {number + 1}: {basis.n_modes} modes",
    }


def _signed_size(space: Array) -> Array:
    """Signed size of every mode, (n_modes,): largest entry, sign of its last lobe.

    Modes have shape (n_modes, n_points). The sign of the largest entry itself would
    flip whenever two lobes change places.
    """
    largest = np.abs(space).max(axis=1)
    last = np.argmax(np.abs(space[:, ::-1]) >= 0.5 * largest[:, None], axis=1)
    size = np.copysign(largest, space[np.arange(len(space)), -1 - last])
    return np.where(largest > 0.0, size, 1.0)


def clips(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Sizes of friction stored as singular vectors, as PGD modes, and as clips.

    "table", the number of its values; "branches", the number of branches of the load;
    and for each of "SVD", "PGD" (None without bases) and "clips" the count of stored
    numbers and the relative error, shape (2, n). The result is None where clips cannot
    represent the friction.
    """
    if not can_be_clipped(sampled.settings) or sampled.settings.instants < 2:
        return None
    fitted = clips_in(sampled.settings, iterate)
    pgd = None
    if iterate.bases:
        pgd = _pairs(of_bases(iterate.problem, iterate.boundary_force, iterate.bases))
    return {
        "table": fitted.given.size,
        "branches": fitted.branches,
        "SVD": _pairs(products_in(fitted)),
        "PGD": pgd,
        "clips": _pairs(of_clips(fitted)),
    }


def _pairs(sizes: Sizes) -> Floats:
    return floats(np.stack([sizes.numbers, sizes.errors]))


def beside(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Measured loop or results of another program, and the iterate's distance.

    "brought" is the loop or the results; "distance" is relative, NaN where both share
    too few rows. The result is None where nothing was brought, or it is of another
    scene.
    """
    brought = needs.brought
    loop = sampled.loop
    distance = np.nan
    if isinstance(brought, MeasuredLoop):
        if brought.units != (loop.across[1], loop.up[1]):
            return None
        # Loops that share too few points have no distance.
        with suppress(SettingError):
            distance = LoopComparison(brought, loop, sampled.problem).of(iterate)
    elif brought is None or brought.scene != sampled.settings.scene:
        return None
    else:
        comparison = _comparison(brought, sampled, needs.interface)
        brought = comparison.results
        distance = comparison.of(iterate)
    return {"brought": brought, "distance": distance}


@lru_cache(maxsize=1)
def _comparison(brought: OtherResults, sampled: Sampled, interface: str) -> Comparison:
    return Comparison(brought, sampled.problem, interface)


def tension(sampled: Sampled, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Tension along a band on a guide, as axial force; None for other structures.

    "x" of places, (n_places,), m along the guide; "force", (1, n_places, n_instants),
    N; "names"; "stuck" has no curve, (0, n_instants). At both ends stand the tensions
    of the free spans.
    """
    band = sampled.settings.structure()
    if not isinstance(band, Band):
        return None
    found = band.tensions(iterate.problem, iterate)[:, sampled.columns]
    kept = thinned(len(found), MOST_POINTS)
    angles = band.guide.angles
    middles = 0.5 * (angles[1:] + angles[:-1])
    places = band.guide.radius * np.concatenate([angles[:1], middles, angles[-1:]])
    return {
        "x": floats(places[kept]),
        "force": floats(found[None, kept]),
        "names": ["band"],
        "stuck": floats(found[:0]),
    }


EXTRAS: dict[str, Callable[[Sampled, Iterate, Needs], Any]] = {
    "spectra": spectra,
    "slips": slips,
    "cycles": cycles,
    "modes": modes,
    "clips": clips,
    "beside": beside,
    "axial force": tension,
}
"""Extras of all scenes, by the names in `View.needs`; bodies of one kind have more
(`Drawn.extras`)."""
