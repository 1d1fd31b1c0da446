"""What one takes away from the page: tables, pictures, a program, a page, a contact problem."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
from bokeh.models import GlyphRenderer

from app.browser import Display
from app.frame import Frame
from app.messages import Compute
from app.offline import offline_page
from app.refusals import message_of
from app.state import PageState
from app.views.view import View
from app.worker.fclib import fclib_file
from app.worker.references import has_reference
from solver.checked import dump
from solver.refusal import RefusedError
from solver.settings import Settings
from solver.study.other_programs.fclib import can_write

WIDTH = 340
SVG = "The same, to save plots from as SVG (.html)"
PROGRAM = """\
from solver.files import scene_settings
from solver.latin import solve
{imports}from solver.scenes import discretise
from solver.scenes.method import method_of

settings = scene_settings({scene}).checked(
    {{
{values}    }}
)
problem = discretise(settings)
{solved}
for record in solution.records:
    print(record.iteration, record.indicator, record.error_force)
print(solution.status.ending)
"""
COMPARED = """\
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
"""
ALONE = "solution = solve(problem, method_of(settings))"
BESIDE = """\
distance = distance_to(reference_of(problem), problem)
solution = solve(problem, method_of(settings), distance=distance)"""


def program(settings: Settings) -> str:
    """A Python program that gives the numbers of a run again, with all its settings."""
    is_compared = has_reference(settings)
    values = settings.values().items()
    return PROGRAM.format(
        imports=COMPARED if is_compared else "",
        scene=json.dumps(settings.scene),
        values="".join(f"        {json.dumps(name)}: {value!r},\n" for name, value in values),
        solved=BESIDE if is_compared else ALONE,
    )


def history_table(frame: Frame) -> str:
    """Scalars of every iteration of a run (CSV, with comments that begin with #)."""
    rows = zip(*(values.tolist() for values in frame.history.values()), strict=True)
    return _csv(frame, ["one line an iteration; seconds of run time"], [[*frame.history], *rows])


def plot_table(view: View, frame: Frame) -> str:
    """What a plot shows (CSV, with comments that begin with #): a line for each point of a curve.

    Columns are those of the plot's sources, in the units of its axes.
    """
    axes = [*view.figure.xaxis[:1], *view.figure.yaxis[:1]]
    names = [f"{n}: {axis.axis_label}" for n, axis in zip("xy", axes, strict=False)]
    tables = list(_sources(view))
    columns = list(dict.fromkeys(name for _, data in tables for name in data))
    rows = [
        [label, *(data[name][place] if name in data else "" for name in columns)]
        for label, data in tables
        for place in range(len(next(iter(data.values()), [])))
    ]
    return _csv(frame, [view.name, *names], [["curve", *columns], *rows])


def _sources(view: View) -> Iterator[tuple[str, dict[str, Any]]]:
    """Legend entry and columns of every source that is shown; paths are taken apart."""
    labels: dict[str, list[str]] = {}
    for item in (item for legend in view.figure.legend for item in legend.items):
        for renderer in item.renderers:
            text = getattr(item.label, "value", None)
            labels.setdefault(renderer.data_source.id, []).append(str(text))
    seen: set[str] = set()
    for renderer in view.figure.renderers:
        if isinstance(renderer, GlyphRenderer) and renderer.data_source.id not in seen:
            source = renderer.data_source
            seen.add(source.id)
            data = {name: list(column) for name, column in source.data.items()}
            for label, flat in _flat(data):
                yield " / ".join([*labels.get(source.id, [source.name or ""]), *label]), flat


def _flat(data: dict[str, list[Any]]) -> Iterator[tuple[list[str], dict[str, list[Any]]]]:
    """Columns of numbers as they are; a table for each path or image."""
    nested = {n for n, column in data.items() if any(np.ndim(cell) for cell in column)}
    if not nested:
        yield [], data
        return
    for place in range(len(next(iter(data.values())))):
        flat = {name: np.ravel(np.asarray(data[name][place])).tolist() for name in nested}
        size = max(map(len, flat.values()))
        if all(len(column) == size for column in flat.values()):
            rest = {n: [column[place]] * size for n, column in data.items() if n not in nested}
            yield [str(place + 1)], {**flat, **rest}


def _csv(frame: Frame, head: list[str], rows: list[list[Any]]) -> str:
    written = io.StringIO()
    settings = dump(frame.run.settings).splitlines()
    at = "answer" if frame.is_answer else f"iteration {frame.iteration}"
    for line in [f"Slipfront, {frame.run.settings.scene}, {at}", *head, "settings:", *settings]:
        written.write(f"# {line}\n")
    csv.writer(written, lineterminator="\n").writerows(rows)
    return written.getvalue()


class TakeAway:
    """A dialog with what can be saved of what is seen.

    Parameters
    ----------
    state, display
        Of the page.

    Attributes
    ----------
    view
        The dialog, which stands in the page's header.
    """

    def __init__(self, state: PageState, display: Display) -> None:
        self._state, self._display = state, display
        self._content = pn.Column(margin=0)
        self.view = pmui.Dialog(
            self._content, title="Take away", show_close_button=True, close_on_click=True
        )

    @property
    def views(self) -> list[View]:
        """The views in sight."""
        return list(self._display.views)

    @property
    def offers(self) -> list[Any]:
        """What can be saved."""
        return list(self._content)

    def open(self) -> None:
        """Offer what there is of what is seen."""
        frame, views = self._state.frame, self.views
        if frame is None:
            self._content[:] = [pmui.Typography("There is no run yet.")]
        else:
            self._content[:] = self._offers(frame, views)
        self.view.open = True

    def _offers(self, frame: Frame, views: list[View]) -> list[Any]:
        name = f"slipfront-{frame.run.settings.scene}"
        texts = [
            ("The run as one page (.html)", f"{name}.html", partial(self.page, frame, views)),
            (SVG, f"{name}-svg.html", partial(self.page, frame, views, "svg")),
            ("The run as a program (.py)", f"{name}.py", partial(program, frame.run.settings)),
            ("All iterations (.csv)", f"{name}-iterations.csv", partial(history_table, frame)),
        ]
        texts += [
            (f"{view.name} (.csv)", f"{name}-{slug(view)}.csv", partial(plot_table, view, frame))
            for view in views
        ]
        offers: list[Any] = [_download(label, file, make) for label, file, make in texts]
        return [*offers, *([self._fclib(name)] if can_write() else [])]

    def page(self, frame: Frame, views: list[View], backend: str = "canvas") -> str:
        """The run as one page that needs nothing beside it.

        The save buttons of its plots write PNG, or SVG with the backend "svg".
        """
        tables = {f"{slug(view)}.csv": plot_table(view, frame) for view in views}
        tables["iterations.csv"] = history_table(frame)
        state = self._state
        return offline_page(frame, views, state.selection, state.ghost, tables, backend)

    def _fclib(self, name: str) -> pn.Column:
        """A button that has the worker make the file, which is there to be saved then."""
        column, state = pn.Column(margin=0), self._state

        def make(_event: Any) -> None:
            state.compute(Compute(fclib_file, state.selection.phase), take)

        def take(result: Any) -> None:
            if isinstance(result, bytes):
                column[1:] = [_download("Save it", f"{name}.hdf5", lambda: result)]
            elif isinstance(result, RefusedError):
                column[1:] = [pmui.Typography(message_of(result, state.settings))]
            else:
                column[1:] = [pmui.Typography(f"It cannot be written: {result}")]

        button = pmui.Button(
            label="Contact problem of this instant (FCLIB)", variant="outlined", **_look()
        )
        button.on_click(make)
        column[:] = [button]
        return column


def slug(view: View) -> str:
    """The name of a view in the name of a file."""
    return view.name.lower().replace(" ", "-").replace("/", "-")


def _look() -> dict[str, Any]:
    return {"size": "small", "width": WIDTH, "margin": (4, 8)}


def _download(label: str, file: str, make: Any) -> pmui.FileDownload:
    def data() -> io.BytesIO:
        content = make()
        return io.BytesIO(content if isinstance(content, bytes) else content.encode())

    made = pmui.FileDownload(label=label, filename=file, callback=data, **_look())
    # Its constructor warns of a variant, whatever it is.
    made.variant = "outlined"
    return made
