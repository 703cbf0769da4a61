"""The saddle of a function of two points, the minimum of a maximum, each by gradient descent."""
import numpy as np

from benchmarks.gradbench.written import written


def value(p, q):
    """p^2 - q^2."""
    return p[0] * p[0] + p[1] * p[1] - (q[0] * q[0] + q[1] * q[1])


value_adjoint = written(value, "adjoint", "q", (np.ones(2), np.ones(2)))
value_tangent = written(value, "tangent", "q", (np.ones(2), np.ones(2)))


def reverse(p, q, out):
    """Writes the gradient of the value for q, by its adjoint."""
    out[:] = 0.0
    value_adjoint(p, q, out, 1.0)


def forward(p, q, out):
    """Writes the gradient of the value for q, by its tangents."""
    (out[0],) = value_tangent(p, q, np.array([1.0, 0.0]))
    (out[1],) = value_tangent(p, q, np.array([0.0, 1.0]))


def highest(p, start, slope):
    """The largest value for a given p, by gradient ascent from the start: the rate halves where the value would fall,
    and doubles after ten steps."""
    q, new, gradient = start.copy(), np.empty(2), np.empty(2)
    rate, steps, found = 1e-5, 0, value(p, q)
    slope(p, q, gradient)
    while np.sqrt(gradient[0] ** 2 + gradient[1] ** 2) > 1e-5:
        if steps == 10:
            rate, steps = 2.0 * rate, 0
            continue
        new[:] = q + rate * gradient
        if np.sqrt((new[0] - q[0]) ** 2 + (new[1] - q[1]) ** 2) <= 1e-5:
            break
        next_found = value(p, new)
        if next_found > found:
            q[:], found, steps = new, next_found, steps + 1
            slope(p, q, gradient)
        else:
            rate, steps = 0.5 * rate, 0
    return found
