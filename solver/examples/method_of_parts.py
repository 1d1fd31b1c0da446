"""The method is put together from parts: four of them come to one solution."""

import numpy as np

from solver import End, Latin, Rods, discretise, solve
from solver.latin import PGD, Anderson, Auto, Paper, StatusStep, Stop

PEAK = 900.0
STIFFNESS = 1e6
STRENGTH = 1500.0
"""Largest load, N; E S, N; friction, N/m."""

times = np.linspace(0.0, 1.0, 41)
bar = Rods(
    length=1.0,
    stiffness=STIFFNESS,
    elements=50,
    substructures=10,
    strength=np.full(51, STRENGTH),
    left=End(displacement=0.0 * times),
    right=End(force=PEAK * times),
    instants=times,
    duration=1.0,
)
problem = discretise(bar)
stop = Stop(accuracy=0.01, tolerance=1e-3, iterations=3000)
accelerated = Latin(Auto(), acceleration=Anderson(), finish=None, stop=stop)
METHODS = {
    "paper": Latin(Paper(), acceleration=None, finish=None, stop=stop),
    "accelerated": accelerated,
    "on modes": Latin(Auto(), PGD(modes=20), acceleration=None, finish=None, stop=stop),
    "status step": Latin(Auto(), finish=StatusStep(), stop=stop),
}
exact = PEAK**2 / (2.0 * STIFFNESS * STRENGTH)
for name, method in METHODS.items():
    solution = solve(problem, method)
    iterate = solution.iterate
    ratio = iterate.displacement[-1, -1] / exact
    ending = solution.status.ending
    print(
        f"{name}: {ending} in {iterate.number} iterations; ratio to exact: {ratio:.6f}"
    )
