"""A block is pressed on a wavy support and sheared; its other sides are free."""

import numpy as np

from solver import Latin, Stack, discretise, solve
from solver.discrete import Side, SideComponent, Support
from solver.latin import Auto, Stop

times = np.linspace(0.0, 1.0, 41)
x = np.linspace(0.0, 0.1, 49)
pressed = SideComponent(prescribed=True, mean=-4e-6 * np.minimum(4 * times, 1.0))
sheared = SideComponent(prescribed=True, mean=2e-6 * np.sin(2 * np.pi * times))
block = Stack(
    length=0.1,
    height=0.05,
    elements=(48, 24),
    substructures=(4, 2),
    young=210e9,
    poisson=0.3,
    instants=times,
    duration=1.0,
    support=Support(gap=1e-6 * np.sin(40 * np.pi * x) ** 2, friction=0.3),
    sides={"top": Side(x=sheared, y=pressed)},
)
method = Latin(direction=Auto(scale=0.5), stop=Stop(accuracy=0.001, iterations=200))
solution = solve(discretise(block), method)
support = solution.iterate.contact("support")
shear = np.abs(support.tangential_force.sum(axis=0))
bound = 0.3 * support.normal_force.sum(axis=0)

print("status:", solution.status.ending)
print("largest shear, N:", shear.max())
print("largest shear over friction:", np.max(shear[1:] / bound[1:]))
for instant in (1, 10):
    share = np.mean(support.status[:, instant] == 2)
    print(f"share that is open at {times[instant]:g} s:", share)
