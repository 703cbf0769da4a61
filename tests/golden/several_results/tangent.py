"""Tangent of kernel: d(return) / d(x).

Engine: NumPy. Level: plain. Arguments:
    x: float64[:], in
"""

# ruff: noqa: FURB136, RUF100

import numpy as np


def polar_tangent(a, a_dot, b, b_dot):
    """Tangent of polar: d(return 0, return 1) / d(a, b)."""
    result = np.hypot(a, b)
    return (
        result, np.arctan2(b, a), 2,
        a * a_dot / (1.0 if result == 0 else result) + b * b_dot / (1.0 if result == 0 else result),
        (a * b_dot / np.hypot(b, a) / np.hypot(b, a) if b_dot != 0.0 else 0.0) -
        (b * a_dot / np.hypot(b, a) / np.hypot(b, a) if a_dot != 0.0 else 0.0)
    )


def kernel_tangent(x, x_dot):
    radius, angle, count, radius_dot, angle_dot = polar_tangent(x[0], x_dot[0], x[1], x_dot[1])
    power = radius ** count
    return (
        (
            angle * (
                (0.0 if count == 0 else count * radius ** (count - 1) * radius_dot)
                if radius_dot != 0.0 else 0.0
            ) if angle != 0.0 else 0.0
        ) + (power * angle_dot if power != 0.0 else 0.0),
    )
