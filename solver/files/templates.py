"""HTML from templates; all values are escaped."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined


def templates_in(folder: Path) -> Environment:
    """Templates in a folder, by their file names.

    Values are escaped, unless they are `Markup` or a template says `safe`. A name that
    has no value raises `jinja2.UndefinedError`.
    """
    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
