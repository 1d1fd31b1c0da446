"""Colours of a report's curves."""

from app.views.colors import GREY
from solver.study.figure_data import HUES

COLORS = (GREY, *HUES)
"""By the hue of a curve."""
