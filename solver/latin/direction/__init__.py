"""Search directions, and their updates during a run."""
