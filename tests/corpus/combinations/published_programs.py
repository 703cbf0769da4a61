"""Programs as scientists publish them: registries, callbacks, properties, mixins, queues, units, early exits."""
from __future__ import annotations

import abc
import bisect
import enum
import heapq
import itertools
import math
from collections import defaultdict
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from tests.corpus import Case


class Integrator(abc.ABC):
    order = 0

    def __init__(self, rhs, dt):
        self.rhs, self.dt, self.evaluations = rhs, dt, 0

    @abc.abstractmethod
    def step(self, t, y):
        ...

    def f(self, t, y):
        self.evaluations += 1
        return self.rhs(t, y)

    def integrate(self, y0, t_end):
        t, y = 0.0, np.array(y0, dtype=float)
        history = [(t, y.copy())]
        while t < t_end - 1e-12:
            y = self.step(t, y)
            t += self.dt
            history.append((t, y.copy()))
        return history


class Euler(Integrator):
    order = 1

    def step(self, t, y):
        return y + self.dt * self.f(t, y)


class Midpoint(Integrator):
    order = 2

    def step(self, t, y):
        half = y + 0.5 * self.dt * self.f(t, y)
        return y + self.dt * self.f(t + 0.5 * self.dt, half)


METHODS = {cls.__name__.lower(): cls for cls in (Euler, Midpoint)}


def oscillator(p, method):
    def rhs(t, y):
        return np.array([y[1], -p[0] * y[0] - p[1] * y[1] + p[2] * math.sin(t)])
    solver = METHODS[method](rhs, dt=0.25)
    ys = np.array([y for _, y in solver.integrate([1.0, 0.0], 1.0)])
    return np.sum(ys[:, 0] ** 2) + solver.order * ys[-1, 1] + 0.001 * solver.evaluations


class Simulation:
    diagnostics = {}

    @classmethod
    def diagnostic(cls, name):
        def register(function):
            cls.diagnostics[name] = function
            return function
        return register

    def __init__(self, n, dt, **params):
        self.t, self.dt, self.params = 0.0, dt, params
        self.u, self.records = np.zeros(n), defaultdict(list)

    def run(self, steps, every=2):
        for k in range(steps):
            p = self.params
            lap = np.roll(self.u, 1) - 2 * self.u + np.roll(self.u, -1)
            self.u = self.u + self.dt * (p["D"] * lap + p["r"] * self.u * (1 - self.u / p["K"]))
            self.t += self.dt
            if (k + 1) % every == 0:
                for name, function in self.diagnostics.items():
                    self.records[name].append(function(self))


@Simulation.diagnostic("mass")
def mass(simulation):
    return np.sum(simulation.u)


@Simulation.diagnostic("peak")
def peak(simulation):
    return np.max(simulation.u) * simulation.t


def with_diagnostics(p, u):
    simulation = Simulation(5, 0.05, D=p[0], r=p[1], K=p[2] + 2)
    simulation.u[:] = u
    simulation.run(4)
    return sum(simulation.records["mass"]) + np.dot(simulation.records["peak"], [1.0, 2.0])


class Thermostat:
    def __init__(self, v):
        self._v = np.array(v)

    @property
    def temperature(self):
        return np.mean(self._v ** 2)

    @temperature.setter
    def temperature(self, value):
        self._v *= np.sqrt(value / self.temperature)

    @staticmethod
    def drag(v, g):
        return v * (1 - g)

    def advance(self, g):
        self._v = self.drag(self._v, g)
        return self


def thermostat(x):
    t = Thermostat(x)
    for g in (0.1, 0.2):
        t.advance(g * x[0]).temperature = 0.8 + g
        t.temperature *= 1.1
    return np.sum(t._v ** 3)


class Covariance:
    def __add__(self, other):
        return Combined(self, other, lambda a, b: a + b)

    def __mul__(self, other):
        return Combined(self, other, lambda a, b: a * b)


@dataclass
class Squared(Covariance):
    length: float

    def __call__(self, a, b):
        return math.exp(-0.5 * ((a - b) / self.length) ** 2)


@dataclass
class Linear(Covariance):
    c: float

    def __call__(self, a, b):
        return 1.0 + self.c * a * b


class Combined(Covariance):
    def __init__(self, a, b, does):
        self.a, self.b, self.does = a, b, does

    def __call__(self, x, y):
        return self.does(self.a(x, y), self.b(x, y))


def gaussian_process(theta):
    k = Squared(theta[0]) * Linear(theta[1]) + Squared(theta[2])
    xs = np.array([0.0, 0.4, 1.1])
    y, cov = np.sin(xs), np.array([[k(a, b) for b in xs] for a in xs]) + 0.1 * np.eye(3)
    return 0.5 * y @ np.linalg.solve(cov, y) + np.sum(np.log(np.diag(np.linalg.cholesky(cov))))


def roots(x, tolerance):
    """A way out of the inner loop, of the round, and of the function."""
    total = 0.0
    for a in x:
        y = 1.0
        for _ in range(30):
            r = y * y * y - a
            if abs(r) < tolerance:
                break
            dy = r / (3 * y * y)
            if abs(dy) > 10:
                return -1.0
            y -= dy
        else:
            y = 0.0
        if y == 0.0:
            continue
        total += y
    return total


def settings(x):
    given = SimpleNamespace(nu=x[0], dt=0.05, steps=3)
    for name, v in (("c", x[1]), ("f", x[2])):
        setattr(given, name, v)
    u = np.sin(np.linspace(0, 3, 7))
    for _ in range(given.steps):
        old = u.copy()
        u[1:-1] = old[1:-1] - given.c * given.dt * (old[1:-1] - old[:-2])
        u += given.dt * given.f * getattr(given, "scale", 2.0) * given.nu
    sums = list(itertools.accumulate(x, lambda a, b: a * 0.5 + b))
    later = list(itertools.accumulate([x[0], x[1]], initial=2.0))
    return np.sum(u * u) + sums[-1] * sums[0] + later[2] * later[0]


def events(x):
    queue = []
    for t, name in ((3, "b"), (1, "a"), (2, "c")):
        heapq.heappush(queue, (t, name))
    rates, s = {"a": x[0], "b": x[1], "c": x[2]}, 0.5
    while queue:
        t, name = heapq.heappop(queue)
        s = s * rates[name] + t
        if name == "a" and t < 4:
            heapq.heappush(queue, (t + 4, "a"))
    return s


def events_of_the_run(x):
    queue = []
    for v in (x[0], x[1]):
        heapq.heappush(queue, (v, 1))
    return heapq.heappop(queue)[0]


class Options(enum.Flag):
    NONE = 0
    DAMPED = enum.auto()
    FORCED = enum.auto()
    ALL = DAMPED | FORCED


def with_flags(x):
    options = Options.DAMPED | Options.FORCED
    y, v = x[0], x[1]
    for k in range(3):
        a = -y
        if Options.DAMPED in options:
            a -= x[2] * v
        if options & Options.FORCED:
            a += math.cos(0.1 * k)
        if options & Options.NONE or ~Options.DAMPED & Options.DAMPED:
            a += 100.0
        if options is Options.ALL and options == Options.ALL:
            a += 0.5 * x[0]
        v += 0.1 * a
        y += 0.1 * v
    return y * y + v


def interpolated(y):
    knots = [0.0, 0.3, 0.7, 1.0]

    def at(t):
        i = min(max(bisect.bisect_right(knots, t) - 1, 0), len(knots) - 2)
        w = (t - knots[i]) / (knots[i + 1] - knots[i])
        return (1 - w) * y[i] + w * y[i + 1]
    return sum(at(0.2 * k) ** 2 for k in range(6)) + at(y[0] * 0.5) + bisect.bisect_left([1, 2, 4], 2)


def cases():
    x, y = np.array([0.7, 1.3, 0.4]), np.array([0.31, 0.92, 0.53, 1.24, 0.75])
    for method in METHODS:
        yield Case(oscillator, (x, method), "p")
    yield Case(with_diagnostics, (x, y), ("p", "u"))
    yield Case(roots, (y, 1e-3), "x")
    yield Case(interpolated, (y[:4],), "y")
    yield Case(gaussian_process, (x,), ("theta",))
    for kernel in (thermostat, settings, events, with_flags, events_of_the_run):
        yield Case(kernel, (x,), "x")
