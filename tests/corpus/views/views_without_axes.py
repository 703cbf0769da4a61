"""Views without axes, which are numbers here: x[0, ...], np.squeeze(x[:1]), np.reshape(x[:1], ())."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.5, 1.2, -0.7, 0.9])


def only_read(x):
    c = x[0, ...]
    d = np.reshape(np.reshape(x[:1], (1, 1)), ()) * np.squeeze(x[1:2])
    y = c * d * x[..., 3]
    x[2] = 2.0 * d
    return y + x[2]


def read_before_the_store(x):
    c = x[2:3].reshape(())
    d = c * 2.0
    x[2] = 0.0
    return d * x[1] + float(np.squeeze(x[2:3]))


def array_written(x):
    c = x[0, ...]
    x[0] = 5.0 * x[1]
    return c * x[1]


def view_written(x):
    c = x[:1].squeeze()
    c *= 3.0
    return np.sum(x * x)


def under_two_names(x):
    c = x[0, ...] if x[1] > 0.0 else x[1, ...]
    d = c
    x[0] = 3.0
    return d * x[1]


def in_a_loop(x):
    s = 0.0
    for i in range(3):
        c = x[i:i + 1].reshape(())
        x[i] = c * x[i + 1]
        s += c
    return s


def first(x):
    return x[0, ...]


def of_a_function(x):
    c = first(x)
    x[0] = 5.0 * x[1]
    return c * x[1]


def add_one(c):
    c += 1.0
    return 0.0


def in_a_function(x):
    return add_one(x[0, ...]) + np.sum(x * x)


def written_row(x):
    m = np.atleast_1d(x[0, ...])
    m[0] = 5.0 * x[1]
    return np.sum(x * x)


def row_of_a_view(x):
    m = np.atleast_1d(np.squeeze(x[:1]))
    x[0] = 5.0 * x[1]
    return m[0] * x[1]


def repeated(x):
    c = np.broadcast_to(x[0, ...], (3,))
    x[0] = 5.0 * x[1]
    return np.sum(c * x[:3])


def the_same_array(x):
    c = np.asarray(x[0, ...], dtype=float)
    x[0] = 5.0 * x[1]
    return c * x[1]


def chosen(x):
    c = max(x[0, ...], x[1, ...])
    x[1] = 5.0 * x[2]
    return c * x[2]


def chosen_from_a_list(x):
    c = min([np.squeeze(x[:1]), np.squeeze(x[1:2]), 3.0]) or x[2, ...]
    x[0] = -2.0 * x[1]
    return c * x[3]


def sorted_items(x):
    c = np.squeeze(x[:1])
    d, e = sorted([c, x[1], 0.1])[:2]
    x[0] = 5.0 * x[1]
    return d * x[2] * e


def chosen_by_a_key(x):
    c = max([x[0, ...], x[1, ...]], key=lambda v: v * v)
    x[1] = 5.0 * x[2]
    return c * x[3]


def sorted_and_only_read(x):
    y = np.array([np.squeeze(x[:1]), x[1]])
    z = sorted([x[0, ...], x[2, ...]])
    return y[0] * y[1] * z[0]


def chosen_and_only_read(x):
    h = max(0.0, np.squeeze(x[:1]))
    k = np.atleast_1d(np.squeeze(x[1:2]))
    return h * k[0] + np.asarray(x[2, ...]) * np.sum(np.broadcast_to(x[0, ...], (3,)))


class Held:
    def __init__(self, x):
        self.c = x[0, ...]


def in_an_object(x):
    held = Held(x)
    x[0] = 5.0 * x[1]
    return held.c * x[1]


def cases():
    yield Case(only_read, (X,), "x", ("return", "x"))
    yield Case(read_before_the_store, (X,), "x")
    yield Case(chosen_and_only_read, (X,), "x")
    yield Case(sorted_and_only_read, (X,), "x")
    view = "a view without axes, x[0, ...] or np.squeeze(x[:1])"
    do = "take the element, x[0], or a number: float(...)"
    for kernel, place in ((array_written, "x[0] = 5.0 * x[1]"), (view_written, "c *= 3.0"),
                          (under_two_names, "x[0] = 3.0"), (in_a_loop, "x[i] = c * x[i + 1]"),
                          (in_an_object, "x[0] = 5.0 * x[1]"), (the_same_array, "x[0] = 5.0 * x[1]"),
                          (chosen, "x[1] = 5.0 * x[2]"), (sorted_items, "c"),
                          (chosen_by_a_key, "x[1] = 5.0 * x[2]"), (chosen_from_a_list, "x[0] = -2.0 * x[1]")):
        yield Case(kernel, (X,), refused=f"S201 at `{place}`: {view}, and it or its array is written: {do}")
    for kernel, place in ((written_row, "m[0] = 5.0 * x[1]"), (row_of_a_view, "x[0] = 5.0 * x[1]"),
                          (repeated, "x[0] = 5.0 * x[1]")):
        yield Case(kernel, (X,), refused=f"S201 at `{place}`: an array is written that NumPy shares with another one, "
                   "which is a view of it by a function: write into the array itself, or take a copy: np.copy(...)")
    yield Case(of_a_function, (X,), refused=f"S201 at `return x[0, ...]`: {view}, is returned to another function: "
               f"{do}")
    yield Case(in_a_function, (X,), refused=f"S201 at `add_one(x[0, ...])`: {view}, is given to a function that "
               f"adds to it in place: {do}")
