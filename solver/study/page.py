"""A report: sections of words, tables and plots, and the one HTML page that a command makes of it.

Whoever shows a report takes its words and tables as they are, and draws its plots in its own way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from solver.study.figure_data import Panel


@dataclass(frozen=True, eq=False)
class PlotSection:
    """Panels side by side, and words for those who cannot see them."""

    heading: str
    panels: Sequence[Panel]


Section = str | PlotSection
"""Words and tables are HTML."""
PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Slipfront: {title}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 90rem; margin: 2rem auto; padding: 0 1rem;
  color: #222; background: #fff; }}
p, ul {{ max-width: 62rem; }}
h2 {{ margin-top: 3rem; }}
img {{ max-width: 100%; height: auto; }}
.caption {{ opacity: 0.75; font-size: 0.9rem; }}
table {{ display: block; overflow-x: auto; border-collapse: collapse; font-size: 0.85rem; }}
th, td {{ padding: 0.2rem 0.5rem; border-bottom: 1px solid #8884; text-align: left;
  vertical-align: top; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
td.verdict {{ border-left: 0.6rem solid; font-weight: 600; }}
td.settings {{ overflow-wrap: anywhere; min-width: 24rem; }}
</style>
<h1>{title}</h1>
{body}
</html>
"""


def page(title: str, sections: Sequence[str]) -> str:
    """Write a page that needs nothing beside it."""
    return PAGE.format(title=escape(title), body="\n".join(sections))


def bullets(lines: Sequence[str]) -> str:
    """Write sentences as a list."""
    return "<ul>\n" + "\n".join(f"<li>{escape(line)}</li>" for line in lines) + "\n</ul>"


def table(heads: Sequence[str], rows: Sequence[str]) -> str:
    """Write a table of rows that are cells already."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return f"<table>\n<tr>{head}</tr>\n{body}\n</table>"


def plain_table(rows: Sequence[Sequence[str]]) -> str:
    """Write a table of texts, whose first row is its head."""
    head, *rest = rows
    return table(head, ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rest])
