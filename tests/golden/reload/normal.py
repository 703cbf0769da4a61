"""Normal form."""

import math


def kernel(a):
    for j in range(a.shape[0]):
        a_here = a[j, j]
        sqrt_value = math.sqrt(a_here)
        a[j, j] = sqrt_value
        for i in range(j + 1, a.shape[0]):
            a_here_2 = a[i, j]
            a_here_3 = a[j, j]
            ratio = a_here_2 / a_here_3
            a[i, j] = ratio
            a_here_4 = a[i, j]
            a[i, i] -= a_here_4 * a_here_4
