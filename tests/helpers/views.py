"""Views of pages that show frames of small runs of all kinds of scenes."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from itertools import chain

from app.frame import Frame, Selection
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.views.catalogue import CARDS
from app.views.view import View
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.settings.scene import Settings

VIEWS = list(chain.from_iterable(CARDS))
NEEDS = frozenset(chain.from_iterable(kind.needs for kind in VIEWS))
SMALL = {
    "bar": {"elements": 60},
    "block": {"elements": 24, "instants": 41},
    "fault": {"elements": 24, "instants": 21},
    "incline": {"instants": 41},
    "layers": {"elements": 24, "instants": 21},
    "rope": {"elements": 20, "instants": 9},
    "strand": {"elements": 40, "instants": 41},
    "wall": {"bricks": 3, "courses": 3, "instants": 21},
}
MORE = {
    "bases": ("bar", {"elements": 60, "linear_stage": "pgd"}),
    "two points": (
        "block",
        {
            "gap": "flat",
            "length": 0.1,
            "height": 0.1,
            "elements": 1,
            "elements_up": 1,
            "substructures": 1,
            "substructures_up": 1,
            "friction": 0.7,
            "duration": 8.0,
            "top_normal_slope": 0.5,
            "top_tangential_load": "cycles",
            "instants": 65,
        },
    ),
}


def settings_of(case: str) -> Settings:
    """Settings of a case, with a search that ends soon."""
    scene, changes = MORE.get(case, (case, SMALL.get(case, {})))
    settings = default_settings(scene)
    return settings.replace(**changes, max_iterations=6)


@cache
def frames_of(case: str) -> tuple[Frame, Frame, Frame]:
    """First iterate, before any reference; one on the way; and the answer."""
    # A view tells runs apart by their numbers.
    number = 1 + 2 * [*SMALL, *MORE].index(case)
    start = Start(number, settings_of(case), math.inf)
    needs = Needs(extras=NEEDS)
    runner = Runner(start, ReferenceCache(), lambda: False)
    runner.advance()
    frames = [runner.frame(needs)]
    while runner.rest() is not None:
        runner.advance()
        if len(runner.history) <= 5 and runner.status is None:
            frames[1:] = [runner.frame(needs)]
    return frames[0], frames[1], runner.frame(needs)


def other_run(frame: Frame) -> Frame:
    """The same frame, of another run."""
    return replace(frame, run=replace(frame.run, number=frame.run.number + 1))


def shown(
    view: View, frame: Frame, ghost: Frame | None = None, **chosen: object
) -> View:
    """Show a frame in a view."""
    view.state.newest = view.state.frame = frame
    view.update(frame, replace(Selection(), **chosen), ghost)
    return view


def view_of(kind: type[View], frame: Frame) -> View:
    """A view of a page that shows a frame."""
    view = kind(PageState(frame.run.settings))
    assert view.figure is not None
    return shown(view, frame)
