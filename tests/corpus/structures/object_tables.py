"""Objects in lists of which only the run knows how long they become, which are changed: rows of tables."""
from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tests.corpus import Case

X = np.array([0.7, 0.9, 0.3])


class Particle:
    def __init__(self, x, v):
        self.x = x
        self.v = v
        self.age = 0.0
        self.alive = True

    def step(self, dt):
        self.x += self.v * dt
        self.v = self.v - 0.1 * self.x * dt
        self.age += dt
        if self.x > 0.9:
            self.alive = False


class Body:
    def __init__(self, pos, vel, m=1.0):
        self.pos, self.vel, self.m = pos, vel, m
        self.force = np.zeros(2)

    def kick(self, dt):
        self.vel = self.vel + dt * self.force / self.m

    def drift(self, dt):
        self.pos += dt * self.vel

    @property
    def energy(self):
        return 0.5 * self.m * np.sum(self.vel ** 2)


@dataclass
class Agent:
    x: float
    wealth: float = 1.0
    n: int = 0


class System:
    def __init__(self, x):
        self.x, self.t, self.parts = x, 0.0, []

    def emit(self):
        self.parts.append(Particle(self.x[0] * self.t, self.x[1]))

    def step(self, dt):
        self.emit()
        for p in self.parts:
            p.step(dt * self.x[2])
        self.parts = [p for p in self.parts if p.alive]
        self.t += dt


def emitted_and_lost(x):
    ps, t, total = [], 0.0, 0.0
    while t < 1.0:
        ps.append(Particle(x[0] * t, x[1]))
        for p in ps:
            p.step(0.6 * x[2])
        ps = [p for p in ps if p.alive]
        t += 0.1 + 0.01 * x[2]
        total += len(ps)
    return sum(p.x ** 2 + p.age for p in ps) + total * x[0]


def bodies_with_arrays(x):
    bodies = []
    for k in range(4):
        if x[k % 3] > 0.1 * k:
            bodies.append(Body(np.array([x[0] * k, x[1]]), np.array([0.1 * k, x[2]]), 1.0 + 0.1 * k))
    for _ in range(5):
        for b in bodies:
            b.force[:] = 0.0
        for i in range(len(bodies)):
            for j in range(i + 1, len(bodies)):
                d = bodies[j].pos - bodies[i].pos
                f = d / (np.sum(d ** 2) + 0.1) ** 1.5
                bodies[i].force += f
                bodies[j].force -= f
        for b in bodies:
            b.kick(0.05)
            b.drift(0.05)
    return sum(b.energy for b in bodies)


def dictionaries(x):
    ps, t = [], 0.0
    while t < 1.0:
        ps.append({"x": x[0] * t, "v": x[1], "n": 0})
        for p in ps:
            p["x"] += p["v"] * 0.3 * x[2]
            p["n"] += 1
        ps = [p for p in ps if p["x"] < 0.8]
        t += 0.1 * x[1]
    return sum(p["x"] ** 2 * p["n"] for p in ps)


def short_lists(x):
    ps, t = [], 0.0
    while t < 1.0:
        ps.append([x[0] * t, x[1]])
        for p in ps:
            p[0] += p[-1] * 0.3 * x[2]
        ps = [p for p in ps if p[0] < 0.8 and len(p) == 2]
        t += 0.1 * x[1]
    return sum(p[0] ** 2 * p[1] for p in ps)


def splitting(x):
    agents = [Agent(x[0] * i, 1.0 + x[1] * i) for i in range(4)]
    for step in range(6):
        new = []
        for a in agents:
            a.wealth *= 1.0 + 0.1 * x[2] * np.sin(a.x + step)
            a.n += 1
            if a.wealth > 2.5 and len(agents) + len(new) < 12:
                a.wealth /= 2.0
                new.append(Agent(a.x + 0.5 * x[0], a.wealth))
        agents.extend(new)
        agents = [a for a in agents if a.wealth > 0.2]
    return sum(a.wealth * a.n for a in agents) / len(agents)


def of_a_system(x):
    s = System(x)
    while s.t < 2.0:
        s.step(0.3 * x[1])
    return sum(p.x ** 2 + p.v ** 2 for p in s.parts)


def two_names_for_one(x):
    ps, hot, t = [], [], 0.0
    while t < 1.0:
        p = Particle(x[0] * t, x[1])
        ps.append(p)
        if t > 0.45:
            hot.append(p)
        p.x += 0.01
        for q in hot:
            q.v *= 1.1 * x[2]
        for q in ps:
            q.x += q.v * 0.1
        t += 0.2 * x[1]
    return sum(p.x ** 2 for p in ps) + sum(1.0 for p in ps if p in hot) * x[0]


def sorted_and_changed(x):
    ps, t = [], 0.0
    while t < 1.0:
        ps.append(Particle(np.sin(7 * t) * x[0], x[1]))
        ps.sort(key=lambda p: p.x)
        ps[0].x += 0.5 * x[2]
        ps[-1].v *= 0.9
        t += 0.2 * x[1]
    best = max(ps, key=lambda p: p.v * p.x)
    best.x *= 2.0
    return sum(p.x * p.v * (k + 1) for k, p in enumerate(ps))


def removed_while_a_copy_is_gone_through(x):
    ps, t = [], 0.0
    while t < 1.0:
        ps.append(Particle(np.sin(7 * t) * x[0], x[1]))
        for p in ps[:]:
            p.x += 0.1 * x[2]
            if p.x > 0.5:
                ps.remove(p)
        t += 0.2 * x[1]
    return sum(p.x * p.v * (k + 1) for k, p in enumerate(ps))


def the_best_of_many(x):
    swarm = [Particle(x[0] + 0.2 * k, x[1] * k) for k in range(6)]
    best = None
    for _ in range(4):
        for p in swarm:
            if best is None or (p.x - 0.5) ** 2 < (best.x - 0.5) ** 2:
                best = p
        for p in swarm:
            p.v = 0.7 * p.v + 0.3 * x[2] * (best.x - p.x)
            p.x += 0.1 * p.v
    return best.x + best.v


def copies(x):
    ps = []
    for k in range(5):
        if x[k % 3] > 0.5 or not ps:
            ps.append(Body(np.array([x[0], k]), x[1] * np.ones(2)))
        else:
            ps.append(copy.deepcopy(ps[k // 2]))
        ps[0].pos += 0.1 * x[2]
        ps[-1].vel = ps[-1].vel * x[0]
    return sum((k + 1) * np.sum(p.pos * p.vel) for k, p in enumerate(ps))


def read_before_it_is_filled(x):
    ps, s = [], 0.0
    for k in range(6):
        for p in ps:
            p.x += 0.1 * x[1]
            s += p.x * k
        if x[k % 3] > 0.5:
            ps.append(Particle(x[k % 3], s))
    return s + sum(p.v for p in ps)


class Vector:
    def __init__(self, x, y):
        self.x, self.y = x, y

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y)

    def __iadd__(self, other):
        self.x += other.x
        self.y += 2.0 * other.y
        return self

    def __sub__(self, other):
        return Vector(self.x - other.x, self.y - other.y)

    def __mul__(self, s):
        return Vector(self.x * s, self.y * s)

    def __neg__(self):
        return Vector(-self.x, -self.y)

    def __contains__(self, v):
        return v < self.x

    def __call__(self, v):
        return self.x * v

    def __len__(self):
        return 2

    def __getitem__(self, k):
        return self.y if k else self.x

    def __setitem__(self, k, v):
        self.x = v / (k + 1)

    def norm(self):
        return self.x ** 2 + self.y ** 2


class Moving:
    def __init__(self, place, speed):
        self.place, self.speed = place, speed


def objects_of_objects(x):
    bodies, shared = [], Vector(x[2], x[1])
    for k, v in enumerate(x):
        if v > 0.4:
            bodies.append(Moving(Vector(v, k), shared if k else Vector(x[1], x[2])))
    for _ in range(2):
        for b in bodies:
            b.place += b.speed * 0.1
            b.speed.y -= 0.05 * b.place.norm()
            b.place -= b.speed
            b.place.x *= 1.1
        bodies = [b for b in bodies if b.place.norm() < 9.0]
    return sum(b.place.norm() + b.speed.norm() for b in bodies) + shared.y


def in_place_operators(x):
    ps = []
    for k, v in enumerate(x):
        if v > 0.4:
            ps.append(Vector(v, k))
    p, q = ps[0], ps[1]
    p += Vector(x[1], x[2])
    ps[1] += Vector(x[0], x[2])
    ps[0] -= Vector(x[1], 1.0)
    return sum((k + 1) * v.norm() for k, v in enumerate(ps)) + p.x + q.y


def methods_by_name(x):
    ps = []
    for v in x:
        if v > 0.2:
            ps.append(Vector(v, 1.0))
    ps[0][1] = x[2]
    ps[1][0] += 1.0
    s = sum(p(x[1]) + (-p).x * len(p) for p in ps) + sum(p[1] for p in ps if 0.4 in p)
    return s + ps[0].x if callable(ps[0]) else 0.0


def methods_of_dictionaries(x):
    ps = []
    for v in x:
        if v > 0.2:
            ps.append({"a": v, "b": 1.0})
    first = ps[0].copy()
    for p in ps:
        for key in p:
            p[key] *= 1.5
    first["b"] += x[1]
    return sum(p.get("a") * p["b"] * p.get("c", 4.0) for p in ps) + first["a"] * first["b"] + len(ps[0])


def a_list_of_objects_as_numbers(x):
    ps = []
    for v in x:
        if v > 0.2:
            ps.append(Vector(v, 1.0))
    for p in ps:
        p.x *= 2.0
    return sum(ps) * x[0]


def none_beside_numbers(x):
    us = []
    for v in x:
        us.append(v)
        if v > 0.5:
            us.append(None)
    return sum(u for u in us if u is not None)


class Named:
    def __init__(self, name, u):
        self.name, self.u = name, u

    @cached_property
    def double(self):
        return 2.0 * self.u


def another_text_for_each(x):
    ps = []
    for k, v in enumerate(x):
        if v > 0.5:
            ps.append(Named("even" if k % 2 == 0 else "odd", v))
    for p in ps:
        p.u *= 2.0
    return sum(p.u for p in ps)


def one_text_for_all(x):
    ps = []
    for v in x:
        if v > 0.5:
            ps.append(Named("u", v))
    for p in ps:
        p.u *= 2.0 if p.name == "u" else 3.0
    return sum(p.u for p in ps)


def computed_once(x):
    ps = []
    for v in x:
        if v > 0.5:
            ps.append(Named("u", v))
    for p in ps:
        p.u *= p.double
    return sum(p.u for p in ps)


def a_new_attribute(x):
    ps = []
    for v in x:
        if v > 0.5:
            ps.append(Named("u", v))
    for p in ps:
        p.w = 2.0 * p.u
    return sum(p.w for p in ps)


class Registered:
    def __init__(self, u, everything):
        self.u = u
        everything.append(self)


def kept_before_it_is_made(x):
    ps, everything = [], []
    for v in x:
        if v > 0.5:
            ps.append(Registered(v, everything))
    for p in ps:
        p.u *= 2.0
    return sum(p.u for p in everything)


def cases():
    for kernel in (emitted_and_lost, bodies_with_arrays, dictionaries, short_lists, splitting, of_a_system,
                   two_names_for_one, sorted_and_changed, removed_while_a_copy_is_gone_through, the_best_of_many,
                   copies, read_before_it_is_filled, one_text_for_all, objects_of_objects, in_place_operators,
                   methods_by_name, methods_of_dictionaries):
        yield Case(kernel, (X,), ("x",))
    yield Case(another_text_for_each, (X,), refused=(
        "S201 at `Named(\"even\" if k % 2 == 0 else \"odd\", v)`: 'name' of an object of class Named, of which only "
        "the run knows which is which, is something else for each, and no number and no array: keep a number that says "
        "the same, and compare that"))
    yield Case(computed_once, (X,), refused=(
        "S201 at `p.double`: a property that is computed once, of an object of which only the run knows which it is: "
        "write it as a property"))
    yield Case(a_new_attribute, (X,), refused=(
        "S201 at `p.w`: 'w' is new in an object of class Named, of which only the run knows which it is: set it where "
        "the object is made"))
    yield Case(kept_before_it_is_made, (X,), refused=(
        "S201 at `Registered(v, everything)`: an object of class Registered is kept elsewhere before it is made, and "
        "put into a list whose length only the run knows: put it there behind its __init__"))
    yield Case(a_list_of_objects_as_numbers, (X,), refused=(
        "S201 at `sum(ps)`: a list of objects, whose length only the run knows, is used as a whole: give the numbers "
        "that they hold: [p.x for p in ps]"))
    yield Case(none_beside_numbers, (X,), refused=(
        "S201 at `us.append(None)`: None is put into a list whose length only the run knows: keep a number that says "
        "the same: -1.0, or numpy.nan"))
