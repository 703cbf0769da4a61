"""Integers that are recorded where the next iteration changes them: within a byte, at its limits, or of any size."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def turned(x, n):
    state, y = 0, 0.4
    for _ in range(n):
        if y > 0.5:
            state = (state + 3) % 5
        y = np.sin(1.3 * y + x[state])
    return y


def summed_behind(x, n):
    # two bytes whose sum is none
    a, b, y = 100, 100, 0.4
    for _ in range(n):
        if y > 0.5:
            a, b = 127 - b % 50, 90 + a % 30
        y = np.sin(1.3 * y + x[(a + b) % x.size] * (a + b) * 0.01 + a * b * 1e-4)
    return y


def below_zero(x, n):
    k, y = -1, 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[k])
        k = -2 if y > 0.5 else -(k % 4) - 1
    return y


def largest(x, n):
    # the place of the largest of nine, of an array that the next iteration fills again
    w, y = np.zeros(9), 0.4
    for _ in range(n):
        for j in range(9):
            w[j] = np.sin(y * j)
        k = np.argmax(w)
        y = np.sin(0.9 * y + 0.5 * x[k % x.size] + 0.01 * w[k] * k)
    return y


def trips_of_a_byte(x, n):
    y = 0.4
    for _ in range(n):
        for _ in range(127):
            y = np.sin(1.3 * y + x[0])
            if y > 0.5:
                break
    return y


def trips_of_more(x, n):
    # 200 trips are none of a byte's
    y = 0.4
    for k in range(n):
        for _ in range(200):
            y = np.sin(0.9 * y + 0.1 * x[k % x.size])
            if y > 2.0:
                break
    return y


def converted(x, n):
    k, y = 0, 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[k])
        k = int(y > 0.5)
    return y


NARROW = {turned: "int8", summed_behind: "int8", below_zero: "int8", largest: "int8", trips_of_a_byte: "int8",
          trips_of_more: "int16", converted: "int8"}


def counted(x, n):
    k, y = 0, 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[k % x.size])
        if y > 0.5:
            k = k + 1
    return y


def just_too_large(x, n):
    # 128 is none of a byte's, and neither is what is added to a byte
    k, y = 127, 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[k % x.size] + k * 0.001)
        if y > 0.5:
            k = 128 if k == 127 else 127
    return y


def as_given(x, n, k):
    y = 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[k % x.size] + k * 1e-4)
        if y > 0.5:
            k = (k + 3) % 5
    return y


def tested_before(x, n):
    # what is known of a name is not known of what it is bound to next
    k, y = 0, 0.4
    for i in range(n):
        if k < 100:
            k = 100 * i
            m = k
            y = np.sin(1.3 * y + x[m % x.size] + m * 1e-4)
        else:
            y = np.sin(y + x[k % x.size] + k * 1e-4)
            k = k - 90
    return y


def of_each_other(x, n):
    # either is bound to the other, and one grows
    a, b, y = 1, 2, 0.4
    for _ in range(n):
        y = np.sin(1.3 * y + x[(a + b) % x.size] + a * 1e-3)
        if y > 0.3:
            a, b = b, a + b % 7
    return y


WIDE = (counted, as_given, tested_before, of_each_other)


def cases():
    x = generator(3).random(5) + 0.2
    for kernel in (*NARROW, just_too_large, counted, tested_before, of_each_other):
        yield Case(kernel, (x, 40), ("x",), ("return",))
    yield Case(as_given, (x, 40, 1000), ("x",), ("return",))
