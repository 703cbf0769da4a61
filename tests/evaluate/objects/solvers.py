"""Simulations whose state and methods live in objects, as published codes have it."""
from __future__ import annotations

import math
import sys
from collections import namedtuple
from enum import Enum

import numpy as np

from tests.corpus import Case


LIMITERS = {1: np.array([1.0, 0.5]), 2: np.array([0.75, 0.25])}
DEBUG = False
Box = namedtuple("Box", "lo hi")


class Edge(Enum):
    PERIODIC = 1
    REFLECT = 2


class Grid:
    """A grid with ghost cells; its fields are made by the constructor, one of them computed."""
    ghost = 2

    def __init__(self, n, lo=0.0, hi=1.0, edge="periodic", names=("u",)):
        self.n, self.lo, self.hi, self.edge = n, lo, hi, edge
        self.first, self.last = self.ghost, self.ghost + n - 1
        self.centres = lo + (np.arange(n + 2 * self.ghost) - self.ghost + 0.5) * self.width
        self.data = {}
        for name in names:
            self.data[name] = np.zeros(n + 2 * self.ghost, dtype=np.float64)

    @property
    def width(self):
        return (self.hi - self.lo) / self.n

    def scratch(self):
        return np.zeros(self.n + 2 * self.ghost)

    def fill(self, name="u"):
        u = self.data[name]
        if self.edge == "periodic":
            u[:self.first] = u[self.last - self.ghost + 1:self.last + 1]
            u[self.last + 1:] = u[self.first:self.first + self.ghost]
        elif self.edge == "outflow":
            u[:self.first] = u[self.first]
            u[self.last + 1:] = u[self.last]
        else:
            sys.exit(f"unknown edge {self.edge}")

    def norm(self, e):
        if len(e) != self.n + 2 * self.ghost:
            return None
        return np.sqrt(self.width * np.sum(e[self.first:self.last + 1] ** 2))


class Solver:
    """Finite volumes; a subclass chooses the states at the faces."""
    def __init__(self, grid, courant=0.5, order=1):
        self.grid, self.courant, self.order = grid, courant, order
        self.t, self.steps = 0.0, 0
        self.history = []

    def limit(self, dt, stop):
        return min(dt, stop - self.t)

    def timestep(self):
        g = self.grid
        return self.courant * g.width / max(abs(g.data["u"][g.first:g.last + 1]))

    def faces(self, u):
        return u[:-1], u[1:]

    def flux(self, left, right):
        speed = 0.5 * (left + right)
        up = np.where(speed > 0.0, left, right)
        return 0.5 * up * up

    def rate(self):
        g = self.grid
        g.fill()
        left, right = self.faces(g.data["u"])
        flux = self.flux(left, right)
        out = g.scratch()
        out[1:-1] = -(flux[1:] - flux[:-1]) / g.width
        return out

    def advance(self, stop):
        while self.t < stop:
            dt = self.limit(self.timestep(), stop)
            u = self.grid.data["u"]
            before = u.copy()
            u[:] = before + dt * self.rate()
            if self.order == 2:
                u[:] = 0.5 * (before + u + dt * self.rate())
            self.t += dt
            self.steps += 1
            if DEBUG:
                print(f"{self.steps}: t = {self.t:.3f}")


class Limited(Solver):
    def __init__(self, grid, courant=0.5, order=2, weights=1):
        super().__init__(grid, courant, order)
        self.weights = LIMITERS[weights]

    def faces(self, u):
        slope = np.zeros_like(u)
        a, b = u[1:-1] - u[:-2], u[2:] - u[1:-1]
        limited = self.weights[0] * np.minimum(a, b) + self.weights[1] * np.maximum(a, b)
        slope[1:-1] = np.where(a * b > 0.0, limited, 0.0)
        return (u + 0.5 * slope)[:-1], (u - 0.5 * slope)[1:]


class Levels:
    """A list of grids, coarse to fine; methods pick one by its level."""
    def __init__(self, n, smoothing=2, verbose=0):
        self.smoothing, self.verbose = smoothing, verbose
        self.grids = []
        size = 2
        while size <= n:
            self.grids.append(Grid(size, edge="outflow", names=("v", "f", "r")))
            size *= 2
        self.number = len(self.grids)

    def smooth(self, level):
        g = self.grids[level]
        v, f = g.data["v"], g.data["f"]
        for _ in range(self.smoothing):
            g.fill("v")
            for colour in (0, 1):
                a = g.first + colour
                v[a:g.last + 1:2] = 0.5 * (v[a - 1:g.last:2] + v[a + 1:g.last + 2:2] - g.width ** 2 * f[a:g.last + 1:2])

    def cycle(self, level):
        self.smooth(level)
        if level > 0:
            fine, coarse = self.grids[level], self.grids[level - 1]
            fine.fill("v")
            v, f, r = (fine.data[k] for k in ("v", "f", "r"))
            r[1:-1] = f[1:-1] - (v[:-2] - 2.0 * v[1:-1] + v[2:]) / fine.width ** 2
            coarse.data["v"][:] = 0.0
            coarse.data["f"][coarse.first:coarse.last + 1] = 0.5 * (
                r[fine.first:fine.last + 1:2] + r[fine.first + 1:fine.last + 1:2])
            self.cycle(level - 1)
            correction = coarse.data["v"][coarse.first:coarse.last + 1]
            v[fine.first:fine.last + 1:2] += correction
            v[fine.first + 1:fine.last + 1:2] += correction
        self.smooth(level)
        if self.verbose:
            print("level", level, "residual", fine.norm(r))


class Counted:
    """An objective that counts its calls, as optimisers' test functions do; extra arguments are never used."""
    def __init__(self, n):
        self.calls, self.n, self.shift = 0, n, np.linspace(0.0, 1.0, n)

    def value(self, x, *args):
        self.calls += 1
        return sum((x - self.shift) ** 2) + self.n * math.exp(-x[0] ** 2)


class Spring:
    __slots__ = ("k", "rest", "ends")

    def __init__(self, k, rest, *ends):
        self.k, self.rest, self.ends = k, rest, ends

    def force(self, x):
        i, j = self.ends
        return self.k * (x[j] - x[i] - self.rest)


def made_inside(x):
    grid = Grid(16)
    solver = Solver(grid)
    grid.data["u"][grid.first:grid.last + 1] = x
    solver.advance(0.1)
    return np.sum(grid.data["u"] ** 2) + solver.t


def subclass(x):
    solver = Limited(Grid(16, edge="outflow"), courant=0.4, weights=2)
    solver.grid.data["u"][2:18] = x
    solver.advance(0.05)
    return solver.grid.norm(solver.grid.data["u"])


def given_object(solver, x):
    solver.grid.data["u"][2:18] = x
    solver.advance(0.1)
    return np.sum(solver.grid.data["u"] ** 3)


def levels(x):
    mg = Levels(16)
    top = mg.grids[mg.number - 1]
    top.data["f"][top.first:top.last + 1] = x
    for _ in range(2):
        mg.cycle(mg.number - 1)
    return np.sum(top.data["v"] ** 2)


def springs(x):
    net = [Spring(1.0 + 0.1 * i, 0.05, i, i + 1) for i in range(len(x) - 1)]
    x = x.copy()
    v = np.zeros_like(x)
    for _ in range(5):
        force = np.zeros_like(x)
        for s in net:
            f = s.force(x)
            force[s.ends[0]] += f
            force[s.ends[1]] -= f
        v += 0.1 * force
        x += 0.1 * v
    return sum(s.k * (x[s.ends[1]] - x[s.ends[0]] - s.rest) ** 2 for s in net)


def generators(x):
    a, b, c, d = (x[k::4] for k in range(4))
    box = Box(lo=a, hi=b)
    parts = {name: f(c) for name, f in zip(("sin", "exp"), (np.sin, np.exp))}
    edge = Edge.PERIODIC
    shift = np.roll(d, 1) if edge is Edge.PERIODIC else d
    return np.sum((box.hi - box.lo) * parts["sin"] * parts["exp"]) + np.sum(shift * d)


def extra_arguments(x, *args, **options):
    scale = options.get("scale", 2.0)
    return scale * np.sum(x ** 2) + sum(args)


def cases():
    x = 1.0 + 0.3 * np.random.default_rng(5).random(16)
    for kernel in (made_inside, levels, springs, generators, extra_arguments):
        yield Case(kernel, (x,), "x")
    yield Case(Counted(16).value, (x,), "x")
