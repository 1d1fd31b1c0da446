"""Loops: force over displacement, cycles, and slips of two points."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from app.frame import Floats, Frame, Run, Selection
from app.views.axis import PERCENT, whole
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
from app.views.flags import FLAGS, add_flag, show_flag
from app.views.parts import gapped, hover
from app.views.view import ExtraView, View
from app.worker.cells import thinned
from solver.arrays import Array
from solver.laws import FrictionLaw
from solver.study import comparison
from solver.study.measured_loop import MeasuredLoop
from solver.study.quantities.cycles import n_cycles_of

NOTHING = np.zeros((2, 0), dtype=np.float32)
"""A curve without points."""
MOST_LOOPS = 12
"""Largest number of loops that are drawn: more cannot be distinguished."""
FAR = 10.0
"""Half the length of a line in the plot of two slips, over the largest slip in it."""


class HysteresisLoop(View):
    """Force over displacement of LATIN, of the reference, and of the closed form."""

    name = "Loop"
    needs = frozenset({"beside"})

    applies = staticmethod(lambda settings: settings.instants > 1)

    def make(self) -> None:
        """Draw a curve for each loop, and the selected instant."""
        plot = self.begin()
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        self.add("reference", color=REFERENCE, width=1.5)
        self.add("beside", color=BESIDE, width=2, dash="dashed")
        latin = self.add("LATIN", color=LATIN, width=2.5)
        self.add("now", "Scatter", color=ERROR, size=10)
        add_flag(self)
        names = "LATIN", "reference", "ghost", "beside", *FLAGS
        self.legend(*names, exact="closed form")
        hover(plot, [latin], {"displacement": "@x{0.000}", "force": "@y{0.000}"})

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the loop of the iterate, and the instant on it."""
        run = frame.run
        self.x.rename(*_across(run))
        self.y.rename(*run.up)
        reference = NOTHING
        if run.reference_loop is not None:
            reference = run.reference_loop
        exact = NOTHING
        for curve in run.known("loop")[:1]:
            exact = np.stack([curve.across, curve.up])
        brought = (frame.extras.get("beside") or {}).get("brought")
        source = ""
        if brought:
            source = brought.source
        beside = _beside(brought, frame)
        curves = [frame.loop, exact, reference, beside]
        # The ghost may go beyond the limits: they are those of this run.
        xs = [x for x, _ in curves]
        ys = [y for _, y in curves]
        self.x.hold(frame.stage, *xs, [0.0], margin=0.08)
        self.y.hold(frame.stage, *ys, [0.0], margin=0.08)
        self.draw("LATIN", *frame.loop)
        self.draw("reference", *reference)
        self.draw("exact", *exact)
        self.draw("ghost", *_ghost_of(run, ghost), self.ghost_name)
        self.draw("beside", *beside, source)
        self.draw("now", *frame.loop[:, [run.column(selection.phase)]])
        show_flag(self, frame)


def _across(run: Run) -> tuple[str, str]:
    """Title and unit of a loop's axis across; shares, as strain, are in per cent."""
    title, unit = run.across
    return title, unit or PERCENT.name


def _ghost_of(run: Run, ghost: Frame | None) -> Floats:
    """Loop of another run with the same quantities, (2, n); else empty."""
    if ghost is None or (ghost.run.across, ghost.run.up) != (run.across, run.up):
        return NOTHING
    return ghost.loop


def _beside(
    brought: comparison.OtherResults | MeasuredLoop | None, frame: Frame
) -> tuple[Array, Array]:
    """A measured loop, or that of other results under the run's load, (n,) each, SI.

    Results of another program have displacements alone: those of the far end are drawn
    over the force of this run at the same instants.
    """
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
        lru_cache(maxsize=64)(lambda settings: n_cycles_of(settings) > 1)
    )

    def _add_legend(self, *names: str) -> None:
        """Add a legend: first cycle, last cycle, glyphs, and a text on further slip."""
        self.mark({"first": SCALE[0], "last": SCALE[-1], "text": UNSEEN})
        self.legend(*names, first="cycle 1", last="last", text="text")

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
        self.x.rename(*_across(run))
        self.y.rename(*run.up)
        self.x.hold(frame.stage, loop[0], margin=0.08)
        self.y.hold(frame.stage, loop[1], margin=0.08)
        x = self.x(loop[0])
        y = self.y(loop[1])
        columns = cycles["columns"]
        count = len(cycles["energy"])
        colors = scaled(count)
        loops: dict[str, list[Any]] = {"xs": [], "ys": [], "color": []}
        for number in thinned(count, MOST_LOOPS):
            # A cycle ends at the instant at which the next one begins.
            cycle = slice(columns[number], columns[number + 1] + 1)
            loops["xs"].append(x[cycle])
            loops["ys"].append(y[cycle])
            loops["color"].append(colors[number])
        self.fill("loops", **loops)
        self.draw("now", *loop[:, [run.column(selection.phase)]])


class CycleEnergy(CyclePlot):
    """Energy dissipated by friction in every cycle."""

    name = "Energy a cycle"

    def make(self) -> None:
        """Draw a bar for each cycle."""
        plot = self.begin(("cycle",), ("energy", "J"))
        whole(plot.xaxis[0])
        bars = self.add("bars", "VBar", "x top color", width=0.7)
        add_flag(self)
        self._add_legend(*FLAGS)
        hover(plot, [bars], {"cycle": "@x", "energy": "@top{0.000}"})

    def _show(self, cycles: Any, frame: Frame, selection: Selection) -> None:
        super()._show(cycles, frame, selection)
        energy = cycles["energy"]
        count = len(energy)
        self.x.span(0.5, count + 0.5)
        # Room for a known number that is larger.
        self.y.hold(frame.stage, [0.0], 1.2 * energy)
        self.fill(
            "bars", x=np.arange(1, count + 1), top=self.y(energy), color=scaled(count)
        )
        show_flag(self, frame)


class SlipPlane(View):
    """Slips of two points, and the limits within which both stick."""

    name = "Slip plane"
    needs = frozenset({"slips"})

    # It is for a body on two points, whose friction follows from their pressure: their
    # slips and pressures are the four components of jumps.
    applies = staticmethod(
        lambda settings: (
            settings.opens and settings.n_jumps == 4 and settings.law == FrictionLaw()
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
            left="left slips",
            right="right slips",
            path="so far",
            room="free in the last cycle",
            held="contact alone holds the block",
        )

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the slips of both points so far, and the present limits."""
        slips = frame.extras.get("slips", {})
        column = frame.run.column(selection.phase)
        # None means that slip says nothing of pressure; {} that the worker has sent
        # nothing yet.
        self.show("held", slips is None)
        if not slips:
            self.clear()
            return
        slip = slips["slip"]
        corners = slips["room"].T
        both = np.concatenate([slip, corners], axis=1)
        self.x.hold(frame.run.number, both[0], margin=0.1)
        self.y.hold(frame.run.number, both[1], margin=0.1)
        self.draw("room", *corners)
        self.draw("path", *slip[:, : column + 1])
        self.draw("now", *slip[:, [column]])
        far = FAR * np.ptp(both, axis=1).max()
        for number, name in enumerate(("left", "right")):
            # Lines of the left and of the right point alternate.
            rows = slice(number, None, 2)
            lines = _lines(slips["matrix"][rows], slips["limit"][rows, column], far)
            self.draw(name, *lines)


def _lines(matrix: Floats, limit: Floats, far: float) -> Floats:
    """Lines A w = b as one curve with NaN in between, shape (2, n), m.

    A has shape (n_lines, 2), N/m, b (n_lines,), N. Each line goes a length `far`, m, to
    both sides of its point nearest to the origin.
    """
    sizes = np.linalg.norm(matrix, axis=1)
    feet = matrix * (limit / sizes**2)[:, None]
    along = far * np.stack([-matrix[:, 1], matrix[:, 0]], axis=1) / sizes[:, None]
    return gapped(np.stack([feet - along, feet + along], axis=1)).T
