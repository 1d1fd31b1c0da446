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
        Lay angle alpha between wire and strand, rad, between 0 and pi / 2.
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
        return float(np.pi * self.radius / np.sin(self.lay))

    def angle(self, arc: Array) -> Array:
        """Give theta along the wire, rad, at arc lengths, m."""
        return np.asarray(self.start + arc * np.sin(self.lay) / self.radius)

    def body_force(self, arc: Array, curvature: Array) -> Array:
        """Give the force per length that stands for the stretch of what the wire lies on.

        It is d/ds(E A kappa R cos^2(alpha) cos(theta)), a change of curvature along the wire
        included, in differences of the elements' forces: equilibrium holds exactly on the mesh.

        Parameters
        ----------
        arc
            Arc lengths of the nodes, shape (n_nodes,), m.
        curvature
            Of the strand, 1/m, shape (n_instants,) where it is uniform, or (n_nodes, n_instants).

        Returns
        -------
        Shape (n_nodes, n_instants), N/m.
        """
        stuck = self.stuck_force(arc, curvature)
        middles = 0.5 * (stuck[1:] + stuck[:-1])
        middles = np.concatenate([stuck[:1], middles, stuck[-1:]])
        length = np.concatenate([[arc[0]], 0.5 * (arc[1:] + arc[:-1]), [arc[-1]]])
        return np.asarray(np.diff(middles, axis=0) / np.diff(length)[:, None])

    def stuck_force(self, arc: Array, curvature: Array) -> Array:
        """Give the change of the wire's force while all sticks, (n_nodes, n_instants), N."""
        stretch = self.stiffness * self.radius * np.cos(self.lay) ** 2
        along = stretch * np.cos(self.angle(arc))
        return np.asarray(along[:, None] * np.atleast_2d(curvature))

    def moment(self, arc: Array, slip: Array, curvature: Array) -> Array:
        """Give what the wire adds to the strand's moment, its mean along the wire.

        As many wires, evenly laid, have it together at every section of the strand.

        Parameters
        ----------
        arc
            Arc lengths of the nodes, shape (n_nodes,), m.
        slip
            Displacement of the wire on its support, shape (n_nodes, n_instants), m.
        curvature
            As in `body_force`.

        Returns
        -------
        Shape (n_instants,), N m.
        """
        stuck = self.stuck_force(arc, curvature)
        elements = np.diff(arc)[:, None]
        force = self.stiffness * np.diff(slip, axis=0) / elements + 0.5 * (stuck[1:] + stuck[:-1])
        angle = self.angle(arc)
        lever = np.diff(np.sin(angle))[:, None] * self.radius / np.sin(self.lay)
        whole = self.radius * np.cos(self.lay) * np.sum(force * lever, axis=0)
        return np.asarray(whole / (arc[-1] - arc[0]))
