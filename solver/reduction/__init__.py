"""Model reduction: what the fields of an interface could be reduced to."""
