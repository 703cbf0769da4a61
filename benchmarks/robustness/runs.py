"""Long, stiff and chaotic runs: kernels, their starts, and gradients of many digits to compare with."""
from __future__ import annotations

import math
from collections.abc import Callable
from types import FunctionType, SimpleNamespace
from typing import Any

import numpy as np

import s2sad


def lorenz(u, steps, dt):
    """Runge and Kutta's four stages; gives the first coordinate at the end."""
    x, y, z = u[0], u[1], u[2]
    for _ in range(steps):
        a1, b1, c1 = 10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 * z / 3.0
        x2, y2, z2 = x + 0.5 * dt * a1, y + 0.5 * dt * b1, z + 0.5 * dt * c1
        a2, b2, c2 = 10.0 * (y2 - x2), x2 * (28.0 - z2) - y2, x2 * y2 - 8.0 * z2 / 3.0
        x3, y3, z3 = x + 0.5 * dt * a2, y + 0.5 * dt * b2, z + 0.5 * dt * c2
        a3, b3, c3 = 10.0 * (y3 - x3), x3 * (28.0 - z3) - y3, x3 * y3 - 8.0 * z3 / 3.0
        x4, y4, z4 = x + dt * a3, y + dt * b3, z + dt * c3
        a4, b4, c4 = 10.0 * (y4 - x4), x4 * (28.0 - z4) - y4, x4 * y4 - 8.0 * z4 / 3.0
        x = x + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        y = y + dt / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4)
        z = z + dt / 6.0 * (c1 + 2.0 * c2 + 2.0 * c3 + c4)
    return x


def swing(a, b, p, q):
    """The rates of a double pendulum of equal arms and masses: of its angles and of their momenta."""
    c, s = math.cos(a - b), math.sin(a - b)
    below = 16.0 - 9.0 * c * c
    da = 6.0 * (2.0 * p - 3.0 * c * q) / below
    db = 6.0 * (8.0 * q - 3.0 * c * p) / below
    dp = -0.5 * (da * db * s + 3.0 * 9.81 * math.sin(a))
    dq = -0.5 * (-da * db * s + 9.81 * math.sin(b))
    return da, db, dp, dq


def pendulum(u, steps, dt):
    """A double pendulum by Runge and Kutta's four stages; gives the upper angle at the end."""
    a, b, p, q = u[0], u[1], u[2], u[3]
    for _ in range(steps):
        a1, b1, p1, q1 = swing(a, b, p, q)
        a2, b2, p2, q2 = swing(a + 0.5 * dt * a1, b + 0.5 * dt * b1, p + 0.5 * dt * p1, q + 0.5 * dt * q1)
        a3, b3, p3, q3 = swing(a + 0.5 * dt * a2, b + 0.5 * dt * b2, p + 0.5 * dt * p2, q + 0.5 * dt * q2)
        a4, b4, p4, q4 = swing(a + dt * a3, b + dt * b3, p + dt * p3, q + dt * q3)
        a = a + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        b = b + dt / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4)
        p = p + dt / 6.0 * (p1 + 2.0 * p2 + 2.0 * p3 + p4)
        q = q + dt / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4)
    return a


def robertson(k, steps, dt):
    """Robertson's stiff reactions, by implicit steps that Newton's method solves three times each."""
    x, y, z = 1.0, 0.0, 0.0
    for _ in range(steps):
        u, v = x, y
        for _ in range(3):
            w = z + dt * k[2] * v * v
            f = u - x + dt * (k[0] * u - k[1] * v * w)
            g = v - y - dt * (k[0] * u - k[1] * v * w - k[2] * v * v)
            fu, fv = 1.0 + dt * k[0], -dt * k[1] * (w + v * 2.0 * dt * k[2] * v)
            gu = -dt * k[0]
            gv = 1.0 - dt * (-k[1] * (w + v * 2.0 * dt * k[2] * v) - 2.0 * k[2] * v)
            below = fu * gv - fv * gu
            u, v = u - (f * gv - fv * g) / below, v - (fu * g - f * gu) / below
        z = z + dt * k[2] * v * v
        x, y = u, v
    return x + 1e4 * y


def brusselator(p, steps, dt):
    """The Brusselator's two reactions by explicit steps, over many of its cycles."""
    u, v = p[2], p[3]
    for _ in range(steps):
        change = u * u * v
        u, v = u + dt * (p[0] + change - (p[1] + 1.0) * u), v + dt * (p[1] * u - change)
    return u + v


def shock(u, c, steps):
    """Advection with a minmod limiter around a ring: a jump that stays sharp."""
    n = u.size
    slope = np.zeros(n)
    flux = np.zeros(n)
    for _ in range(steps):
        for i in range(n):
            left, right = u[i] - u[i - 1], u[(i + 1) % n] - u[i]
            if left * right <= 0.0:
                slope[i] = 0.0
            elif abs(left) < abs(right):
                slope[i] = left
            else:
                slope[i] = right
        for i in range(n):
            flux[i] = u[i] + 0.5 * (1.0 - c) * slope[i]
        for i in range(n):
            u[i] = u[i] - c * (flux[i] - flux[i - 1])
    return np.sum(u * u)


def relaxation(x, steps, dt):
    """A long loop whose steps forget: x follows a target."""
    level = x[0]
    for _ in range(steps):
        level = level + dt * (x[1] - level * level * level)
    return level


START = np.array([1.0, 1.0, 1.0])
SWING = np.array([2.5, 2.5, 0.0, 0.0])
RATES = np.array([0.04, 1e4, 3e7])
CYCLE = np.array([1.0, 2.5, 1.0, 1.0])


def ring(n: int) -> np.ndarray:
    """A jump and a hill, with the wave in its values that keeps differences apart."""
    x = np.arange(n) / n
    return np.where(np.abs(x - 0.3) < 0.1, 1.0, 0.0) + np.exp(-200.0 * (x - 0.7) ** 2) + 0.01 * np.sin(7.0 * x)


# name: the kernel, its arguments for a number of steps
RUNS: dict[str, tuple[Callable[..., Any], Callable[[int], tuple[Any, ...]]]] = {
    "lorenz": (lorenz, lambda steps: (START, steps, 0.01)),
    "pendulum": (pendulum, lambda steps: (SWING, steps, 0.01)),
    "robertson": (robertson, lambda steps: (RATES, steps, 0.1)),
    "brusselator": (brusselator, lambda steps: (CYCLE, steps, 0.01)),
    "shock": (shock, lambda steps: (ring(64), 0.4, steps)),
    "relaxation": (relaxation, lambda steps: (np.array([2.0, 0.5]), steps, 1e-3)),
}


def both(name: str, steps: int, engine: str) -> tuple[np.ndarray, np.ndarray]:
    """The gradient by the adjoint, and by a tangent for each element (of at most four)."""
    kernel, arguments = RUNS[name]
    given = arguments(steps)
    function = s2sad.differentiate(kernel, engine=engine)
    first = kernel.__code__.co_varnames[0]
    adjoint = s2sad.gradient(function, wrt=first)(*given)
    tangents = []
    for k in range(min(4, given[0].size)):
        direction = np.zeros(given[0].size)
        direction[k] = 1.0
        tangents.append(s2sad.jvp(function, given, {first: direction})["return"])
    return np.asarray(adjoint), np.asarray(tangents, dtype=float)


def disagreement(adjoint: np.ndarray, tangents: np.ndarray) -> float:
    """The largest difference of adjoint and tangent, over the gradient's largest element."""
    return float(np.max(np.abs(adjoint[:tangents.size] - tangents)) / np.max(np.abs(adjoint)))


def exact(name: str, steps: int, digits: int = 120) -> np.ndarray:
    """The gradient of the same steps from the same numbers (needs mpmath): by differences of many digits, of a kernel
    that writes arrays with 113 bits."""
    import mpmath
    kernel, arguments = RUNS[name]
    first, *rest = arguments(steps)
    if name == "shock":
        from benchmarks.precision import reference
        return reference.gradient(kernel, (first, *rest), ("u",))["u"]
    plain = _of_many_digits(kernel, SimpleNamespace(sin=mpmath.sin, cos=mpmath.cos))
    with mpmath.workdps(digits):
        step = mpmath.mpf(10) ** -(digits // 2)
        rest = [mpmath.mpf(r) if isinstance(r, float) else r for r in rest]
        found = []
        for k in range(first.size):
            values = []
            for sign in (1, -1):
                moved = [mpmath.mpf(float(v)) for v in first]
                moved[k] += sign * step
                values.append(plain(moved, *rest))
            found.append((values[0] - values[1]) / (2 * step))
        return np.array(found, dtype=object)


def _of_many_digits(kernel: Callable[..., Any], words: SimpleNamespace) -> Callable[..., Any]:
    """The kernel with other functions under `math`, and so the functions of this module that it calls."""
    space: dict[str, Any] = {**globals(), "math": words}
    for name, value in list(space.items()):
        if isinstance(value, FunctionType) and value.__module__ == __name__:
            space[name] = FunctionType(value.__code__, space, name)
    return space[kernel.__name__]
