"""Lists of new arrays: what a function makes anew in each round, and rows whose sizes follow from what is there."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator


def given(*shape: int) -> np.ndarray:
    return generator(6).uniform(0.3, 1.2, shape)


def smoothed(a, c=0.5):
    w = np.empty(a.shape)
    for i in range(len(a)):
        w[i] = a[i] * c + a[i - 1] ** 2
    return w


def three(x, i):
    y = np.zeros(3)
    y[0] = x[i]
    y[1] = x[i] ** 2
    y[2] = x[i - 1]
    return y


def scaled(x, i):
    return x * i


def two(r):
    z = np.zeros(2)
    z[0] = r[0] * r[1]
    z[1] = np.sum(r)
    return z


def part(x, i):
    return x[i:i+2]


def itself_or_new(x, i):
    if i > 0:
        return x
    return x * 2.0


def written_after(x, n):
    us = [smoothed(x, c=0.1 * k) for k in range(n)]
    us[1] *= us[0]
    us[2][0] = us[1][1] ** 2
    return np.sum(np.array(us) ** 2)


def appended(x, n):
    out = []
    for i in range(n):
        out.append(three(x, i))
    out[1][0] *= x[0]
    return np.sum(np.array(out) ** 2)


def of_rows(x):
    return np.sum(np.array([two(r) for r in x]) ** 2)


def only_appended(x, n):
    out = []
    for i in range(n):
        out.append(three(x, i))
    return np.sum(np.array(out) ** 2)


def written_before(x, n):
    out = []
    for i in range(n):
        y = three(x, i)
        y[1] *= 2.0
        out.append(y)
    x[0] *= out[0][1]
    return np.sum(np.array(out) ** 2) + x[0]


def multiples(x, n):
    us = [scaled(x, k) for k in range(n)]
    us[1] *= us[0]
    x[0] = 3.0 * us[1][0]
    return np.sum(np.array(us) ** 2) + x[0]


def of_each_other(x, n):
    us = [smoothed(smoothed(x), c=0.1 * k) for k in range(n)]
    us.append(scaled(x, 2))
    us[1] *= us[0]
    return np.sum(us[1] ** 2) + np.sum(us[-1])


def of_expressions(x):
    return np.sum(np.array([two(r) + 1.0 for r in x]) ** 2) + np.sum([two(r) for r in x])


def parts(x):
    out = []
    for i in range(x.size - 1):
        out.append(x[i:i+2] * 1.0)
    return np.sum(np.array(out) ** 2) + out[1][0]


def rolled(f):
    g = np.stack([np.roll(f[q], 1, axis=0) for q in range(2)])
    return np.sum(g * f ** 2)


def means(x, n):
    out = []
    for i in range(n):
        out.append(x.mean(axis=1) * i)
    return np.sum(np.array(out) ** 2)


def joined(x, n):
    out = [np.concatenate((x * i, x[1:])) for i in range(n)]
    return np.sum(np.array(out) ** 3)


def interpolated(x, n):
    out = [np.interp(np.linspace(0, 3, 5), np.arange(4.0), x * (i + 1)) for i in range(n)]
    return np.sum(np.array(out) ** 2)


def chunks(x, m):
    out = []
    for i in range(2):
        out.append(x[i * m:(i + 1) * m] ** 2)
    return np.sum(np.array(out) * np.arange(2.0)[:, None])


def columns(x, n):
    out = [x[i, None] * x[:, i] for i in range(n)]
    return np.sum(np.array(out) ** 2)


def of_new_arrays(x, n):
    out = []
    for i in range(n):
        w = np.zeros((x.size, 2))
        w[:, 0] = x * i
        z = w[1:, 0] + w[:-1, 1]
        out.append(z)
    return np.sum(np.array(out) ** 2)


def transformed(x, n):
    out = [np.fft.irfft(np.fft.rfft(x * i)) for i in range(n)]
    return np.sum(np.array(out) ** 2)


def products(x, n):
    out = []
    for i in range(n):
        out.append(np.outer(x[1:], x[:2]) @ x[i:i + 2])
    return np.sum(np.array(out) ** 2)


def spread(x, n):
    out = []
    for i in range(n):
        out.append(np.broadcast_to(x[i], (3,)) + x[:3])
    return np.sum(np.array(out) ** 2)


def singles(x, n):
    out = []
    for i in range(n):
        out.append(x[i:i + 1] * 2.0)
    return np.sum(np.array(out) ** 2)


def sorted_parts(x, n):
    out = []
    for i in range(n):
        out.append(np.sort(x[np.argsort(x)[:3]]) * x[i])
    return np.sum(np.array(out) ** 2)


CASES = [
    (written_after, (given(4), 3)), (appended, (given(4), 3)), (of_rows, (given(3, 2),)),
    (only_appended, (given(4), 3)),
    (written_before, (given(4), 3)), (multiples, (given(4), 3)), (of_each_other, (given(4), 3)),
    (of_expressions, (given(3, 2),)), (parts, (given(4),)), (rolled, (given(2, 3, 2),)), (means, (given(2, 3), 3)),
    (joined, (given(4), 3)), (interpolated, (given(4), 3)), (chunks, (given(6), 3)), (columns, (given(3, 3), 3)),
    (of_new_arrays, (given(4), 3)), (transformed, (given(4), 3)), (products, (given(7), 3)), (spread, (given(7), 3)),
    (singles, (given(7), 3)), (sorted_parts, (given(7), 3)), (chunks, (given(2), 1)), (means, (given(2, 3), 0)),
    (appended, (given(4).astype(np.float32), 3)), (parts, (given(4).astype(np.float32),)), (rolled, (given(2, 1, 1),))]


def parts_written(x, n):
    us = [part(x, k) for k in range(n)]
    us[1] *= us[0]
    return np.sum(x**2)


def one_of_them_given(x, n):
    us = [itself_or_new(x, k) for k in range(n)]
    us[1] *= us[0]
    return np.sum(x**2)


def twice(x, n):
    us = []
    for k in range(n):
        y = three(x, k)
        us.append(y)
        us.append(y)
    us[1] *= us[2]
    return np.sum(np.array(us)**2)


def made_once(x, n):
    us = []
    y = three(x, 0)
    for _ in range(n):
        us.append(y)
        y[0] *= 2.0
    return np.sum(np.array(us)**2)


def longer_and_longer(x, n):
    out = [np.concatenate((x, x[:i + 1])) for i in range(n)]
    return np.sum(out[0])


def beginnings(x, n):
    out = []
    for k in range(1, n):
        out.append(x[:k] ** 2)
    return sum(np.sum(o) for o in out)


def ends(x, n):
    out = [np.cumsum(np.diff(x[i:])) for i in range(n)]
    return out[0][0]


def of_two_sizes(x):
    out = []
    out.append(x[:2] * 1.0)
    out.append(x[:1] * 1.0)
    return np.sum(out[1]) + np.sum(out[0])


def masked(x, n):
    out = []
    for _ in range(n):
        out.append(x[x > 0.5] * 1.0)
    return np.sum(out[0])


def levels(x, n):
    made = [x.copy(), x[::2] * x[1::2]]
    s = 0.0
    for k in range(n):
        s += np.sum(made[k] ** 2)
    return s


def coarser_and_coarser(x, n):
    made = [x.copy()]
    for _ in range(n):
        made.append(0.5 * made[-1][::2])
    return np.sum(made[n])


def solved(x, n):
    out, v = [], np.zeros(2)
    for i in range(n):
        b = np.zeros(2)
        b[0] += x[i]
        b[1] += v[0] ** 2
        v = np.linalg.solve(np.array([[x[0] + 2.0, 1.0], [0.5, x[1]]]), b)
        out.append(v)
        out.append(np.clip(b, 0.0, 0.4))
    return np.sum(np.array(out) ** 2)


def cases():
    yield Case(solved, (given(4), 3), ("x",))
    # lists of new arrays
    for kernel, arguments in CASES:
        first = kernel.__code__.co_varnames[0]
        yield Case(kernel, arguments, (first,))
    yield Case(of_two_sizes, arguments, "x")
    # what a function gives may be a part of an argument, or the argument
    for kernel in (parts_written, one_of_them_given):
        yield Case(kernel, (given(4), 3), ("x",), ("x", "return"))
    # what is not new and what has other sizes is refused
    for kernel, refused in (
            (twice,
             "S201 at `us[1] *= us[2]`: the list 'us' holds views of an array, or one array several times, and "
             "what it holds is written: append a copy: .append(x.copy())"),
            (made_once,
             "S201 at `us.append(y)`: a list holds an array that is written, not a copy of it: append a copy: "
             ".append(x.copy())"),
            (longer_and_longer,
             "S201 at `[np.concatenate((x, x[:i + 1])) for i in range(n)]`: the sizes of the rows of 'out' are "
             "not known where the list is made: allocate an array before and fill it in a for loop"),
            (beginnings,
             "S201 at `out = []`: the sizes of the rows of 'out' are not known where the list is made: allocate "
             "an array before and fill it in a for loop"),
            (ends,
             "S201 at `[np.cumsum(np.diff(x[i:])) for i in range(n)]`: the sizes of the rows of 'out' are not "
             "known where the list is made: allocate an array before and fill it in a for loop"),
            (masked,
             "S201 at `out = []`: the sizes of the rows of 'out' are not known where the list is made: allocate "
             "an array before and fill it in a for loop")):
        arguments = (given(4), 3)[:kernel.__code__.co_argcount]
        yield Case(kernel, arguments, "x", refused=refused)
    # arrays of other sizes in a list are refused when they are there
    for kernel, part in (
            (levels, "made = [x.copy(), x[::2] * x[1::2]]"),
            (coarser_and_coarser, "made.append(0.5 * made[-1][::2])")):
        yield Case(kernel, (given(8), 2), "x", refused=(
            f"S501 at `{part}`: "
            "an array of another size than the others is put into a list, whose arrays have one size: "
            "x.shape[0] is 8, len(range(0, x.shape[0], 2)) is 4: give arrays of different sizes different "
            "names"))
