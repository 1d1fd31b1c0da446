"""The two stages of an iteration, and what they are made of."""
