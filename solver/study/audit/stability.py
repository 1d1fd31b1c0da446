"""Where the method is sound: stiff and extreme cases of all scenes, by both methods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from solver.study.audit.audit import Audited, Trial
from solver.study.audit.bar_cases import bar_cases
from solver.study.audit.cases import METHODS, Case
from solver.study.audit.fault_cases import fault_cases
from solver.study.audit.plane_cases import plane_cases
from solver.study.audit.report import AuditReport
from solver.study.audit.rope_cases import rope_cases
from solver.study.audit.strand_cases import strand_cases
from solver.study.audit.units import words_of

COLUMNS = (
    "scene",
    "group",
    "case",
    "method",
    "expected",
    "verdict",
    "passed",
    "status",
    "iterations",
    "error_displacement",
    "error_force",
    "indicator",
    "behaviour",
    "condition_structure",
    "condition_substructure",
    "seconds",
    "doubt",
    "advice",
)
TITLE = "Stability on stiff and extreme cases"
NOTES = (
    "A run passes if it comes to what is expected of it. Right are errors of at most 1e-6.",
    "Errors: distance to the reference solution over space and time, as a share of it; where it is "
    "zero, as a share of the load, or in m and N.",
    "Condition numbers: of the stiffness of the whole structure with its supports but without "
    "contact (structure, K; infinite where contact alone holds a body), and the largest of what a "
    "substructure solves in an iteration (substructure, E).",
)


def cases_of(scene: str | None = None, *, quick: bool = False) -> list[Case]:
    """Give the cases of one scene, or of all, and with `quick` only the few for a short check."""
    return [
        case
        for case in (*bar_cases(), *strand_cases(), *rope_cases(), *fault_cases(), *plane_cases())
        if scene in (None, case.scene) and (case.quick or not quick)
    ]


def trials_of(cases: Sequence[Case]) -> list[Trial]:
    """Give the runs of cases, each by both methods."""
    return [case.trial(method) for case in cases for method in METHODS]


def stability_report(rows: Sequence[Audited], apart: Mapping[str, float]) -> AuditReport:
    """Report on cases.

    Parameters
    ----------
    rows
        Those that are done.
    apart
        What `invariance` found; empty where it was not asked.
    """
    notes = [*NOTES, *([words_of(apart)] if apart else [])]
    return AuditReport("stability", TITLE, COLUMNS, rows, notes)
