"""The square of a number."""


def square(x: float):
    """x^2."""
    return x * x
