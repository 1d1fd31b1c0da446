"""The two stages of an iteration, and their parts."""
