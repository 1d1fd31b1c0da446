"""What a plot shows, in a sentence of the run's numbers, for whoever does not see it."""

from __future__ import annotations

import numpy as np

from app.picture.units import rounded, titled
from app.views.drawing.drawing import Axis, Curve, Drawing, View
from app.views.drawing.legend import Key
from solver.arrays import Array
from solver.phrases import Phrase, joined

LINES = "line", "dashed", "dotted", "band"
"""Marks of keys that stand for curves."""


def told(view: View, drawing: Drawing) -> str:
    """Say what a drawing has: how far its curves go, or which shares an image has of what."""
    plot, keys = view.plot, drawing.keys
    if plot.words:
        shown = [*(word.text for word in drawing.words), *(key.text for key in keys)]
        return joined(" ", (drawing.sentence, Phrase("{}.", joined(", ", [*filter(None, shown)]))))
    if drawing.image is not None and not plot.scale:
        return Phrase("{}: {}.", _axes(view, drawing), _shares(drawing))
    if drawing.colors is not None and (drawing.image is not None or drawing.bodies is not None):
        title = drawing.colors.unit or plot.scale
        ends = rounded(drawing.colors.low), rounded(drawing.colors.high)
        return Phrase("{} from {} to {}, as colours.", title, *ends)
    named = [(key.text, _curve_of(key, drawing)) for key in keys if key.mark in LINES]
    is_history = "y" in plot.logarithmic
    spans: list[str] = [
        joined(" ", (name, _span(name, curve, is_history)))
        for name, curve in named
        if curve is not None and not _is_rule(curve, drawing)
    ]
    if not spans and drawing.curves:
        whole = np.concatenate([np.asarray(one.y, dtype=float).ravel() for one in drawing.curves])
        spans = [_span("", Curve((), whole, ""), is_history=False)]
    return Phrase("{}: {}.", _axes(view, drawing), joined("; ", spans)) if spans else ""


def _axes(view: View, drawing: Drawing) -> str:
    return Phrase(
        "{} over {}", _label(drawing.y, view.plot.y_label), _label(drawing.x, view.plot.x_label)
    )


def _label(axis: Axis | None, label: str) -> str:
    return titled(axis.label, axis.unit) if axis is not None and axis.label else label


def _curve_of(key: Key, drawing: Drawing) -> Curve | None:
    """Find the curve of an entry of the legend, which lies above others of its colour."""
    is_broken = key.mark in ("dashed", "dotted")
    found = [
        one
        for one in drawing.curves
        if one.color == key.color and (one.dash != "solid") == is_broken and np.size(one.y)
    ]
    return found[-1] if found else None


def _is_rule(curve: Curve, drawing: Drawing) -> bool:
    """Tell a line over the whole height of a plot from what has values."""
    values = _known(curve)
    return drawing.y is not None and set(values) == {drawing.y.low, drawing.y.high}


def _known(curve: Curve) -> Array:
    values: Array = np.asarray(curve.y, dtype=float) + 0.0
    return values[np.isfinite(values)]


def _span(name: str, curve: Curve, is_history: bool) -> str:
    """Say where a curve begins and ends in the course of a run, or else between what it lies."""
    values = _known(curve)
    if not len(values):
        return "not known yet"
    if is_history:
        return Phrase("from {} to {}", rounded(values[0], 2), rounded(values[-1], 2))
    values = np.abs(values) if name.startswith("±") else values
    low, high = values.min() + 0.0, values.max() + 0.0
    return Phrase("from {} to {}", rounded(low), rounded(high)) if high > low else rounded(low)


def _shares(drawing: Drawing) -> str:
    assert drawing.image is not None
    values = drawing.image.values
    names = [key.text for key in drawing.keys if key.mark == "square"]
    shares = [(name, 100.0 * np.mean(values == place)) for place, name in enumerate(names)]
    return joined(", ", [Phrase("{} {} %", name, f"{share:.0f}") for name, share in shares])
