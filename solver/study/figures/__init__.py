"""The paper's figures: their runs, what is found in them, and how they are shown."""

from __future__ import annotations

from solver.study.figures.convergence import figure_3, figure_4
from solver.study.figures.figure import PaperFigure
from solver.study.figures.modes import figure_5, figure_6, figure_7, figure_8
from solver.study.figures.paper_runs import PaperRuns


def paper_figures(runs: PaperRuns) -> list[PaperFigure]:
    """Figs. 3 to 8."""
    return [make(runs) for make in (figure_3, figure_4, figure_5, figure_6, figure_7, figure_8)]
