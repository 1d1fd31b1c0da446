"""A study as a report: curves of error over time, of growth, and the tables."""

from __future__ import annotations

from collections.abc import Sequence

from solver.study.error_against_time import Study
from solver.study.growth import Growth
from solver.study.page import PlotSection, Section, bullets, plain_table
from solver.study.study_panels import CAPTION, CURVES, GROWTH, error_panels, growth_panels
from solver.study.study_report import (
    GROWTH_NOTE,
    TIMES,
    TIMES_NOTE,
    WINNERS,
    WINNERS_NOTE,
    conditions,
    growth_table,
    table,
    winners,
)

TITLE = "Error against run time"


def study_sections(study: Study, found: Sequence[Growth]) -> list[Section]:
    """Write a study, and growth with the size if that was measured."""
    growth: list[Section] = [
        f"<h2>{GROWTH}</h2>\n<p>{GROWTH_NOTE}</p>",
        PlotSection(GROWTH, growth_panels(found)),
        plain_table(growth_table(found)),
    ]
    return [
        f"<h2>{WINNERS}</h2>\n{plain_table(winners(study))}\n<p>{WINNERS_NOTE}</p>",
        PlotSection(CURVES, error_panels(study)),
        f"<p>{CAPTION}</p>\n<h2>{TIMES}</h2>\n<p>{TIMES_NOTE}</p>\n{plain_table(table(study))}",
        *(growth if found else []),
        f"<h2>How it was measured</h2>\n{bullets(conditions(study))}",
    ]
