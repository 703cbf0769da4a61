"""A kernel's files, imported anew as another process does."""
from __future__ import annotations

import importlib
import sys
from pathlib import Path

from s2sad import pipeline, read

KERNEL = '''
from dataclasses import dataclass
import numpy as np
from helpers_of_artifacts import SETTINGS, Shape, helper, settings

G = 2.0
WEIGHTS = np.array([1.0, 2.0])


@dataclass
class Params:
    k: float = 3.0
    n: int = 2


def f(x, c=1.5):
    return G * helper(x) * SETTINGS["a"] * settings.b * c * np.sum(WEIGHTS)


def made(x):
    p = Shape(x)
    return p.a * p.b


def structured(x, p):
    total = 0.0
    for i in range(p.n):
        total += p.k * helper(x) * (i + 1)
    return total


def summed(u):
    return np.sum(u * u) * G


def pair(x, y):
    return x * x * y


def picks(x, n):
    return x ** n


def found(x, keys):
    rows = {1: x, "b": x * x}
    return sum(np.sum(rows[key]) for key in keys)


def with_function(x):
    return applied(helper, x)


def applied(f, x):
    return f(x)


class Model:
    scale = 2.0

    def __init__(self):
        self.k = 3.0

    def energy(self, x):
        return self.scale * self.factor() * x

    def factor(self):
        return self.k


MODEL = Model()


def talking(x):
    print("here", x)
    return x * x


def through_work(x, work):
    work[0] = x * x
    return work[0] * G


def through(x):
    return MODEL.energy(x)
'''
HELPERS = '''
from dataclasses import dataclass
from types import SimpleNamespace

SETTINGS = {"a": 3.0}
settings = SimpleNamespace(b=5.0)


@dataclass
class Shape:
    a: float
    b: float = 7.0


def helper(x, *, power=2):
    return x ** power
'''


class Processes:
    """A kernel's files, imported anew as another process does; `derived` has what reached the compiler since."""

    def __init__(self, folder: Path, monkeypatch):
        self.folder, self.derived, self.read = folder, [], []
        self.write()
        derive, load = pipeline.derive, read.load
        monkeypatch.setattr(pipeline, "derive", lambda program, request, **given: self.derived.append(
            request) or derive(program, request, **given))
        monkeypatch.setattr(read, "load", lambda *given: self.read.append(given) or load(*given))

    def write(self, kernel=KERNEL, helpers=HELPERS):
        (self.folder / "kernel_of_artifacts.py").write_text(kernel)
        (self.folder / "helpers_of_artifacts.py").write_text(helpers)

    def fresh(self):
        for name in ("kernel_of_artifacts", "helpers_of_artifacts"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        self.derived.clear()
        self.read.clear()
        return importlib.import_module("kernel_of_artifacts")

    @property
    def warm(self):
        return not self.derived and not self.read
