"""Quantities of whole interfaces: friction that prevents sliding, and its force."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from solver.arrays import RESIDUE, Array, Flags, Indices
from solver.discrete.plane.makers.band import MOST_EXPONENT, Band
from solver.laws import OPEN
from solver.reference.distance import determinate_forces
from solver.settings.scene import Settings
from solver.study.quantities.belt_measures import SLACK
from solver.study.quantities.finished import EQUAL, FinishedRun
from solver.study.quantities.held_ends import held_lengths
from solver.study.quantities.quantity import quantity


def _rubs_by_mu(settings: Settings) -> bool:
    """Check whether the friction bound is mu N, independent of slip."""
    return settings.law.is_by_pressure_alone


@dataclass(frozen=True, eq=False)
class _Hold:
    """Resultant forces of an interface at every instant, and its reserve to sliding.

    Attributes
    ----------
    pressing
        Sum of the pressing forces, shape (n_instants,), N; where mu varies along the
        interface, weighted by its factors.
    carried
        Sum of the friction forces, shape (n_instants,), N.
    slides
        Whether all its points slip in one direction, shape (n_instants,).
    needed
        Mobilised coefficient of friction, shape (n_instants,); 0 without pressing.
    """

    pressing: Array
    carried: Array
    slides: Flags
    needed: Array

    def sliding(self, friction: float, instants: Array) -> Array:
        """Pressing forces during sliding, and at its onset, (n,), N.

        Sliding begins between two instants, where the friction, if it continues growing
        at its last rate, comes to mu times the pressing force.

        Parameters
        ----------
        friction
            Coefficient of friction mu.
        instants
            Instants of the run, shape (n_instants,), s.
        """
        pressing = self.pressing
        begins = np.flatnonzero(self.slides[2:] & ~self.slides[1:-1]) + 2
        before = begins - 1
        rise = pressing[begins] - pressing[before]
        share = self._onset(friction, np.diff(instants), before, rise)
        at_onset = pressing[before] + np.clip(share, 0.0, 1.0) * rise
        return np.concatenate([pressing[self.slides], at_onset])

    def _onset(
        self, friction: float, steps: Array, before: Indices, rise: Array
    ) -> Array:
        """Share of a step after which sliding begins, shape (n_onsets,); else 1.

        Parameters
        ----------
        friction
            Coefficient of friction mu.
        steps
            Time steps, shape (n_instants - 1,), s.
        before
            Last instants before sliding, shape (n_onsets,).
        rise
            Growth of the pressing force in the step after those, shape (n_onsets,), N.
        """
        carried = np.abs(self.carried)
        rate = (carried[before] - carried[before - 1]) / steps[before - 1]
        growth = rate * steps[before]
        reserve = friction * self.pressing[before] - carried[before]
        # Friction grows towards a bound that moves by mu times the pressing force.
        closes = growth - friction * rise
        return np.divide(reserve, closes, np.ones_like(reserve), where=closes > 0.0)


def _holds(run: FinishedRun) -> list[_Hold]:
    """Resultant forces of every interface with friction."""
    # A point that a clamp holds, too, never slips: it counts as free.
    determinate = determinate_forces(run.problem)
    band = run.settings.structure()
    if isinstance(band, Band):
        (name,) = run.problem.contacts.surfaces
        *_, tangential = run.problem.contacts.forces[name]
        return [_hold_of_band(run, band, _hold(run, name, determinate[tangential]))]
    holds = []
    for name in run.problem.contacts.surfaces:
        *_, tangential = run.problem.contacts.forces[name]
        holds.append(_hold(run, name, determinate[tangential]))
    return holds


def _hold(run: FinishedRun, name: str, determinate: Flags) -> _Hold:
    """Resultant forces of an interface.

    `determinate` says where the friction is determinate, shape (n_points, n_instants).
    """
    contact = run.iterate.contact(name)
    status = contact.status
    # Rounding presses at points that are open, and rubs there.
    is_open = status == OPEN
    pressing = np.where(is_open, 0.0, _pressing_by_friction(run, name))
    friction = np.where(is_open, 0.0, contact.tangential_force)
    # Points that carry no friction cannot keep the others from sliding.
    is_free = is_open | ~determinate | (pressing <= 0.0)
    forward = ((status == 1) | is_free).all(axis=0)
    backward = ((status == -1) | is_free).all(axis=0)
    slides = (forward | backward) & ~is_free.all(axis=0)
    pressing_beside, friction_beside = _at_held_ends(run, name)
    pressed = pressing.sum(axis=0) + pressing_beside @ pressing
    carried = friction.sum(axis=0) + friction_beside @ friction
    nothing = np.zeros_like(pressed)
    needed = np.divide(np.abs(carried), pressed, nothing, where=pressed > 0.0)
    return _Hold(pressed, carried, slides, needed)


def _hold_of_band(run: FinishedRun, band: Band, hold: _Hold) -> _Hold:
    """Reserve to sliding of a band, by Euler's formula from the tensions of its ends.

    The sum of the pressing forces says less: it grows as a band slips, and what slips
    first presses most.
    """
    tensions = band.tensions(run.problem, run.iterate)
    ends = np.sort(tensions[[0, -1]], axis=0)
    # No friction holds a band without any tension at its other end.
    least = SLACK * float(np.abs(ends).max())
    smaller, larger = np.maximum(ends, least)
    ratio = np.divide(larger, smaller, np.ones_like(larger), where=smaller > 0.0)
    exponent = min(run.settings.friction * band.guide.angle, MOST_EXPONENT)
    # Friction adds as much to the smaller tension before the band slides.
    reached = smaller * math.expm1(exponent) / run.settings.friction
    return _Hold(
        pressing=np.where(hold.slides, hold.pressing, reached),
        carried=hold.carried,
        slides=hold.slides,
        needed=np.log(ratio) / band.guide.angle,
    )


def _at_held_ends(run: FinishedRun, name: str) -> tuple[Array, Array]:
    """Forces at held ends that have no points, over those of the points beside them.

    Ends of wires or layers that are held together do not rub in the discrete problem.
    They are pressed like what is beside them, and friction goes on evenly up to them,
    as it does up to the clamp of a body (`solver.discrete.driven_friction`); springs
    between them are not strained. Shares of pressing force and of friction, (n_points,)
    both.
    """
    law = run.problem.contacts[name]
    lengths = law.by_point(law.weights)
    pressing = held_lengths(run, name) / lengths
    if law.tangential.compliance is None:
        return pressing, pressing
    return pressing, np.zeros_like(pressing)


def _pressing_by_friction(run: FinishedRun, name: str) -> Array:
    """Pressing force times the factor on mu of each point, (n_points, n_instants), N.

    Where the pressure is given, it follows from the friction bound.
    """
    law = run.problem.contacts[name]
    contact = run.iterate.contact(name)
    friction = run.settings.friction
    if contact.normal_force is None:
        bound = law.by_point(law.tangential.bound) * run.problem.scales.force
        return np.broadcast_to(bound / friction, contact.status.shape)
    # mu is that of the settings, and its profile a factor on the pressing force.
    share = law.mean_by_point(law.tangential.friction) / friction
    return np.asarray(share[:, None] * contact.normal_force)


def _largest_needed(holds: list[_Hold]) -> float:
    """Largest mobilised coefficient of friction of any interface at any instant.

    Zero where rounding alone leaves something.
    """
    needed = max(float(hold.needed.max(initial=0.0)) for hold in holds)
    if needed > RESIDUE:
        return needed
    return 0.0


@quantity("Smallest friction that holds against these forces", applies=_rubs_by_mu)
def holding_friction(run: FinishedRun) -> float:
    """Smallest coefficient of friction at which no interface slides as a whole.

    The coefficient is the sum of the friction forces over the sum of the pressing
    forces at the worst instant; where mu varies, the factor on its profile. NaN where
    an interface slides: the run then cannot tell how much more friction would hold it.
    """
    if not run.settings.friction:
        return math.nan
    holds = _holds(run)
    if any(hold.slides.any() for hold in holds):
        return math.nan
    return _largest_needed(holds)


@quantity("Largest force that friction could hold", "N", applies=_rubs_by_mu)
def holding_force(run: FinishedRun) -> float:
    """Largest friction force, N, of the interface nearest to sliding.

    The force is mu times the sum of the pressing forces. Where interfaces slide as a
    whole, it is the largest one while they slide, from the onset on. Otherwise it is
    the one at the interface and the instant at which the largest share of it is in use,
    and the largest of several such.
    """
    friction = float(run.settings.friction)
    if not friction:
        return 0.0
    holds = _holds(run)
    instants = run.problem.instants
    # Where an interface slides, its friction is the largest it can hold.
    forces = [hold.sliding(friction, instants) for hold in holds if hold.slides.any()]
    if not forces:
        enough = (1.0 - EQUAL) * _largest_needed(holds)
        forces = [hold.pressing[hold.needed >= enough] for hold in holds]
    return friction * float(np.concatenate(forces).max(initial=0.0))
