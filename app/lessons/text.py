"""What a lesson says, with the quantities of the frame that is shown."""

from __future__ import annotations

import math
import re

from app.frame import Frame
from app.units import number, percent, unit_for
from solver.lessons.lesson import Control, Value, pieces
from solver.study.quantities.quantities import reading

PENDING = "…"
"""What only the rest of the run will tell."""
POWER = re.compile(r"\^(\d+)")


def parts_of(paragraph: str) -> list[str | Control]:
    """A paragraph, split where a control stands; the rest is Markdown with `{value:NAME}` in it."""
    parts: list[str | Control] = [""]
    for piece in pieces(paragraph):
        if isinstance(piece, Control):
            parts += [piece, ""]
        else:
            text = f"{{value:{piece.reading.name}}}" if isinstance(piece, Value) else piece
            parts[-1] = f"{parts[-1]}{text}"
    # A sentence ends with its control: its full stop would stand alone.
    texts = (
        part.lstrip(" .:") if n else part for n, part in enumerate(parts) if isinstance(part, str)
    )
    return [part if isinstance(part, Control) else next(texts) for part in parts]


def without_controls(paragraph: str) -> str:
    """A paragraph without the sentences that ask to move a control, for paper."""
    sentences = re.split(r"(?<=[.?!]) +", paragraph)
    return " ".join(sentence for sentence in sentences if "{control:" not in sentence)


def filled(text: str, frame: Frame | None) -> str:
    """Markdown in which every quantity is that of a frame."""
    text = re.sub(r"\{value:(.*?)\}", lambda match: f"**{_value(frame, match[1])}**", text)
    return POWER.sub(r"<sup>\1</sup>", text)


def _value(frame: Frame | None, name: str) -> str:
    value = frame.readings.get(name, math.nan) if frame is not None else math.nan
    is_over = frame is not None and frame.status is not None and name in frame.readings
    return written(value, name, frame.iteration) if is_over or math.isfinite(value) else PENDING


def written(value: float, name: str, iterations: int) -> str:
    """A quantity of a run of so many iterations, with its unit."""
    quantity = reading(name).quantity
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        # All that is counted and may never come are iterations.
        return "not reached" if quantity.unit else f"more than {iterations}"
    if quantity.is_share:
        return percent(value)
    return unit_for(abs(value), quantity.unit)(value) if quantity.unit else number(value)
