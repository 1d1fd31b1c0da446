"""Settings of the method, common to all scenes; each is defined once here or in its scene.

A settings object is checked once, at the edge, and cannot be changed; `replace` gives a new one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from solver.checked import Checked
from solver.definitions import choice, count, quantity, switch


def _is_reduced(settings: Settings) -> bool:
    return settings.is_reduced


def _is_sampled(settings: Settings) -> bool:
    return _is_reduced(settings) and settings.local_stage == "reduced"


class Settings(Checked):
    """Settings of the method, common to all scenes; a scene adds its own.

    `Settings.checked` is the one edge at which values are verified.
    """

    METHODS: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "fast": {
            "search_direction": "auto",
            "acceleration": "anderson",
            "start": "nested",
            "relaxation": 0.8,
            "finish": "status",
            "tolerance": 1e-3,
        },
        "paper": {
            "search_direction": "paper",
            "acceleration": "none",
            "start": "zero",
            "relaxation": 0.8,
            "finish": "none",
            "tolerance": 1e-10,
        },
    }

    substructures = count(
        10,
        (1, 20_000),
        (1, 50),
        "Number of substructures; their sizes differ by at most one element.",
        group="Decomposition",
        title="Substructures",
        essential=True,
    )
    multiscale = switch(
        True,
        "Solve the coarse problem: macro forces between substructures are in equilibrium at every "
        "iteration.",
        group="Decomposition",
        title="Multiscale (coarse problem)",
        applies=lambda settings: settings.n_substructures > 1,
        essential=True,
    )
    method = choice(
        "fast",
        ["fast", "paper"],
        "Sets search direction, acceleration, start, relaxation, finish and tolerance at once: to "
        "what reaches the accuracy soonest, or to the paper's. Each can still be set alone.",
        group="Method",
        title="Method",
        essential=True,
    )
    search_direction = choice(
        "auto",
        ["paper", "auto"],
        "Rule for the search direction: the paper's, from the length of a substructure, or on "
        "friction points from the length that is expected to slide and that of an element.",
        group="Method",
        title="Search direction",
        essential=True,
    )
    k_scale = quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Factor on the search direction k. Changes the path, not the limit.",
        group="Method",
        title="Factor on k",
        logarithmic=True,
        essential=True,
    )
    k_friction_scale = quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Further factor on the search direction of the friction points alone.",
        group="Method",
        title="Friction k factor",
        logarithmic=True,
    )
    relaxation = quantity(
        0.8,
        (0.01, 1.0),
        (0.1, 1.0),
        "Share of the new iterate that is kept; 0.5 is Douglas-Rachford, 1 Peaceman-Rachford.",
        group="Method",
        title="Relaxation",
        essential=True,
    )
    linear_stage = choice(
        "full",
        ["full", "pgd"],
        "How the linear stage is solved: full space-time fields, or a separated basis (PGD).",
        group="Method",
        title="Linear stage",
        essential=True,
    )
    pgd_modes = count(
        10,
        (1, 1000),
        (1, 20),
        "Most modes that a substructure's basis keeps; more are dropped, the smallest first.",
        group="Method",
        title="Most PGD modes",
        applies=_is_reduced,
        essential=True,
    )
    pgd_tolerance = quantity(
        1e-4,
        (1e-14, 1.0),
        (1e-8, 1e-1),
        "Share of a substructure's field that downsizing may drop; a residual below it is left.",
        group="Method",
        title="PGD tolerance",
        logarithmic=True,
        applies=_is_reduced,
    )
    pgd_enrichment = quantity(
        0.1,
        (0.0, 1.0),
        (0.0, 1.0),
        "Share of the residual that the update of the time functions may leave before modes are "
        "added; 0 always adds, 1 never does.",
        group="Method",
        title="PGD enrichment threshold",
        applies=_is_reduced,
    )
    pgd_pairs = count(
        2,
        (1, 1000),
        (1, 10),
        "Most pairs of modes that one iteration adds to a substructure's basis.",
        group="Method",
        title="PGD pairs per iteration",
        applies=_is_reduced,
    )
    pgd_sharing = quantity(
        0.0,
        (0.0, 1.0),
        (0.0, 0.5),
        "Substructures of equal operators share one basis when at most this share of each one's "
        "field lies outside the other's; 0 shares nothing.",
        group="Method",
        title="PGD basis sharing",
        applies=lambda settings: _is_reduced(settings) and settings.n_substructures > 1,
    )
    local_stage = choice(
        "full",
        ["full", "reduced"],
        "Where the interface laws are evaluated: everywhere, or at reference points and instants "
        "alone, from which the basis rebuilds the field.",
        group="Method",
        title="Local stage",
        applies=_is_reduced,
    )
    local_points = quantity(
        0.5,
        (0.0, 1.0),
        (0.1, 1.0),
        "Share of the friction points that are reference points, at least one for each mode.",
        group="Method",
        title="Reference points",
        applies=_is_sampled,
    )
    local_instants = quantity(
        0.5,
        (0.0, 1.0),
        (0.1, 1.0),
        "Share of the instants that are reference instants, at least one for each mode.",
        group="Method",
        title="Reference instants",
        applies=_is_sampled,
    )
    acceleration = choice(
        "anderson",
        ["none", "anderson"],
        "Anderson mixes the newest iterate with those before, so that their residual is least.",
        group="Method",
        title="Acceleration",
        applies=lambda settings: not _is_reduced(settings),
        essential=True,
    )
    start = choice(
        "nested",
        ["zero", "nested"],
        "Where the iteration starts: from zero, or from the solution of coarser meshes, uncut and "
        "accelerated, each started so itself. Their time is billed to the run.",
        group="Method",
        title="Start",
        essential=True,
    )
    k_update = choice(
        "none",
        ["none", "status"],
        "How the search direction changes along the run: not at all, or once, when the contact "
        "status has settled, with a smaller k where points slip; taken back if it does not help.",
        group="Method",
        title="Update of k",
        applies=lambda settings: not _is_reduced(settings),
    )
    finish = choice(
        "status",
        ["none", "status"],
        "Whether a run may end with a status step: stick, slip and opening are taken from an "
        "iterate and, where the step itself shows them to be wrong, mended; taken only if the "
        "field so found obeys all laws up to rounding.",
        group="Method",
        title="Finish",
        applies=lambda settings: not _is_reduced(settings),
    )
    accuracy = quantity(
        0.01,
        (1e-12, 1.0),
        (1e-6, 0.1),
        "The run ends when the estimated error of the contact force falls below this share of it.",
        group="Stop",
        title="Accuracy",
        logarithmic=True,
        essential=True,
    )
    tolerance = quantity(
        1e-3,
        (1e-30, 1.0),
        (1e-16, 1e-2),
        "A run that no status step finishes goes on until the LATIN indicator eta is below this, "
        "too. Eta is not an error.",
        group="Stop",
        title="Tolerance on η",
        logarithmic=True,
    )
    max_iterations = count(
        1000,
        (1, 1_000_000),
        (10, 5000),
        "The run ends after this many iterations.",
        group="Stop",
        title="Most iterations",
        logarithmic=True,
    )
    threads = count(
        1,
        (1, 64),
        (1, 4),
        "Threads that share the work of an iteration on a large structure, for a machine with "
        "nothing else to do. The iterates are the same to the bit.",
        group="Method",
        title="Threads",
    )

    @property
    def n_substructures(self) -> int:
        """Number of substructures in all."""
        return self.substructures

    @property
    def k_factors(self) -> tuple[float, float]:
        """Give further factors on k of contacts, along and across them."""
        return self.k_friction_scale, 1.0

    @property
    def n_jumps(self) -> int:
        """Components of all contacts that open or lie between bodies, which a reference condenses.

        None on a rigid support of known bound.
        """
        return 0

    @property
    def is_reduced(self) -> bool:
        """Whether the linear stage works on separated bases."""
        return bool(self.linear_stage == "pgd")
