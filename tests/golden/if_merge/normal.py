"""Normal form."""

import math


def kernel(a, b):
    c = a
    taken = b > 0.0
    if taken:
        c_1 = a * b
        d = math.sin(c_1)
        c_2 = c_1
        d_4 = d
    else:
        taken_2 = a > 0.0
        if taken_2:
            d_1 = c * b
            d_3 = d_1
        else:
            d_2 = 2.0
            d_3 = d_2
        c_2 = c
        d_4 = d_3
    result = c_2 * d_4
    return result
