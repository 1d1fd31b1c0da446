"""The long commands of the command line as a page has them made: the same reports, as they grow."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from app.picture.units import measured, scale_of
from app.session.report_folder import ReportFolder
from solver.scenes import CATALOGUE
from solver.study.audit.audit import Audited, audit
from solver.study.audit.stability import cases_of, stability_report, trials_of
from solver.study.audit.units import invariance
from solver.study.figures.figure_page import figure_sections
from solver.study.figures.paper_figures import MAKERS
from solver.study.figures.paper_runs import PaperRuns
from solver.study.mesh import (
    AN_ELEMENT,
    TIME_STEP,
    Refinement,
    answer,
    instants_around,
    meshes_around,
    size_of,
    value_on,
    which_to_refine,
)
from solver.study.page import Section
from solver.study.progress import Tell
from solver.study.proof.case import HeldNumber, rows_of
from solver.study.proof.report import cases, write_proof
from solver.study.proof.sections import proof_sections
from solver.study.quantities.quantities import reading
from solver.study.speed.crossover import crossover
from solver.study.speed.error_against_time import error_against_time
from solver.study.speed.growth import growth
from solver.study.speed.study_page import study_sections, write_study

PARTS = {"curves": 1.0, "growth": 4.0, "map": 1.0}
"""Of a study, and how long each takes beside the others, roughly."""
RUNS = 5
"""On three meshes and with three numbers of instants, one of them in common."""
SHOWN_EVERY = 0.5
"""Seconds: a table that grows is sent to the browser as a whole."""
Work = Callable[[Path], None]
"""Picklable; it is given the folder of its report."""


def study_of(scene: str, values: dict[str, Any], repeats: int, sizes: bool, folder: Path) -> None:
    """Measure error against run time, and with `sizes` growth with the size of the problem."""
    growing, settings = ReportFolder(folder), CATALOGUE[scene].settings.checked(values)
    parts = {name: long for name, long in PARTS.items() if sizes or name != "growth"}
    tell = _shares(growing, parts)
    study = error_against_time(settings, repeats, tell["curves"])
    found = growth(settings, tell["growth"]) if sizes else []
    who = crossover(settings, tell["map"])
    growing.tell("Writing the report", 1.0)
    growing.publish(lambda place: write_study(study, found, who, place))
    growing.show(study_sections(study, found, who))


def _shares(growing: ReportFolder, parts: dict[str, float]) -> dict[str, Tell]:
    """Give to each part of a report what tells how far the whole of it is."""
    whole, done, found = sum(parts.values()), 0.0, dict[str, Tell]()
    for name, long in parts.items():
        found[name] = _part(growing, done / whole, long / whole)
        done += long
    return found


def _part(growing: ReportFolder, before: float, share: float) -> Tell:
    return lambda doing, done: growing.tell(doing, before + share * done)


def stability_of(quick: bool, folder: Path) -> None:
    """Run the stability matrix, or a quarter of it, and show it again and again as it grows."""
    growing, matrix, rows = ReportFolder(folder), trials_of(cases_of(quick=quick)), list[Audited]()
    total, shown = len(matrix), 0.0
    growing.tell(f"0 of {total} runs", 0.0)
    for row in audit(matrix):
        rows.append(row)
        growing.tell(f"{len(rows)} of {total} runs", len(rows) / total)
        if time.monotonic() - shown > SHOWN_EVERY:
            growing.show(stability_report(rows, {}).sections())
            shown = time.monotonic()
    growing.tell("The same bar in other units", 1.0)
    report = stability_report(rows, invariance())
    growing.publish(report.write)
    growing.show(report.sections())


def proof_of(folder: Path) -> None:
    """Set what is known beside what is found, and show it case by case."""
    growing, chosen, rows = ReportFolder(folder), list(cases()), list[HeldNumber]()
    for number, case in enumerate(chosen):
        growing.tell(f"{number} of {len(chosen)} cases", number / len(chosen))
        rows += rows_of(case)
        growing.show(proof_sections(rows, page=""))
    growing.publish(lambda place: write_proof(rows, place))


def mesh_of_run(scene: str, values: dict[str, Any], of: str, units: str, folder: Path) -> None:
    """Take a quantity on three meshes and three numbers of instants, and show what they tell."""
    growing, settings, asked = (
        ReportFolder(folder),
        CATALOGUE[scene].settings.checked(values),
        reading(of),
    )
    told, values, unit = list[str](), dict[str, float](), asked.quantity.unit
    factor, name, answers, refinements = 1.0, unit, list[str](), list[Refinement]()
    around = {AN_ELEMENT: meshes_around(settings), TIME_STEP: instants_around(settings)}
    for halved, (runs, own) in around.items():
        for run in runs:
            size = size_of(run)
            if size not in values:
                growing.tell(size, len(values) / RUNS)
                values[size] = value_on(run, asked)
                told.append(f"{size}: <b>{measured(values[size], unit, units, 4)}</b>")
                growing.show([" · ".join(told), *answers])
        if not refinements:
            factor, name = scale_of(abs(values[size_of(runs[-1])]), unit, units)
        coarse, middle, fine = (values[size_of(run)] / factor for run in runs)
        refinements.append(Refinement((coarse, middle, fine), own))
        answers.append(f"<br>{answer(refinements[-1], name, halved)}")
    elements, instants = refinements
    answers.append(f"<br>{which_to_refine(elements, instants)}")
    growing.show([" · ".join(told), *answers])


def figures_of_the_paper(folder: Path) -> None:
    """Compute the paper's figures, and show each as it comes."""
    growing, runs, shown = ReportFolder(folder), PaperRuns(), list[Section]()
    for number, make in enumerate(MAKERS):
        growing.tell(f"{number} of {len(MAKERS)} figures", number / len(MAKERS))
        shown += figure_sections(make(runs))
        growing.show(shown)
