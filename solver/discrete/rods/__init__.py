"""Rods: data, and how they are cut."""
