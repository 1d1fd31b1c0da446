"""Tables in workbooks (.xlsx): the first sheet, read with openpyxl (optional)."""

from __future__ import annotations

import io
import warnings
import zipfile

from solver.files.table_lines import Line, line_of, up_to_last_filled
from solver.settings.values import Refuse

UNPACKED = 20_000_000
"""Largest size of a workbook's parts in bytes: some five times that of a text."""
MISSING = (
    "it is a workbook, which needs openpyxl: save the table as CSV, or install it with "
    "`pip install 'slipfront[excel]'`"
)
OTHER = "it is no workbook (.xlsx) and no text: save the table as CSV"


def is_archive(data: bytes) -> bool:
    """Check whether a file is an archive (as workbooks are), or an old workbook."""
    return data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0"))


def lines_of_workbook(data: bytes, refuse: Refuse) -> tuple[list[Line], str]:
    """Lines of the first sheet, without empty ones, and messages on the sheet.

    Raises
    ------
    SettingError
        Without openpyxl, and for a file that it cannot read.
    """
    _check_archive(data, refuse)
    try:
        import openpyxl
    except ImportError:
        raise refuse(MISSING) from None
    try:
        # It warns of what it does not read: forms, charts, styles.
        with warnings.catch_warnings(action="ignore"):
            book = openpyxl.load_workbook(
                io.BytesIO(data), read_only=True, data_only=True
            )
            sheet = book.worksheets[0]
            rows = []
            for values in sheet.iter_rows(values_only=True):
                rows.append([_text_of(value) for value in values])
            names = book.sheetnames
            book.close()
    except Exception as problem:  # whatever a file that is broken makes of its readers
        raise refuse(f"{OTHER} ({type(problem).__name__})") from None
    lines = []
    for number, row in enumerate(rows, start=1):
        # Empty rows keep their number: messages name lines as the workbook does.
        line = line_of(number, " ".join(row), up_to_last_filled(row))
        if line.cells:
            lines.append(line)
    words = f"sheet {sheet.title!r}"
    if len(names) > 1:
        words = f"{words} of {len(names)}"
    return lines, words


def _check_archive(data: bytes, refuse: Refuse) -> None:
    """Refuse archives that are no workbook, or become too large when unpacked."""
    try:
        # Sizes are in the directory of an archive, so nothing is unpacked for this.
        parts = zipfile.ZipFile(io.BytesIO(data)).infolist()
    except zipfile.BadZipFile:
        raise refuse(OTHER) from None
    if "xl/workbook.xml" not in [part.filename for part in parts]:
        raise refuse(OTHER)
    if sum(part.file_size for part in parts) > UNPACKED:
        raise refuse(f"it has more than {UNPACKED // 1_000_000} MB when it is unpacked")


def _text_of(value: object) -> str:
    """Text of a cell; numbers with all digits and a decimal point."""
    if value is None:
        return ""
    return str(value).strip()
