"""From drawings to what the models of the page are set to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from app.languages.language import Language
from app.picture.glossary import ENGLISH
from app.picture.shown import Look
from app.picture.units import BY_SIZE, TIME, measured, titled
from app.views.catalogue import fitting
from app.views.drawing.colors import VERMILION
from app.views.drawing.drawing import (
    POSITION,
    Axis,
    Curve,
    Drawing,
    Image,
    Marks,
    QuadMesh,
    View,
)
from app.views.drawing.in_units import in_units
from app.views.drawing.legend import card_title
from app.views.drawing.scales import upright
from app.views.scene import Scene
from app.wire.block import Attributes, Packer, Places, Quads
from app.wire.reports import Facts
from app.worker.readings import values
from app.worker.telling import told
from solver.phrases import Phrase
from solver.settings import Settings

TAKE_AWAY, PLOTS = "take-away", "plots"
"""Names of the components that save what is seen, and that show it."""
ITERATION, INSTANT = "iteration", "instant"
"""Names of the sliders over these."""


class Painter:
    """All views of a page, with what they want to be kept."""

    def __init__(self) -> None:
        self.packer = Packer()
        self._kept: dict[str, Any] = {}

    def paint(self, scene: Scene, words: Mapping[str, str], facts: Facts) -> bytes:
        """Draw every view that is seen; give what has changed of the page."""
        say = scene.look.say
        seen_now, said = {"caption": say(caption(scene))}, []
        models: dict[str, Attributes] = {
            TAKE_AWAY: seen_now,
            **sliders(facts, say, scene.look.units),
        }
        if scene.look.readings:
            models["lesson"] = {"values": values(scene)}
        for view, drawing in self._drawings(scene):
            said.append([view.slug, say(told(view, drawing))])
            models.update(parts(view, drawing, say))
        models[PLOTS] = {"said": said, "bathtub": bathtub(scene), **seen_now}
        return self.say(words, models)

    def plots(self, scene: Scene) -> bytes:
        """Draw every view that is seen; give what has changed of the plots alone."""
        models: dict[str, Attributes] = {}
        for view, drawing in self._drawings(scene):
            models.update(parts(view, drawing, scene.look.say))
        return self.packer.pack(models)

    def _drawings(self, scene: Scene) -> Iterator[tuple[View, Drawing]]:
        for view in seen(scene.run.settings, scene.look):
            drawing = view.draw(scene, self._kept.get(view.slug))
            if drawing is not None:
                self._kept[view.slug] = drawing.kept
                yield view, in_units(marked(view, drawing, scene.look.place), scene.look.units)

    def say(
        self, words: Mapping[str, str], models: Mapping[str, Attributes] | None = None
    ) -> bytes:
        """Give words (HTML) by the names of what they stand in, with what else is painted."""
        texts = {name: {"text": escape(text)} for name, text in words.items()}
        return self.packer.pack({**(models or {}), **texts})


def bathtub(scene: Scene) -> list[Any]:
    """Give iterations over k, the present k, and how near they come; nothing without a curve."""
    points = scene.bathtub.points if scene.bathtub else []
    settings = scene.run.settings
    return [points, settings.k_scale, f"{100 * settings.accuracy:g} %"] if points else []


def caption(scene: Scene) -> str:
    """Say of which moment of which run a picture is."""
    time, settings = scene.run.stand.instants[scene.instant], scene.run.settings
    called = scene.run.called(scene.frame.iteration)
    at = measured(float(time), TIME, scene.look.units)
    return Phrase("{}, t = {}, {}", settings.scene, at, called)


def sliders(facts: Facts, say: Language = ENGLISH, units: str = BY_SIZE) -> dict[str, Attributes]:
    """Give where the sliders over iterations and instants stand, and what they say."""
    at, done, searched = facts.iteration, max(facts.done, 1), max(facts.searched, 1)
    said = say(Phrase("{} of {}", at, searched) if at <= searched else "answer")
    last, time = max(facts.instants - 1, 1), f"t = {measured(facts.time, TIME, units)}"
    return {
        ITERATION: {"end": max(done, 2), "shown": at, "text": said},
        INSTANT: {"end": last, "shown": facts.instant, "text": time},
    }


def seen(settings: Settings, look: Look) -> list[View]:
    """Give the views of a run that are looked at."""
    return [view for view in fitting(settings) if view.name in look.views]


def marked(view: View, drawing: Drawing, place: float | None) -> Drawing:
    """Mark a place, m, where positions run across a plot."""
    if place is None or view.plot.x_label != POSITION or drawing.y is None:
        return drawing
    mark = upright([place], drawing.y, color=VERMILION, width=1.5)
    return replace(drawing, curves=[*drawing.curves, mark])


def parts(view: View, drawing: Drawing, say: Language = ENGLISH) -> dict[str, Attributes]:
    """Give what the models of a view's figure are set to, by their names."""
    found: dict[str, Attributes] = {
        "title": {"text": card_title(view.name, drawing.keys, drawing.sentence, say)}
    }
    for name, axis in (("x", drawing.x), ("y", drawing.y)):
        found.update(_axis(name, axis, say, is_fitted=drawing.bodies is not None))
    found["curves"] = _curves(drawing)
    if view.plot.words:
        found["curves"] = {**found["curves"], **_shifts(drawing.curves)}
        found["words"] = _words(drawing, say)
        found["handles"] = _handles(drawing)
    if view.plot.is_touched:
        found["contacts"] = _contacts(drawing)
    for kind in view.plot.marks:
        found[kind.kind] = _marks(kind, drawing)
    if drawing.image is not None:
        found["image"] = _image(drawing.image)
    if drawing.bodies is not None:
        found.update(_bodies(drawing.bodies))
    if drawing.colors is not None:
        found["colors"] = {"low": drawing.colors.low, "high": drawing.colors.high}
        if drawing.colors.unit:
            found["color-bar"] = {"title": drawing.colors.unit}
    return {f"{view.slug}.{name}": attributes for name, attributes in found.items()}


def _axis(
    name: str, axis: Axis | None, say: Language, *, is_fitted: bool
) -> Iterator[tuple[str, Attributes]]:
    """Give what an axis says, and where it ends unless bodies are fitted into it."""
    if axis is None:
        return
    if not is_fitted:
        yield name, {"start": axis.low, "end": axis.high}
    if axis.label is not None:
        yield f"{name}-axis", {"axis_label": say(titled(axis.label, axis.unit))}
    if axis.ticks is not None:
        yield f"{name}-ticks", {"ticks": list(axis.ticks)}


def _curves(drawing: Drawing) -> Attributes:
    curves = drawing.curves
    return {
        **_lines(drawing, [curve.x for curve in curves], [curve.y for curve in curves]),
        **_columns(curves, "color", "width", "alpha", "dash", "name"),
    }


def _lines(drawing: Drawing, xs: Sequence[ArrayLike], ys: Sequence[ArrayLike]) -> Attributes:
    """Give lines; those beside bodies by their places in the picture."""
    if drawing.bodies is None:
        return {"xs": [np.asarray(one) for one in xs], "ys": [np.asarray(one) for one in ys]}
    box = drawing.bodies.box
    return {"xs": Places(xs, box.left, box.right), "ys": Places(ys, box.low, box.high)}


def _shifts(curves: Sequence[Curve]) -> Attributes:
    """Give the pixels that curves lie beside their places."""
    return {
        "dx": [np.atleast_1d(curve.dx) for curve in curves],
        "dy": [np.atleast_1d(curve.dy) for curve in curves],
    }


def _columns(marks: Sequence[Any], *names: str) -> Attributes:
    return {name: [getattr(mark, name) for mark in marks] for name in names}


def _words(drawing: Drawing, say: Language) -> Attributes:
    places = _columns(drawing.words, "x", "y", "dx", "dy")
    return {
        **{name: np.array(values, float) for name, values in places.items()},
        "text": [say(word.text) for word in drawing.words],
        **_columns(drawing.words, "across", "up"),
    }


def _handles(drawing: Drawing) -> Attributes:
    handles = drawing.handles
    return {
        **{
            name: [one.ends[:, axis] for one in handles]
            for axis, name in enumerate(("xs", "ys", "dx", "dy"))
        },
        **_columns(handles, "setting", "value", "is_metric"),
        "rate": [float(f"{one.rate:.6g}") for one in handles],
    }


def _contacts(drawing: Drawing) -> Attributes:
    places = drawing.contacts.values()
    return {
        **_lines(drawing, [one[:, 0] for one in places], [one[:, 1] for one in places]),
        "name": list(drawing.contacts),
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


def _bodies(bodies: QuadMesh) -> Iterator[tuple[str, Attributes]]:
    box, (x, y) = bodies.box, bodies.places.T
    ends = box.left, box.right, box.low, box.high
    quads = Quads(bodies.corners, Places([x], *ends[:2]), Places([y], *ends[2:]))
    yield "bodies", {"quads": quads, "value": bodies.values}
    yield "patches", {"line_alpha": bodies.lines}
    if bodies.along is not None:
        yield "along", {"x": bodies.along}
    yield "box", {"edge": [*ends, *box.room, *box.lines, box.flattest, box.filled]}
