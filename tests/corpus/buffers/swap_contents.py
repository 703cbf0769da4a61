"""Names that swap their arrays in a branch."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.8, 0.2, 0.4])


def in_a_loop(x, n):
    a, b = x.copy(), x * 2.0
    for _ in range(n):
        if a[0] > b[0]:
            a, b = b, a
        r = a[1:]
        r += 0.1 * b[:-1] ** 2
        a[0] += 0.35
        b = a * 0.5 + b
    return a, np.sum(a * b ** 2)


def in_several_branches(x, n):
    a, b = np.outer(x, x), np.zeros((x.size, x.size))
    for i in range(n):
        for j in range(2):
            if a[i, j] > 0.2:
                a, b = b, a
            b[i] += a[j] ** 2 + x
        if i == 1:
            t = a
            a = b
            b = t
    return np.sum(a * b)


def view_before(x, n):
    a, b = x.copy(), x * 2.0
    r = a[1:]
    for k in range(n):
        if k % 2 == 0:
            a, b = b, a
        a[1:] += 0.1 * b[:-1] ** 2
        r[0] += 1.0 * x[1]
    return np.sum(a * b ** 2)


def argument(x, n):
    b = x * 2.0
    a = x
    for k in range(n):
        if k % 2 == 0:
            a, b = b, a
        a[1:] += 0.1 * b[:-1] ** 2
    return np.sum(a * b ** 2)


def third_name(x, n):
    a, b = x.copy(), x * 2.0
    c = a
    for k in range(n):
        if k % 2 == 0:
            a, b = b, a
        a[1:] += 0.1 * b[:-1] ** 2
    return np.sum(a * b ** 2) + c[0]


def in_a_list(x, n):
    a, b = x.copy(), x * 2.0
    us = []
    for k in range(n):
        us.append(a)
        if k % 2 == 0:
            a, b = b, a
        a[0] += 0.1 * b[0] ** 2
    return np.sum(us[0] * us[1]) + a[0]


def name_kept(x, n):
    a, b = x.copy(), x * 2.0
    t = a
    for k in range(n):
        if k % 2 == 0:
            t = a
            a = b
            b = t
        a[0] *= 3.0 + t[0]
    return np.sum(a * b * b) + t[1]


def of_two_sizes(x, n):
    a, b = x[:1].copy(), x * 2.0
    for k in range(n):
        if k % 2 == 0:
            a, b = b, a
        a[0] += 0.1 * b[0] ** 2
    return np.sum(a) * np.sum(b ** 2)


def cases():
    for kernel in (in_a_loop, in_several_branches):
        yield Case(kernel, (X, 4), ("x",))
    for kernel, refused in (
            (view_before,
             "S201 at `a[1:] += 0.1 * b[:-1] ** 2`: an array is written that another name may stand for here, as it "
             "did before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold\nS201 at `r[0] += 1.0 * x[1]`: an "
             "array is written that another name may stand for here, as it did before a loop or branch bound it "
             "anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a branch, "
             "swap what their arrays hold"),
            (argument,
             "S201 at `a[1:] += 0.1 * b[:-1] ** 2`: an array is written that another name may stand for here, as it "
             "did before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold"),
            (third_name,
             "S201 at `a[1:] += 0.1 * b[:-1] ** 2`: an array is written that another name may stand for here, as it "
             "did before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold"),
            (in_a_list,
             "S201 at `us.append(a)`: a list holds an array that is written, not a copy of it: append a copy: "
             ".append(x.copy())"),
            (name_kept,
             "S201 at `a[0] *= 3.0 + t[0]`: an array is written that another name may stand for here, as it did "
             "before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold")):
        yield Case(kernel, (X, 4), of=None, refused=refused)
    # arrays of different sizes
    yield Case(of_two_sizes, (X, 3), "x", refused=(
            "S501 at `a`: names swap arrays of different sizes in a branch: a.shape is (1,), b.shape is (6,): swap "
            "what arrays of one size hold"))
