"""The laws of friction that a scene may choose, by name."""

from __future__ import annotations

from solver.laws.compliant import Compliant
from solver.laws.coulomb import Coulomb
from solver.laws.friction_law import FrictionLaw
from solver.laws.slip_dependent import SlipDependent

FRICTION_LAWS: dict[str, type[FrictionLaw]] = {
    "coulomb": Coulomb,
    "compliant": Compliant,
    "slip-dependent": SlipDependent,
}
"""Their attributes are named like the settings that choose them."""
