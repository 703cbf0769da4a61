"""One name bound several times: each value has a name of its own where the reverse sweep reads it."""
import math


def kernel(a, b):
    z = a * b
    z = math.sin(z)
    z = z * z + a
    z *= b
    return z


ARGUMENTS = (0.7, -1.3)
WRT, OF = ("a", "b"), ("return",)
