"""What an expression reads is read when Python reads it: before a store or a call behind it, where a slice or a list is
made, and not later."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def scale(v, s):
    v *= s
    return v[0]


def grown(k):
    k[0] += 1
    return k[0]


def slice_of_elements(x, y, p, a):
    s = slice(p[0], p[1])
    p[0] = 2
    x[s] *= y[s]
    return np.sum(x ** 2)


def slice_of_a_value(x, y, p, a):
    s = slice(int(x[0] * 2.0), 4)
    x[0] = 0.2
    x[s] *= y[s]
    return np.sum(x ** 2)


def slice_in_a_loop(x, y, p, a):
    for k in range(2):
        s = np.s_[p[k]:p[k] + 2]
        p[k] += 1
        x[s] *= y[s]
    return np.sum(x ** 2)


def slice_by_a_call(x, y, p, a):
    s = slice(0, grown(p))
    x[s] *= y[s]
    x[s] += y[s]
    return np.sum(x ** 2) * p[0]


def slice_of_counters(x, y, p, a):
    n = 1
    s, every = slice(n, n + 2), slice(None, None, 2)
    n += 1
    x[s] *= y[s]
    x[every] += y[every]
    t = slice(n, None), 0
    n -= 1
    return np.sum(x ** 2) * a[t][0]


def slice_of_an_earlier_trip(x, y, p, a):
    for k in range(3):
        n = k + 1
        if k == 0:
            s = slice(0, n)
        x[s] *= y[s]
    x[s] += y[s]
    return np.sum(x ** 2)


def slice_of_a_name_bound_twice(x, y, p, a):
    n = 1
    for k in range(3):
        n = k
        part = slice(0, n)
        x[part] *= y[part]
    return np.sum(x ** 2) * n


def slice_with_places(x, y, p, a):
    s = np.s_[p[0], :]
    t = np.s_[x > 0.8]
    p[0] = 2
    x[0], x[1] = x[1], x[0]
    return np.sum(a[s] ** 2) * np.sum(y[t])


def bundle_swapped(x, y, p, a):
    q = (x, y)
    q[0][1], y[0] = y[1], x[1]
    return np.sum(x * x) + 3.0 * y[0]


def bundle_of_views(x, y, p, a):
    h = (x[::-1],)
    h[0][0], x[1] = x[1], x[4]
    return np.sum(x * y)


def bundle_before_a_call(x, y, p, a):
    q = [x, y]
    return q[0][1] * scale(x, 0.9) + y[1] * scale(q[1], 0.8)


def sum_from_a_number(x, y, p, a):
    w = 0.0
    w += x
    return w[1] * scale(w, y[0])


def product_from_a_number(x, y, p, a):
    w = 1
    w *= x[1:]
    z = 0
    z -= y
    return w[1] * scale(w, y[0]) + z[2] * scale(z, 0.5)


def rows_in_a_comprehension(x, y, p, a):
    w = [row[1] * scale(a[k], 1.1) for k, row in enumerate(a)]
    return sum(w) + sum(row[1] * scale(a[k], 1.1) for k, row in enumerate(a))


def named_after_an_out(x, y, p, a):
    v = np.multiply(x, y, out=x)
    return v[1] * scale(x, 0.9)


def list_as_long_as_an_element(x, y, p, a):
    us = []
    p[0] = p[1]
    for k in range(p[0]):
        us.append(x[k] ** 2)
    return sum(us)


def list_as_long_as_a_call_says(x, y, p, a):
    us = []
    for k in range(grown(p)):
        us.append(x[k] ** 2)
    vs = [y[k] ** 2 for k in range(grown(p))]
    return sum(us) * sum(vs) * p[0]


def list_as_long_as_a_name(x, y, p, a):
    us = [y[0]]
    m = p[1]
    vs = []
    p[1] = 1
    n = int(x[0] * 3.0)
    x[0] = 0.3
    for k in range(n):
        vs.append(x[k] * y[k])
    for k in range(2):
        us.append(x[m - k])
    return sum(us) * sum(vs)


def slice_as_long_as_a_list(x, y, p, a):
    us = [x[0]]
    part = slice(0, len(us))
    us.append(x[1])
    us.append(x[2])
    for k in range(2):
        us.append(x[k])
        every = np.s_[:len(us) - 3, ::2]
        us.append(y[k])
        x[1] += np.sum(a[every] ** 2)
    rest = slice(1, min(5, len(us) - 4))
    return np.sum(y[part] ** 2) * us[2] + np.sum(y[rest] ** 3) * x[1]


def slice_from_the_last_counter(x, y, p, a):
    s = 0.0
    for k in range(3):
        x[k] *= 2.0
        s += k
    return np.sum(x[k:k + 2]) + np.sum(x[k:] * y[k:]) * s + np.max(y[:k])


def second(_first, given):
    return given


def written_in_an_item(x, y, p, a):
    s = (x[0], np.add(x, y, out=x)[1], x[2])[0] + [x.fill(y[1]), x[0]][1]
    t = (y.sort(), np.copyto(a, 2.0 * a), y[2])[-1]
    return s * t * np.sum(x) + np.sum(a)


def written_in_an_argument(x, y, p, a):
    def last(_first, _second, given):
        return given
    s = last(np.add(x, y, out=x), x.sort(), x[0]) + second(np.sin(y, out=y), y[1])
    return s * x[1] * y[2]


def written_in_what_is_dropped(x, y, p, a):
    (np.multiply(x, y, out=x), 1)  # noqa: B018
    n = len([np.add(y, x[0], out=y), 1])
    return np.sum(x * y) * n


KERNELS = (slice_of_elements, slice_of_a_value, slice_in_a_loop, slice_by_a_call, slice_of_counters,
           slice_of_an_earlier_trip, slice_of_a_name_bound_twice, slice_with_places, bundle_swapped, bundle_of_views,
           bundle_before_a_call, sum_from_a_number, product_from_a_number, rows_in_a_comprehension, named_after_an_out,
           list_as_long_as_an_element, list_as_long_as_a_call_says, list_as_long_as_a_name,
           slice_as_long_as_a_list, slice_from_the_last_counter, written_in_an_item, written_in_an_argument,
           written_in_what_is_dropped)


def arguments():
    return (np.array([0.9, 0.31, 1.4, 0.55, 1.13]), np.array([0.7, 1.1, 0.8, 1.4, 1.3]), np.array([1, 3, 2]),
            np.arange(1.0, 7.0).reshape(3, 2) / 3.0)


def too_long_for_its_list(x, p):
    us = [x[0]]
    p[0] = p[1]
    for k in range(p[0]):
        us.append(x[k])
    return sum(us)


def longer_every_time(x, p):
    us = [x[0]]
    for _ in range(2):
        for k in range(p[0]):
            us.append(x[k])
        p[0] += 1
    return sum(us)


def longer_by_a_call(x, p):
    us = [x[0]]
    grown(p)
    for k in range(p[0]):
        us.append(x[k])
    return sum(us)


def longer_by_a_function(x, p):
    us = [x[0]]
    np.add(p, 1, out=p)
    for k in range(p[0]):
        us.append(x[k])
    return sum(us)


def made_in_the_first_trip(x, p):
    for k in range(3):
        if k == 0:
            us = [x[0]]
        for j in range(k):
            us.append(x[j])
    return sum(us)


def made_in_another_trip(x, p):
    for k in range(3):
        if k == 0:
            us = [x[0]]
        else:
            us.append(x[k])
    return sum(us)


def cases():
    # read when python reads it
    for kernel in KERNELS:
        yield Case(kernel, arguments(), ("x", "y", "a"))
    for kernel in (made_in_another_trip, made_in_the_first_trip, too_long_for_its_list, longer_every_time,
                   longer_by_a_call, longer_by_a_function):
        yield Case(kernel, (arguments()[0], np.array([2, 3])), "x")
