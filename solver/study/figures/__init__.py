"""The paper's figures: their runs, what is found in them, and how they are shown."""
