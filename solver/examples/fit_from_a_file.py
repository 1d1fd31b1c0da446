"""Friction of a bar from a measured loop in a file; a closed form is the rig here."""

import tempfile
from pathlib import Path

import numpy as np

from solver.files.tables import read_table
from solver.scenes import CATALOGUE
from solver.study.fit import fit
from solver.study.measured_loop import CAN, loop_in

MU = 0.25
"""Friction of the rig, which the fit is to find; the settings begin at 0.4."""

settings = CATALOGUE["bar"].checked({"load": "ramp", "friction": 0.4, "elements": 100})
stiffness = settings.young * settings.section
force = np.linspace(0.0, settings.peak, 31)
displacement = force**2 / (2.0 * stiffness * MU * settings.pressure)
rows = [f"{1e3 * u:.8g},{f:.8g}" for u, f in zip(displacement, force, strict=True)]

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "rig.csv"
    file.write_text("\n".join(["travel [mm],load [N]", *rows, ""]), encoding="utf-8")
    table = read_table(file.read_bytes(), file.name, "--with", CAN)

measured = loop_in(table, settings.structure().axes)
found = fit(settings, measured, ["friction"])
(friction,) = found.nearest.values

print("read:", measured.message)
print("runs:", found.runs)
print("friction:", friction, "known:", MU)
print(f"margins: {found.lower[0]:.6g} to {found.upper[0]:.6g}")
print("distance:", found.nearest.distance)
