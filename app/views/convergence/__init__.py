"""Views of how far a run is, over iterations and over time."""
