"""Rectangular bodies on a grid: data, cuts, loads and the laws at their sides."""
