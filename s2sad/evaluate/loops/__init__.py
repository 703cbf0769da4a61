"""Loops, comprehensions and lists that are spelled out: everything that is gone through becomes a loop that counts."""
