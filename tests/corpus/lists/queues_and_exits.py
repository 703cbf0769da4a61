"""Queues of a loop that is left, of another length on each way, and deques that keep the last items."""
from collections import deque

import numpy as np

from tests.corpus import Case


def read_in_the_loop_alone(b, tolerance):
    recent, total = deque(maxlen=2), 0.0
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b[0])
        total = total + sum(recent)
    return total + b[1]


class Window:
    def __init__(self):
        self.recent, self.total = deque(maxlen=3), 0.0

    def filled(self, b, tolerance):
        for _ in range(4):
            b = b * 0.8
            if np.sum(b) < tolerance:
                return b
            self.recent.append(b[0])
            self.total = self.total + self.recent[0] * len(self.recent)
        return b * 2.0


def of_an_object(b, tolerance):
    window = Window()
    return window.filled(b, tolerance)[0] + window.total


def another_one_behind(b, tolerance):
    recent = deque(maxlen=2)
    kept = recent
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        kept.append(b[0])
    recent = deque([b[1]])
    recent.append(b[2])
    return sum(recent) * b[0]


def of_one_length(b, tolerance):
    recent = deque([b[0], b[1]], maxlen=2)
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b[0])
    return sum(recent) + b[1]


def of_differences(b, tolerance):
    recent = deque(maxlen=3)
    for _ in range(5):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b)
        if len(recent) < 2:
            b = b - 0.01
            continue
        b = b + 0.01 * np.array([recent[k + 1] - recent[k] for k in range(len(recent) - 1)]).sum(axis=0)
    return np.sum(b ** 2)


def read_behind(b, tolerance):
    recent = deque(maxlen=2)
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b[0])
    return sum(recent) + b[1]


def read_of_a_pair(b, tolerance):
    recent = deque(maxlen=2)
    pair = (recent, b[0])
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b[0])
    return pair[1] * b[0]


def read_of_an_object(b, tolerance):
    window = Window()
    b = window.filled(b, tolerance)
    return b[0] * len(window.recent)


def newest_behind(b, tolerance):
    recent = deque(maxlen=2)
    for _ in range(4):
        b = b * 0.8
        if np.sum(b) < tolerance:
            break
        recent.append(b[0])
    return recent[-1] * b[1] if len(recent) == recent.maxlen else b[2]


def emptied(x):
    window, s = deque(maxlen=3), 0.0
    for k in range(len(x)):
        window.append(x[k] ** 2)
        s += sum(window) * window[0] / len(window)
        if x[k] > 0.8:
            window.clear()
    return s


def full(x):
    last, s, t = deque([x[0], x[1], x[2]], maxlen=2), 0.0, 0.0
    while t < 2.1:
        last.append(x[0] * t + last[-1])
        t += x[1]
        if len(last) == last.maxlen:
            s += last[0] * last[1]
    return s


def of_pairs(x):
    steps, s, t = deque(maxlen=2), 0.0, 0.0
    while t < 2.1:
        steps.append((t, x[0] * t))
        t += x[1]
        for a, b in zip(steps, reversed(steps)):
            s += a[0] * b[1]
    return s


def extended(x):
    a, t = deque(maxlen=3), 0.0
    while t < 2.1:
        a.extend([t * x[2], t * t])
        a += (x[0],)
        t += x[1]
    return sum(a) * a[0]


def made_anew(x):
    a, s, t, k = deque(maxlen=2), 0.0, 0.0, 0
    while t < 2.1:
        a.append(t * x[2])
        if k == 2:
            a = deque(maxlen=4)
        s += sum(a)
        t += x[1]
        k += 1
    return s


def one_of_two(x):
    a, t = deque(maxlen=2), 0.0
    while t < 2.1:
        a.append(t * x[2])
        t += x[1]
    if x[0] > 0.5:
        a = deque(maxlen=4)
    a.append(x[1])
    return sum(a)


def of_two_lengths(x):
    s = 0.0
    for m in (2, 3):
        a, t = deque(maxlen=m), 0.0
        while t < 2.1:
            a.append(t * x[2])
            s += sum(a)
            t += x[1]
    return s


def cases():
    b = np.array([1.0, 0.8, 0.6])
    for kernel in (read_in_the_loop_alone, of_an_object, another_one_behind, of_one_length, of_differences):
        for tolerance in (0.31, 1.3, 2.1):
            yield Case(kernel, (b, tolerance), ("b",))
    for kernel in (read_behind, read_of_a_pair, read_of_an_object, newest_behind):
        for tolerance in (0.31, 0.5, 1.3):
            yield Case(kernel, (b, tolerance), ("b",))
    # deques whose items only the run counts
    x = np.array([0.7, 0.4, 0.9, 0.3])
    for kernel in (emptied, full, of_pairs, extended):
        yield Case(kernel, (x,), ("x",))
    yield Case(made_anew, (x,), refused=(
        "S201 at `while t < 2.1:`: 'a' is a list of other things in each round, or a deque of another length: give "
        "each a name of its own"))
    yield Case(one_of_two, (x,), refused=(
        "S201 at `a.append(x[1])`: a deque with a length is one of several: give each a name of its own"))
    yield Case(of_two_lengths, (x,), refused=(
        "S201 at `deque(maxlen=m)`: deques of several lengths are made here, whose items only the run counts: make "
        "each in a statement of its own"))
