"""Functions that are held fixed, against differences of the kernel in which their results are replayed."""
from __future__ import annotations

import math
import sys

import numpy as np
import pytest

import s2sad
from tests.harness.seeds import generator

ENGINES = ("numpy", "numba")


@s2sad.nondifferentiable
def total(u):
    return u.sum()


@s2sad.nondifferentiable
def product(u, i):
    return u[i] * u[i - 1]


@s2sad.nondifferentiable(result="int")
def largest(u):
    return int(np.argmax(u))


@s2sad.nondifferentiable
def square(x):
    return x * x


@s2sad.rule(x="math.cos(x) * a", a="math.sin(x)")
def wave(x, a):
    return math.sin(x) * a


def reads_what_the_loop_writes(u, v):
    for i in range(u.size):
        s = total(u)
        u[i] = s * v[i] * wave(u[i], v[i])


def reads_elements(u, v):
    for i in range(1, u.size):
        u[i] = product(u, i) * v[i] + u[i - 1] * square(u[i])
        v[i] = v[i] * u[i]


def chooses_an_element(u, v):
    t = 0.0
    for _ in range(3):
        j = largest(u)
        u[j] = -u[j] * v[j]
        t += wave(u[j] * t, v[0]) * total(v)
        v[:] = v * 0.9 + u * t
    return t


def ends_a_loop(u, v):
    while total(u) < 5.0:
        for i in range(u.size):
            u[i] += 0.3 + wave(v[i], u[i]) ** 2
        v[largest(u)] *= square(total(v))
    return total(u) * u[0]


def stepped(u, v, i):
    u[i] = u[i] * total(v) + wave(v[i], 1.0)
    return product(u, i) * v[i]


def within_a_helper(u, v):
    r = 0.0
    for i in range(u.size):
        r += stepped(u, v, i) * r + 1.0
        v[i] = r
    return r


def beside_whole_arrays(u, v):
    w = u * v
    s = total(w)
    w[:] = w * s + wave(s, u[0])
    v[1:] += w[:-1] * w[1:]
    return np.sum(w) * total(v)


KERNELS = [(reads_what_the_loop_writes, "u"), (reads_elements, "uv"), (chooses_an_element, "uvr"),
           (ends_a_loop, "uvr"), (within_a_helper, "uvr"), (beside_whole_arrays, "vr")]


def replayed(kernel, u, v, monkeypatch):
    """The kernel as a function of a flat vector, with the held functions' results as they are at (u, v)."""
    held, module, results = ("total", "product", "largest", "square"), sys.modules[__name__], []

    def noting(function):
        def called(*arguments):
            results.append(function(*arguments))
            return results[-1]
        return called
    with monkeypatch.context() as patch:
        for name in held:
            patch.setattr(module, name, noting(getattr(module, name)))
        kernel(u.copy(), v.copy())

    def run(x):
        remaining, (first, second) = iter(results), np.split(x.copy(), 2)
        with monkeypatch.context() as patch:
            for name in held:
                patch.setattr(module, name, lambda *arguments: next(remaining))
            result = kernel(first, second)
        return {"u": first, "v": second, "r": result}
    return run


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("kernel", "outputs"), KERNELS, ids=[k.__name__ for k, _ in KERNELS])
def test_held_fixed(kernel, outputs, engine, monkeypatch):
    rng = generator(1)
    u, v = rng.uniform(0.2, 1.0, 5), rng.uniform(0.2, 1.0, 5)
    run, x = replayed(kernel, u, v, monkeypatch), np.concatenate([u, v])
    seeds = {name: rng.standard_normal(5) if name in "uv" else rng.standard_normal() for name in outputs}

    def weighed(shifted):
        found = run(shifted)
        return math.fsum(float(np.sum(seeds[name] * found[name])) for name in outputs)
    shifts = 1e-4 * np.eye(10)
    expected = [(8 * (weighed(x + h) - weighed(x - h)) - weighed(x + 2 * h) + weighed(x - 2 * h)) / 12e-4
                for h in shifts]
    ours = s2sad.differentiate(kernel, engine=engine)
    given = {{"r": "return"}.get(name, name): seed for name, seed in seeds.items()}
    found = s2sad.vjp(ours, (u, v), given, wrt=("u", "v"))
    np.testing.assert_allclose(np.concatenate([found["u"], found["v"]]), expected, rtol=1e-9,
                               atol=1e-10 * np.abs(expected).max())
