"""Iterators: those that never end beside others, and items that are read when their turn comes."""
from __future__ import annotations

import itertools

import numpy as np

from tests.corpus import Case

X = np.array([0.7, 1.3, 0.9, 1.6, 0.4])
Y = np.array([1.1, 0.5, 1.2, 0.8, 0.6])


def over(x, least):
    found = []
    for v in x:
        if v > least:
            found.append(v * v)
    return found


def square(v):
    return v * v


def exceeds(v):
    return v > 2.0


def beside_what_ends(x, y):
    s = 0.0
    for k, v, w in zip(itertools.count(1), x, itertools.cycle((1.0, -2.0, 3.0))):
        s += k * v * w * v
    for v, k, w in zip(over(x, 0.8), itertools.count(5, -2), itertools.repeat(y[0])):
        s += k * v * w
    for k, (v, w) in enumerate(zip(x, itertools.cycle((y[1], y[2] * y[2])))):
        s += k * v * w
    for f, v in zip(itertools.cycle((np.sin, np.cos)), (x[0], x[1], x[2])):
        s += f(v)
    ys = [k * v for k, v in zip(itertools.count(), y)]
    s += sum(map(lambda a, b: a * b, ys, itertools.repeat(2.0)))
    for t, v in zip(itertools.count(0.0, 0.1), x):
        s += np.sin(t * v)
    return s


def first_of_several(x):
    previous, s = None, 0.0
    for v, w, k in zip(x, itertools.cycle((1.0, 2.0, 3.0)), itertools.count(3)):
        if previous is not None:
            s += (v - previous) ** 2 * w * k
        previous = v
    return s


def neighbours(x):
    s = sum((b - a) ** 3 for a, b in itertools.pairwise(x))
    for k, (a, b) in enumerate(itertools.pairwise(over(x, 0.6))):
        s += k * a * b * b
    for a, b in itertools.pairwise(x):      # an element is read a round before it is the first of two
        s += a * b * b
        x[1], x[2] = s, s * x[3]
    grid = x.reshape(5, 1) * x
    for u, v in itertools.pairwise(grid):
        v[0] += u[1]
        s += np.sum(u * v)
    return s


class Source:
    """Numbers and signs of what it makes."""

    def __init__(self):
        self.numbers, self.signs = itertools.count(1), itertools.cycle((1.0, -1.0))

    def make(self, v):
        return next(self.numbers), v * next(self.signs)


def asked_one_by_one(x):
    source, s, c = Source(), 0.0, itertools.count(2)
    for k in range(4):
        number, v = source.make(x[k])
        s += number * v ** 3
    for v in x:
        if v > 0.8:
            s += next(c) * v
    first = next(c) if s > 100.0 else 7
    for k, v in zip(source.numbers, x):
        s += first * k * v * v
    return s


def some_of_many(x):
    def powers():
        a, b = x[0], x[1]
        while True:
            yield a
            a, b = b, a * b
    s = sum(itertools.islice(powers(), 5)) + sum(v * v for v in itertools.islice(x, 1, 5, 2))
    for k in itertools.islice(itertools.count(1), 1, 4):
        s += k * x[k] ** 2
    for v, w in zip(x, itertools.islice(itertools.cycle((1.0, 2.0)), 3)):
        s += v * w
    for v in itertools.islice(over(x, 0.6), 1, None):
        s += v * v
    for k in itertools.takewhile(lambda k: k < 3, itertools.count()):
        s += k * x[k]
    return s + sum(itertools.starmap(lambda a, b: a * b, ((x[0], x[1]), (x[2], x[3])))) * sum(
        v * v for v in itertools.chain.from_iterable(([x[0], x[1]], [x[2]])))


def alone(x):
    ws, s = [x[0], x[1]], 0.0
    for w in itertools.cycle(ws):
        s += x[3] * w * w
        ws[1] = x[2] * x[2]         # read in the first round, and kept from then on
        if s > 9.0:
            break
    for w in itertools.repeat(x[4]):
        s += w
        if s > 12.0:
            break
    return s


def read_in_their_turn(x):
    ws = [x[0], x[1]]
    its = iter(ws), iter(zip(ws, x)), iter(ws)
    ws[0] = x[2] * x[2]
    ws.append(x[3])
    s = next(its[0]) * next(its[0]) * next(its[0])
    (a, b), (c, d) = next(its[1]), next(its[1])
    s += a * b * c * d + next(its[2])
    for v in its[2]:
        s += v * v
        ws[2] = s
    held = {"a": x[0], "b": x[1]}
    values = iter(held.values())
    held["b"] = x[3] ** 2
    return s * next(values) * next(values) + next(iter(v * v for v in ws))


def backwards_from_where_it_was(x):
    ws, shorter = [x[0], x[1]], [x[2], x[3]]
    it, some, rest = reversed(ws), reversed(ws), reversed(shorter)
    ws.append(x[2] * x[2])
    shorter.pop()
    s = sum(rest) + x[4]
    for k, v in enumerate(it):
        s += (k + 1) * v * v
    a, b = list(some)
    return s * a + b


def computed_in_their_turn(x):
    ys = list(map(square, over(x, 0.6)))
    s = sum(map(lambda a, b: a * b, ys, reversed(over(x, 0.8)))) + max(map(np.sin, ys))
    kept = list(filter(lambda v: v > 0.8, x))
    s += kept[0] * kept[1] * len(kept) + sum(filter(lambda v: v > 1.0, (x[0], x[1], x[3])))
    for k, v in enumerate(map(square, ys)):
        s += k * v
        ys[1] = s
    for v in (w * w for w in over(x, 0.5) if w > 0.3):
        s += v * v
    for v in filter(lambda v: v > 1.0, x):
        s += v ** 3
    return s if any(map(exceeds, ys)) else x[0]


def changed_in_a_cycle(x):
    ws, s = [x[0], x[1]], 0.0
    for v, w in zip(x, itertools.cycle(ws)):
        s += v * w
        ws[1] = x[2] * x[2]
    return s


def cycle_of_an_array(x):
    return sum(v * w for v, w in zip(x, itertools.cycle(x[:2])))


def none_ends(x):
    s = 0.0
    for i, j in zip(itertools.count(), itertools.count(1)):
        if j > 3:
            break
        s += x[i] * x[j]
    return s


def all_of_what_never_ends(x):
    return sum(itertools.count()) * x[0]


def count_of_a_number_of_the_run(x):
    return sum(np.sin(t * v) for t, v in zip(itertools.count(x[0], 0.1), x))


def part_from_behind(x):
    return sum(itertools.islice(x, -2))


def twice_beside_what_ends(x):
    turns, total = itertools.cycle((2.0, 3.0, 5.0)), 0.0
    for v, w in zip(x, turns):
        total += v * w
    for w, v in zip(turns, x):
        total += v * w
    return total


_NEVER = ("an iterator that never ends, of which all items are asked for: go through it beside what ends, as in "
          "zip(x, itertools.count()), or take some: itertools.islice(it, n)")


def cases():
    yield Case(beside_what_ends, (X, Y), ("x", "y"))
    yield Case(neighbours, (X,), "x", ("x", "return"))
    for kernel in (first_of_several, asked_one_by_one, some_of_many, alone, read_in_their_turn, computed_in_their_turn,
                   backwards_from_where_it_was):
        yield Case(kernel, (X,), "x")
    for kernel, place, why in (
            (changed_in_a_cycle, "zip(x, itertools.cycle(ws))", "a list that changes while itertools.cycle goes "
             "through it: give it a copy: itertools.cycle(tuple(...))"),
            (cycle_of_an_array, "itertools.cycle(x[:2])", "itertools.cycle of an array or a list of the run, which "
             "keeps what it gives first: take the items by their places: w[k % len(w)]"),
            (none_ends, "zip(itertools.count(), itertools.count(1))", "several iterators at once of which none ends: "
             "go through one of them, and count in the loop: k += 1"),
            (all_of_what_never_ends, "sum(itertools.count())", _NEVER),
            (count_of_a_number_of_the_run, "zip(itertools.count(x[0], 0.1), x)", "where a count beside other sequences "
             "starts, and its step, must be known before the run"),
            (twice_beside_what_ends, "zip(turns, x)", "an iterator that never ends is gone through twice, and goes on "
             "where it was left: make another one"),
            (part_from_behind, "itertools.islice(x, -2)", "itertools.islice with what is no place from the start")):
        yield Case(kernel, (X,), refused=f"S201 at `{place}`: {why}")
