"""A kernel that is given arrays, numbers and an integer, and one that is given a matrix."""
from __future__ import annotations


def scaled(v, u, k, n):
    s = 0.0
    for i in range(n):
        v[i] = k * u[i] ** 2
        s += v[i]
    return s


def product(v, a, x):
    for i in range(v.size):
        v[i] = 0.0
        for j in range(x.size):
            v[i] += a[i, j] * x[j]
