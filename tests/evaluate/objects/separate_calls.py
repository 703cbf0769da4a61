"""Functions that stay functions when they are called, and those that are written out: `CASES` says which stay."""
from __future__ import annotations

import functools

import numpy as np

from tests.corpus import Case

X = np.array([0.3, 0.7, 1.1, 1.9])
SCALE = np.array([1.0, 2.0, 0.5, 3.0])


class Grid:

    def __init__(self, n, width=0.5):
        self.n, self.width, self.calls = n, width, 0
        self.u, self.v = np.zeros(n), np.ones(n)
        self.shared = self.u

    def smooth(self, weight):
        self.u[1:-1] += weight * (self.u[:-2] - 2.0 * self.u[1:-1] + self.u[2:])

    def norm(self):
        return np.sqrt(self.width * np.sum(self.u ** 2) + 1.0)

    def counted(self):
        self.calls += 1
        return self.calls * self.width

    def chained(self, x):
        self.u[:] = x * self.v
        return self

    def both(self, x):
        self.u[:] = 2.0 * x
        return self.shared[0] + self.u[1]

    @property
    def inside(self):
        return self.u[1:-1]


def made(x):
    grid = Grid(4)
    grid.u[:] = x
    return grid


# -- what stays ------------------------------------------------------------------------------------------------------
def square(u, k):
    return k * u * u


def literals(x):
    return np.sum(square(x, 3.0) + square(np.sin(x), 0.5))


def power(u, p):
    return u ** p


def exponents(x):
    return np.sum(power(x, 2) + power(x, 3) + power(1.0 + x, 2))


def methods(x):
    grid = made(x)
    for _ in range(3):
        grid.smooth(0.1)
    return grid.norm() + np.sum(grid.u * x)


def filled(u, x):
    u[:] = x * x
    u[0] += x[1]


def an_effect_between_operands(x):
    u = np.ones(4)
    grid = made(x)

    def change(v):
        v[:] = v * x
        return v[0] + 1.0
    return grid.norm() + u[0] * change(u) + u[0] * change(u) + u[1]


def filled_by_a_function(x):
    grid = made(x)
    filled(grid.v, grid.u)
    return np.sum(grid.v * x)


def sides(u, k):
    left = k * u
    return left, u + left[0]


def several_results(x):
    a, b = sides(x, 2.0)
    for _ in range(2):
        a, b = sides(a * b, 0.1)
    return np.sum(a * b)


def early(u, v):
    if u[0] > 0.5:
        return u * v
    for k in range(u.size):
        if v[k] > 1.0:
            return k * u
    return u + v


def early_returns(x):
    grid = made(x)
    return np.sum(early(x, grid.v) + early(x + 1.0, grid.v) + early(x, grid.v + x))


def scale_of(k):
    w = np.full(4, k)

    def scaled(u):
        return w * u * k
    return scaled


def closures(x):
    grid = made(x)
    return np.sum(scale_of(2.0)(x) + scale_of(x[0])(grid.u))


def partials(x):
    f = functools.partial(square, k=x[1])
    return np.sum(f(x) + f(2.0 * x) * made(x).width)


def chosen(u, kind="sin", shift=None):
    found = np.sin(u) if kind == "sin" else np.cos(u)
    return found if shift is None else found + shift


def options_that_are_known(x):
    return np.sum(chosen(x) + chosen(x, "cos") + chosen(x, shift=x) + chosen(2.0 * x) + made(x).u)


def applied(f, u):
    return f(u) * f(u + 1.0)


def functions_that_are_given(x):
    return np.sum(applied(np.sin, x) + applied(lambda v: v * x[0], x) + made(x).u)


def chained(x):
    return made(x).chained(x).norm() * np.sum(x)


def outside(u):
    return SCALE * u


def arrays_from_outside(x):
    return np.sum(outside(x) * made(x).u)


def guarded(u):
    if u[0] < 0.0:
        raise ValueError("negative")
    return np.sqrt(u)


def guards(x):
    return np.sum(guarded(x) * made(x).u)


def printed(u):
    print("sum", u[0])
    return 2.0 * u


def printing(x):
    return np.sum(printed(x) * made(x).u)


def factorial(u, n):
    return u if n == 0 else n * u * factorial(0.5 * u, n - 1)


def recursion(x):
    return np.sum(factorial(1.0 * x, 3) * made(x).u)


class Pair:

    def __init__(self, a, b):
        self.a, self.b = a, b


def paired(u, v):
    return Pair(u + v, [u * v, 2.0])


def structures_of_what_is_new(x):
    pair = paired(x, made(x).v)
    pair.a = pair.a * 2.0
    pair.b.append(pair.a)
    return np.sum(pair.a * pair.b[0] * pair.b[1] + pair.b[2])


def added(u, v):
    u += v
    return u


def written_and_returned(x):
    grid = made(x)
    w = added(grid.u, x)
    w[0] = x[1] * w[1]
    return np.sum(grid.u * w)


def what_is_computed_is_written_and_returned(x):
    w = added(x * 2.0, x)
    return np.sum(w * x * made(x).u)


def an_array_of_two(x):
    a, b = x.copy(), 2.0 * x
    s = a if x[0] > 0.2 else b
    return two(s, a) + np.sum(a * s) + made(x).norm()


def read_before(u, v):
    u[0] = 2.0 * v[1]
    return v[0] * u[0] + v[1]


def parts_of_what_is_given(x):
    grid = made(x)
    return read_before(grid.u[:2], grid.u) + read_before(grid.u[1:3], grid.v) + np.sum(grid.u * x)


class Settings:
    level = 1.0

    def __init__(self):
        self.other = 2.0

    def run(self, x):
        self.choose()
        return self.level * self.other * np.sum(x * made(x).u)

    def choose(self):
        self.level = 3.0
        self.other = 5.0


def two(u, v):
    u[:] = u + v
    v[0] = 3.0 * u[0]
    return u[0] * v[1]


def one_array_given_twice(x):
    grid = made(x)
    return two(grid.u, grid.u) + two(grid.u, grid.v) + np.sum(grid.u * x)


def given_and_reached(x):
    grid = made(x)
    return grid.both(x) + np.sum(grid.shared * x)


def in_a_branch(x):
    grid = made(x)
    if x[0] > 0.2:
        filled(grid.v, x)
        y = sides(grid.v, 0.5)[1]
    else:
        y = grid.u
    return np.sum(y * grid.v)


def bound_anew(u, k):
    u = u * k
    u = u + k
    u[0] = k
    return u


def parameters_bound_anew(x):
    return np.sum(bound_anew(x, x[0]) * bound_anew(x, 2.0) * made(x).v)


def truth(u):
    if u[0] > 0.5:
        return True
    return False


def truths(x):
    grid = made(x)
    return np.sum(x * (2.0 if truth(grid.u) else 3.0)) + (1.0 if truth(x + 1.0) else 5.0) * x[1]


# -- what is written out ---------------------------------------------------------------------------------------------
def counting(x):
    grid = made(x)
    return grid.counted() * x[0] + grid.counted() * np.sum(x)


def a_view(x):
    grid = made(x)
    inside = grid.inside
    inside[0] = x[3] * x[3]
    return np.sum(grid.u * x)


def either(u, v, first):
    return u if first > 0.5 else v


def one_of_two(x):
    grid = made(x)
    w = either(grid.u, grid.v, x[0])
    return np.sum(w * x)


def counter_in_a_closure(x):
    n, total = 0, x[0]

    def step(u):
        nonlocal n, total
        n += 1
        total = total + u[n]
        return n * u
    found = np.sum(step(x)) + np.sum(step(x * x))
    return found + total * n


def grown(us, v):
    us.append(v)
    return len(us)


def a_list_that_grows(x):
    us = [x]
    n = grown(us, x * x)
    return np.sum(us[1]) * n


def kept(v, seen=[]):                                # noqa: B006
    return v * len(seen)


def a_default_that_is_a_list(x):
    return np.sum((kept(x) + x) * made(x).u)


def remembered(v, seen=[]):                         # noqa: B006
    seen.append(v)
    return seen[0] * len(seen)


def a_default_that_grows(x):
    return np.sum(remembered(x) + remembered(2.0 * x))


def summed_to(u, k):
    total = 0.0
    for i in range(k):
        total += u[i]
    return total


def numbers_of_rounds(x):
    return summed_to(x, 2) * summed_to(x, 4) + summed_to(x, 3) * made(x).norm()


REFUSED = {a_default_that_grows: "is from outside, and is changed"}
STAYS = {
    literals: ["square"], exponents: ["power", "power_2"], methods: ["Grid_smooth", "Grid_norm"],
    an_effect_between_operands: ["Grid_norm", "change"], filled_by_a_function: ["filled"],
    several_results: ["sides"], early_returns: ["early"], closures: ["scaled", "scaled_2"], partials: ["square"],
    options_that_are_known: ["chosen", "chosen_2", "chosen_3"], functions_that_are_given: ["applied", "applied_2"],
    chained: ["Grid_chained", "Grid_norm"], arrays_from_outside: ["outside"], guards: ["guarded"],
    printing: ["printed"], recursion: ["factorial", "factorial_2", "factorial_3"],
    structures_of_what_is_new: ["paired"], written_and_returned: ["added"], one_array_given_twice: ["two", "two_2"],
    given_and_reached: ["Grid_both"], in_a_branch: ["filled", "sides"], parameters_bound_anew: ["bound_anew"],
    truths: ["truth"], what_is_computed_is_written_and_returned: ["added"],
    an_array_of_two: ["two", "Grid_norm"], parts_of_what_is_given: ["read_before"],
    counting: [], a_view: [], one_of_two: [], counter_in_a_closure: [], a_list_that_grows: [],
    a_default_that_is_a_list: ["kept"], numbers_of_rounds: ["summed_to", "Grid_norm"],
}


def cases():
    for kernel in STAYS:
        yield Case(kernel, (X,), "x")
    yield Case(Settings().run, (X,), "x")
