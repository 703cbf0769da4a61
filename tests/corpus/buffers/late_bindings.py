"""Arrays that only some iterations of a loop bind, and that are read behind them."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 1.1, 0.7, 0.9])
Y = np.array([0.5, 1.5, 1.1, 2.0])


def best_so_far(x, y):
    least, best = np.inf, None
    for k in range(4):
        z = x * y[k]
        loss = np.sum((z - 1.0) ** 2)
        if loss < least:
            least = loss
            best = z.copy()
    return least + best[0]


def best_in_a_while(x, y):
    best, k = -1.0, 0
    while k < y.size:
        z = np.sin(x) * y[k]
        if z[0] > best:
            best, chosen = z[0], z
        k += 1
    return chosen @ x


def last_hit(x, y):
    hit = None
    for k in range(4):
        if x[k] > 0.5:
            hit = x * y
            hit[k] *= x[0]
    return np.sum(hit ** 2) if hit is not None else 0.0


class Search:
    def __init__(self):
        self.best, self.chosen = np.inf, None

    def tell(self, z):
        if z[0] < self.best:
            self.best, self.chosen = z[0], z


def of_an_object(x, y):
    search = Search()
    for k in range(4):
        search.tell(x * y[k] + y[::-1])
    search.chosen[1] *= 3.0
    return np.sum(search.chosen ** 2)


def in_each_round(x, y):
    s = 0.0
    for t in range(3):
        best = 0.0
        for k in range(y.size):
            z = np.outer(x, y[k:k + 1])[:, 0] + t
            if z[1] > best:
                best, chosen = z[1], z
        s += chosen @ x
    return s


def read_in_later_rounds(x, y):
    s = 0.0
    for k in range(4):
        if k > 0:
            s += chosen[0] * x[k]      # noqa: F821
        if k == 0 or x[k] > 0.8:
            chosen = x * y[k]
    return s + chosen[1]


def written_behind_the_loop(x, y):
    best = None
    for k in range(4):
        if x[k] > 0.5:
            best = x * y[k]
    best[1:] = x[0]
    best[0] += y[1]
    return best @ x


def of_two_sizes(x, y):
    best = 0.0
    for k in range(4):
        z = x * y[k]
        if z[0] > best:
            best, chosen = z[0], z
        elif z[0] < 0.1:
            chosen = z[1:]
    return best + chosen[0]


def an_array_that_is_written_later(x, y):
    w, best = x * 2.0, 0.0
    for k in range(4):
        z = x * y[k] if k > 1 else w
        if z[0] > best:
            best, chosen = z[0], z
        w[0] += x[1]
    return best + chosen[0]


def cases():
    for kernel in (best_so_far, best_in_a_while, last_hit, of_an_object, in_each_round, read_in_later_rounds,
                   written_behind_the_loop):
        yield Case(kernel, (X, Y), ("x", "y"))
    yield Case(of_two_sizes, (X, Y), refused=(
        "S201 at `chosen`: 'chosen' may stand for different arrays here: copy into one array with x[...] = ..., or use "
        "two names"))
    yield Case(an_array_that_is_written_later, (X, Y), refused=(
        "S201 at `w[0] += x[1]`: an array is written that another name may stand for here, as it did before a loop or "
        "branch bound it anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
        "branch, swap what their arrays hold"))
