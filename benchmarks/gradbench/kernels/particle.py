"""A charged particle between two charges, one of which is moved by a control w until the particle hits the origin."""
import numpy as np

from benchmarks.gradbench.written import written


def potential(x, w: float):
    """The electric potential at x of the charges at (10, 10 - w) and (10, 0)."""
    return 1.0 / np.hypot(x[0] - 10.0, x[1] - (10.0 - w)) + 1.0 / np.hypot(x[0] - 10.0, x[1])


potential_adjoint = written(potential, "adjoint", "x", (np.ones(2), 0.0))
potential_tangent = written(potential, "tangent", "x", (np.ones(2), 0.0))


def reverse(x, w, out):
    """Writes the gradient of the potential, by its adjoint."""
    out[:] = 0.0
    potential_adjoint(x, out, w, 1.0)


def forward(x, w, out):
    """Writes the gradient of the potential, by its tangents."""
    (out[0],) = potential_tangent(x, np.array([1.0, 0.0]), w)
    (out[1],) = potential_tangent(x, np.array([0.0, 1.0]), w)


def miss(w: float, slope):
    """The square of the place where the particle crosses the x axis: Euler's method, then a straight line."""
    x, v, new, force = np.array([0.0, 8.0]), np.array([0.75, 0.0]), np.empty(2), np.empty(2)
    while True:
        new[:] = x + 0.1 * v
        if new[1] <= 0.0:
            break
        slope(x, w, force)
        v -= 0.1 * force
        x[:] = new
    return (x[0] - x[1] / v[1] * v[0]) ** 2
