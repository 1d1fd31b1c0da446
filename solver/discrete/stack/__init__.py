"""Rectangular bodies in the plane, one or several on each other."""
