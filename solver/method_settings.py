"""Settings of the method, which all scenes have."""

from __future__ import annotations

from typing import ClassVar

from solver.checked import Checked
from solver.definitions import DECOMPOSITION, METHOD, Group

STOP = Group("Stop")


def _on_modes(settings: MethodSettings) -> bool:
    return bool(settings.linear_stage == "pgd")


def _on_fields(settings: MethodSettings) -> bool:
    return bool(settings.linear_stage == "full")


class MethodSettings(Checked):
    """Settings of the method; a scene adds its own."""

    METHODS: ClassVar = {
        "fast": {
            "search_direction": "auto",
            "acceleration": "anderson",
            "start": "nested",
            "relaxation": 0.8,
            "finish": "at-once",
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
    """What `method` sets at once."""

    substructures = DECOMPOSITION.count(
        10,
        (1, 20_000),
        (1, 50),
        "Number of pieces (substructures) that a body is cut into.",
    )
    multiscale = DECOMPOSITION.switch(
        True,
        "Also balance the mean forces between substructures at every iteration, by a small coarse "
        "problem. Without it, a load travels one substructure an iteration.",
        title="Multiscale (coarse problem)",
        applies=lambda settings: settings.n_substructures > 1,
    )
    method = METHOD.choice(
        "fast",
        ["fast", "paper"],
        "fast: what reaches the accuracy soonest. paper: the iteration of the paper. Sets search "
        "direction, acceleration, start, relaxation, finish and tolerance at once; each can be "
        "changed afterwards.",
    )
    search_direction = METHOD.choice(
        "auto",
        ["paper", "auto"],
        "How k, the stiffness that joins the two stages of an iteration, is chosen. paper: from "
        "the length of a substructure. auto: at points that may slip, from the length that is "
        "expected to slide and that of an element; between bodies that turn out to slip nowhere, "
        "from their depth.",
    )
    k_scale = METHOD.quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Multiplies the search direction k: other iterations, the same solution.",
        title="Factor on k",
    )
    relaxation = METHOD.quantity(
        0.8,
        (0.01, 1.0),
        (0.1, 1.0),
        "How far an iteration goes towards its new result: 1 all the way (Peaceman-Rachford), 0.5 "
        "half of it (Douglas-Rachford). Less is slower and safer.",
    )
    linear_stage = METHOD.choice(
        "full",
        ["full", "pgd"],
        "full: a value for every point and instant. pgd: a sum of a few modes, each a shape in "
        "space times a function of time (model reduction). That holds many cycles of a load in a "
        "fraction of the memory; full fields come sooner to any error.",
    )
    pgd_modes = METHOD.count(
        10,
        (1, 1000),
        (1, 20),
        "Most modes kept for a substructure; the smallest are dropped. Many cycles of a load need "
        "no more than one.",
        title="Most PGD modes",
        applies=_on_modes,
    )
    pgd_tolerance = METHOD.quantity(
        1e-7,
        (1e-14, 1.0),
        (1e-12, 1e-3),
        "Share of a substructure's field that may be lost: so much is dropped with the smallest "
        "modes, and no mode is added for a residual below it. Most of a field is displacement: "
        "with 1e-4, 15 % of a contact force were lost.",
        title="PGD tolerance",
        applies=_on_modes,
    )
    pgd_pairs = METHOD.count(
        2,
        (1, 1000),
        (1, 10),
        "Most modes that one iteration adds to a substructure.",
        title="PGD pairs per iteration",
        applies=_on_modes,
    )
    pgd_sharing = METHOD.quantity(
        1e-5,
        (0.0, 1.0),
        (0.0, 0.5),
        "Equal substructures use the same modes if these miss at most this share of each one's "
        "field. 0: each has modes of its own.",
        title="PGD basis sharing",
        applies=lambda settings: _on_modes(settings) and settings.n_substructures > 1,
    )
    acceleration = METHOD.choice(
        "anderson",
        ["none", "anderson"],
        "anderson: combine the last iterates so that the two stages agree best, which saves "
        "iterations. none: take the newest as it is.",
        applies=_on_fields,
    )
    start = METHOD.choice(
        "nested",
        ["zero", "nested"],
        "zero: start from nothing. nested: start from the solution on half the elements, which the "
        "incremental solver finds; the run time includes that.",
    )
    k_update = METHOD.choice(
        "none",
        ["none", "status"],
        "none: k is as the search direction says. status: once stick and slip have settled, k "
        "becomes smaller where points slip; taken back if that does not help.",
        title="Update of k",
        applies=_on_fields,
    )
    finish = METHOD.choice(
        "at-once",
        ["none", "accuracy", "at-once"],
        "When a status step ends the run: keep the present stick, slip and opening, solve the "
        "linear problem that is left, and take its solution if it obeys all laws. at-once: as soon "
        "as one holds. accuracy: once the iterates themselves are within the accuracy; the answer "
        "is then put beside them. none: only iterate.",
    )
    accuracy = STOP.quantity(
        0.01,
        (1e-12, 1.0),
        (1e-6, 0.1),
        "The run ends when friction, and pressure where it is not known, are each estimated to be "
        "wrong by less than this share; 0.01 is 1 %.",
    )
    tolerance = STOP.quantity(
        1e-3,
        (1e-30, 1.0),
        (1e-16, 1e-2),
        "Unless a status step ends it, a run also goes on until the LATIN indicator η is below "
        "this. η is not an error.",
        title="Tolerance on η",
    )
    max_iterations = STOP.count(
        1000,
        (1, 1_000_000),
        (10, 5000),
        "The run stops after so many iterations, converged or not.",
        title="Most iterations",
    )
    threads = METHOD.count(
        1,
        (1, 64),
        (1, 4),
        "Threads that share an iteration on a large structure, where the machine has nothing else "
        "to do. The results are the same to the bit.",
    )

    @property
    def n_bodies(self) -> int:
        """Number of bodies, each of which is cut."""
        return 1

    @property
    def n_substructures(self) -> int:
        """Number of substructures in all."""
        return self.n_bodies * self.substructures
