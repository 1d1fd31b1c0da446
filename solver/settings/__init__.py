"""Settings: their definitions, and those that all scenes share."""
