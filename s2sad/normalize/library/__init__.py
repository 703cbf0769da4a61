"""Calls of NumPy and SciPy in canonical form: one spelling, positional arguments, options as names with a rule."""
