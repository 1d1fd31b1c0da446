"""From a structure as plain data to a discrete problem."""

from solver.discrete.problem import Problem

__all__ = ["Problem"]
