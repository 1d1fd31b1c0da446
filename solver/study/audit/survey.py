"""Random runs of all scenes: what is called converged has to be right."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Sequence

from solver.latin import Ending
from solver.settings import Settings
from solver.study.audit.audit import SOUND, Audited, Trial, Verdict
from solver.study.audit.draws import draw, is_foolish
from solver.study.audit.report import AuditReport

COLUMNS = (
    "scene",
    "seed",
    "row",
    "method",
    "foolish_k",
    "may_finish",
    "verdict",
    "ending",
    "certified",
    "iterations",
    "accuracy",
    "estimated_error",
    "error_force",
    "error_displacement",
    "residual",
    "seconds",
    "doubt",
    "advice",
    "settings",
)
TITLE = "Random runs of all scenes"
NOTES = ("Right are errors of the contact force of at most the accuracy.",)
MISSED = "Not converged, of runs that have one solution and a k that is not foolish"


def draws(scenes: Sequence[str], numbers: Sequence[int], seed: int) -> Iterator[Trial]:
    """Draw random runs of scenes in turn.

    Parameters
    ----------
    scenes
        Names of the catalogue.
    numbers
        Of the rows to draw; row n is of scene n modulo their number.
    seed
        Of the draws.
    """
    for number in numbers:
        yield drawn(draw(scenes[number % len(scenes)], seed, number), seed, number)


def drawn(settings: Settings, seed: int, number: int) -> Trial:
    """Give the run of settings that were drawn."""
    scene, changed = settings.scene, settings.changed()
    return Trial(
        scene,
        method_name(settings),
        f"row {number} of the seed {seed}",
        changed,
        settings.accuracy,
        math.inf,
        SOUND,
        conditions=False,
        labels={
            "seed": seed,
            "row": number,
            "foolish_k": is_foolish(settings),
            "may_finish": settings.finish != "none",
            "accuracy": settings.accuracy,
            "settings": json.dumps(changed),
        },
        again=(f"python -m solver survey {scene} --seed {seed} --row {number}", command(settings)),
    )


def method_name(settings: Settings) -> str:
    """Name the method; with bases, or with options of its own, that is said."""
    if settings.linear_stage == "pgd":
        return "pgd"
    own = set(settings.changed()) & {*settings.METHODS["fast"], "k_update"}
    return f"{settings.method}{', mixed' if own - {'tolerance'} else ''}"


def command(settings: Settings) -> str:
    """Give the command line that makes a run."""
    plain = {
        name: value if isinstance(value, str) else json.dumps(value)
        for name, value in settings.changed().items()
    }
    changes = (f"--set {shlex.quote(f'{name}={value}')}" for name, value in plain.items())
    return " ".join([f"python -m solver run {settings.scene}", *changes])


def survey_report(rows: Sequence[Audited]) -> AuditReport:
    """Report on those that are done."""
    return AuditReport("survey", TITLE, COLUMNS, rows, NOTES, {MISSED: table_of_missed(rows)})


def table_of_missed(rows: Sequence[Audited]) -> list[list[str]]:
    """Count the runs that could converge and did not, by whether a status step may end them."""
    sound = [row for row in rows if is_sound(row)]
    kinds = {
        "may end with a status step": [row for row in sound if row.trial.labels["may_finish"]],
        "only iterate": [row for row in sound if not row.trial.labels["may_finish"]],
        "all": sound,
    }
    head = ["runs that", "in all", "not converged", "share", "of these out of iterations"]
    return [head, *([kind, *_missed(own)] for kind, own in kinds.items())]


def is_sound(row: Audited) -> bool:
    """Tell whether a run could converge: it has a solution, and its k is not foolish."""
    refused = row.verdict is Verdict.REFUSED
    return not (row.trial.labels["foolish_k"] or row.outcome.doubt or refused)


def _missed(rows: Sequence[Audited]) -> list[str]:
    """Count runs, those that did not converge, and among them those out of iterations."""
    missed = [row.outcome.ending for row in rows if row.outcome.ending != Ending.CONVERGED]
    share = f"{100.0 * len(missed) / len(rows):.1f} %" if rows else "-"
    return [str(len(rows)), str(len(missed)), share, str(missed.count(Ending.EXHAUSTED))]
