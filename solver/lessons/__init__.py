"""Lessons: data files that are read, checked against the engine, and shown by the page."""
