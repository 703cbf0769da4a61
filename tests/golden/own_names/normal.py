"""Normal form."""

import math


def kernel(u, seed):
    u_bar = math.sin(u[0])
    u_bar_1 = u_bar
    for np in range(1, u.size):
        u_bar_2 = u_bar_1 * u[np] * seed
        u_bar_1 = u_bar_2
    return u_bar_1
