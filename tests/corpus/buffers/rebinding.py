"""Names that are bound to another array, in loops and branches."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.corpus.calls.array_results import M, U, V, Y, rhs, stepped


def time_loop(y, u, p, n):
    v = u.copy()
    for _ in range(n):
        v = v + 0.01 * rhs(v, p)
    w = u
    for _ in range(n):
        w = stepped(w, 0.1)
    y[:] = v + w


def swaps(y, u, v, n):
    a = u.copy()
    b = v * 2.0
    new = np.zeros_like(u)
    for _ in range(n):
        a, b = b, a * b
        for i in range(1, u.size - 1):
            new[i] = a[i] * a[i - 1] + a[i + 1]
        a, new = new, a
    y[:] = a + 3.0 * b


def previous(y, u, n):
    old = u
    err, k = 1.0, 0
    while err > 1e-3 and k < n:
        old = u
        u = stepped(u, 0.1)
        err = np.sum((u - old) ** 2)
        k += 1
    y[:] = u + old * err


def left_early(y, u, n):
    for _ in range(n):
        u = stepped(u, 0.2)
        if u[2] > 0.9:
            u = u * 2.0
            break
        u = u * u + 0.4
    y[:] = u


def branches(y, u, n, c):
    if c > 0.0:
        u = stepped(u, c)
    for s in range(n):
        if u[1] > 0.5:
            u = stepped(u, 0.2 * c)
        else:
            u = u * 0.9
        v = u[::-1]
        if s == 2:
            v = u
        u = v + 0.1
        u = u[::-1]
    y[:] = u


def nested_loops(y, u, m, n):
    r = m[0]
    for a in range(n):
        w = u
        for _ in range(2):
            w = stepped(w, 0.1)
        u = w * u
        y += r
        r = m[a] * u
    y[:] += u


# -- refusals ---------------------------------------------------------------------------------------------------------

def double_buffer_of_an_argument(y, u, n):
    new = np.zeros_like(u)
    for _ in range(n):
        for i in range(1, u.size - 1):
            new[i] = u[i] * u[i - 1] + u[i + 1]
        u, new = new, u
    y[:] = u


def written_in_the_first_turn(y, u, n):
    v = u
    for _ in range(n):
        v[0] = 0.0
        v = v * 2.0
    y[:] = v


def start_is_written(y, u, n):
    v = u
    for s in range(n):
        u[0] = u[0] * 0.5
        y[s] = v[0]
        v = v * 2.0


def one_array_twice(y, u, n):
    a = u.copy()
    b = u * 2.0
    for _ in range(n):
        a[0] += b[0]
        c = a * b
        a = c
        b = c
    y[:] = a + b


def row_of_the_matrix(y, m, n):
    r = m[0]
    for i in range(n):
        r[0] = 2.0 * r[1]
        y += r
        r = m[i]


def old_after_the_loop(y, u, n):
    for _ in range(n):
        old = u
        u = u * 2.0
    y[:] = old


def grown(y, u, n):
    for k in range(n):
        u = np.ones(k + 2) * u[0]
    y[0] = u[0]


def shrunk(y, u, n):
    for _ in range(n):
        u = u[1:] - u[:-1]
    y[0] = u[0]


def cases():
    yield Case(time_loop, (Y, U, np.array([0.3, 0.7]), 3), ("u", "p"), ("y",))
    yield Case(swaps, (Y, U, V, 3), ("u", "v"), ("y",))
    yield Case(previous, (Y, U, 3), ("u",), ("y",))
    for u, n in ((U, 4), (0.1 * U, 2)):
        yield Case(left_early, (Y, u, n), ("u",), ("y",))
    for n, c in ((4, 0.3), (0, -0.3)):
        yield Case(branches, (Y, U, n, c), ("u", "c"), ("y",))
    yield Case(nested_loops, (Y, U, M, 2), ("u", "m"), ("y",))
    for kernel in (grown, shrunk):
        yield Case(kernel, (Y, U, 2), ("u",), ("y",))
    # what is written before a name leaves an argument's array is written there
    yield Case(written_in_the_first_turn, (Y, U, 3), ("u",), ("y", "u"))
    # an argument may take turns with another array
    yield Case(double_buffer_of_an_argument, (Y, U, 3), ("u",), ("y", "u"))
    yield Case(start_is_written, (Y, U, 3), ("u",), ("y", "u"))
    for kernel, given, refused in (
            (one_array_twice, U,
             "S201 at `a[0] += b[0]`: an array is written that another name may stand for here, as it did before a "
             "loop or branch bound it anew: bind the name to a copy before the loop or branch: u = u.copy(); where "
             "names swap in a branch, swap what their arrays hold"),
            (row_of_the_matrix, M,
             "S201 at `r[0] = 2.0 * r[1]`: an array is written that another name may stand for here, as it did "
             "before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold"),
            (old_after_the_loop, U,
             "S201 at `old`: 'old' may stand for different arrays here: copy into one array with x[...] = ..., or "
             "use two names")):
        yield Case(kernel, (Y, given, 3), of=None, refused=refused)


