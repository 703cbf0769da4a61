"""A function that returns an array, in a file of its own, with a constant of its own."""
from __future__ import annotations

FACTOR = 3.0


def scaled(u, factor):
    """The array times two numbers."""
    return FACTOR * factor * u
