"""Queues of a loop that is left: of another length on each way, they are refused where they are read behind it."""
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


def cases():
    b = np.array([1.0, 0.8, 0.6])
    for kernel in (read_in_the_loop_alone, of_an_object, another_one_behind, of_one_length, of_differences):
        for tolerance in (0.31, 1.3, 2.1):
            yield Case(kernel, (b, tolerance), ("b",))
    for kernel, place, called in ((read_behind, "recent", "recent"), (read_of_a_pair, "pair", "pair"),
                                  (read_of_an_object, "window.recent", "window_recent")):
        yield Case(kernel, (b, 0.5), ("b",), refused=(
            f"S201 at `{place}`: '{called}' has another length on each way: append to it on both, or on none"))
