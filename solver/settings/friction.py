"""Settings of the law of friction, which all scenes have."""

from __future__ import annotations

import numpy as np

from solver.laws import FrictionLaw, SlipFactor
from solver.refusal import plain
from solver.settings.definitions import ANY, CONTACT, Rows, TablePreset, properties_of
from solver.settings.method import MethodSettings

SHORTEST_SLIP = 1e-12
"""Smallest slip between two points of a strength, m."""
LARGEST_FACTOR = 1e3
"""Largest factor of a strength."""
STIFFNESSES = 1e-9, 1e9
"""Smallest and largest stiffness of contacts and springs, over the stiffness of bodies.
Beyond, no digits are left."""


STRENGTHS = {
    "constant": TablePreset(
        "1, whatever has slipped", lambda settings: settings.strength_points()
    ),
    "linear": TablePreset(
        "from 1 evenly to friction_ratio at slip_length, where it stays",
        lambda settings: settings.strength_points(),
    ),
}


class FrictionSettings(MethodSettings):
    """Settings of the law of friction, beside the coefficient."""

    friction_law = CONTACT.choice(
        "coulomb",
        ["coulomb", "compliant", "slip-dependent", "general"],
        "coulomb: a point sticks until the friction force reaches its bound. "
        "compliant: it gives way like a spring before it slips (Jenkins' element), as "
        "in joints and fretting. slip-dependent: its bound grows or falls with the "
        "slip that has gone by, as when surfaces run in. general: all of that "
        "together, with its stiffness in absolute units, and cohesion and a cap.",
    )
    contact_stiffness = CONTACT.quantity(
        100.0,
        (1e-3, 1e9),
        (1.0, 1e4),
        "Stiffness of that spring, as a multiple of E S / L² along a rod, with the "
        "harmonic mean S of its elements, or of E / L in the plane, with the E of the "
        "stiffest body; of all wires of a rope alike, as a multiple of the stiffest "
        "E S over the square of the longest L.",
        applies=lambda settings: settings.friction_law == "compliant",
    )
    tangential_stiffness = CONTACT.quantity(
        0.0,
        (0.0, 1e18),
        (1e4, 1e9),
        "Stiffness of a spring along the interface, in series with friction, per "
        "length of rod: a bond, a soft layer. 0: rigid.",
        unit="N/m^2",
        applies=lambda settings: settings.is_general,
    )
    cohesion = CONTACT.quantity(
        0.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Friction force per length of rod without any pressure, beside μ p.",
        title="Cohesion c",
        unit="N/m",
        applies=lambda settings: settings.is_general,
    )
    friction_cap = CONTACT.quantity(
        0.0,
        (0.0, 1e15),
        (0.0, 5000.0),
        "Largest friction force per length of rod that pressure and cohesion make, "
        "before slip. 0: none.",
        unit="N/m",
        applies=lambda settings: settings.is_general,
    )
    strength = CONTACT.curve(
        "constant",
        STRENGTHS,
        {"slip": "m", "factor": ""},
        "Factor on the largest friction force over the accumulated slip of a point: a "
        "preset, or points (m, factor), the first (0, 1), such as a peak, softening "
        "and a residual; the last one stays.",
        bounds=(ANY, (0.0, LARGEST_FACTOR)),
        title="Strength over slip",
        applies=lambda settings: settings.is_general,
    )

    friction_ratio = CONTACT.quantity(
        1.5,
        (0.0, 1e3),
        (0.5, 2.0),
        "Last friction over the first: above 1 it hardens with slip, below it softens.",
        title="Last friction over first",
        applies=lambda settings: settings.is_linear_in_slip,
    )
    slip_length = CONTACT.quantity(
        1e-4,
        (1e-12, 1e6),
        (1e-6, 1e-2),
        "Accumulated slip of a point at which its friction is the last.",
        unit="m",
        applies=lambda settings: settings.is_linear_in_slip,
    )

    @property
    def is_general(self) -> bool:
        """Check whether the friction law is the general one, with all its parts."""
        return bool(self.friction_law == "general")

    @property
    def is_linear_in_slip(self) -> bool:
        """Check whether friction changes with slip by a ratio over a length."""
        by_ratio = self.is_general and self.strength == "linear"
        return by_ratio or bool(self.friction_law == "slip-dependent")

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`: N/m^2 along rods, N/m^3 in the plane."""
        raise NotImplementedError

    @property
    def law(self) -> FrictionLaw:
        """Law of friction, without mu."""
        if self.friction_law == "compliant":
            return FrictionLaw(stiffness=self.contact_stiffness * self.contact_unit)
        is_given = self.is_general and self.strength != "constant"
        slip_factor = None
        # A strength that stays 1 is no strength: then no slip is accumulated.
        if self.is_linear_in_slip or is_given:
            slips, factors = zip(*self.strength_points(), strict=True)
            slip_factor = SlipFactor(slips, factors)
        if not self.is_general:
            return FrictionLaw(slip_factor=slip_factor)
        return FrictionLaw(
            stiffness=self.tangential_stiffness or np.inf,
            cohesion=self.cohesion,
            cap=self.friction_cap or np.inf,
            slip_factor=slip_factor,
        )

    def strength_points(self) -> Rows:
        """Points (slip, factor) of the strength, from its table or preset."""
        table: str | Rows = self.strength
        if self.is_linear_in_slip:
            return (0.0, 1.0), (self.slip_length, self.friction_ratio)
        if isinstance(table, str):
            return (0.0, 1.0), (self.slip_length, 1.0)
        return table

    def check_together(self) -> None:
        """Refuse a strength that does not begin at 1, too soft or too stiff contact."""
        super().check_together()
        if not self.is_general:
            return
        self._check_strength()
        stiffnesses = {"tangential_stiffness", "normal_stiffness"}
        for name in self.definitions().keys() & stiffnesses:
            self.check_digits(
                name,
                self.contact_unit,
                "write 0 where nothing gives way, or take away friction where nothing "
                "holds",
            )

    def _check_strength(self) -> None:
        """Refuse a table that does not begin at (0, 1), or has slips too close."""
        table = self.strength
        if isinstance(table, str):
            return
        begins = len(table) > 1 and table[0] == (0.0, 1.0)
        if not begins or np.diff(np.array(table)[:, 0]).min() < SHORTEST_SLIP:
            raise self.refusal(
                "strength",
                "at least two points (slip, factor), the first (0, 1), and slips that "
                f"grow by {plain(SHORTEST_SLIP)} m",
                "the factor at slip 0 is 1, as the rest of the law says what friction "
                "is there",
            )

    def check_digits(self, name: str, stiffness: float, remedy: str) -> None:
        """Refuse a stiffness that vanishes by rounding beside that of the bodies."""
        # Beyond these bounds the spring, or the body, has no digit left in their sum.
        value = getattr(self, name)
        definition = self.definitions()[name]
        unit = properties_of(definition).unit
        low, high = (share * stiffness for share in STIFFNESSES)
        if self.applies(name) and value and not low <= value <= high:
            none = "0, or " if definition.bounds[0] == 0.0 else ""
            ends = f"from {plain(low)} {unit} to {plain(high)} {unit}"
            raise self.refusal(name, f"{none}{ends} with such bodies", remedy)
