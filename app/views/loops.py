"""Loops: force over displacement, cycles, and slips of two points."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from app.frame import Floats, Frame, Selection
from app.views.acts import gapped
from app.views.axis import whole
from app.views.colors import (
    BESIDE,
    DISPLACEMENT,
    ERROR,
    EXACT,
    FORWARD,
    GHOST,
    LATIN,
    REFERENCE,
    SCALE,
    UNSEEN,
    scaled,
)
from app.views.view import ExtraView, View, hover
from app.worker.geometry import thinned
from solver.arrays import Array
from solver.laws import FrictionLaw
from solver.study import comparison
from solver.study.measured_loop import MeasuredLoop
from solver.study.quantities.cycles import cycles_in

MOST_LOOPS = 12
"""Loops that are drawn at most; more cannot be told apart."""
FAR = 10.0
"""Times the plot of two slips by which a line goes beyond it."""


class HysteresisLoop(View):
    """Force over displacement of LATIN, of the reference, and of the closed form."""

    name = "Loop"
    needs = frozenset({"beside"})

    applies = staticmethod(lambda settings: settings.instants > 1)

    def make(self) -> None:
        """Draw a curve for each loop, and the selected instant."""
        made = self.begin()
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        self.add("reference", color=REFERENCE, width=1.5)
        self.add("beside", color=BESIDE, width=2, dash="dashed")
        latin = self.add("LATIN", color=LATIN, width=2.5)
        self.add("now", "Scatter", color=ERROR, size=10)
        self.legend("LATIN", "reference", "ghost", "beside", exact="closed form")
        hover(made, [latin], {"displacement": "@x{0.000}", "force": "@y{0.000}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the loop of the iterate, and the instant on it."""
        run = frame.run
        nothing = np.zeros((2, 0))
        self.x.rename(*run.across)
        self.y.rename(*run.up)
        exact = next(((curve.across, curve.up) for curve in run.known("loop")), nothing)
        if run.reference_loop is None:
            reference = nothing
        else:
            reference = run.reference_loop
        brought = (frame.extras.get("beside") or {}).get("brought")
        beside = _beside(brought, frame)
        for axis, row in ((self.x, 0), (self.y, 1)):
            curves = frame.loop[row], exact[row], reference[row], beside[row]
            axis.hold(frame.stage, *curves, [0.0], margin=0.08)
        is_alike = ghost is not None and (ghost.run.across, ghost.run.up) == (
            run.across,
            run.up,
        )
        self.draw("LATIN", *frame.loop)
        self.draw("reference", *reference)
        self.draw("exact", *exact)
        self.draw(
            "ghost", *(ghost.loop if ghost and is_alike else nothing), self.ghost_name
        )
        self.draw("beside", *beside, brought.source if brought else "")
        self.draw("now", *frame.loop[:, [run.column(selection.phase)]])


def _beside(
    brought: comparison.OtherResults | MeasuredLoop | None, frame: Frame
) -> tuple[Array, Array]:
    """A measured loop, or another program's under the run's load, (n,) each, SI."""
    if isinstance(brought, MeasuredLoop):
        return brought.displacement, brought.force
    if brought is None or brought.quantity != comparison.DISPLACEMENT:
        return np.zeros(0), np.zeros(0)
    x = brought.positions
    t = brought.times
    instants = frame.run.instants
    end = x[np.abs(x - frame.run.geometry.description.length).argmin()]
    rows = np.flatnonzero((x == end) & (t <= instants[-1]))
    rows = rows[np.argsort(t[rows])]
    return brought.values[rows], np.interp(t[rows], instants, frame.loop[1])


class CyclePlot(ExtraView):
    """A plot of the cycles of the load."""

    needs = frozenset({"cycles"})

    applies = staticmethod(
        lru_cache(maxsize=64)(lambda settings: cycles_in(settings) > 1)
    )

    def _add_legend(self) -> None:
        """Add a legend of the first and the last cycle, and of how slip goes on."""
        self.mark({"first": SCALE[0], "last": SCALE[-1], "text": UNSEEN})
        self.legend(first="cycle 1", last="last", text="text")

    def _show(self, cycles: Any, frame: Frame, selection: Selection) -> None:
        self.show("last", f"cycle {len(cycles['energy'])}")
        self.show("text", cycles["text"])


class Cycles(CyclePlot):
    """Force over displacement from the first cycle to the last."""

    name = "Cycles"

    def make(self) -> None:
        """Draw the loops of the cycles, and the selected instant."""
        self.begin()
        self.add("loops", "MultiLine", "xs ys color", width=2)
        self.add("now", "Scatter", color=ERROR, size=10)
        self._add_legend()

    def _show(self, cycles: Any, frame: Frame, selection: Selection) -> None:
        super()._show(cycles, frame, selection)
        run = frame.run
        loop = frame.loop
        self.x.rename(*run.across)
        self.y.rename(*run.up)
        for axis, values in ((self.x, loop[0]), (self.y, loop[1])):
            axis.hold(frame.stage, values, margin=0.08)
        x = self.x(loop[0])
        y = self.y(loop[1])
        count = len(cycles["energy"])
        columns = cycles["columns"]
        shown = thinned(count, MOST_LOOPS)
        parts = [slice(columns[n], columns[n + 1] + 1) for n in shown]
        colors = np.array(scaled(count))[shown].tolist()
        self.fill(
            "loops", xs=[x[p] for p in parts], ys=[y[p] for p in parts], color=colors
        )
        self.draw("now", *loop[:, [run.column(selection.phase)]])


class CycleEnergy(CyclePlot):
    """Energy that friction takes in every cycle."""

    name = "Energy a cycle"

    def make(self) -> None:
        """Draw a bar for each cycle."""
        made = self.begin(("cycle",), ("energy", "J"))
        whole(made.xaxis[0])
        bars = self.add("bars", "VBar", "x top color", width=0.7)
        self._add_legend()
        hover(made, [bars], {"cycle": "@x", "energy": "@top{0.000}"})

    def _show(self, cycles: Any, frame: Frame, selection: Selection) -> None:
        super()._show(cycles, frame, selection)
        energy = cycles["energy"]
        count = len(energy)
        self.x.span(0.5, count + 0.5)
        self.y.hold(frame.stage, [0.0], energy, 1.1 * energy)
        self.fill(
            "bars", x=np.arange(1, count + 1), top=self.y(energy), color=scaled(count)
        )


class SlipPlane(View):
    """Slips of two points, and the lines between which both stick."""

    name = "Slip plane"
    needs = frozenset({"slips"})

    # Two points rub, whose friction follows from what presses them.
    applies = staticmethod(
        lambda settings: (
            settings.opens and settings.jumps == 4 and settings.law == FrictionLaw()
        )
    )

    def make(self) -> None:
        """Draw the limits of slip of both points, and the path of their slip."""
        self.begin(("left slip", "m"), ("right slip", "m"))
        self.add("room", "Patch", color=DISPLACEMENT, alpha=0.3)
        self.add("left", color=LATIN, width=1.5)
        self.add("right", color=FORWARD, width=1.5)
        self.add("path", color=REFERENCE, width=2)
        self.add("now", "Scatter", color=ERROR, size=10)
        self.mark({"held": UNSEEN})
        self.legend(
            left="left slips", right="right slips", path="so far", room="free in the last cycle",
            held="contact alone holds the block",
        )  # fmt: skip

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the slips of both points so far, and the present limits of slip."""
        slips = frame.extras.get("slips", {})
        column = frame.run.column(selection.phase)
        self.show("held", slips is None)
        if not slips:
            for name in self.sources:
                self.draw(name, [], [])
            return
        slip = slips["slip"]
        corners = slips["room"].T
        both = np.concatenate([slip, corners], axis=1)
        for axis, values in zip((self.x, self.y), both, strict=True):
            axis.hold(frame.run.number, values, margin=0.1)
        self.draw("room", *corners)
        self.draw("path", *slip[:, : column + 1])
        self.draw("now", *slip[:, [column]])
        far = FAR * np.ptp(both, axis=1).max()
        for number, name in enumerate(("left", "right")):
            rows = slice(number, None, 2)
            self.draw(
                name, *_lines(slips["matrix"][rows], slips["limit"][rows, column], far)
            )


def _lines(matrix: Floats, limit: Floats, far: float) -> Floats:
    """Lines A w = b as one curve broken by NaN, shape (2, n)."""
    sizes = np.linalg.norm(matrix, axis=1)
    feet = matrix * (limit / sizes**2)[:, None]
    along = far * np.stack([-matrix[:, 1], matrix[:, 0]], axis=1) / sizes[:, None]
    return gapped(np.stack([feet - along, feet + along], axis=1)).T
