"""Friction along the interface beside the reference, and what lies between them."""

from __future__ import annotations

import numpy as np
from bokeh.plotting import figure

from app.frame import ContactFields, Floats, Frame, Interface, Run, Selection
from app.views.colors import BESIDE, CUT, ERROR, EXACT, GHOST, LATIN, PRESSURE, REFERENCE
from app.views.view import Axis, Key, View, extent, hover, key_of, plot, put, source
from solver.scenes import kind_of

ROOM, MOST = 1.15, 2.0
"""What is seen of forces, over their bound or reference: at least, and at most."""


class ContactForce(View):
    """Contact forces at the selected instant, LATIN on top of the reference, the error shaded.

    Of plane bodies whose pressure is not given they are pressure and friction.
    """

    name = "Contact force"
    needs = frozenset({"beside"})

    def make(self) -> figure:
        """A new figure."""
        made = plot("", "")
        self._x, self._y = Axis(made, "x", "x", "m"), Axis(made, "y", "force", "N/m")
        self.friction, self.pressure = (source("x", "latin", "reference") for _ in range(2))
        self.bound, self.cuts = source("x", "upper", "lower"), source("x")
        self.exact, self.ghost = source("xs", "ys"), source("xs", "ys")
        self.beside, self.place = source("x", "y"), source("x")
        made.vspan("x", source=self.cuts, color=CUT, alpha=0.4, line_width=1)
        made.vspan("x", source=self.place, color=ERROR, alpha=0.7, line_width=1)
        both = self.friction, self.pressure
        exact = made.multi_line("xs", "ys", source=self.exact, color=EXACT, width=8, alpha=0.35)
        areas = [
            made.varea("x", "reference", "latin", source=each, color=ERROR, alpha=0.35)
            for each in both
        ]
        bounds = [
            made.line("x", side, source=self.bound, color=REFERENCE, dash="dashed")
            for side in ("upper", "lower")
        ]
        ghost = made.multi_line("xs", "ys", source=self.ghost, color=GHOST, width=2, dash="dotted")
        references = [
            made.line("x", "reference", source=each, color=REFERENCE, width=1.5) for each in both
        ]
        beside = made.line("x", "y", source=self.beside, color=BESIDE, width=2, dash="dashed")
        pressure = made.line("x", "latin", source=self.pressure, color=PRESSURE, width=2.5)
        latin = made.line("x", "latin", source=self.friction, color=LATIN, width=2.5)
        entries = {
            "LATIN": [latin],
            "pressure": [pressure],
            "reference": references,
            "error": areas,
            "±µp": bounds,
            "closed form": [exact],
            "ghost": [ghost],
            "beside": [beside],
        }
        self._key = Key(made, entries)
        tips = {"x": "@x{0.000}", "LATIN": "@latin{0.000}", "reference": "@reference{0.000}"}
        hover(made, [latin, pressure], tips)
        self._scaled_for: object = None
        return made

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the contact forces along the selected interface."""
        run, name = frame.run, selection.interface_of(frame.run)
        fields, interface = frame.contact.get(name), run.interfaces[name]
        if fields is None:
            return
        column, reference = run.column(selection.phase), run.reference.get(name)
        is_plane, has_pressure = kind_of(run.settings) == "plane", fields.pressure is not None
        self._y.rename("traction" if is_plane else "force", "Pa" if is_plane else "N/m")
        bound = _bound(interface, fields)
        curves = run.known("friction") + (run.known("pressure") if has_pressure else [])
        exact = [curve for curve in curves if curve.across.ndim == 1 and curve.up.ndim == 2]
        self._scale(run, name, fields, [curve.up for curve in exact])
        x = self._x(interface.positions)
        for target, quantity in ((self.friction, "friction"), (self.pressure, "pressure")):
            latin, known = getattr(fields, quantity), getattr(reference, quantity, None)
            if latin is None:
                put(target, x=x[:0], latin=x[:0], reference=x[:0])
                continue
            latin = self._y(latin[:, column])
            known = latin if known is None else self._y(known[:, column])
            put(target, x=x, latin=latin, reference=known)
        limit = self._y(bound[:, min(column, bound.shape[1] - 1)])
        put(self.bound, x=x, upper=limit, lower=-limit)
        put(self.cuts, x=self._x(interface.cuts))
        put(self.place, x=self._x([] if selection.place is None else [selection.place]))
        put(
            self.exact,
            xs=[self._x(curve.across) for curve in exact],
            ys=[self._y(curve.up[:, column]) for curve in exact],
        )
        self._show_ghost(ghost, selection, is_plane=is_plane)
        beside = self._show_beside(frame, float(run.instants[column]))
        self._key.show(
            {
                "LATIN": "friction" if has_pressure else "LATIN",
                "pressure": has_pressure,
                "reference": reference is not None,
                "error": reference is not None,
                "closed form": bool(exact),
                "ghost": self.ghost_name if self.ghost.data["xs"] else "",
                "beside": beside,
            }
        )

    def _scale(self, run: Run, name: str, fields: ContactFields, exact: list[Floats]) -> None:
        """Hold all that is known, and of iterates what does not dwarf it."""
        key = (*key_of(run), name)
        if key != self._scaled_for:
            known = run.reference.get(name, fields)
            bound = run.interfaces[name].bound
            ends = [known.friction, *exact, *([] if known.pressure is None else [known.pressure])]
            self._known = extent([*ends, *([] if bound is None else [bound, -bound])])
            self._scaled_for = key
            self._x.hold(key, *extent([run.interfaces[name].positions]))
        low, high = self._known
        most = MOST * max(abs(low), abs(high))
        least, largest = extent([f for f in (fields.friction, fields.pressure) if f is not None])
        low, high = min(ROOM * low, max(least, -most)), max(ROOM * high, min(largest, most))
        self._y.hold(key, low, high)

    def _show_ghost(self, ghost: Frame | None, selection: Selection, *, is_plane: bool) -> None:
        fields = None
        if ghost is not None and (kind_of(ghost.run.settings) == "plane") == is_plane:
            name = selection.interface_of(ghost.run)
            fields = ghost.contact.get(name)
        if ghost is None or fields is None:
            put(self.ghost, xs=[], ys=[])
            return
        x, column = ghost.run.interfaces[name].positions, ghost.run.column(selection.phase)
        shown = [field for field in (fields.friction, fields.pressure) if field is not None]
        put(
            self.ghost,
            xs=[self._x(x)] * len(shown),
            ys=[self._y(field[:, column]) for field in shown],
        )

    def _show_beside(self, frame: Frame, time: float) -> str:
        """Show another program's friction at its nearest instant, and name it."""
        beside = frame.extras.get("beside")
        if beside is None or beside["quantity"] != "friction force":
            put(self.beside, x=[], y=[])
            return ""
        times = np.asarray(beside["t"])
        near = times[np.abs(times - time).argmin()]
        rows = times == near
        x, y = np.asarray(beside["x"])[rows], np.asarray(beside["values"])[rows]
        order = np.argsort(x)
        put(self.beside, x=self._x(x[order]), y=self._y(y[order]))
        return f"{beside.get('name', 'another program')}, t = {near:.3g} s"


def _bound(interface: Interface, fields: ContactFields) -> Floats:
    """Largest friction, shape (n_points, n_instants) or (n_points, 1)."""
    if interface.bound is not None:
        return interface.bound
    assert interface.coefficient is not None
    assert fields.pressure is not None
    return interface.coefficient * np.maximum(fields.pressure, 0.0)
