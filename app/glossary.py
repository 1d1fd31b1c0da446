"""The keys of the page, and what its words mean."""

from __future__ import annotations

import tomllib
from pathlib import Path

import panel as pn
import panel_material_ui as pmui

from app.widgets import dialog

TEXTS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
"""Keys and words, each with its meaning."""


def glossary() -> pmui.Dialog:
    """A dialog of both."""
    tables = pn.pane.HTML("".join(map(_table, TEXTS.values())), sizing_mode="stretch_width")
    return dialog("Keys and words", tables, width_option="md")


def _table(entries: dict[str, str]) -> str:
    rows = "".join(f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in entries.items())
    return f'<table style="text-align:left;font-size:14px;margin-bottom:12px">{rows}</table>'
