"""Contact forces along an interface, with the reference and other results."""

from __future__ import annotations

import numpy as np

from app.frame import Floats, Frame, FrictionInterface, InterfaceFields, Run, Selection
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
from app.views.parts import hover, joined
from app.views.view import View
from solver.reference.closed_forms import ExactCurve
from solver.study.comparison import FRICTION, OtherResults

ROOM = 0.05
"""Room at the ends of the axis of forces, as a share of its length."""
RUBBED = "±µp"
HELD = "most friction"
"""Names of the largest friction: of µ times the pressure, and of other laws."""


class ContactForce(View):
    """Contact forces at the selected instant: LATIN, the reference, the error shaded.

    In plane bodies whose pressure is not given these are pressure and friction.
    """

    name = "Contact force"
    needs = frozenset({"beside"})

    def make(self) -> None:
        """Draw curves of LATIN, the reference, the strength and other results."""
        plot = self.begin(("x", "m"), ("force", "N/m"))
        # From the bottom to the top: LATIN's curves lie on all others.
        self.add("cuts", "VSpan", "x", color=CUT, alpha=0.4, line_width=1)
        self.add("position", "VSpan", "x", color=ERROR, alpha=0.7, line_width=1)
        self.add("exact", color=EXACT, width=8, alpha=0.35)
        area = {"y1": "reference", "y2": "latin", "color": ERROR, "alpha": 0.35}
        for name in ("friction", "pressure"):
            self.add("error", "VArea", "x", also="latin reference", on=name, **area)
        self.add("bound", color=REFERENCE, dash="dashed")
        self.add("ghost", color=GHOST, width=2, dash="dotted")
        self.add("reference", color=REFERENCE, width=1.5)
        self.add("beside", color=BESIDE, width=2, dash="dashed")
        pressure = self.add("pressure", y="latin", color=PRESSURE, width=2.5)
        friction = self.add("friction", y="latin", color=LATIN, width=2.5)
        self.legend(
            friction="LATIN",
            pressure="pressure",
            reference="reference",
            error="error",
            bound=RUBBED,
            exact="closed form",
            ghost="ghost",
            beside="beside",
        )
        tips = {
            "x": "@x{0.000}",
            "LATIN": "@latin{0.000}",
            "reference": "@reference{0.000}",
        }
        hover(plot, [pressure, friction], tips)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the contact forces along the selected interface."""
        run = frame.run
        name = run.interface(selection.interface)
        fields = frame.contact.get(name)
        # Where fields are large a frame has the interface that was selected then.
        if fields is None:
            return
        interface = run.interfaces[name]
        column = run.column(selection.phase)
        if run.settings.kind == "plane":
            self.y.rename("traction", "Pa")
        else:
            self.y.rename("force", "N/m")
        self.x.rename(run.x_title(name), "m")
        exact = _closed_forms(run, name, has_pressure=fields.pressure is not None)
        self._scale(frame, name, fields, [curve.up for curve in exact])
        self._show_forces(interface, fields, run.reference.get(name), column)
        title = HELD
        if run.settings.law.is_by_pressure_alone:
            title = RUBBED
        self._show_strength(interface, fields, column, title)
        self.fill("cuts", x=self.x(interface.cuts))
        self.fill("position", x=self.x(selection.marked))
        curves = [(curve.across, curve.up[:, column]) for curve in exact]
        self.draw("exact", *joined(curves))
        self._show_ghost(ghost, selection)
        self._show_beside(frame, float(run.instants[column]))

    def _show_forces(
        self,
        interface: FrictionInterface,
        fields: InterfaceFields,
        reference: InterfaceFields | None,
        column: int,
    ) -> None:
        """Show the forces of the iterate and the reference, with their difference."""
        positions = interface.positions
        has_pressure = fields.pressure is not None
        for quantity in ("friction", "pressure"):
            latin = getattr(fields, quantity)
            # Without a reference the difference is zero.
            known = getattr(reference or fields, quantity)
            if latin is None:
                latin = known = np.zeros((0, column + 1))
            title = quantity if has_pressure else "LATIN"
            self.fill(
                quantity,
                title,
                x=self.x(positions[: len(latin)]),
                latin=self.y(latin[:, column]),
                reference=self.y(known[:, column]),
            )
        self.draw("reference", *_curves(positions, reference, column))
        self.show("error", reference is not None)

    def _show_strength(
        self,
        interface: FrictionInterface,
        fields: InterfaceFields,
        column: int,
        title: str,
    ) -> None:
        """Show the largest friction in both directions, of the law or by µ alone."""
        strength = fields.bound
        if strength is None:
            strength = interface.strength
        if strength is None:
            strength = interface.coefficient * np.maximum(fields.pressure, 0.0)
        # A strength that does not change has a single column.
        strength = strength[:, min(column, strength.shape[1] - 1)]
        positions = interface.positions
        curves = [(positions, strength), (positions, -strength)]
        self.draw("bound", *joined(curves), title)

    def _show_ghost(self, ghost: Frame | None, selection: Selection) -> None:
        if ghost is None:
            self.clear("ghost")
            return
        run = ghost.run
        name = run.interface(selection.interface)
        positions = run.interfaces[name].positions
        column = run.column(selection.phase)
        curve = _curves(positions, ghost.contact.get(name), column)
        self.draw("ghost", *curve, self.ghost_name)

    def _scale(
        self, frame: Frame, name: str, fields: InterfaceFields, exact: list[Floats]
    ) -> None:
        """Set the limits to known curves, and to the iterate."""
        run = frame.run
        key = (*frame.stage[:2], name)
        strength = run.interfaces[name].strength
        known = run.reference.get(name)
        strengths = []
        if strength is not None:
            strengths = [strength, -strength]
        elif known is None:
            known = fields
        curves = [*_given(known), *exact, *strengths]
        self.x.hold(key, run.interfaces[name].positions)
        self.y.hold(key, *curves, iterate=_given(fields), margin=ROOM)

    def _show_beside(self, frame: Frame, time: float) -> None:
        """Show another program's friction at the instant nearest to a time, s."""
        results = (frame.extras.get("beside") or {}).get("brought")
        is_shown = isinstance(results, OtherResults) and results.quantity == FRICTION
        if not is_shown or not len(results.times):
            self.clear("beside")
            return
        near = results.times[np.abs(results.times - time).argmin()]
        rows = np.flatnonzero(results.times == near)
        rows = rows[np.argsort(results.positions[rows])]
        title = f"{results.source}, t = {near:.3g} s"
        self.draw("beside", results.positions[rows], results.values[rows], title)


def _closed_forms(run: Run, name: str, *, has_pressure: bool) -> list[ExactCurve]:
    """Closed forms of the contact forces along an interface at all instants."""
    curves = run.known("friction")
    if has_pressure:
        curves = curves + run.known("pressure")
    of_interface = [curve for curve in curves if curve.interface in ("", name)]
    fields = [curve for curve in of_interface if curve.up.ndim == 2]
    return [curve for curve in fields if curve.across.ndim == 1]


def _curves(positions: Floats, fields: InterfaceFields | None, column: int) -> Floats:
    """Friction and, if a result, pressure as one curve, m and N/m or Pa, (2, n)."""
    return joined([(positions, field[:, column]) for field in _given(fields)])


def _given(fields: InterfaceFields | None) -> list[Floats]:
    """Friction and, if a result, pressure, shape (n_points, n_instants) each."""
    if fields is None:
        return []
    if fields.pressure is None:
        return [fields.friction]
    return [fields.friction, fields.pressure]
