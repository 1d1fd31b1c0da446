"""Interface laws: objects that own all that is said about them, all points at once."""

from solver.laws.around import Bodies, Rod
from solver.laws.boundary import Dirichlet, Neumann
from solver.laws.friction import OPEN, Friction
from solver.laws.interface import Component, Interface
from solver.laws.perfect import Perfect
from solver.laws.slack_spring import SlackSpring

__all__ = [
    "OPEN",
    "Bodies",
    "Component",
    "Dirichlet",
    "Friction",
    "Interface",
    "Neumann",
    "Perfect",
    "Rod",
    "SlackSpring",
]
