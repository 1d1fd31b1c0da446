"""HTML of the page from templates, for commands that import no widgets, too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from solver.files.templates import templates_in

TEMPLATES = templates_in(Path(__file__).parent)
"""Templates of HTML: each is next to its module, and is named by its path from
here."""


def html(template: str, **values: Any) -> str:
    """HTML of a template with escaped values."""
    return TEMPLATES.get_template(template).render(values)
