"""What the solver is held to: closed forms, each with its source, beside what it finds."""
