"""Spellings that mean no more than plainer ones: texts of errors and of print, and what NumPy is to warn of."""
# ruff: noqa: UP031, UP032
from __future__ import annotations

import numpy as np

from tests.corpus import Case

V = np.array([0.3, 1.2, 0.8, 2.0])


def texts(x, n, name="it"):
    if n < 0:
        raise ValueError("bad %d in %s" % (n, name))
    if n > 100:
        raise ValueError("bad {} ".format(n) + str(n))
    assert n < 50, "n is " + str(n)
    return np.sum(x * x) * n


def printed(x, n):
    print("n=%d %.3e" % (n, x[0]))
    print("s: {}".format(n), "plain", "a" + str(n), f"{n}!")
    return np.sum(x * x)


def quiet(x):
    with np.errstate(divide="ignore", invalid="ignore"):
        y = np.where(x > 0, 1.0 / x, 0.0)
        z = y * y
    return np.sum(z)


def quiet_in_a_loop(x):
    t = 0.0
    for i in range(x.size):
        with np.errstate(all="ignore"):
            if x[i] < 0.5:
                continue
            t += np.sqrt(x[i])
    return t


def compared(x):
    s = f"{x[0]}"
    return x[0] if s == "0.7" else x[1]


def searched(x):
    s = f"{x[0]}"
    return x[0] if "7" in s else x[1]


def cases():
    # gradients
    for kernel, arguments in ((texts, (V, 3)), (printed, (V, 3)), (quiet, (V,)), (quiet_in_a_loop, (V,))):
        yield Case(kernel, arguments, ("x",))
    for kernel, place in ((compared, 's == "0.7"'), (searched, '"7" in s')):
        yield Case(kernel, (V,), ("x",), refused=(
            f"S201 at `{place}`: a text of what only the run knows is compared: keep a number that says the same, and "
            "compare that"))
