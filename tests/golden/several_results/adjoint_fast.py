"""Adjoint of kernel: d(return) / d(x).

Engine: Numba. Level: fast. Arguments:
    x: float64[:], in

It records nothing.
"""

# ruff: noqa: FURB136, RUF100

import math

import numpy as np


def polar(a, b):
    return math.hypot(a, b), math.atan2(b, a), 2


def polar_adjoint(a, b, result_0_bar, result_1_bar):
    """Adjoint of polar: d(return 0, return 1) / d(a, b)."""
    # forward sweep: only what the reverse sweep reads
    result = math.hypot(a, b)
    # reverse sweep
    # return math.hypot(a, b), math.atan2(b, a), 2
    reciprocal = 1.0 / np.hypot(b, a)
    b_bar = a * result_1_bar * reciprocal * reciprocal if result_1_bar != 0.0 else 0.0
    a_bar = -(b * result_1_bar * reciprocal * reciprocal if result_1_bar != 0.0 else 0.0)
    reciprocal_2 = 1.0 / (1.0 if result == 0 else result)
    a_bar += a * result_0_bar * reciprocal_2
    b_bar += b * result_0_bar * reciprocal_2
    return a_bar, b_bar


def kernel_adjoint(x, x_bar, result_bar):
    # forward sweep: only what the reverse sweep reads
    argument = x[0]
    argument_2 = x[1]
    radius, angle, count = polar(argument, argument_2)
    # reverse sweep
    # return radius ** count * angle
    power_bar = angle * result_bar
    angle_bar = radius ** count * result_bar
    radius_bar = (
        (0.0 if count == 0 else count * radius ** (count - 1) * power_bar) if power_bar != 0.0
        else 0.0
    )
    # radius, angle, count = polar(x[0], x[1])
    gain, gain_2 = polar_adjoint(argument, argument_2, radius_bar, angle_bar)
    x_bar[1] += gain_2
    x_bar[0] += gain
