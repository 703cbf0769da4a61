"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
"""

import numpy as np


def kernel_tangent(x, x_dot):
    total = 1.0
    total_dot = 0.0
    for i in range(x.size):
        part = x[i]
        part_dot = x_dot[i]
        for _ in range(i + 1):
            part_1 = part * np.cos(part)
            part_dot = np.cos(part) * part_dot - part * (np.sin(part) * part_dot)
            part = part_1
        total_1 = total * part
        total_dot = part * total_dot + total * part_dot
        total = total_1
    return (total_dot,)
