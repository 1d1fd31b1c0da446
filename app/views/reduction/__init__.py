"""Views of reduced bases: modes, singular values, fronts as clips."""
