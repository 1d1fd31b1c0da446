"""The files of a study: its tables, and its page where it can be drawn."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from solver.study.error_against_time import Study
from solver.study.growth import Growth
from solver.study.study_page import TITLE, study_sections
from solver.study.study_report import write_tables

NO_PAGE = "The page needs matplotlib: pip install 'slipfront[figures]'"


def write_study(study: Study, found: Sequence[Growth], folder: Path) -> tuple[list[Path], bool]:
    """Write the tables, and `study.html` if matplotlib is there.

    Parameters
    ----------
    study, found
        Errors against run time; growth with the size, or nothing.
    folder
        An existing folder; files of these names are replaced.

    Returns
    -------
    The files, and whether the page is one of them.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    files = write_tables(study, found, folder)
    try:
        from solver.study.drawing import write_page
    except ModuleNotFoundError as missing:
        if (missing.name or "").split(".")[0] not in ("matplotlib", "PIL"):
            raise
        return files, False
    file = folder / "study.html"
    write_page(file, TITLE, study_sections(study, found))
    return [*files, file], True
