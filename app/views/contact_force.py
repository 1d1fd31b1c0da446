"""Friction along the interface beside the reference, and what lies between them."""

from __future__ import annotations

import numpy as np

from app.frame import Floats, Frame, InterfaceFields, Selection
from app.views.axis import extent
from app.views.colors import (
    BESIDE,
    CUT,
    ERROR,
    EXACT,
    GHOST,
    LATIN,
    PRESSURE,
    REFERENCE,
)
from app.views.view import View, hover, joined
from solver.study.comparison import FRICTION, OtherResults

ROOM = 1.15
MOST = 2.0
"""What is seen of forces, over their bound or reference: at least, and at most."""


class ContactForce(View):
    """Contact forces at the selected instant, LATIN on top of the reference, the error shaded.

    Of plane bodies whose pressure is not given they are pressure and friction.
    """

    name = "Contact force"
    needs = frozenset({"beside"})

    def make(self) -> None:
        """Draw curves of LATIN, the reference, the bound and what they are compared with."""
        made = self.begin(("x", "m"), ("force", "N/m"))
        self.add("cuts", "VSpan", "x", color=CUT, alpha=0.4, line_width=1)
        self.add("place", "VSpan", "x", color=ERROR, alpha=0.7, line_width=1)
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        area = {"y1": "reference", "y2": "latin", "color": ERROR, "alpha": 0.35}
        for name in ("friction", "pressure"):
            self.add("error", "VArea", "x", also="latin reference", on=name, **area)
        self.add("bound", color=REFERENCE, dash="dashed")
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        self.add("reference", color=REFERENCE, width=1.5)
        self.add("beside", color=BESIDE, width=2, dash="dashed")
        lines = [
            self.add(name, y="latin", color=color, width=2.5)
            for name, color in (("pressure", PRESSURE), ("friction", LATIN))
        ]
        self.legend(
            friction="LATIN", pressure="pressure", reference="reference", error="error",
            bound="±µp", exact="closed form", ghost="ghost", beside="beside",
        )  # fmt: skip
        tips = {
            "x": "@x{0.000}",
            "LATIN": "@latin{0.000}",
            "reference": "@reference{0.000}",
        }
        hover(made, lines, tips)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the contact forces along the selected interface."""
        run = frame.run
        name = selection.interface_of(frame.run)
        fields = frame.contact.get(name)
        interface = run.interfaces[name]
        if fields is None:
            return
        column = run.column(selection.phase)
        reference = run.reference.get(name)
        is_plane = run.settings.kind == "plane"
        has_pressure = fields.pressure is not None
        self.y.rename("traction" if is_plane else "force", "Pa" if is_plane else "N/m")
        curves = run.known("friction") + (run.known("pressure") if has_pressure else [])
        exact = [
            curve for curve in curves if curve.across.ndim == 1 and curve.up.ndim == 2
        ]
        self._scale(frame, name, fields, [curve.up for curve in exact])
        places = interface.positions
        # The error is nothing where there is no reference.
        for quantity in ("friction", "pressure"):
            both = [getattr(each, quantity) for each in (fields, reference or fields)]
            if both[0] is not None:
                latin, known = both
            else:
                latin, known = np.zeros((2, 0, column + 1))
            forces = {
                "latin": self.y(latin[:, column]),
                "reference": self.y(known[:, column]),
            }
            title = quantity if has_pressure else "LATIN"
            self.fill(quantity, title, x=self.x(places[: len(latin)]), **forces)
        self.draw("reference", *_curves(places, reference, column))
        self.show("error", reference is not None)
        bound = interface.bound
        if bound is None:
            bound = interface.coefficient * np.maximum(fields.pressure, 0.0)
        bound = bound[:, min(column, bound.shape[1] - 1)]
        self.draw("bound", *joined([(places, bound), (places, -bound)]))
        self.fill("cuts", x=self.x(interface.cuts))
        self.fill(
            "place", x=self.x([] if selection.place is None else [selection.place])
        )
        self.draw("exact", *joined([(c.across, c.up[:, column]) for c in exact]))
        past = None
        if ghost is not None:
            other = selection.interface_of(ghost.run)
            past = ghost.contact.get(other)
            places = ghost.run.interfaces[other].positions
            column = ghost.run.column(selection.phase)
        self.draw("ghost", *_curves(places, past, column), self.ghost_name)
        self._show_beside(frame, float(run.instants[run.column(selection.phase)]))

    def _scale(
        self, frame: Frame, name: str, fields: InterfaceFields, exact: list[Floats]
    ) -> None:
        """Hold all that is known, and of iterates what does not dwarf it."""
        run = frame.run
        key = (*frame.stage[:2], name)
        bound = frame.run.interfaces[name].bound
        known = run.reference.get(name, fields if bound is None else None)
        if bound is None:
            bounds = []
        else:
            bounds = [bound, -bound]
        low, high = extent([*_given(known), *exact, *bounds])
        most = MOST * max(abs(low), abs(high))
        self.x.hold(key, run.interfaces[name].positions)
        self.y.hold(
            key, [ROOM * low, ROOM * high], np.clip(extent(_given(fields)), -most, most)
        )

    def _show_beside(self, frame: Frame, time: float) -> None:
        """Show another program's friction at its nearest instant, and name it."""
        results = (frame.extras.get("beside") or {}).get("brought")
        if not isinstance(results, OtherResults) or results.quantity != FRICTION:
            self.draw("beside", [], [])
            return
        near = results.times[np.abs(results.times - time).argmin()]
        rows = np.flatnonzero(results.times == near)
        rows = rows[np.argsort(results.positions[rows])]
        title = f"{results.source}, t = {near:.3g} s"
        self.draw("beside", results.positions[rows], results.values[rows], title)


def _curves(places: Floats, fields: InterfaceFields | None, column: int) -> Floats:
    """Friction, and pressure where it is not given, as one curve, shape (2, n)."""
    return joined([(places, field[:, column]) for field in _given(fields)])


def _given(fields: InterfaceFields | None) -> list[Floats]:
    if fields is None:
        both = []
    else:
        both = [fields.friction, fields.pressure]
    return [field for field in both if field is not None]
