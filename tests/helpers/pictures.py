"""Pictures of scenes as a page draws them, and the boxes of the words on them."""

from __future__ import annotations

from itertools import chain

import frames
import numpy as np

from app.frame import Frame, Selection
from app.messages import Needs
from app.state import PageState, default_settings
from app.views.catalogue import CARDS
from app.views.scene import Scene
from solver.settings.scene import Settings

KINDS = tuple(chain.from_iterable(CARDS))
NEEDS = frozenset(chain.from_iterable(kind.needs for kind in KINDS))
COARSE = {"elements": 24, "instants": 21}
PHASES = np.linspace(0.0, 1.0, 7)
"""Shares of the interval at which pictures are looked at."""
LEFT_OF = {"left": 0.0, "center": 0.5, "right": 1.0}
"""Share of a text at the left of its anchor, by its alignment."""


def frame_of(settings: Settings, *, ends: bool = False) -> Frame:
    """Frame of the second iterate, or that with which the run ends."""
    return frames.frame_of(settings, Needs(extras=NEEDS), ends=ends)


def coarse(scene: str) -> Settings:
    """Settings with which a page begins a scene, on a coarse mesh."""
    settings = default_settings(scene)
    fewer = {
        name: min(most, getattr(settings, name))
        for name, most in COARSE.items()
        if name in settings.definitions()
    }
    if scene == "bundle":
        # Those of a contact, of which a wire has several.
        fewer["elements"] = 4
    return settings.checked(fewer)


def small(scene: str) -> Settings:
    """Settings of a scene with few bodies."""
    settings = coarse(scene)
    if scene == "bundle":
        return settings.replace(rings=1)
    return settings


def shown(frame: Frame, phase: float = 0.75, kind: type[Scene] = Scene) -> Scene:
    """Scene of a page that shows a frame at a share of the interval."""
    view = kind(PageState(frame.run.settings, frame=frame))
    _ = view.figure
    view.update(frame, Selection(phase), None)
    return view


def boxes_of_words(
    view: Scene, letter: float = 7.5, half: float = 7.0
) -> list[tuple[str, np.ndarray]]:
    """Texts of a picture, each with its lower left and upper right corner, (2, 2), px.

    `letter` is the width of a letter, `half` half of the height of a text, px.
    """
    words = view.sources["words"].data
    boxes = []
    for x, y, text, align in zip(
        words["x"], words["y"], words["text"], words["text_align"], strict=True
    ):
        length = letter * len(text)
        left = x - LEFT_OF[align] * length
        boxes.append((text, np.array([[left, y - half], [left + length, y + half]])))
    return boxes


def meet(box: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Check whether a box, (2, 2), meets others between corners, (2,) or (n, 2) each.

    A point is a box whose corners are equal.
    """
    return bool(np.any(np.all((low < box[1]) & (high > box[0]), axis=-1)))
