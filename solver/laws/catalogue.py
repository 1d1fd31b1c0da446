"""The laws of friction that a scene may choose, by name."""

from __future__ import annotations

from solver.laws.compliant import Compliant
from solver.laws.coulomb import Coulomb
from solver.laws.tangential import FrictionLaw

FRICTION_LAWS: dict[str, type[FrictionLaw]] = {
    "coulomb": Coulomb,
    "compliant": Compliant,
}
"""Their attributes are named like the settings that choose them."""
