"""Interface laws, vectorised: prescribed values, glued cuts, contact and friction."""

from solver.laws.contact import OPEN, Contact
from solver.laws.friction import Friction, FrictionLaw
from solver.laws.interface import Component, Interface
from solver.laws.linear import Dirichlet, Neumann, Perfect
from solver.laws.play import SlipFactor
from solver.laws.stiffness import BodyStiffness, NodalStiffness, RodStiffness
from solver.laws.unilateral import Unilateral

__all__ = [
    "OPEN",
    "BodyStiffness",
    "Component",
    "Contact",
    "Dirichlet",
    "Friction",
    "FrictionLaw",
    "Interface",
    "Neumann",
    "NodalStiffness",
    "Perfect",
    "RodStiffness",
    "SlipFactor",
    "Unilateral",
]
