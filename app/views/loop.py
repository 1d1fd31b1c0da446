"""Hysteresis loop: force over displacement."""

from __future__ import annotations

import numpy as np
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.views.colors import BESIDE, ERROR, EXACT, GHOST, LATIN, REFERENCE
from app.views.view import Axis, Key, View, extent, hover, key_of, plot, put, source
from solver.settings import Settings


class HysteresisLoop(View):
    """Force over displacement of LATIN, of the reference, and of the closed form."""

    name = "Loop"
    needs = frozenset({"beside"})

    @staticmethod
    def applies(settings: Settings) -> bool:
        """Whether there are several instants."""
        return settings.instants > 1

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        self._x, self._y = Axis(made, "x", ""), Axis(made, "y", "")
        names = "latin", "reference", "exact", "ghost", "beside", "now"
        self.sources = {name: source("x", "y") for name in names}
        looks = {
            "exact": {"color": EXACT, "width": 8, "alpha": 0.35},
            "ghost": {"color": GHOST, "width": 2, "dash": "dotted"},
            "reference": {"color": REFERENCE, "width": 1.5},
            "beside": {"color": BESIDE, "width": 2, "dash": "dashed"},
            "latin": {"color": LATIN, "width": 2.5},
        }
        lines = {
            name: [made.line("x", "y", source=self.sources[name], **look)]
            for name, look in looks.items()
        }
        made.scatter("x", "y", source=self.sources["now"], color=ERROR, size=10)
        titles = {
            "LATIN": "latin",
            "reference": "reference",
            "closed form": "exact",
            "ghost": "ghost",
            "beside": "beside",
        }
        self._key = Key(made, {title: lines[name] for title, name in titles.items()})
        hover(made, lines["latin"], {"displacement": "@x{0.000}", "force": "@y{0.000}"})
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the loop of the iterate, and the instant on it."""
        run, column = frame.run, frame.run.column(selection.phase)
        self._x.rename(*run.across)
        self._y.rename(*run.up)
        exact, reference = run.known("loop"), run.reference_loop
        settled = [(curve.across, curve.up) for curve in exact]
        settled += [] if reference is None else [tuple(reference)]
        for axis, row in ((self._x, 0), (self._y, 1)):
            low, high = extent([frame.loop[row], *(pair[row] for pair in settled)])
            axis.hold(key_of(run), min(low, 0.0), max(high, 0.0), 0.08)
        is_alike = ghost is not None and (ghost.run.across, ghost.run.up) == (run.across, run.up)
        past = ghost.loop if ghost is not None and is_alike else None
        beside = self._beside(frame)
        self._draw("latin", frame.loop)
        self._draw("reference", reference)
        self._draw("exact", settled[0] if exact else None)
        self._draw("ghost", past)
        self._draw("beside", beside)
        self._draw("now", frame.loop[:, [column]])
        name = (frame.extras.get("beside") or {}).get("name", "another program")
        self._key.show(
            {
                "reference": reference is not None,
                "closed form": bool(exact),
                "ghost": "" if past is None else self.ghost_name,
                "beside": "" if beside is None else name,
            }
        )

    def _draw(self, name: str, loop: object) -> None:
        x, y = ([], []) if loop is None else loop  # type: ignore[misc]
        put(self.sources[name], x=self._x(x), y=self._y(y))

    @staticmethod
    def _beside(frame: Frame) -> tuple[np.ndarray, np.ndarray] | None:
        """Another program's displacement of the loaded end, under the load of the run."""
        beside, instants = frame.extras.get("beside"), frame.run.instants
        if beside is None or beside["quantity"] != "displacement":
            return None
        x, t, values = (np.asarray(beside[name]) for name in ("x", "t", "values"))
        rows = (x == x[np.abs(x - frame.run.geometry.description.length).argmin()]) & (
            t <= instants[-1]
        )
        order = np.argsort(t[rows])
        times = t[rows][order]
        return values[rows][order], np.interp(times, instants, frame.loop[1])
