"""How the quantities of a run follow from it; NaN where a run has none, infinity for never."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from solver.arrays import RESIDUE, Array
from solver.discrete.probes import AxialForce
from solver.latin import Record
from solver.laws import OPEN
from solver.reduction.svd import InterfaceField, decompositions
from solver.reference.distance import determinate_forces
from solver.scenes import structure_of
from solver.study.quantities.cycles import ends_of
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.memory import memory_of

EQUAL = 1e-6
"""Relative difference up to which two loads count as equally large."""
UNLOADED = 1e-3
"""Share of the largest force below which a structure counts as unloaded."""
REGAINED = 0.9
"""Share of its tension up to which a broken wire is watched; it regains the rest at that rate. The
element in which the rest is regained would blur the place."""


def recorded(name: str) -> Callable[[FinishedRun, float | None], float]:
    """Make the reading of one scalar of the records, at an iteration or at the end."""

    def of(run: FinishedRun, at: float | None) -> float:
        records = run.solution.records
        if at is not None:
            records = [entry for entry in records if entry.iteration == at]
        return float(getattr(records[-1], name)) if records else math.nan

    return of


def seconds_per_iteration(run: FinishedRun, at: float | None) -> float:
    """Give the median time between two iterations, s; that of the only one with its set-up."""
    seconds = [one.seconds for one in run.solution.records]
    return float(np.median(np.diff(seconds) if len(seconds) > 1 else seconds or [math.nan]))


def until(column: str, error: str) -> Callable[[FinishedRun, float | None], float]:
    """Make the reading of what a run spends until an error is as small as it is asked to be."""

    def of(run: FinishedRun, at: float | None) -> float:
        if not run.has_errors:
            return math.nan
        iterates = (one for one in run.solution.records if not one.is_answer)
        reached = (one for one in iterates if getattr(one, error) <= (at or 0.0))
        first: Record | None = next(reached, None)
        return math.inf if first is None else float(getattr(first, column))

    return of


def memory(run: FinishedRun, at: float | None) -> float:
    """Give the memory that the run takes, B, which takes another run; NaN where none is told."""
    return memory_of(run.settings)


def modes(run: FinishedRun, at: float | None) -> float:
    """Give the largest separated basis of a substructure at the end; NaN without bases."""
    reduction = run.iterate.reduction
    return math.nan if reduction is None else max(one.modes for one in reduction.records)


def singular(field: InterfaceField) -> Callable[[FinishedRun, float | None], float]:
    """Make the count of singular vectors that leave an error, where a substructure needs most.

    NaN in the plane, where most substructures do not rub.
    """

    def of(run: FinishedRun, at: float | None) -> float:
        if run.problem.inside is not None:
            return math.nan
        return max(one.modes_for(at or 0.0) for one in decompositions(run.iterate, field))

    return of


def peak_displacement(run: FinishedRun, at: float | None) -> float:
    """Give the largest displacement of any node at any instant, m."""
    inside, moved = run.problem.inside, run.iterate.displacement
    if inside is None:
        return float(np.abs(moved).max())
    return float(np.linalg.norm(inside.displacement(moved, slice(None)), axis=1).max())


def peak_slip(run: FinishedRun, at: float | None) -> float:
    """Give the farthest that any point in contact has come along what it rubs on, m."""
    contacts = map(run.iterate.contact, run.problem.rubbing)
    return float(max(np.abs(one.slip * (one.status != OPEN)).max() for one in contacts))


def peak_friction(run: FinishedRun, at: float | None) -> float:
    """Give the largest sum over all points of the sizes of the friction force, N."""
    return float(np.abs(run.iterate.friction_force).sum(axis=0).max())


def peak_pressing(run: FinishedRun, at: float | None) -> float:
    """Give the largest sum over all points of the pressing force, N; NaN where it is given."""
    pressing = [
        normal
        for name in run.problem.rubbing
        if (normal := run.iterate.contact(name).normal_force) is not None
    ]
    return float(np.concatenate(pressing).sum(axis=0).max()) if pressing else math.nan


def holding_friction(run: FinishedRun, at: float | None) -> float:
    """Give the smallest coefficient of friction at which no interface slides as a whole.

    All its friction over all that presses, at the worst instant. NaN where one slides: the run
    then cannot tell how much more it would take.
    """
    needed, friction = 0.0, run.settings.friction
    if not friction:
        return math.nan
    # A point that a clamp holds, too, never slips.
    determinate = determinate_forces(run.problem)
    for name, law in run.problem.rubbing.items():
        contact = run.iterate.contact(name)
        *_, tangential = run.problem.contact_places[name]
        is_free = (contact.status == OPEN) | ~determinate[tangential]
        ways = [(contact.status == way) | is_free for way in (-1, 1)]
        if any((way.all(axis=0) & ~is_free.all(axis=0)).any() for way in ways):
            return math.nan
        if contact.normal_force is None:
            bound = law.tangential.bound.sum(axis=0) * run.problem.scales.force
            pressing = np.broadcast_to(bound / friction, run.problem.n_instants)
        else:
            pressing = contact.normal_force.sum(axis=0)
        held = np.abs(contact.tangential_force.sum(axis=0))[pressing > 0.0]
        needed = max(needed, float((held / pressing[pressing > 0.0]).max(initial=0.0)))
    return needed if needed > RESIDUE else 0.0


def end_displacement(run: FinishedRun, at: float | None) -> float:
    """Give the loop's displacement where its force first is largest, m; NaN for an angle."""
    return displacement_at(run, largest_load(run))


def largest_load(run: FinishedRun) -> int:
    """Find the instant at which the loop's force first is largest."""
    size = np.abs(run.force)
    return int(np.argmax(size >= (1.0 - EQUAL) * size.max()))


def stiffness(run: FinishedRun, at: float | None) -> float:
    """Give the loop's largest force over its displacement, N/m; NaN for an angle."""
    moved = end_displacement(run, at)
    return float(run.force[largest_load(run)]) / moved if moved else math.nan


def displacement_at(run: FinishedRun, instant: int) -> float:
    """Give the loop's displacement at an instant, m; NaN for an angle."""
    return float(run.displacement[instant]) if run.measures_displacement else math.nan


def residual_displacement(run: FinishedRun, at: float | None) -> float:
    """Give what is left of the loop's displacement without load, m; NaN if the end is loaded."""
    size = np.abs(run.force)
    if not run.measures_displacement or size[-1] > UNLOADED * size.max():
        return math.nan
    return float(run.displacement[-1])


def dissipation(run: FinishedRun, at: float | None) -> float:
    """Give the energy that friction takes, J: of the whole run, or of one cycle.

    Cycles are those of the load (`solver.study.quantities.cycles`); NaN if there are fewer.
    """
    if at is None:
        return float(run.dissipated.sum())
    ends, number = ends_of(run.settings), int(at)
    if len(ends) <= number:
        return math.nan
    return float(run.dissipated[ends[number - 1] + 1 : ends[number] + 1].sum())


def slipped_share(run: FinishedRun, at: float | None) -> float:
    """Give the share of the points that slip at any instant."""
    return float(_has_slipped(run)[:, -1].mean())


def _has_slipped(run: FinishedRun) -> NDArray[np.bool_]:
    """Tell which points have slipped by every instant, shape (n_points, n_instants)."""
    return np.logical_or.accumulate(np.abs(run.iterate.status) == 1, axis=1)


def _first_slip(run: FinishedRun, at: float | None) -> int | None:
    """Find the instant by which a share of the points, or any, has slipped."""
    share = _has_slipped(run).mean(axis=0)
    slips = (share > 0.0) & (share >= (at or 0.0))
    return int(np.argmax(slips)) if slips.any() else None


def first_slip_time(run: FinishedRun, at: float | None) -> float:
    """Give the first instant by which points have slipped, s; infinite if none do."""
    place = _first_slip(run, at)
    return math.inf if place is None else float(run.problem.instants[place])


def first_slip_displacement(run: FinishedRun, at: float | None) -> float:
    """Give the loop's displacement at that instant, m; NaN for an angle."""
    if not run.measures_displacement:
        return math.nan
    place = _first_slip(run, at)
    return math.inf if place is None else float(run.displacement[place])


def recovery_length(run: FinishedRun, at: float | None) -> float:
    """Give how far from its break a wire carries its tension again, at the largest tension, m."""
    return recovery_length_at(run, int(np.argmax(run.force)))


def recovery_length_at(run: FinishedRun, instant: int) -> float:
    """Give how far from its break a wire carries its tension again at an instant, m.

    NaN without a broken wire, or without tension; infinite if it does so on neither side.
    """
    described = structure_of(run.settings).described()
    if described.broken is None or not run.force[instant]:
        return math.nan
    wire, place = described.broken
    axial = AxialForce(run.problem)
    force = axial(run.iterate.displacement[:, instant])[axial.wires == wire]
    share = force / run.force[instant]
    size = described.length / len(share)
    node = round(place / size)
    sides = share[node:], share[:node][::-1]
    return min(size * _reached(side, REGAINED) / REGAINED for side in sides)


def _reached(share: Array, level: float) -> float:
    """Find where a share of the tension, known in the middles of elements, reaches a level.

    Parameters
    ----------
    share
        From the break on, where it is nothing, shape (n,).
    level
        Above nothing.

    Returns
    -------
    Distance in elements, linear between their middles; infinite if it is not reached.
    """
    places = np.concatenate([[0.0], np.arange(len(share)) + 0.5])
    values = np.concatenate([[0.0], share])
    above = int(np.argmax(values >= level))
    if above == 0:
        return math.inf
    return float(np.interp(level, values[above - 1 : above + 1], places[above - 1 : above + 1]))
