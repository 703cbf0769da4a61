"""Seeds that one number divides several times, or one that changes in between, beside values of the kernel."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def quotients(x, y, d, z):
    for i in range(x.shape[0]):
        z[i] = x[i] / y[i] / d


def divisor_moves(x, d, z):
    # one name, another number in each iteration and behind the first statement
    s = d
    for i in range(x.shape[0]):
        z[i] = x[i] / s
        s = s + 0.5 * x[i]
        z[i] = z[i] / s + x[i] / s


def place_of_a_quotient(x, d, z):
    # the place is found again with the digits that it had: 49 * (1 / 49) is less than 1
    for i in range(x.shape[0]):
        q = x[i] / d
        k = int(q)
        z[k] += q * q / d
        x[i] = z[k] / d


def divided_on_one_side(x, d, z):
    for i in range(x.shape[0]):
        if x[i] > 0.8:
            z[i] = x[i] / d + z[i] / (d * d)
        else:
            z[i] = x[i] * d


def divisor_of_a_loop(x, z):
    # bound by iterations, of which there may be none
    for k in range(x.shape[0] // 4):
        s = x[k] + 1.0
        for i in range(x.shape[0]):
            z[i] = z[i] / s + x[i]


def ratio_of(a, b):
    return a / b, b / a


def of_a_helper(x, z):
    for i in range(x.shape[0]):
        p, q = ratio_of(x[i], z[i])
        z[i] = p * q + p + q * q


def cases():
    rng = generator(81)

    def some(*shape):
        return rng.uniform(0.4, 1.2, shape)

    yield Case(quotients, (some(5), some(5), 1.7, np.zeros(5)), ("x", "y", "d"), ("z",))
    yield Case(divisor_moves, (some(5), 0.7, np.zeros(5)), ("x", "d"), ("z",))
    yield Case(place_of_a_quotient, (np.array([52.0, 99.0, 3.0]), 49.0, some(4)), ("x", "d", "z"), ("x", "z"))
    yield Case(divided_on_one_side, (some(6), 1.3, some(6)), ("x", "d", "z"), ("z",))
    for n in (3, 9):
        yield Case(divisor_of_a_loop, (some(n), some(n)), ("x", "z"), ("z",))
    yield Case(of_a_helper, (some(5), some(5)), ("x", "z"), ("z",))
    yield Case(quotients, (some(5).astype(np.float32), some(5).astype(np.float32), 1.7, np.zeros(5, np.float32)),
               ("x", "y", "d"), ("z",), options={"rtol": 2e-2})
