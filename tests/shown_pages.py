"""The runs of a page in this process, asked for pictures as a page asks, and what it shows."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

from ropes import SMALL_ROPE
from unpacking import Unpacker

from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import Look
from app.views.catalogue import VIEWS
from app.views.drawing.drawing import Drawing
from app.views.scene import Scene
from app.wire.orders import Order, Ready, Run, Watch
from app.wire.reports import File, Picture
from app.worker.page_runs import PageRuns
from app.worker.run import WorkerRun
from solver.scenes import CATALOGUE

ALL = Look(views=tuple(view.name for view in VIEWS))
SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 20, "instants": 21, "substructures": 4},
    "strand": {"elements": 10, "instants": 11},
    "block": {"elements": 16, "elements_up": 6, "instants": 13},
    "layers": {"elements": 16, "layers": 2, "instants": 13},
    "fault": {"elements": 16, "elements_up": 8, "instants": 13},
    "incline": {"elements": 12, "elements_up": 6, "instants": 13},
    "rope": {**SMALL_ROPE, "elements": 10, "instants": 13},
}
"""Settings of every scene with which a run takes next to no time."""
Models = dict[str, dict[str, Any]]


def run_of(ticket: int, scene: str, values: dict[str, Any], **options: Any) -> Run:
    """Give the order for a run with settings of a scene."""
    settings = CATALOGUE[scene].settings
    if (twin := options.pop("twin", None)) is not None:
        options["twin"] = settings.checked(twin)
    return Run(ticket, settings.checked(values), **options)


class Shown:
    """The runs of a page.

    Parameters
    ----------
    look
        What is looked at.
    is_quick
        Whether it paints in no time: every iterate is seen. One that is slow sees the first
        iterates that there are after an order, and what they come to.

    Attributes
    ----------
    pictures, files, said
        All that it sent, and what it said between pictures.
    models
        What the page has after each of them.
    """

    def __init__(self, look: Look = ALL, *, is_quick: bool = False) -> None:
        self._is_quick, self._is_painting = is_quick, False
        self.pictures: list[Picture] = []
        self.files: list[list[Any]] = []
        self.said: list[str] = []
        self.models: list[Models] = []
        self._unpack = Unpacker()
        self.runs = PageRuns(self._paint, lambda: False)
        self.runs.obey(Watch(look))
        self.runs.obey(Ready())

    def obey(self, *orders: Order) -> None:
        for order in orders:
            self.runs.obey(order)
        self.work()

    def run(self, ticket: int, scene: str, values: dict[str, Any], **options: Any) -> None:
        self.obey(run_of(ticket, scene, values, **options))

    def work(self) -> None:
        """Go on until there is nothing to do."""
        while (rest := self._rest()) is not None:
            time.sleep(rest)
            if not self.runs.paint():
                self.runs.go_on()

    def _rest(self) -> float | None:
        """Give the seconds until there is something to do; a slow page has painted till then."""
        rest = self.runs.rest()
        if rest is None and self._is_painting:
            self._is_painting = False
            self.runs.obey(Ready())
            rest = self.runs.rest()
        return rest

    @property
    def page(self) -> Models:
        return self.models[-1]

    @property
    def words(self) -> str:
        found: str = self.page["status"]["text"]
        return found

    @property
    def at_work(self) -> WorkerRun:
        assert self.runs._run is not None
        return self.runs._run

    @property
    def recording(self) -> Recording:
        return self.at_work.recording

    def frame(self, look: Look = ALL) -> Frame:
        return self.at_work.frame(look)

    def scene(self, look: Look = ALL, instant: int = 5) -> Scene:
        return replace(self.runs._scene(self.at_work, self.frame(look), instant), look=look)

    def _paint(self, picture: Picture | File) -> None:
        if isinstance(picture, File):
            found = self._unpack(picture.block)
            if "take-away" in found:
                self.files.append(found["take-away"]["file"])
                self.runs.obey(Ready())
            else:
                self.said.append(found["status"]["text"])
            return
        self.pictures.append(picture)
        before = self.models[-1] if self.models else {}
        self.models.append({**before, **self._unpack(picture.block)})
        if self._is_quick:
            self.runs.obey(Ready())
        self._is_painting = not self._is_quick


def keys(drawing: Drawing | None) -> list[str]:
    """Give the words of a legend."""
    assert drawing is not None
    return [key.text for key in drawing.keys]
