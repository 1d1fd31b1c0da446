"""Interface laws: prescribed values, glued cuts, contact and friction, vectorised."""

from solver.laws.contact import OPEN, Contact
from solver.laws.friction import Friction, FrictionLaw
from solver.laws.interface import Component, Interface
from solver.laws.linear import Dirichlet, Neumann, Perfect
from solver.laws.play import SlipFactor
from solver.laws.stiffness import BeamStiffness, BodyStiffness, RodStiffness
from solver.laws.unilateral import Unilateral

__all__ = [
    "OPEN",
    "BeamStiffness",
    "BodyStiffness",
    "Component",
    "Contact",
    "Dirichlet",
    "Friction",
    "FrictionLaw",
    "Interface",
    "Neumann",
    "Perfect",
    "RodStiffness",
    "SlipFactor",
    "Unilateral",
]
