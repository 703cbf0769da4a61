"""Kernels whose tapes depend on their loops in all the ways that loops have."""
from __future__ import annotations

import numpy as np


def triangle(u, n: int):
    s = 0.1
    for i in range(n):
        for j in range(i):
            s = np.sin(s) * u[j] + s * s
    return s


def tetrahedron(u, n: int):
    s = 0.1
    for i in range(n):
        for j in range(i):
            for k in range(j):
                s = np.sin(s) * u[k]
    return s


def backwards(u, n: int):
    s = 1.0
    for k in range(n, 0, -1):
        for j in range(k, 0, -2):
            s = np.sin(s) * u[j - 1]
    return s


def product(u, m):
    s = 1.0
    for j in range(m):
        s = s * s * u[j]
    return s


def helper_in_triangle(u, n: int):
    s = 0.0
    for k in range(n):
        s = s * s + product(u, k)
    return s


def twice(u, n: int):
    for _ in range(n):
        square(u)
        square(u)
    return product(u, min(3, u.size)) + product(u, n)


def square(u):
    for i in range(u.size):
        u[i] = u[i] * u[i]


def rows(data, columns, start, x):
    """The bounds of the inner loop are data."""
    s = 0.0
    for i in range(start.size - 1):
        for k in range(start[i], start[i + 1]):
            s = s * s + data[k] * x[columns[k]]
    return s


def every_tenth(u, n: int):
    s = 0.1
    for i in range(n):
        if i % 10 == 0:
            for _ in range(10):
                s = np.sin(s) * u[i]
        s = s * s
    return s


def large_ones(u, n: int):
    """Data decide how often the inner loop runs."""
    s = 0.1
    for i in range(n):
        k = 0
        if u[i] > 0.5:
            k = 8
        for _ in range(k):
            s = np.sin(s) * u[i]
        s = s * s
    return s


def until(u, dt, end):
    t = 0.0
    while t < end:
        u *= u
        t += dt
    return np.sum(u)


def leaves(u, n: int):
    s = 0.1
    for i in range(n):
        s = np.sin(s) * u[i]
        if s > 1e9:
            break
    return s


def wider(u, n: int):
    """An array of another size in each step."""
    s = 0.0
    for i in range(n):
        w = np.zeros(i + 1)
        for j in range(i + 1):
            w[j] = np.sin(u[j]) * s
        s = s + np.sum(w * w)
    return s


def swaps(u, v, n: int):
    for _ in range(n):
        for i in range(u.size):
            v[i] = u[i] * u[i]
        u, v = v, u
    return np.sum(u)


def whole_arrays(u, dt, n: int):
    for k in range(n):
        u[1:-1] = u[1:-1] + dt * (u[:-2] - 2.0 * u[1:-1] + u[2:]) * u[1:-1] ** 2
        for i in range(k):
            u[:i] = u[:i] * u[:i]
    return np.sum(u)


def large_state(u, steps: int):
    """Few steps of large arrays: intermediate results are most of what is held."""
    for _ in range(steps):
        u[...] = np.sin(u) * u + np.cos(u) * (u * u + 1.0)
    return np.sum(u)


def two_levels(u, n: int, m: int):
    for k in range(n):
        for j in range(m):
            u[...] = u * u * (1.0 + 0.01 * k * j)
    return np.sum(u)


def of_helper(u, n: int):
    return product(u, n)


def slower(u, dt, end):
    """Data decide how many steps there are."""
    t = 0.0
    while t < end:
        u *= u
        t += dt * (1.0 + u[0])
    return np.sum(u)


def down(u, dt, end):
    n = int(end)
    while 0 < n:
        u *= u
        n -= 3
    return np.sum(u)


def no_further(u, dt, end):
    t = 0.0
    while t + dt <= end:
        for i in range(u.size):
            u[i] = u[i] * np.cos(u[i] + t)
        t = t + dt
    return np.sum(u)


def or_left(u, dt, end):
    t = 0.0
    while t < end:
        u *= u
        t += dt
        if u[0] > 2.0:
            break
    return np.sum(u)


def never(u, dt, end):
    t = 0.0
    while t < end:
        u *= u
        t -= dt
        if u[0] < 0.5:
            t = end
    return np.sum(u)


def thickened(u, n: int):
    for _ in range(n):
        mean = 0.5 * (u[1:, 1:] + u[:-1, :-1])
        flux = mean ** 5
        u[1:-1, 1:-1] = flux[1:, 1:] + flux[:-1, :-1]
    return np.sum(u)
