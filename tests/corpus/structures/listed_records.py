"""Objects, dicts and named tuples in lists of which only the run knows how long they become."""
from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass

import numpy as np

from tests.corpus import Case

X = np.array([0.7, 0.4, 0.9, 0.3, 1.1, 0.5])
Pair = namedtuple("Pair", "a b")


class Event:
    def __init__(self, t, y):
        self.t, self.y = t, y

    def weight(self):
        return self.t * self.y ** 2


@dataclass
class Particle:
    number: int
    place: np.ndarray
    weight: float = 1.0


class Simulation:
    def __init__(self, x):
        self.x, self.t, self.history, self.events = x, 0.0, [], []

    def step(self):
        self.x = self.x * 0.9
        self.t += 0.2 * self.x[2] + 0.01
        self.history.append({"t": self.t, "e": np.sum(self.x ** 2)})
        if self.x[0] < 0.5:
            self.events.append(Event(self.t, self.x[0]))

    def run(self, end):
        while self.t < end:
            self.step()


def dicts(x):
    t, v, log = 0.0, x.copy(), []
    while t < 1.0:
        v = v * 0.9
        if v[0] > 0.3:
            log.append({"kind": "step", "t": t, "state": {"v": v.copy(), "n": 3}})
        t += 0.1
    s = 0.0
    for r in log:
        s += np.sum(r["state"]["v"]) * r["t"] * r["state"]["n"]
    return s * (log[0]["kind"] == "step")


def named_tuples(x):
    v, out = x[0], []
    while v < 5:
        v = v * 1.3 + x[1]
        if v > 1:
            out.append(Pair(v, v * v))
    return sum(p.a * p.b for p in out) + out[-1].a


def of_a_simulation(x):
    s = Simulation(x)
    s.run(0.8)
    ts, es = np.array([h["t"] for h in s.history]), np.array([h["e"] for h in s.history])
    r = np.sum(ts * es) + s.history[-1]["e"] / s.history[0]["e"]
    for k, h in enumerate(s.history):
        r += k * h["e"]
    for a, b in zip(s.history[:-1], s.history[1:]):
        r += (b["t"] - a["t"]) * (a["e"] + b["e"]) / 2
    return r + sum(e.weight() for e in s.events) + len(s.events)


def cascade(x):
    stack, s = [Particle(0, x[:3].copy())], 0.0
    while stack:
        p = stack.pop()
        s += p.weight * np.sum(p.place ** 2) * x[p.number % 6]
        if p.weight * x[5] > 0.1:
            stack.append(Particle(p.number + 1, p.place * 0.9, p.weight * x[5]))
            stack.append(Particle(p.number + 2, p.place + 0.1, p.weight * 0.5 * x[5]))
    return s


def the_largest(x):
    t, events = 0.0, []
    while t < 1.0:
        e = Event(t, np.sin(5 * t) * x[0])
        e.y = e.y + 0.1
        events.append(e)
        t += 0.2 * x[2]
    best = events[0]
    for other in events:
        if other.y > best.y:
            best = other
    return best.weight()


def one_after_another(x):
    old, t = Event(0.0, x[0]), 0.0
    events = [old]
    while t < 1.0:
        new = Event(t, old.y * x[1] + t)
        events.append(new)
        if t * x[0] > 0.3:
            old = new
        t += 0.2 * x[2]
    return sum(e.weight() for e in events) * old.y


def not_in_a_list(x):
    old, t, s = Event(0.0, x[0]), 0.0, 0.0
    while t < 1.0:
        new = Event(t, old.y * x[1] + t)
        old.y = 5.0 * x[3]
        s += new.y * old.y
        old = new
        new.y = new.y * 1.1
        t += 0.2 * x[2]
    return s + old.y


def written_arrays(x):
    t, events = 0.0, []
    while t < 1.0:
        events.append(Event(t, x * t))
        t += 0.2 * x[2]
    for e in events:
        e.y[0] += x[1]
    return sum(np.sum(e.y ** 2) for e in events)


def changed_behind(x):
    t, events = 0.0, []
    while t < 1.0:
        e = Event(t, x[0] * t)
        events.append(e)
        e.y = e.y * 2
        t += 0.2 * x[2]
    return sum(e.weight() for e in events)


def one_object(x):
    t, events, e = 0.0, [], Event(0.0, x[0])
    while t < 1.0:
        e.t = t
        events.append(e)
        t += 0.2 * x[2]
    return sum(e.weight() for e in events)


def changed_in_the_list(x):
    t, events = 0.0, []
    while t < 1.0:
        events.append(Event(t, x[0] * t))
        t += 0.2 * x[2]
    events[-1].y += x[1]
    return sum(e.weight() for e in events)


def changed_in_the_next_round(x):
    old, t, events = Event(0.0, x[0]), 0.0, []
    while t < 1.0:
        old.y = old.y * 1.1
        new = Event(t, old.y * x[1])
        events.append(new)
        old = new
        t += 0.2 * x[2]
    return sum(e.weight() for e in events)


def inside_of_another(x):
    t, log = 0.0, []
    while t < 1.0:
        d = {"a": x[0] * t, "e": Event(t, x[1])}
        log.append(d)
        d["e"].y = d["e"].y * t
        t += 0.2 * x[2]
    return sum(d["e"].weight() + d["a"] for d in log)


def shared_array(x):
    t, events, w = 0.0, [], x.copy()
    while t < 1.0:
        events.append(Event(t, w))
        w[0] += 0.1
        t += 0.2 * x[2]
    return sum(np.sum(e.y ** 2) * e.t for e in events)


def identity(x):
    t, events = 0.0, []
    while t < 1.0:
        events.append(Event(t, x[0] * t))
        t += 0.2 * x[2]
    return x[1] if events[0] is events[-1] else x[2]


def of_several_kinds(x):
    t, log = 0.0, []
    while t < 1.0:
        if t * x[0] > 0.3:
            log.append({"kind": "a", "t": t})
        else:
            log.append({"kind": "b", "u": t * t})
        t += 0.2 * x[2]
    return sum(r["t"] for r in log if r["kind"] == "a")


def several_loops(x):
    t, events = 0.0, []
    while t < 1.0:
        events.append(Event(t, x[0] * t))
        t += 0.2 * x[2]
    s = 0.0
    for e in range(3):
        s += x[e]
    for _ in range(2):
        for e in events:
            s = s * 0.5 + e.weight()
        for k, e in enumerate(events):
            for other in events[k + 1:]:
                s = s * 0.7 + e.t * other.y
        for e in events:
            if e.t > 0.5:
                break
            s += e.y ** 2
    return s


def read_behind_a_loop(x):
    t, events, s = 0.0, [], 0.0
    while t < 1.0:
        events.append(Event(t, x[0] * t))
        t += 0.2 * x[2]
    e = Event(x[0], x[1])
    for e in events:
        s += e.y
    return s + e.weight()


def texts_in_tuples(x):
    log, t = [], 0.0
    while t < 2.0:
        t += 0.3 + 0.1 * x[0]
        log.append((t, "late" if t > 1.0 else "early", x * t))
        if t > 1.5:
            log.append((t * x[1], "last", x))
    return sum(time * u[1] for time, _, u in log) + log[-1][0] * len(log)


def one_text_in_tuples(x):
    log = [("point", k, v * v) for k, v in enumerate(x) if v > 0.45]
    return sum(e[2] * (e[1] + 1) for e in log) + len(log[0][0]) * x[0]


def another_thing(x):
    us = []
    for v in x:
        if v > 0.1:
            us.append((v, "a"))
    us.append(3.0)
    return us[-1] * x[0]


def cases():
    # gradients
    for kernel in (dicts, named_tuples, of_a_simulation, cascade, the_largest, one_after_another, not_in_a_list,
                   written_arrays, several_loops, texts_in_tuples, one_text_in_tuples, changed_behind, one_object,
                   changed_in_the_list, changed_in_the_next_round, inside_of_another, identity):
        yield Case(kernel, (X,), ("x",))
    # refusals
    yield Case(read_behind_a_loop, (X,), refused="S201 at `e`: 'e' is a structure before a loop that binds it, and "
               "read behind it: give what the loop binds another name")
    yield Case(another_thing, (X,), refused=(
        "S201 at `us.append(3.0)`: objects that hold different things are put into one list whose length only the run "
        "knows: give each the same attributes, or keep a list for each kind"))
    yield Case(shared_array, (X,), refused=(
        "S201 at `events.append(Event(t, w))`: a list holds an array that is written, not a copy of it: append a copy: "
        ".append(x.copy())"))
    yield Case(of_several_kinds, (X,), refused=(
        "S201 at `log.append({\"kind\": \"b\", \"u\": t * t})`: objects that hold different things are put into one "
        "list whose length only the run knows: give each the same attributes, or keep a list for each kind"))
