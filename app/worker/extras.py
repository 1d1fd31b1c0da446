"""What only some views need of an iterate, computed while one of them is in sight."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from app.frame import Floats
from app.messages import Needs
from app.units import percent, unit_for
from app.worker.geometry import MOST_POINTS, floats, thinned
from solver.arrays import Array
from solver.latin import Iterate
from solver.reduction.sizes import Sizes, of_bases, of_clips
from solver.reduction.svd import decompositions
from solver.reference.assembly import NoReferenceError
from solver.reference.shakedown import SlipSpace, room_of_two, slip_space
from solver.settings.definitions import SettingError
from solver.study.comparison import Comparison, OtherResults
from solver.study.measured_loop import LoopComparison, MeasuredLoop
from solver.study.quantities.cycles import (
    LoadCycles,
    cycles_of,
    ends_of,
    fate_of,
    slips_of,
)
from solver.study.quantities.reduction_measures import (
    can_be_clipped,
    clips_in,
    products_in,
)

if TYPE_CHECKING:
    from app.worker.sampling import Sampler

MOST_SPECTRA = 24
MOST_VALUES = 64
"""Substructures, and singular values of each, that are shown at most."""
MOST_MODES = 5
"""Modes that are shown at most."""


def spectra(sampler: Sampler, iterate: Iterate, needs: Needs) -> list[Floats]:
    """Singular values of the friction force in substructures, over the largest of these."""
    places = thinned(len(iterate.problem.substructures), MOST_SPECTRA)
    parts = decompositions(
        iterate.problem, iterate.boundary_force, places, is_force=True
    )
    shown = [part.values[:MOST_VALUES] for part in parts]
    largest = max((float(part.max(initial=0.0)) for part in shown), default=0.0) or 1.0
    return [floats(np.asarray(part) / largest) for part in shown]


def slips(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Floats] | None:
    """Slips of two points, and the lines A w = b between which both stick.

    "slip" of both, (2, n_instants), m; "matrix" A, (4, 2), N/m, and "limit" b, (4,
    n_instants), N, whose first and third lines are those of the left point; "room", the
    corners of where both may stay in the whole last cycle, (n_corners, 2), m. None
    where contact alone holds the body, whose slip says nothing of what presses it.
    """
    space = _slip_space(sampler)
    if space is None:
        return None
    ((law, slip, _),) = slips_of(iterate)
    ends = ends_of(sampler.settings)
    if len(ends) > 1:
        last = slice(ends[-2], ends[-1] + 1)
    else:
        last = None
    if last is None:
        room = np.zeros((0, 2))
    else:
        room = room_of_two(space, last)
    moved = np.cumsum(law.mean_by_point(slip), axis=1)
    return {
        "slip": floats(moved[:, sampler.columns]),
        "matrix": floats(space.matrix),
        "limit": floats(space.limit[:, sampler.columns]),
        "room": floats(room),
    }


@lru_cache(maxsize=1)
def _slip_space(sampler: Sampler) -> SlipSpace | None:
    problem = sampler.problem
    points = [len(law.positions) for law in problem.rubbing.values()]
    if points != [2] or problem.motions is not None:
        return None
    try:
        space = slip_space(problem)
    except NoReferenceError:
        return None
    return space if space.matrix.shape[1] == 2 else None


def cycles(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """The iterate, cycle by cycle of its load; None where that has none.

    "columns" of the instants at which cycles begin, and the last one ends, (n_cycles +
    1,); "energy" that friction takes in each, (n_cycles,), J; "text", what becomes of
    slip.
    """
    found = cycles_of(sampler.settings, iterate)
    if not len(found):
        return None
    slipped = bool(found.slip.any() or found.before.any())
    return {
        "columns": np.searchsorted(sampler.columns, found.ends),
        "energy": floats(found.energy),
        "text": _fate_text(found) if slipped else "nothing slips",
    }


def _fate_text(cycles: LoadCycles) -> str:
    energy = unit_for(abs(cycles.energy[-1]), "J")(cycles.energy[-1])
    most = cycles.slip.max(axis=0)
    match fate_of(cycles):
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


def modes(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """The largest modes of the selected substructure's separated basis; None without bases.

    "x" along rods, (n_places,), m; "space", (n_modes, n_places), over the largest entry
    of each; "time", (n_modes, n_instants), m; "substructure" from 0; "text", what the
    iteration did to the basis.
    """
    if not iterate.bases:
        return None
    last = len(iterate.bases) - 1
    if needs.substructure is None:
        place = last
    else:
        place = min(max(needs.substructure, 0), last)
    basis = iterate.bases[place]
    problem = sampler.problem
    # Rows of two interfaces that meet at a point move together.
    rows = problem.row_dofs[problem.substructures[place].rows]
    dofs, first = np.unique(rows, return_index=True)
    space = basis.displacement_modes[first, :MOST_MODES].T
    size = _signed_size(space)
    time = (
        basis.time_functions(place)[:MOST_MODES, sampler.columns]
        * problem.scales.displacement
    )
    kept = thinned(len(dofs), MOST_POINTS)
    return {
        "x": floats(problem.positions[dofs[kept]]),
        "space": floats(space[:, kept] / size[:, None]),
        "time": floats(time * size[:, None]),
        "substructure": place,
        "text": f"substructure {place + 1}: {basis.n_modes} modes",
    }


def _signed_size(space: Array) -> Array:
    """Largest entry of every mode, with the sign of its last large lobe.

    The sign of the largest entry itself would flip whenever two lobes change places.
    """
    largest = np.abs(space).max(axis=1)
    last = np.argmax(np.abs(space[:, ::-1]) >= 0.5 * largest[:, None], axis=1)
    size = np.copysign(largest, space[np.arange(len(space)), -1 - last])
    return np.where(largest > 0.0, size, 1.0)


def clips(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """Numbers that the iterate's friction takes, kept as singular vectors, modes, and clips.

    None where it cannot be kept as clips.

    "table", how many values it has; "branches", times that the load goes one way; and
    for each of "SVD", "PGD" (None without bases) and "clips" the numbers and errors,
    (2, n).
    """
    if not can_be_clipped(sampler.settings) or sampler.settings.instants < 2:
        return None
    fitted = clips_in(sampler.settings, iterate)
    bases = iterate.bases
    if bases:
        pieces = of_bases(iterate.problem, iterate.boundary_force, bases)
    else:
        pieces = None
    return {
        "table": fitted.given.size,
        "branches": fitted.branches,
        "SVD": _pairs(products_in(fitted)),
        "PGD": None if pieces is None else _pairs(pieces),
        "clips": _pairs(of_clips(fitted)),
    }


def _pairs(sizes: Sizes) -> Floats:
    return floats(np.stack([sizes.numbers, sizes.errors]))


def beside(sampler: Sampler, iterate: Iterate, needs: Needs) -> dict[str, Any] | None:
    """What was "brought", a measured loop or results of another program, if it is of this scene.

    And the relative "distance" of the iterate to it, NaN where both share too few rows.
    """
    brought = needs.brought
    loop = sampler.loop
    distance = np.nan
    if isinstance(brought, MeasuredLoop):
        if brought.units != (loop.across[1], loop.up[1]):
            return None
        with suppress(SettingError):
            distance = LoopComparison(brought, loop, sampler.problem).of(iterate)
    elif brought is None or brought.scene != sampler.settings.scene:
        return None
    else:
        distance = _comparison(brought, sampler, needs.interface).of(iterate)
    return {"brought": brought, "distance": distance}


@lru_cache(maxsize=1)
def _comparison(brought: OtherResults, sampler: Sampler, interface: str) -> Comparison:
    return Comparison(brought, sampler.problem, interface)


EXTRAS: dict[str, Callable[[Sampler, Iterate, Needs], Any]] = {
    "spectra": spectra,
    "slips": slips,
    "cycles": cycles,
    "modes": modes,
    "clips": clips,
    "beside": beside,
}
"""By the name that a view needs them by; bodies of one kind have more
(`Drawn.extras`)."""
