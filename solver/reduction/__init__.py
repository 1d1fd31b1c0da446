"""Model reduction: compact forms of the fields of an interface."""
