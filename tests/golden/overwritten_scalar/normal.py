"""Normal form."""

import math


def kernel(a, b):
    z = a * b
    z_1 = math.sin(z)
    z_2 = z_1 * z_1 + a
    z_3 = z_2 * b
    return z_3
