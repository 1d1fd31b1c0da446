"""What stands above a plot: its name, with its legend beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from app.languages.language import Language
from app.picture.glossary import ENGLISH, explained


@dataclass(frozen=True)
class Key:
    """One entry of a legend, which stands beside the view's name: a mark and its meaning.

    Attributes
    ----------
    mark
        "line", "dashed", "dotted", "thin", "band", "square", "front" (a line on a square), "dot",
        "ring", "cross", "strip" (of many colours), or "bare" for none.
    """

    color: str
    mark: str
    text: str


def card_title(name: str, keys: Sequence[Key], sentence: str = "", say: Language = ENGLISH) -> str:
    """Write a view's name with its legend beside it, and a sentence below (HTML)."""
    entries = "".join(
        f'<span class="key"><i class="{key.mark}" style="--mark:{key.color}"></i>'
        f"{explained(escape(say(key.text)), say=say)}</span>"
        for key in keys
    )
    below = f"<p>{escape(say(sentence))}</p>" if sentence else ""
    return f"<b>{explained(escape(say(name)), say=say)}</b>{entries}{below}"
