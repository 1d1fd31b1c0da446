"""Interface laws: objects that own all that is said about them, all points at once."""

from solver.laws.around import Bodies, PointOfBody, Rod
from solver.laws.boundary import Dirichlet, Neumann
from solver.laws.compliant import Compliant
from solver.laws.contact import OPEN, Contact
from solver.laws.coulomb import Coulomb
from solver.laws.friction_law import FrictionLaw
from solver.laws.frictionless import Frictionless
from solver.laws.interface import Component, Interface, RowValues
from solver.laws.perfect import Perfect
from solver.laws.slack_spring import SlackSpring
from solver.laws.sliders import Sliders
from solver.laws.tangential import Tangential
from solver.laws.unilateral import Unilateral

__all__ = [
    "OPEN",
    "Bodies",
    "Compliant",
    "Component",
    "Contact",
    "Coulomb",
    "Dirichlet",
    "FrictionLaw",
    "Frictionless",
    "Interface",
    "Neumann",
    "Perfect",
    "PointOfBody",
    "Rod",
    "RowValues",
    "SlackSpring",
    "Sliders",
    "Tangential",
    "Unilateral",
]
