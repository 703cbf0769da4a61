"""Names that stand for one array or another, as a branch says, and are written."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.9, 0.7, 0.8, 0.2, 0.4])


def moved(dst, src):
    dst[1:] = src[:-1] ** 2 + dst[1:]


def chosen(a, b, k):
    if k % 2 == 0:
        w = a
    else:
        w = b
    w[0] += a[1] * b[2]
    return w


def in_turn(a, b, n):
    for k in range(n):
        if k % 2 == 0:
            src, dst = a, b
        else:
            src, dst = b, a
        for i in range(1, a.size - 1):
            dst[i] = 0.5 * (src[i - 1] + src[i + 1]) + src[i] ** 2
        dst[0] = src[1] ** 2
        if dst[0] > 0.5:
            continue
        moved(dst, src)
        moved(src, dst)
    return np.sum(a * b)


def by_expressions(a, b, n):
    for k in range(n):
        src = a if k % 2 == 0 else b
        dst = b if k % 2 == 0 else a
        dst[1:-1] = 0.5 * (src[:-2] + src[2:]) + src[1:-1] ** 2
        w, v = (a, b) if a[0] > b[0] else (b[:], b)
        w[1:] += v[:-1] ** 2
        w[0] *= 0.5
        if w[0] > 2.0:
            break
        v[2] += w[0]
    return np.sum(a * b)


def of_three(a, b, n):
    c, r, j = a * b, a[1:], 0
    for k in range(n):
        if k % 3 == 0:
            w = a[j:]
        elif k % 3 == 1:
            w = b
        else:
            w = c
        j = 1
        w[0] += c[1] * a[2]
        v = w[1:]
        v[0] += w[2] * r[0]
        r[1] += w[1]
    return np.sum(c * a)


def of_two_choices(a, b, n):
    k = 0
    while k < n:
        src = a if k % 2 == 0 else b
        if a[0] > 0.5:
            dst = a
        else:
            dst = b
        dst[0] *= 0.5 + src[1] ** 2
        if a[0] > 0.5:
            v = a
        else:
            v = b
        v[k] += dst[0] ** 2
        k += 1
    old = a
    w = old
    if n > 3:
        old = b
    w[0] = b[1] ** 2
    old[1] = a[0] ** 2
    a[2] = old[0] + w[1]


def handed_back(a, b, n):
    for k in range(n):
        v = chosen(a, b, k)
        v[1] += 2.0 * a[0]
    w = a if n > 3 else b * 2.0
    w[0] *= 2.0
    return w


KERNELS = [(in_turn, ("a", "b", "return")), (by_expressions, ("a", "b", "return")), (of_three, ("a", "b", "return")),
           (of_two_choices, ("a", "b")), (handed_back, ("a", "b", "return"))]


def kept(a, b, n):
    old = a
    for k in range(n):
        w = a if k < 2 else b
        w[0] += old[1] ** 2
        w[1] += old[0] ** 2
        old = w
    return np.sum(old)


def kept_copy(a, b, n):
    old = a.copy()
    for k in range(n):
        w = a if k < 2 else b
        w[0] += old[1] ** 2
        old[2] = w[1] ** 2
        old = w
    return np.sum(old)


def from_the_turn_before(a, b, n):
    w = a
    for k in range(n):
        w[1] += b[0] ** 2
        w = b if k % 2 else a
        w[0] += a[1] ** 2


def once_chosen(a, b, n):
    w = a
    for k in range(n):
        if k > 1:
            w = b
        w[0] += a[1] ** 2
        a[2] += w[0] ** 2
    return np.sum(a * b)


def at_the_break(a, b, n):
    for k in range(n):
        w = a
        if k == 1:
            break
        w = b
    return np.sum(w * b)


def bound_at_the_break(a, b, n):
    for k in range(n):
        w = b
        if k == 1:
            w = a
            break
    return np.sum(w * b)


def on_one_side(a, b, n):
    for k in range(n):
        if k % 2 == 0:
            w = a
            if a[0] > 2.0:
                break
            b[0] *= 2.0
        else:
            w = b
    return np.sum(w * b)


def the_same_everywhere(a, b, n):
    v = b
    for k in range(n):
        w = a
        if a[0] > 2.0:
            v = a * b
            break
        w[k] *= 0.5
    return np.sum(w * v)


def cases():
    # derivatives
    for kernel, of in KERNELS:
        for n in (1, 2, 4):
            yield Case(kernel, (X.copy(), 0.7 * X, n), ("a", "b"), of)
    # refused
    for kernel, refused in (
            (kept,
             "S201 at `w[0] += old[1] ** 2`: an "
             "array is written that another name may stand for here, as it did before a loop or branch bound it "
             "anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
             "branch, swap what their arrays hold\nS201 at `w[1] += old[0] ** 2`: an array is written that "
             "another name may stand for here, as it did before a loop or branch bound it anew: bind the name to "
             "a copy before the loop or branch: u = u.copy(); where names swap in a branch, swap what their "
             "arrays hold"),
            (kept_copy,
             "S201 at `w[0] += old[1] ** 2`: an "
             "array is written that another name may stand for here, as it did before a loop or branch bound it "
             "anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
             "branch, swap what their arrays hold\nS201 at `old[2] = w[1] ** 2`: an array is written that "
             "another name may stand for here, as it did before a loop or branch bound it anew: bind the name to "
             "a copy before the loop or branch: u = u.copy(); where names swap in a branch, swap what their "
             "arrays hold"),
            (from_the_turn_before,
             "S201 at `w[1] += b[0] ** 2`: an array is written that another name may stand for here, as it did "
             "before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold\nS201 at `w[0] += a[1] ** 2`: "
             "an array is written that another name may stand for here, as it did before a loop or branch bound "
             "it anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
             "branch, swap what their arrays hold"),
            (once_chosen,
             "S201 at `w[0] += a[1] ** 2`: an array is written that another name may stand for here, as it did "
             "before a loop or branch bound it anew: bind the name to a copy before the loop or branch: u = "
             "u.copy(); where names swap in a branch, swap what their arrays hold\nS201 at `a[2] += w[0] ** 2`: "
             "an array is written that another name may stand for here, as it did before a loop or branch bound "
             "it anew: bind the name to a copy before the loop or branch: u = u.copy(); where names swap in a "
             "branch, swap what their arrays hold")):
        yield Case(kernel, (X, 0.7 * X, 4), of=None, refused=refused)
    # left by a break
    # Behind the loop a name stands for what it did where the loop was left.
    for kernel in (at_the_break, bound_at_the_break, on_one_side):
        yield Case(kernel, (X, 0.7 * X, 4), of=None, refused=(
            "S201 at `w`: 'w' may stand for different arrays here: copy into one array with x[...] = ..., or "
            "use two names"))
    yield Case(the_same_everywhere, (X, 0.7 * X, 4), ("a", "b"), ("a", "return"))
