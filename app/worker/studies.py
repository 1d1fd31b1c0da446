"""The studies of the command line as jobs of a page: what a process does, and what comes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from app.worker.job import Doing, Part, Send
from solver.scenes import CATALOGUE
from solver.study.error_against_time import Study, error_against_time
from solver.study.figure_data import PaperFigure
from solver.study.growth import Growth, growth
from solver.study.paper_figures import MAKERS
from solver.study.paper_runs import PaperRuns
from solver.study.stability import METHODS, Row, cases_of, stability
from solver.study.stability_report import write_report
from solver.study.stability_units import invariance
from solver.study.study_files import write_study

SHARE_OF_GROWTH = 0.8
"""Of the whole time, roughly, where growth is measured too."""
Files = Mapping[str, bytes]
"""Contents of the files that the command line would write, by name."""


@dataclass(frozen=True, eq=False)
class StudyFound:
    """Error against run time, and growth with the size, which may be empty."""

    study: Study
    growth: Sequence[Growth]
    files: Files


@dataclass(frozen=True, eq=False)
class StabilityFound:
    """The stability matrix, and differences between units."""

    rows: Sequence[Row]
    apart: Mapping[str, float]
    files: Files


def study_of(
    scene: str, values: dict[str, Any], repeats: int, sizes: bool, send: Send
) -> StudyFound:
    """Measure error against run time, and with `sizes` growth with the size of the problem."""
    settings = CATALOGUE[scene].settings.checked(values)
    first = 1.0 - SHARE_OF_GROWTH if sizes else 1.0
    study = error_against_time(
        settings, repeats, lambda doing, share: send(Doing(doing, first * share))
    )
    found = (
        growth(settings, lambda doing, share: send(Doing(doing, first + (1.0 - first) * share)))
        if sizes
        else []
    )
    send(Doing("Writing the report", 1.0))
    return StudyFound(study, found, _files(lambda folder: write_study(study, found, folder)))


def stability_of(quick: bool, send: Send) -> StabilityFound:
    """Run the stability matrix, or a quarter of it, and send every row as it comes."""
    matrix = cases_of(quick=quick)
    total = len(METHODS) * len(matrix)
    rows: list[Row] = []

    def report(row: Row) -> None:
        rows.append(row)
        send(Part(row))
        send(Doing(f"{len(rows)} of {total} runs", len(rows) / total))

    send(Doing(f"0 of {total} runs", 0.0))
    stability(matrix, report)
    send(Doing("The same bar in other units", 1.0))
    apart = invariance()
    return StabilityFound(rows, apart, _files(lambda folder: write_report(rows, apart, folder)))


def figures_of_the_paper(send: Send) -> list[PaperFigure]:
    """Compute the paper's figures, and send each as it comes."""
    runs, figures = PaperRuns(), list[PaperFigure]()
    for make in MAKERS:
        send(Doing(f"{len(figures)} of {len(MAKERS)} figures", len(figures) / len(MAKERS)))
        figures.append(make(runs))
        send(Part(figures[-1]))
    return figures


def _files(write: Callable[[Path], object]) -> Files:
    with TemporaryDirectory() as name:
        write(Path(name))
        return {file.name: file.read_bytes() for file in sorted(Path(name).iterdir())}
