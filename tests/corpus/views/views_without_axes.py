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
    view = "a view without axes, x[0, ...] or np.squeeze(x[:1])"
    do = "take the element, x[0], or a number: float(...)"
    for kernel, place in ((array_written, "x[0] = 5.0 * x[1]"), (view_written, "c *= 3.0"),
                          (under_two_names, "x[0] = 3.0"), (in_a_loop, "x[i] = c * x[i + 1]"),
                          (in_an_object, "x[0] = 5.0 * x[1]")):
        yield Case(kernel, (X,), refused=f"S201 at `{place}`: {view}, and it or its array is written: {do}")
    yield Case(of_a_function, (X,), refused=f"S201 at `return x[0, ...]`: {view}, is returned to another function: "
               f"{do}")
    yield Case(in_a_function, (X,), refused=f"S201 at `add_one(x[0, ...])`: {view}, is given to a function that "
               f"adds to it in place: {do}")
