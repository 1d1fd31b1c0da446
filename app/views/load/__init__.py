"""Views of the load: what acts over time, its loop, its cycles."""
