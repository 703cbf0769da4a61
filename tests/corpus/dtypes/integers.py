"""Integers and bools: what Python and NumPy compute with them, and what differs is refused."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case

WORD, FLAG = np.uint8(3), np.bool_(True)


def whole_numbers(x, level):
    h, fact, seed = 1.0 / 2 ** level, 1, 12345
    total = x[0] * 2 ** (-level) + x[1] * 10 ** -level * h
    for n in range(1, 2 ** level):
        fact *= n
        seed = (1103515245 * seed + 12345) % 2147483648
        total += (-1) ** n * x[0] ** n / fact * x[seed % 3]
    sides = (x > 0.5) + (x < 0.2)
    both = (x > 0.5) * (x < 0.8)
    return total + np.sum(sides * x ** 2) + np.sum(both * x) + np.sum(x[sides])


def negative(x, k):
    return x[0] * -k[0]


def swapped_bools(x, k):
    b, c = x[0] > 0.5, k.size > 5
    for i in range(2):
        b, c = c, b
        x[i] *= b + b + 1


def listed_bools(x, k):
    for i in range(2):
        x[i] *= ~[True, False][i]


def word(x, k):
    return x[0] * WORD


def flag(x, k):
    return x[0] * FLAG


def remainders(x, k, n):
    """Of the dividend's sign."""
    signed = np.fmod(k, 3)
    total = np.sum(signed * x) + math.fmod(n, 3) * x[0] + np.fmod(n, 4) * x[1] + math.fmod(n, x[2])
    return total + x[k[np.fmod(n, 2)]] * np.fmod(k[0], -2) + np.sum(np.fmod(k, 2.5) * x)


def cases():
    yield Case(whole_numbers, (np.array([0.6, 0.1, 0.9]), 3), ("x",))
    yield Case(remainders, (np.array([0.6, 0.3, 0.9]), np.array([-7, 2, 1]), -7), ("x",))
    yield Case(listed_bools, (np.array([0.6, 0.1]), 3), ("x",), ("x",))
    for kernel, refused in (
            (negative,
             "S201 at `-k[0]`: the negative of uint8, which wraps around: convert first: k.astype(np.int64), or "
             "int(k[i])"),
            (swapped_bools,
             "S201 at `b + b`: the sum of two bools, which is a bool for NumPy's and a number for Python's: write "
             "int(a) + int(b), or a or b"),
            (word,
             "S201 at `WORD`: 'WORD' cannot be used in a kernel: it is an uint8: pass it as an argument, or make it "
             "a number or a NumPy array"),
            (flag,
             "S201 at `FLAG`: 'FLAG' cannot be used in a kernel: it is a bool: pass it as an argument, or make it a "
             "number or a NumPy array")):
        yield Case(kernel, (np.ones(2), np.array([200, 100], "uint8")), "x", refused=refused)
