"""Normal form."""

import math


def kernel(x):
    total = 1.0
    total_1 = total
    for i in range(x.size):
        part = x[i]
        part_1 = part
        for _ in range(i + 1):
            part_2 = part_1 * math.cos(part_1)
            part_1 = part_2
        total_2 = total_1 * part_1
        total_1 = total_2
    return total_1
