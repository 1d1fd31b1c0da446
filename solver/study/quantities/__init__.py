"""What a run is asked for: each quantity once, and what it is taken from."""
