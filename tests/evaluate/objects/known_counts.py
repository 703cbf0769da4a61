"""Counts and choices that are known where the lengths of arguments are, or that only the run knows."""
from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy as np

from tests.corpus import Case

X = np.array([1.3, 2.2, 0.7, 0.4, 1.6, 0.9])


class Polynomial:
    def __init__(self, c):
        self.c = tuple(c)

    def __call__(self, t):
        r = 0.0
        for a in reversed(self.c):
            r = r * t + a
        return r

    def derivative(self):
        return Polynomial(i * a for i, a in enumerate(self.c) if i)

    def __mul__(self, other):
        r = [0.0] * (len(self.c) + len(other.c) - 1)
        for (i, a), (j, b) in itertools.product(enumerate(self.c), enumerate(other.c)):
            r[i + j] += a * b
        return Polynomial(r)


def polynomials(x):
    p = Polynomial(x[:3])
    return (p * p.derivative())(0.5) + p(x[3])


def list_of_an_array(x):
    xs = list(x)
    xs.insert(1, x[0] * 2.0)
    xs.pop()
    xs.extend([3.0, x[2]])
    return sum(v * (i + 1) for i, v in enumerate(xs))


@dataclass(frozen=True)
class Circle:
    r: float


@dataclass(frozen=True)
class Rectangle:
    w: float
    h: float


def area(shape):
    match shape:
        case Circle(r=r):
            return np.pi * r ** 2
        case Rectangle(w, h) if w > h:
            return w * h
        case Rectangle(w=w, h=h):
            return w + h


def guards_of_cases(x):
    return area(Circle(x[0])) + 2.0 * area(Rectangle(x[1], x[2])) + 3.0 * area(Rectangle(x[2], x[1]))


def cases_of_numbers(x):
    s = 0.0
    for k in range(6):
        match int(x[k] * 2.0):
            case 0 | 1:
                s += x[k]
            case 2 if x[k] > 1.2:
                s += 2.0 * x[k] ** 2
            case 3:
                s += np.sin(x[k])
            case _:
                s -= x[k] ** 3
    return s


@functools.cache
def binomial(n, k):
    return 1 if k in (0, n) else binomial(n - 1, k - 1) + binomial(n - 1, k)


@functools.cache
def squared(v):
    return v * v


def behind_caches(x):
    @functools.cache
    def cubed(v):
        return v * squared(v) + np.sin(v)
    return sum(binomial(5, k) * x[k] * 0.3 ** k for k in range(6)) + squared(x[0]) * squared(x[1]) + cubed(x[2])


def cases():
    for kernel in (polynomials, list_of_an_array, guards_of_cases, cases_of_numbers, behind_caches):
        yield Case(kernel, (X,), "x")
