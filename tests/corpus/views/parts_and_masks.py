"""Parts of arrays in whole-array statements: backwards, of length 1, picked by masks and integers, at counters."""
from __future__ import annotations

import math

import numpy as np

from tests.corpus import Case, outputs
from tests.harness.seeds import generator


def joined_masks(x, y, m):
    low = x < 0.3
    y[low & (x < 0.2)] *= 0.5
    y[low | (y > 0.9)] -= 0.3 * x[0]
    both = (x > 0.1) ^ ~low
    x[both] *= y[both] * y[both]
    m[(x[:3] < 0.3) & (y[:3] > -2.0)] *= x[:4]


def numbers_spread_and_summed(x, y, m):
    a = np.sum(x[1] * np.ones(3), axis=0)
    y[1] = a ** 3 + (x[2] * np.ones((3, 2))).mean()
    m[:, 1] += np.sum(y[0] * np.ones((3, 5)), axis=1)
    m[0] *= np.mean(x[3] * y[2] * np.ones((2, 4)), axis=0)


def sizes_of_picked_elements(x, y, m):
    where = np.array([0, 2, 2, 1, 0])
    y[2] = np.std(m[where]) * m[where].shape[0]
    m[0] *= np.var(m[where], axis=0) * x[where].shape[0]


def parts_of_picked_elements(x, y, m):
    where = np.array([1, 2, 0])
    m[:, 1] *= m[where, 2][::-1]
    m[...] = 0.3 * np.cumsum(m[where], axis=0) * np.diff(x[where])[:1]
    y[1:] -= m[where][0] * y[where][-1]


def picked_from_parts(x, y, m):
    inner = x[1:-1]
    inner[inner < 0.2] *= y[0]
    inner[inner > 0.3] = 0.5 * inner[inner > 0.3] * y[1]
    y[1:][y[1:] > 0.1] -= 0.1 * np.sum(inner[inner < 0.25])
    block = m[1:, :2]
    block[block > 0.0] = np.sin(block[block > 0.0])
    block[np.array([0, 1, 0]), 1] += x[:3]
    for i in range(2):
        part = m[i:, 1]
        part[part > 0.1] *= x[i]
        x[i:][x[i:] < 0.4] += 0.1
    y[0] = np.sum(block[np.array([0, 1, 0])] * m[0, :2]) + x[1:][np.array([0, 0])][1]


def parts_that_run_backwards(x, y, m):
    for i in range(3):
        y[i] *= 2.0 * np.sum(y[:i][::-1] * x[i:][::-1][:i])
        y[i:][::-1] *= x[:5 - i]
        x[:i] += y[:i][::-1][:]
    x[1:][::-1] *= y[::-1][:4]
    y[::2][::-1] += x[::-2]
    x[::-1][::-1] *= y[::-2][1]
    x[::-1][1:] *= y[1:]
    x[::-2][::-1] *= y[::2][:]
    m[:, 1:][::-1, ::-1] *= 0.3
    x += y[:1][::-1] * m[1, ::-1][:1] * m[1:, 1:2][::-1][-1:][0]
    y[1:] *= y[::-1][-1:] * x[1:-1][1:2] + x[::-1][1:2]


def one_element_at_counters_of_several_loops(x, y, m):
    for i in range(1, -1, -1):
        x[:] *= x[i:i + 1]
    for i in range(3):
        y += x[i + 1:i + 2] * y[i]
        m[i] *= m[:, i:i + 1][0]
    for k in range(1, 4):
        k = k - 2  # noqa: PLW2901
        y[0] += np.sum(x[k:k + 1]) * x[k + 1]


def elements_of_parts_from_their_end(x, y, m):
    turned, inner, even = y[::-1], x[1:-1], m[:, ::2]
    for i in range(x.size):
        x[i] += turned[i] * turned[i - 1]
    for i in range(inner.size):
        y[i] += inner[i - 1] * inner[i - 2] * inner[-i - 1]
        inner[i - 1] *= 0.5 * y[i]
    for k in range(-1, 2):
        even[k, k] *= even[k, -k - 1] + turned[k]


def sums_of_pythons_own(x, y, m):
    y[0] += sum(x) / len(x) + sum(x ** 2) ** 0.5 + sum(y, 1.0)
    y[1] += max(x) * min(y * x)
    m[0] += sum(m) * np.array([np.sum(x[0] * np.ones(3)), np.mean(y), 1.0, max(y)])
    m[1] *= np.full(4, np.var(m[:, ::-1]))


def once_and_twice_the_size(x, y, m):
    y[0] += np.sum(np.concatenate((x, x)) ** 2) + np.sum(np.cumsum(x) * y) + np.sum(np.hstack((m, m)) * 2.0)


def tables_of_numbers(x, y, m):
    stages = [[0, 0], [0.5, 1 / 2], (-1, 2.0)]
    half = ((1, -0.25), (0, math.pi))
    for s in range(len(stages)):
        for j, weight in enumerate(stages[s]):
            y[s] += stages[s][j] * x[j] * weight + half[j % 2][1] * x[s]
    for low, high in half:
        y[0] += low * x[0] * high


def copies_within_expressions(x, y, m):
    x[np.array([0, 2, 2, 1, 4])] = y.copy()
    x[1:] += y[1:].copy() * x[0]
    x *= np.copy(y) + 0.5 * np.asarray(x[::-1])
    m[0] += np.sum(np.ascontiguousarray(y)) * np.asarray([x[0], 2.0, 1.0, y[0]])
    z = y.copy()
    z += 1.0
    x[0] = np.sum(z.copy() * x)
    y[...] = x.copy()
    for i in range(2):
        w = x[i:].copy()
        y[i:] += w * w


def scaled(u, v, c):
    u *= v
    u += c * v
    v *= c


def parts_of_length_one_to_a_helper(x, y, m):
    scaled(x, y[:1], y[2])
    scaled(x[1:], y[2:3], 2.0)
    scaled(m, y[:3, None], 0.7)
    column = x[1:4][:, None]
    column *= m[:, :1]
    for i in range(2):
        scaled(m, x[i:i + 1], 0.7)
        scaled(m[i], y[i:i + 1], 0.7)


def counters_of_a_loop_that_is_written_out(x, y, m):
    for i, w in enumerate((0.5, 2.0)):
        x[i] = x[i] ** 2 * w
    for i in range(1, 3):
        x[i] *= x[i - 1]
    for w, i in zip((0.5, 2.0), (2, 1)):
        y[i] = y[i] ** 2 * w * x[i]
    for i in reversed(range(1, 3)):
        y[i] *= y[i - 1]


def extremes_of_no_rows(x, y, m):
    for j in range(3):
        m[:j, 1] -= np.max(x[-1] * np.ones((j, 2)), axis=1) * np.min(y[:2] * np.ones((j, 2)), axis=1)


def asked_of_whole_arrays(x, y, m):
    flags, k = x > 0.0, np.array([2, 1, 3, 0, 2])
    y[...] = x ** 2 * np.any(flags) + x * np.all(flags) + y * np.any(y > 0.2)
    x += np.where(np.any(x > 0.5), x ** 2, y) * np.size(m) * np.ndim(m)
    y[1:] *= x[1:] * np.argmin(k) * k.max() * np.count_nonzero(k > 1) + flags.argmax()
    y[flags] = x[flags] * float(np.any(flags)) * np.minimum(2.0, np.any(k > 2))
    m *= np.searchsorted(np.arange(4), 2) * np.all(np.diff(k) > -5) * np.allclose(x, x)
    m[1] -= x[:4] * np.any(m > 0.3)


def deviations_and_choices(x, y, m):
    m[1] += np.std(m[::-1, :].T, axis=1)
    m[0] *= np.where(x[1:] > 0.1, 0.5, m[0])


def guards_of_branches(x, y, flag):
    if flag > 2:
        assert x.shape[0] == y.shape[0] + 1
        x[1:] += y
    elif flag > 1:
        assert y.shape[0] == 3
        x[:3] += y
    else:
        for _ in range(3):
            y[1:] *= y[:-1] * x[0]
            t = y[2:] * y[:-2]
            y[:-2] += t * t
            x[1:] *= np.sum(t) * x[:-1]


def of_equal_numbers(x, c):
    x[-1] -= 0.2 * (x[-1] - np.std(c * np.ones((5, 3))))


def copy_of_a_number(x):
    x[0] = x[1].copy() * x[2]


def cases():
    random = generator(5)
    given = random.uniform(-0.9, 0.9, 5), random.uniform(-0.9, 0.9, 5), random.uniform(-0.9, 0.9, (3, 4))
    for kernel in (
            extremes_of_no_rows, asked_of_whole_arrays, counters_of_a_loop_that_is_written_out,
            copies_within_expressions, parts_of_length_one_to_a_helper, joined_masks, numbers_spread_and_summed,
            sizes_of_picked_elements, parts_of_picked_elements, picked_from_parts, parts_that_run_backwards,
            one_element_at_counters_of_several_loops, elements_of_parts_from_their_end, sums_of_pythons_own,
            tables_of_numbers, once_and_twice_the_size):
        yield Case(kernel, given, ("x", "y", "m"), outputs(kernel, given))
    # float32 stays float32
    yield Case(deviations_and_choices, tuple(g.astype("float32") for g in given), ("m",), ("m",))
    # a guard holds where it stands
    for size, flag in ((4, 1), (8, 1), (3, 2), (4, 3)):
        random = generator(5)
        lengths = random.uniform(0.5, 1.0, 5), random.uniform(0.5, 1.0, size)
        yield Case(guards_of_branches, (*lengths, flag), ("x", "y"), ("x", "y") if flag == 1 else ("x",))
    # the deviation of equal numbers: its derivative is nothing but rounding errors
    yield Case(of_equal_numbers, (np.full(5, 0.7), 0.3), ("x", "c"), ("x",), options={"vanishing": 1e-16})
    yield Case(copy_of_a_number, (np.array([0.3, 0.7, 0.4]),), "x", "x")
