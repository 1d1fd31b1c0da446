"""Strands of helical wires that are bent."""
