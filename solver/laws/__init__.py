"""Interface laws: what an interface is, and the pure function that obeys it, all points at once."""

from solver.laws.boundary import Dirichlet, Neumann
from solver.laws.contact import Contact
from solver.laws.friction import Friction
from solver.laws.perfect import Perfect

Interface = Perfect | Dirichlet | Neumann | Friction | Contact

__all__ = ["Contact", "Dirichlet", "Friction", "Interface", "Neumann", "Perfect"]
