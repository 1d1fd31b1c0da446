"""A wire between two others is broken: friction gives its force back to both sides."""

import numpy as np

from solver import End, Rods, discretise, solve

TENSION = 600.0
STRENGTH = 1500.0
STIFFNESS = 659_400.0
ELEMENTS = 60
"""Of every wire, N; friction at an interface, N/m; E S of a wire, N."""

times = np.linspace(0.0, 1.0, 21)
strand = Rods(
    length=1.0,
    stiffness=STIFFNESS,
    elements=ELEMENTS,
    substructures=6,
    strength=np.full(ELEMENTS + 1, STRENGTH),
    wires=3,
    broken=(2, ELEMENTS // 2),
    left=End(displacement=0.0 * times),
    right=End(force=TENSION * times),
    instants=times,
    duration=1.0,
)
solution = solve(discretise(strand))

# Points stand wire after wire, and the break has two of them: the second wire has one
# more.
displacement = solution.iterate.displacement[ELEMENTS + 1 : 2 * ELEMENTS + 3, -1]
left = displacement[: ELEMENTS // 2 + 1]
force = STIFFNESS * np.diff(left) * ELEMENTS
middle = (np.arange(ELEMENTS // 2) + 0.5) / ELEMENTS
exact = np.minimum(TENSION, 2.0 * STRENGTH * (0.5 - middle))

print("status:", solution.status.ending)
print("force beside the break, N:", force[-1])
print("largest distance over the tension:", np.abs(force - exact).max() / TENSION)
