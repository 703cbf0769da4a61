"""Runge-Kutta's method of order 4 for a chain of equations."""
import numpy as np


def slopes(x, y, out):
    """y_0' = x_0 and y_i' = x_i y_{i-1}."""
    out[0] = x[0]
    out[1:] = x[1:] * y[:-1]


def primal(x, s: int):
    """y at t = 2 after s steps from y = 0."""
    h = 2.0 / s
    y = np.zeros(x.size)
    k1, k2, k3, k4 = np.empty(x.size), np.empty(x.size), np.empty(x.size), np.empty(x.size)
    for _ in range(s):
        slopes(x, y, k1)
        slopes(x, y + 0.5 * h * k1, k2)
        slopes(x, y + 0.5 * h * k2, k3)
        slopes(x, y + h * k3, k4)
        y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return y


def last(x, s: int):
    """The last element of y, whose gradient is asked for."""
    return primal(x, s)[-1]
