"""Calls of the user's functions: inlining, destination passing, specialization for aliases, path conditions."""
