"""Frames of runs as a page draws them, made once by all tests of a process."""

from __future__ import annotations

import math

from app.frame import Frame
from app.messages import Needs, Start
from app.state import default_settings
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.files.saved import dump
from solver.settings.scene import Settings

FRAMES = dict[tuple[str, Needs, bool], Frame]()
"""Frames by the text of their settings, their needs, and whether the run had ended."""


def frame_of(settings: Settings, needs: Needs, *, ends: bool) -> Frame:
    """Frame with which a run ends, or that of its second iterate."""
    key = dump(settings), needs, ends
    if key not in FRAMES:
        runner = Runner(Start(1, settings, math.inf), ReferenceCache(), lambda: False)
        while ends and runner.status is None:
            runner.advance()
        while len(runner.history) < 2 and runner.status is None:
            runner._iterate()
        FRAMES[key] = runner.frame(needs)
    return FRAMES[key]


def ran(settings: Settings, *, ends: bool = True) -> Frame:
    """Frame with which a run ends, or that of its second iterate."""
    needs = Needs(frozenset({"thrust", "stress"}), readings=("hinges@0.5",))
    return frame_of(settings, needs, ends=ends)


def arch(**changes: object) -> Settings:
    """Settings of an arch of few voussoirs."""
    few = {"voussoirs": 12, "instants": 21, **changes}
    return default_settings("arch").replace(**few)
