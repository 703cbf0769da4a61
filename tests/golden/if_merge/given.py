"""Names bound in both branches, in one, and in none."""
import math


def kernel(a, b):
    c = a
    if b > 0.0:
        c = a * b
        d = math.sin(c)
    elif a > 0.0:
        d = c * b
    else:
        d = 2.0
    return c * d


ARGUMENTS = (0.7, -1.3)
WRT, OF = ("a", "b"), ("return",)
