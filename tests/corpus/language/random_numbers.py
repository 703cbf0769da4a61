"""Random numbers that a kernel draws from a sequence that it begins are data, the same each time that it runs again; a
sequence that goes on from outside is refused."""
from __future__ import annotations

import random

import numpy as np
from numpy.random import randn

from tests.corpus import Case


def of_a_generator(x):
    rng = np.random.default_rng(0)
    noise = rng.standard_normal(3)
    rng.normal()
    noise *= x[0]
    w = rng.uniform(-1.0, 1.0, (3, 2)) @ np.ones(2)
    return np.sum(noise * x) + np.sum(w * x ** 2) + rng.normal(x[1], 0.1)


def kick(u, rng, k):
    noise = rng.normal(0.1, abs(u[0]), size=u.size)
    for i in range(u.size):
        u[i] = np.sin(u[i] * noise[i]) + 0.1 * k + rng.normal() * u[i]


def by_a_helper_that_runs_again(x):
    rng = np.random.default_rng(3)
    u = x.copy()
    for k in range(4):
        kick(u, rng, k)
    return np.sum(u ** 2)


def while_it_grows(x):
    rng = np.random.RandomState(3)
    u = x.copy()
    while np.sum(u) < 20.0:
        rng.normal()
        u = u * 1.5 + 0.1 * rng.normal(size=(x.size,))
    return np.sum(u ** 2)


class Walker:
    def __init__(self, seed):
        self.rng, self.means = np.random.default_rng(seed), []

    def step(self, u):
        u = u + 0.1 * self.rng.normal(size=len(u)) * np.sqrt(np.abs(u))
        self.means.append(u.mean())
        return u


def in_an_object(x):
    walker, u = Walker(5), x
    for _ in range(5):
        u = walker.step(u)
    return sum(walker.means) + np.sum(u * u)


def shake(u):
    u += 0.1 * np.random.randn(u.size) * u


def seeded(x):
    np.random.seed(0)
    u = x * np.random.rand()
    for _ in range(3):
        shake(u)
    np.random.seed(1)
    return np.sum(u ** 3) + np.random.uniform(0.0, x[0]) + np.sum(np.random.normal(x[1], x[2], (2, 3)))


def of_all_kinds(x):
    rng = np.random.default_rng(1)
    i, j = rng.integers(0, 3, size=5), rng.choice(x, 4)
    k = rng.choice(3, p=[0.2, 0.5, 0.3])
    p, y = rng.permutation(x), x.copy()
    rng.shuffle(y)
    total = np.sum(x[i] ** 2) + np.prod(j) + x[k] * p[0] + y[1] ** 3 + rng.poisson(3.0) * x[0]
    total += np.sum(rng.poisson(2.0, 3) * x) + rng.exponential(x[0]) + rng.gamma(2.0, x[1]) + rng.lognormal(x[0], 0.1)
    return total + rng.beta(2.0, 3.0) * x[1] + rng.binomial(5, 0.3) * x[2] + np.sum(rng.normal(x, 0.1 * x) ** 2)


def one_for_each_parameter(x):
    rng, old, n = np.random.default_rng(1), np.random.RandomState(1), np.array([3, 4, 5])
    total = np.sum(rng.integers(n) * x) + np.sum(rng.integers(n, n + 3, endpoint=True) * x ** 2)
    total += np.sum(old.randint(0, n) * x) + np.sum(rng.poisson(1.5 * n) * x) + np.sum(rng.binomial(n, 0.4) * x)
    total += np.sum(rng.beta(1.0 * n, 2.0) * x) + np.sum(rng.standard_gamma(1.0 * n) * x)
    return total + np.sum(rng.gamma(1.0 * n, x) ** 2) + np.sum(rng.gamma(1.0 * n, x[0]) * x)


def row_of_its_own(x):
    row = np.random.default_rng(1).choice(x)
    row *= 2.0
    return np.sum(x ** 2) + np.sum(row ** 3)


def paths(x):
    rng = np.random.default_rng(1)
    end = np.zeros(4)
    for p in range(4):
        s = x[0]
        for _ in range(5):
            s = s * np.exp((x[1] - 0.5 * x[2] ** 2) * 0.1 + x[2] * np.sqrt(0.1) * rng.standard_normal())
        end[p] = s
    return np.mean(np.maximum(end - 0.1, 0.0))


def one_for_each_round(x):
    total = 0.0
    for k in range(3):
        rng = np.random.default_rng(k)
        if rng.random() < 0.5:
            total += rng.standard_normal() * x[k] ** 2
        else:
            total += rng.standard_normal() * x[k]
    return total


def active_shape(x):
    rng = np.random.default_rng(1)
    return rng.gamma(x[0]) * x[1]


def in_a_branch(x):
    if x[0] > 0.0:
        np.random.seed(1)
    return np.random.rand() * x[0]


def unseeded(x):
    rng = np.random.default_rng()
    return rng.normal() * x[0]


def imported(x):
    return np.sum(randn(3) * x)


def of_python(x):
    return x[0] * random.random()


def cases():
    x = np.array([0.4, 1.2, 0.7])
    for kernel in (of_a_generator, by_a_helper_that_runs_again, while_it_grows, in_an_object, seeded, of_all_kinds,
                   one_for_each_parameter, paths, one_for_each_round):
        yield Case(kernel, (x,), ("x",), ("return",))
    yield Case(row_of_its_own, (np.outer(x, x[:2]),), ("x",), ("return",))
    yield Case(active_shape, (x,), ("x",), refused=(
        "S301 at `rng.gamma(x[0])`: 'standard_gamma' has no adjoint of its own, only its tangent: give it with "
        "s2sad.rule, whose docstring says what it takes and returns"))
    yield Case(in_a_branch, (x,), ("x",), refused=(
        "S201 at `np.random.seed(1)`: the sequence that all share is begun in a loop or a branch: make one of its own: "
        "rng = np.random.default_rng(seed)"))
    for kernel, said in ((unseeded, "np.random.default_rng"), (imported, "randn"), (of_python, "random.random")):
        yield Case(kernel, (x,), ("x",), refused=(
            f"S201 at `{said}`: '{said}' draws random numbers, or begins a sequence of them: begin it in the kernel, "
            "rng = np.random.default_rng(1), or draw them before and give them to the kernel as an argument: both "
            "sweeps read the same ones"))
