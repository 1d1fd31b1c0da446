"""From drawings to what the models of the page are set to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

import numpy as np

from app.views.catalogue import fitting
from app.views.drawing import Axis, Bodies, Drawing, Image, Marks, Scene, View
from app.views.legend import card_title
from app.worker.block import Attributes, Packer, Quads
from app.worker.readings import values
from app.worker.shown import Look
from solver.settings import Settings

TAKE_AWAY = "take-away"
"""Name of the component that saves what is seen."""


class Easel:
    """All views of a page, with what they want to be kept."""

    def __init__(self) -> None:
        self.packer = Packer()
        self._kept: dict[str, Any] = {}

    def paint(self, scene: Scene, words: Mapping[str, str]) -> bytes:
        """Draw every view that is seen; give what has changed of the page."""
        models: dict[str, Attributes] = {TAKE_AWAY: {"caption": caption(scene)}}
        if scene.look.readings:
            models["lesson"] = {"values": values(scene)}
        for view in seen(scene.run.settings, scene.look):
            drawing = view.draw(scene, self._kept.get(view.slug))
            if drawing is not None:
                self._kept[view.slug] = drawing.kept
                models.update(parts(view, drawing))
        return self.say(words, models)

    def say(
        self, words: Mapping[str, str], models: Mapping[str, Attributes] | None = None
    ) -> bytes:
        """Give words (HTML) by the names of what they stand in, with what else is painted."""
        texts = {name: {"text": escape(text)} for name, text in words.items()}
        return self.packer.pack({**(models or {}), **texts})


def caption(scene: Scene) -> str:
    """Say of which moment of which run a picture is."""
    time, settings = scene.run.stand.instants[scene.instant], scene.run.settings
    return f"{settings.scene}, t = {time:.3g} s, iteration {scene.frame.iteration}"


def seen(settings: Settings, look: Look) -> list[View]:
    """Give the views of a run that are looked at."""
    return [view for view in fitting(settings) if view.name in look.views]


def parts(view: View, drawing: Drawing) -> dict[str, Attributes]:
    """Give what the models of a view's figure are set to, by their names."""
    found: dict[str, Attributes] = {"title": {"text": escape(card_title(view.name, drawing.keys))}}
    for name, axis in (("x", drawing.x), ("y", drawing.y)):
        found.update(_axis(name, axis))
    if view.plot.words or not view.plot.equal:
        found["curves"] = _curves(drawing)
    if view.plot.words:
        found["words"] = _words(drawing)
    for kind in view.plot.marks:
        found[kind.kind] = _marks(kind, drawing)
    if drawing.image is not None:
        found["image"] = _image(drawing.image)
    if drawing.bodies is not None:
        found.update(_bodies(drawing.bodies))
    if drawing.colors is not None:
        found["colors"] = {"low": drawing.colors.low, "high": drawing.colors.high}
        found["scale"] = {"ticks": list(drawing.colors.ticks)}
        if drawing.colors.title is not None:
            found["bar"] = {"title": drawing.colors.title}
    return {f"{view.slug}.{name}": attributes for name, attributes in found.items()}


def _axis(name: str, axis: Axis | None) -> Iterator[tuple[str, Attributes]]:
    if axis is None:
        return
    yield name, {"start": axis.low, "end": axis.high}
    if axis.label is not None:
        yield f"{name}-axis", {"axis_label": axis.label}
    if axis.ticks is not None:
        yield f"{name}-ticks", {"ticks": list(axis.ticks)}


def _curves(drawing: Drawing) -> Attributes:
    curves = drawing.curves
    return {
        "xs": [np.asarray(curve.x) for curve in curves],
        "ys": [np.asarray(curve.y) for curve in curves],
        "color": [curve.color for curve in curves],
        "width": [curve.width for curve in curves],
        "alpha": [curve.alpha for curve in curves],
        "dash": [curve.dash for curve in curves],
        "name": [curve.name for curve in curves],
    }


def _words(drawing: Drawing) -> Attributes:
    words = drawing.words
    return {
        "x": np.array([word.x for word in words], float),
        "y": np.array([word.y for word in words], float),
        "text": [word.text for word in words],
        "color": [word.color for word in words],
        "across": [word.across for word in words],
        "up": [word.up for word in words],
    }


def _marks(kind: Marks, drawing: Drawing) -> Attributes:
    marks = next((one for one in drawing.marks if one.kind == kind.kind), kind)
    return {"x": np.asarray(marks.x, float), "y": np.asarray(marks.y, float)}


def _image(image: Image) -> Attributes:
    return {
        "image": image.values,
        "x": [image.left],
        "y": [image.low],
        "dw": [image.width],
        "dh": [image.height],
    }


def _bodies(bodies: Bodies) -> Iterator[tuple[str, Attributes]]:
    yield "bodies", {"quads": Quads(bodies.corners, bodies.places), "value": bodies.values}
    yield "box", {"edge": list(bodies.box)}
