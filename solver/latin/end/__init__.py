"""The end of a run: stop rules, error estimate, status step, certified answer."""
