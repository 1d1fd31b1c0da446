"""Two bricks are pressed on each other, then moved at the top until they slide."""

import numpy as np

from solver import Stack, discretise, solve
from solver.discrete import Side, SideComponent
from solver.discrete.plane.rectangles.bricks import Brick

MU = 0.4
WIDTH = 0.2
PRESSURE = 1e5
"""Of friction; m; Pa."""

times = np.linspace(0.0, 1.0, 21)
still = SideComponent(prescribed=True, mean=0.0 * times)
moved = SideComponent(prescribed=True, mean=1e-4 * np.maximum(2.0 * times - 1.0, 0.0))
pressed = SideComponent(prescribed=False, mean=-PRESSURE * np.minimum(2.0 * times, 1.0))
pile = Stack(
    length=WIDTH,
    height=0.1,
    elements=(12, 6),
    substructures=(1, 1),
    bricks=[Brick(x=0, y=0, columns=12, rows=6), Brick(x=0, y=6, columns=12, rows=6)],
    young=5e9,
    poisson=0.2,
    friction=MU,
    instants=times,
    duration=1.0,
    sides={"bottom": Side(still, still), "top": Side(moved, pressed)},
)
problem = discretise(pile)
solution = solve(problem)
(joint,) = problem.contacts
shear = solution.iterate.contact(joint).tangential_force.sum(axis=0)

print("status:", solution.status.ending)
print("certified:", solution.is_certified)
print("shear over mu p b at the end:", np.abs(shear[-1]) / (MU * PRESSURE * WIDTH))
