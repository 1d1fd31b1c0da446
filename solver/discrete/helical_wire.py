"""A helical wire of a strand that is bent, as a rod on a support that is stretched with it.

Plane sections of the strand stay plane, so a curvature kappa stretches what the wire lies on by
kappa R cos^2(alpha) cos(theta) along the wire, with theta the polar angle at which the wire stands.
Of the wire's displacement only what it slips on its support is unknown, and that is a rod's on a
rigid support under the body force that the support's stretch brings about (K.-O. Papailiou, On the
bending stiffness of transmission line conductors, IEEE Trans. Power Delivery 12, 1997). Its growth
of tension by friction (the capstan term) is left out, as are wires beside each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solver.arrays import Array


@dataclass(frozen=True)
class HelicalWire:
    """A wire on the cylinder of a strand.

    Attributes
    ----------
    stiffness
        Axial stiffness E A of the wire, N.
    radius
        Of the helix of its centre line, R, m.
    lay
        Lay angle alpha between wire and strand, rad, above 0 in size and below pi / 2; negative if
        theta falls along the wire.
    start
        Polar angle theta at the wire's beginning, from the outermost fibre, rad.
    """

    stiffness: float
    radius: float
    lay: float
    start: float = 0.0

    @property
    def half_pitch(self) -> float:
        """Length of wire over which it goes half round the strand, m."""
        return float(np.pi * self.radius / abs(np.sin(self.lay)))

    def angle(self, arc: Array) -> Array:
        """Theta along the wire, rad, at arc lengths, m."""
        return np.asarray(self.start + arc * np.sin(self.lay) / self.radius)

    def body_force(self, arc: Array, curvature: Array) -> Array:
        """Force per length that stands for the stretch of what the wire lies on.

        It is d/ds(E A kappa R cos^2(alpha) cos(theta)), a change of curvature along the wire
        included, in differences of the elements' forces: equilibrium holds exactly on the mesh.
        Shape (n_nodes, n_instants), N/m, from the arc lengths of the nodes, m, and the curvature of
        the strand, 1/m, of shape (n_instants,) where it is uniform, or (n_nodes, n_instants).
        """
        stuck = self.stuck_force(arc, curvature)
        middles = 0.5 * (stuck[1:] + stuck[:-1])
        middles = np.concatenate([stuck[:1], middles, stuck[-1:]])
        length = np.concatenate([[arc[0]], 0.5 * (arc[1:] + arc[:-1]), [arc[-1]]])
        return np.asarray(np.diff(middles, axis=0) / np.diff(length)[:, None])

    def stuck_force(self, arc: Array, curvature: Array) -> Array:
        """Change of the wire's force while all sticks, (n_nodes, n_instants), N."""
        stretch = self.stiffness * self.radius * np.cos(self.lay) ** 2
        along = stretch * np.cos(self.angle(arc))
        return np.asarray(along[:, None] * np.atleast_2d(curvature))

    def mean_levers(self, arc: Array) -> Array:
        """What a newton in each element adds to the mean moment of the strand, N m.

        As many wires, evenly laid, have that moment together at every section. `arc` as in
        `body_force`; shape (n_elements,), m.
        """
        around = np.diff(np.sin(self.angle(arc))) * self.radius / np.sin(self.lay)
        return np.asarray(self.radius * np.cos(self.lay) * around / (arc[-1] - arc[0]))

    def levers_at_beginning(self, arc: Array) -> Array:
        """What a newton in each element adds to the moment at the wire's beginning, N m.

        The force there follows from the first two elements, in whose middles it is known. `arc` as
        in `body_force`; shape (n_elements,), m.
        """
        levers = np.zeros(len(arc) - 1)
        shares = np.array([1.5, -0.5])[: len(levers)]
        arm = self.radius * np.cos(self.lay) * np.cos(self.start)
        levers[:2] = arm * shares / shares.sum()
        return levers
