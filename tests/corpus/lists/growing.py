"""Lists that grow by append, and comprehensions."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case, outputs
from tests.harness.seeds import generator


# -- a: (3, 4), x: (3,), y: (4,) -------------------------------------------------------------------------------------

def comprehensions(a, x, y):
    n = x.shape[0]
    squares = [x[i] * y[i] for i in range(n)]
    b = np.array(squares) * squares[0] / squares[0]
    c = np.array([u * u + k for k, u in enumerate(x)])
    d = np.array([a[i] * x[i] for i in range(n)])
    e = np.array([[x[i] * y[j] for j in range(4)] for i in range(3)])
    f = np.vstack([a[i] * x[i] for i in range(3)]) + np.stack([row * row for row in a])
    s = sum(p * q for p, q in zip(x, y)) + sum([x[i] ** 2 for i in range(n)]) + np.sum([v for v in y if v > 0.7])
    return s + np.sum(b * c) + np.sum(d * e) + np.sum(f ** 2)


def appended(a, x, y):
    out, rows, us = [], [], [x[0]]
    for i in range(3):
        out.append(x[i] * y[i])
        out.append(x[i] ** 2)
        rows.append(a[i] * x[i])
        us.append(us[-1] * x[i] + us[i])
    b = np.concatenate(rows)
    c = np.column_stack(rows)
    return np.sum(np.array(out) ** 2) + np.sum(b[1:] * b[:-1]) + np.sum(c[1:] * x) + np.sum(np.array(us) ** 2) * len(us)


def sometimes(a, x, y):
    large = []
    for i in range(3):
        for j in range(4):
            if a[i, j] > 0.6:
                large.append(a[i, j] ** 2)
    s = 0.0
    for v in large:
        s += v * v
    for k in range(3):
        held = [y[k]]
        for j in range(k):
            held.append(a[j, k])
        x[k] += np.sum(np.array(held) ** 2)
    return s * len(large)


def trajectory(a, x, y):
    states = [x.copy()]
    for _ in range(4):
        x += 0.1 * np.array([x[1] * x[2], -x[0], x[0] * x[1]])
        states.append(x.copy())
    whole = np.array(states)
    return np.sum(whole[1:] * whole[:-1]) + np.sum(np.hstack(states)[2:5])


def triangular(a, x, y):
    pairs, rows = [], []
    for i in range(2):
        for j in range(i, 3):
            if x[j] > 0.1:
                pairs.append(x[i] * x[j])
        for j in range(i + 1):
            rows.append([x[i], y[j] ** 2])
    m = np.array(rows)
    return np.sum(np.array(pairs) ** 2) + np.sum(m[:, 0] * m[:, 1])


def square(v):
    return v * v


def of_a_kernel(a, x, y):
    b = np.array([square(v) for v in y])
    return np.sum(b * y)


def none_or_one(x):
    out = []
    for v in x:
        out.append(v * v)
    return np.sum(np.array(out)) + np.sum(np.array([v ** 3 for v in x]))


def unknown_length(x):
    out = []
    while len(out) < 3:
        out.append(x[0])
    return np.sum(np.array(out))


def rebound_length(x, n):
    out = []
    n = n + 1
    for i in range(n):
        out.append(x[i])
    return np.sum(np.array(out))


def not_copied(x):
    rows = []
    row = np.zeros(2)
    for i in range(2):
        row[:] = x[i]
        rows.append(row)
    return np.sum(np.array(rows) * x)


def removed(x):
    out = []
    for i in range(3):
        out.append(x[i])
    return out.pop() * x[0]


def part_from_the_end(x, k):
    out = []
    for i in range(3):
        out.append(x[i])
    return np.sum(np.array(out[k:])) * x[0]


def repeated(x):
    out = [v * v for v in x]
    return np.sum(np.array(out * 2))


def joined(x):
    out = []
    for v in x:
        out.append(v * v)
    return np.sum(np.array(out + [x[0]]))


def operands(x):
    squares, doubles = [v * v + 1.0 for v in x], [2.0 * v for v in x]
    y = x / squares + squares * x - x % squares
    y[y < doubles] -= 1.0
    y += squares
    squares[0] = 3.0
    twice = 2 * squares + doubles
    return np.sum(y * np.maximum(x, squares)) + twice[1] * twice[4] * (x @ squares)


def repeated_as_often_as_known_when_run(x):
    out = [v * v for v in x]
    return np.sum(np.array(out * len(x)))


def beside_a_number_of_numpy(x):
    out = [v * v for v in x]
    return np.sum((out - np.mean(out)) * x)


def times_a_float(x):
    out = [v * v for v in x]
    return np.sum(out * x[0])


def less_a_written_number(x):
    out = [v * v for v in x]
    return np.sum(-1.0 + np.array(out) - (out - 1.0))


def of_two_lists(x):
    out, more = [v * v for v in x], [2.0 * v for v in x]
    return np.sum(out - more)


def pairs_of_floats(x):
    pairs = []
    for v in x:
        pairs.append((v, 2.0))
    return np.sum(pairs[0] * x[1])


def table_stored_into(x):
    table = [[0, 0], [0, 0]]
    for i in range(2):
        for j in range(2):
            table[i][j] = x[i] * x[j]
    total = 0.0
    for i in range(2):
        for j in range(2):
            total += table[i][j]
    return total


def mixed_table_added_to(x):
    table = [[0.0, 0], [0, 0]]
    for i in range(2):
        for j in range(2):
            table[i][j] += x[i] * x[j]
    return table[0][1] * 1.0


def rows_stored_into(x):
    table, k = [[0, 0], [0, 0]], 0
    for row in table:
        row[k] = x[k]
        k += 1
    total = 0.0
    for i in range(2):
        total += table[i][i]
    return total


def room_for_what_a_longer_list_gives(x, n):
    us = [x[1], x[2]]
    vs = []
    for k in range(n):
        for i in range(3):
            us.append(np.sin(x[i] * k))
    for _ in range(len(us) - 1):
        vs.append(x[0])
        us.append(x[0])
    for _ in range(len(us) - 1):
        vs.append(x[1])
    return sum(us) * sum(vs)


def cases():
    random = generator(7)
    given = 0.3 + 0.7 * random.random((3, 4)), 0.5 + random.random(3), 0.5 + random.random(4)
    for kernel in (comprehensions, appended, sometimes, trajectory, triangular, of_a_kernel):
        yield Case(kernel, given, ("a", "x", "y"), outputs(kernel, given))
    # sizes of one and none
    for x in (np.zeros(0), np.array([1.5])):
        yield Case(none_or_one, (x,), ("x",))
    yield Case(table_stored_into, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(rows_stored_into, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(mixed_table_added_to, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(unknown_length, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(removed, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(not_copied, (np.array([[1.5, 0.3], [0.7, 2.0]]),), "x")
    yield Case(rebound_length, (np.array([0.7, 1.3, 0.4]), 1), ("x",))
    yield Case(part_from_the_end, (np.array([0.7, 1.3, 0.4]), 2), ("x",))
    yield Case(joined, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(repeated, (np.array([0.7, 1.3, 0.4]),), "x")
    yield Case(operands, (np.array([0.7, -1.3, 0.4]),), "x")
    yield Case(room_for_what_a_longer_list_gives, (np.array([0.7, 1.3, 0.4]), 4), ("x",))
    # refused
    yield Case(repeated_as_often_as_known_when_run, (np.ones(3),), refused=(
        "S201 at `out * len(x)`: repeating no written number of times a list: make it an array with np.array"))
    yield Case(beside_a_number_of_numpy, (np.array([0.7, -1.3, 0.4]),), "x")
    missing = "Python has no such operator for a"
    for kernel, marked, found in ((times_a_float, "out * x[0]", "list"), (less_a_written_number, "out - 1.0", "list"),
                                  (of_two_lists, "out - more", "list"),
                                  (pairs_of_floats, "pairs[0] * x[1]", "tuple that is an element of a list")):
        yield Case(kernel, (np.ones(3),), refused=(
            f"S201 at `{marked}`: {missing} {found}: make it an array with np.array"))
