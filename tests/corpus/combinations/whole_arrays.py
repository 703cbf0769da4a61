"""Kernels with slices, views, broadcasting, reductions and linear algebra, under both engines."""
from __future__ import annotations

import numpy as np

from benchmarks.kernels.cases import ARRAYS
from tests.corpus import Case
from tests.harness.seeds import generator


def overlapping_store(x, y):
    x[1:] = x[:-1] * y[1:]
    x[:-1] += x[1:] * x[1:]
    x[::-1] = x * y


def strided(x, y):
    x[::2] = y[::2] * x[::2]
    x[1::2] -= x[:-1:2] * y[1::2]
    y[3:0:-1] *= x[1:4]


def view_of_a_view(x, y):
    inner = x[1:-1]
    part = inner[1:]
    part *= y[2:-1] * inner[:-1]
    inner[0] = part[0] * part[-1]
    part[1:] = inner[:-2] ** 2


def view_kept_across_a_rebinding(x, y):
    row = x[1:]
    y[:-1] *= row
    row = x[:-1]
    row += y[1:] * row
    y[1:] += row * row


def read_after_the_view_was_overwritten(x, y):
    part = x[2:]
    old = part.copy()
    part[...] = y[2:] * old
    y[2:] += part * old


def broadcast_both_ways(a, x, y):
    a += x[:, None] * y[None, :]
    a *= a[0] + x[1]
    b = np.exp(0.1 * a) * y
    x += b[:, 0] * b[:, -1]
    y *= np.sum(b, axis=0)


def broadcast_in_a_sum(a, x, y):
    return np.sum(a * y) + np.sum(x[:, None] * y) + np.sum(x[:, None] + y) + np.sum((a + y) * x[:, None] ** 2)


def reductions(a, x, y):
    rows = np.sum(a, axis=1)
    columns = a.mean(axis=0)
    x *= rows
    y[:] = y * columns + a.max(axis=0) - np.min(a, axis=0)
    return np.sum(a) * np.mean(x) + np.max(y) * a.min() + np.sum(np.sum(a * a, axis=0, keepdims=True) * y)


def kept_dimensions(a, x, y):
    a -= a.mean(axis=1, keepdims=True)
    a /= np.sum(a * a, axis=(0, 1), keepdims=True)
    a[...] = a - np.max(a, axis=-1, keepdims=True)
    return np.sum(a * x[:, None]) + y[0]


def moved(a, x, y):
    b = np.roll(a, 1, axis=0) * np.roll(a, -2, axis=1)
    a += np.flip(b, axis=1) * b
    x[:] = np.roll(x, 1) * x[::-1]
    c = a.T * y[:, None]
    return np.sum(c * np.outer(y, x)) + np.sum(a.reshape(-1) ** 3) + np.sum(np.ravel(c) * a.reshape((12,)))


def products(a, x, y):
    b = a @ y
    x += b * x
    y *= a.T @ x
    c = a.T @ a
    c += np.outer(y, y)
    return np.dot(x, b) + np.sum(c @ c) + np.sum(x @ a)


def chosen(a, x, y):
    b = np.where(a > 0.5, a * a, np.sqrt(a))
    b[0, :] = np.where(y > x[0], y, 0.0)
    a[:, 1:] = np.maximum(b[:, 1:], a[:, :-1]) * np.clip(a[:, 1:], 0.2, 0.8)


def in_loops(a, x, y):
    for k in range(3):
        part = a[k]
        part[1:] += part[:-1] * y[1:]
        a[:, k] *= x
        t = a[:, 1:] - a[:, :-1]
        x += t[:, 0] * t[:, k]
        y[1:] -= 0.1 * np.sum(t * t, axis=0)


def window(x, y):
    for k in range(x.size - 2):
        x[k:k + 2] += y[k + 1:k + 3] * x[k]
        y[k] = np.sum(x[k:k + 3]) * y[k]


def scaled(part, c):
    part *= c
    part[1:] += part[:-1] * part[0]


def part_passed_to_a_helper(a, x, y):
    scaled(a[1], y[0])
    scaled(a[:, 2], x[1])
    scaled(x[1:], a[0, 0])


def batched_rows(a, x, y):
    s = np.empty((3, 1))
    s[:, 0] = x * x
    a *= s
    d = a - s * np.ones(4)
    return np.sum(d * d * y)


def masked(x, y):
    mask = x > 0.9
    x[mask] *= y[mask] + x[mask] ** 2
    y[x < 1.0] = 0.3
    x[~mask] += 0.5 * np.sum(y[mask] ** 2)
    part = x[mask] * x[mask]
    mask[0] = False
    y[mask] -= x[mask] * 0.1
    x[mask] = x[mask] ** 3
    return np.sum(part * part)


def mask_that_changes(x, y):
    for _ in range(3):
        low = x < y
        x[low] = x[low] * x[low] + 0.7
        y[low] *= 0.9 * x[low]
        x -= 0.05 * y


def masked_matrix(a, x, y):
    high = a > 0.6
    a[high] = np.sqrt(a[high]) * x[0]
    rows = x > 0.8
    a[rows] *= y
    a[rows, 1:] += x[1]
    return np.sum(a[high]) * np.sum(a[rows] ** 2)


def picked_elements(x, y):
    places = np.array([0, 2, 2, 5])
    y[:4] *= x[places] * x[places]
    x[places] = y[:4] * y[1:5]
    x[places] += y[places] * x[0]
    z = x[places]
    return np.sum(z * z) + x[places[1]] * y[-1]


def picked_twice_in_a_loop(x, y):
    places = np.array([1, 1, 3])
    for k in range(3):
        x[places] *= y[places + k % 2] * x[k]
        places[0] = (places[0] + 1) % 4
        y[places] = np.sin(x[places])


def operand_as_result(m, q):
    m[:] = m @ q
    m[1] = q @ m[1]
    for i in range(4):
        q[i, i] += 4.0
    q[:] = np.linalg.solve(q, m)
    q[2] = np.max(q, axis=0)
    q[:, 1] = np.mean(q, axis=1)
    q[0, 0] = q[0] @ q[1]


def reductions_into_parts(a, x, y):
    b = a * a
    a[0] = np.max(b, axis=0)
    a[:, 1] = np.sum(b * b, axis=1)
    a[:, ::-1] -= np.mean(b, axis=0)
    x[2] = np.mean(a)
    x[0] = np.mean(x)
    y[1:3] = np.sum(y * y)
    y[2:] = np.max(y[1:])
    a[1:] = np.sum(b, axis=0, keepdims=True)


def sums_within_sums(a, x, y):
    x[1] = np.sum(np.sum(x) * x)
    return np.sum(np.max(y) * y * x[0]) + np.sum(y @ y * a + np.sum(x) * y)


def picked_in_order(x, y):
    order = np.argsort(x)
    y *= x[order]
    return np.sum(y[order] * x) + x[order[0]] * y[order[1]]


THREE = (overlapping_store, strided, view_of_a_view, view_kept_across_a_rebinding, read_after_the_view_was_overwritten,
         window, masked, mask_that_changes, picked_elements, picked_twice_in_a_loop, picked_in_order)
KERNELS = (*THREE, masked_matrix, broadcast_both_ways, broadcast_in_a_sum, reductions, kept_dimensions, moved, products,
           chosen, in_loops, part_passed_to_a_helper, batched_rows, operand_as_result, reductions_into_parts,
           sums_within_sums)
SQUARE = (operand_as_result,)


def arguments(kernel):
    random = generator(11)
    if kernel in THREE:
        return 0.5 + random.random(6), 0.5 + random.random(6)
    if kernel in SQUARE:
        return 0.3 + 0.7 * random.random((4, 4)), 0.3 + 0.7 * random.random((4, 4))
    return 0.3 + 0.7 * random.random((3, 4)), 0.5 + random.random(3), 0.5 + random.random(4)


def outputs(kernel, names):
    given, left = arguments(kernel), arguments(kernel)
    result = kernel(*left)
    changed = tuple(n for n, a, b in zip(names, given, left) if not np.array_equal(a, b))
    return changed + (("return",) if result is not None else ())


def joined_in_a_sum(p, q):
    return np.sum(p * q + p)


def joined_by_a_helper(x, y):
    scaled_by(x, y)
    return joined_in_a_sum(x, y) + np.max(y - x)


def scaled_by(p, q):
    p *= q
    p += q * q


def transposed_and_written(m):
    w = m.T
    w[0] = 1.0


def reshaped_then_the_operand_written(m, v):
    w = m.reshape(-1)
    m *= 2.0
    v[:] = w[:4]


def as_array_written(m):
    w = np.asarray(m)
    w *= w


def squared(p):
    p *= p


def transposed_for_a_helper_that_writes(m):
    squared(m.T)


def flipped_and_the_operand_read(m):
    t = m * m
    w = np.flip(t, axis=0)
    w *= 3.0
    return np.sum(t)


def transposed_and_read(m, v):
    for _ in range(3):
        w = m.T
        v += 0.1 * (w @ v)
        m *= 0.9
    t = (m * m).reshape(-1)
    t *= 2.0
    v *= t[:4]


def quotient_in_a_sum(m, v):
    return np.sum((m + v) * m / v)


def bounds_that_cross(x, y):
    for i in range(8):
        for j in range(4):
            t = x[i:j] * y[i:j]
            x[i:j] = 0.5 * t * t
            y[j] += np.sum(t) + np.sum(x[i - 4:i])


def bound_of_a_view_that_changes(x, n, y):
    part = x[n:]
    n -= 1
    part *= 2.0 * y[3:]
    x[n:] *= x[n:]
    while n > 0:
        t = x[n:] * x[:-n]
        y[n] += np.sum(t)
        x[n:] = t
        n -= 1


def one_column_at_a_time(m):
    for i in range(3):
        f = m[i + 1:, i:i + 1] / m[i, i]
        m[i + 1:] -= f * m[i]
        f *= f
        m[:1] += f[:1] * m[-1:]
        if i > 1:
            g = np.mean(m[i:], axis=0, keepdims=True)
        else:
            g = np.ones((1, 4))
        m *= g


def one_counter_for_two_loops(m, v):
    for i in range(4):
        v[i] -= m[i, :i] @ v[:i]
    for i in range(3, -1, -1):
        v[i] = (v[i] - m[i, i + 1:] @ v[i + 1:]) / m[i, i]


def step_that_changes(x):
    for i in range(1, 3):
        x[::i] *= 2.0


def cases():
    # kernel
    for kernel in KERNELS:
        names = kernel.__code__.co_varnames[:kernel.__code__.co_argcount]
        yield Case(kernel, arguments(kernel), names, outputs(kernel, names))
    # case
    for case in ARRAYS:
        yield Case(case.function, case.arguments("small"), case.wrt, case.of)
    # lengths of one
    for kernel in (joined_in_a_sum, joined_by_a_helper):
        long, one = np.linspace(0.4, 1.3, 6), np.array([0.7])
        for x, y in ((long, long), (long, one), (one, one), (long, one + 0.1)):
            of = ("x", "return") if kernel is joined_by_a_helper else ("return",)
            yield Case(kernel, (x.copy(), y.copy()), kernel.__code__.co_varnames[:2], of)
    # views by functions are written through
    for kernel in (transposed_and_written, reshaped_then_the_operand_written, as_array_written,
            transposed_for_a_helper_that_writes, flipped_and_the_operand_read):
        given = (np.linspace(0.3, 1.2, 16).reshape(4, 4), np.ones(4))[:kernel.__code__.co_argcount]
        of = {2: ("m", "v"), 1: ("m",)}[len(given)] if kernel is not flipped_and_the_operand_read else ("return",)
        yield Case(kernel, given, ("m", "v")[:len(given)], of)
    # square
    for kernel in (transposed_and_read, quotient_in_a_sum):
        random = generator(5)
        of = ("m", "v") if kernel is transposed_and_read else ("return",)
        yield Case(kernel, (0.3 + random.random((4, 4)), 0.3 + random.random(4)), ("m", "v"), of)
    # bounds known at run time
    random = generator(7)
    x, y, m = 0.5 + random.random(6), 0.5 + random.random(6), 0.5 + random.random((4, 4)) + 2.0 * np.eye(4)
    yield Case(bounds_that_cross, (x, y), ("x", "y"), ("x", "y"))
    yield Case(bound_of_a_view_that_changes, (x, 3, y), ("x", "y"), ("x", "y"))
    yield Case(one_column_at_a_time, (m,), ("m",), ("m",))
    # bounds of products
    random = generator(7)
    given = 0.5 + random.random((4, 4)), 0.5 + random.random(4)
    yield Case(one_counter_for_two_loops, given, ("m", "v"), ("v",))
    # a step that changes
    yield Case(step_that_changes, (np.ones(6),), ("x",), ("x",))
