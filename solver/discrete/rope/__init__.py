"""Ropes: helical wires around a core, and the forces that they pass on."""
