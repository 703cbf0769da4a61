"""Kernels written at random in which objects lie in lists of the run, under several names, and are changed."""
from __future__ import annotations

from random import Random

CLASSES = '''import copy
from dataclasses import dataclass

import numpy as np


class P:
    def __init__(self, a, b, pos):
        self.a = a
        self.b = b
        self.n = 0
        self.on = True
        self.pos = pos

    def move(self, dt):
        self.a += self.b * dt
        self.pos += 0.1 * dt
        self.n += 1

    def hit(self, other, w):
        d = other.a - self.a
        self.b += w * d
        other.b -= 0.5 * w * d
        other.pos = other.pos + w * self.pos

    def renew(self):
        self.pos = self.pos * 0.9
        return self

    @property
    def size(self):
        return self.a * self.b + np.sum(self.pos ** 2)

    @size.setter
    def size(self, v):
        self.b = v / (1.0 + self.a ** 2)


@dataclass
class D:
    a: float
    b: float
    w: float = 1.0
    n: int = 0

    def push(self, v):
        self.a, self.b = self.b, self.a + v
        return self.a


class Box:
    def __init__(self):
        self.ds = []
        self.t = 0.0
        self.last = None

    def add(self, d):
        self.ds.append(d)
        self.last = d
        self.t += d.a

    def step(self, v):
        for d in self.ds:
            d.a += 0.1 * v * d.b
        self.ds = [d for d in self.ds if d.a < 0.9]

    def total(self):
        return sum(d.a * d.w for d in self.ds) + self.t


def both(u, v, w):
    u.a += w * v.b
    v.b -= 0.1 * u.a
    return u.a * v.b


def fresh(a, w):
    d = D(a, w)
    d.w *= w
    return d
'''

BODIES = ("P(x[{k} % 4] * 0.5, x[1], np.array([x[0], s]))", "P(s * 0.1, x[2] * {k}, np.zeros(2))",
          "P(x[3], 0.5, np.array([0.1, x[({k} + 1) % 4]]))")
CHANGES = (
    "{p}.a += 0.1 * x[{k} % 4]", "{p}.b = 0.7 * {p}.b + {p}.a * x[1]", "{p}.pos += 0.1 * {p}.b", "{p}.pos[0] += {p}.a",
    "{p}.pos[:] = {p}.pos * 0.5 + x[2]", "{p}.pos = {p}.pos + x[:2]", "{p}.move(0.3 * x[0])", "{p}.n += 1",
    "{p}.on = {p}.a < 0.4", "{p}.size += 0.1 * x[3]", "s += {p}.size * 0.1", "s = 0.5 * s + {p}.pos[1] * {p}.n",
    "{p}.renew().a *= 0.9", "{p}.a, {p}.b = {p}.b, {p}.a", "{p}.a -= 0.1 if {p}.on else 0.2 * s")
PAIRS = (
    "{p}.hit({q}, 0.1 * x[1])", "{p}.a, {q}.a = {q}.a, {p}.a", "{p}.b += {q}.a", "{p}.pos[1] += {q}.pos[0]",
    "s += 0.3 if {p} is {q} else 0.1 * {p}.a", "if {p} is not {q}: {p}.b *= 0.9", "{p}.pos = {q}.pos.copy()",
    "{p}.a = {q}.b * x[0]")
LISTS = (
    "{ps}.append({new})", "p = {new}; {ps}.append(p); {qs}.append(p)", "p = {new}; {change}; {ps}.append(p); {change}",
    "{ps} = [u for u in {ps} if u.a < {c}]", "{ps} = [u for u in {ps} if u.on or u.n < 2]",
    "{ps}.sort(key=lambda u: u.a)", "{ps}.sort(key=lambda u: -u.b)", "{ps}.reverse()",
    "if {ps}: {qs}.append({ps}[{k} % len({ps})])", "if len({ps}) > 2: {ps}.pop()", "if len({ps}) > 2: {ps}.pop(0)",
    "if {ps}: {qs}.insert(0, {ps}[-1])", "{qs} = list({ps})", "{qs} = {ps}[1:]", "{qs} = {ps} + {qs}",
    "{ps}.extend({qs}[:2])", "if {ps}: {ps}.remove({ps}[{k} % len({ps})])",
    "if {ps} and len({ps}) < 5: {ps}.append(copy.deepcopy({ps}[0]))",
    "if {ps}: q = max({ps}, key=lambda u: u.a * u.b); q.b += 0.2", "s += sum(u.a * u.b for u in {ps})",
    "s += 0.1 * len([u for u in {ps} if u.on])", "if {ps} and {qs}: s += 0.5 if {ps}[0] in {qs} else 0.0",
    "{qs} = sorted({ps}, key=lambda u: u.a + s)")
PLAIN = (
    "{ps}.append(D(x[{k} % 4], s))", "{ps}.append(fresh(s, x[{k} % 4]))", "{ps} = {qs}[:]",
    "if {ps}: s += both({ps}[0], {ps}[-1], 0.1)", "if {ps}: s += 0.1 * {ps}[{k} % len({ps})].push(x[1])",
    "if {ps}:\n    best = None\n    for u in {ps}:\n        if best is None or u.a < best.a: best = u\n    best.b += s",
    "box.add(D(x[{k} % 4], 0.5))", "box.step(x[1])", "if {ps}: box.add({ps}[0])", "if box.ds: {ps}.append(box.ds[-1])",
    "{ps}.extend(box.ds)", "if len(box.ds) > 1: box.ds.pop(0)", "if box.last is not None: box.last.a *= 0.9",
    "for u in {ps}:\n    if u.a > 0.6: continue\n    u.a += 0.1\n    if u.b > 0.9: break",
    "j = 0\nwhile j < len({ps}) and {ps}[j].a < 0.8:\n    {ps}[j].a += 0.15\n    j += 1",
    "{ps}.sort(key=lambda u: (u.n, u.a))", "{qs} = [copy.copy(u) for u in {ps}]",
    "if {ps}: u = {ps}[0]; {ps}[0] = {ps}[-1]; {ps}[-1] = u", "if {ps}: {ps}[-1] = D(s, x[2])",
    "for u in {ps}[:]:\n    if u.a > 0.65: {ps}.remove(u)",
    "for u in list({ps}):\n    if u.a < 0.3: {ps}.append(fresh(u.a + 0.2, u.b))",
    "s += max((u.a for u in {ps}), default=0.0)", "arr = np.array([u.a for u in {ps}]); s += 0.01 * np.sum(arr ** 2)",
    "if {ps}: {qs}.append({ps}.pop())", "u = D(s, x[0]); {ps}.append(u); {qs}.append(u); u.a += 0.1",
    "for u in {ps}: u.n += 1", "for u, v in zip({ps}, {qs}): u.a, v.a = v.a, u.a",
    "for u, v in zip({ps}, {ps}[1:]): u.b += 0.2 * (v.a - u.a)")


class Objects:
    """Writes statements at random, of objects with arrays or of plain ones."""

    def __init__(self, rng: Random, plain: bool):
        self.rng, self.plain, self.lines = rng, plain, list[str]()
        self.new = ("D(x[{k} % 4], s)", "fresh(s, x[{k} % 4])") if plain else BODIES

    def add(self, indent: str, text: str, k: str, **names: str) -> None:
        ps, qs = self.rng.choice((("ps", "qs"), ("qs", "ps")))
        change = self.rng.choice(CHANGES).format(p="p", k=k)
        text = text.format(ps=ps, qs=qs, k=k, change=change, new=self.rng.choice(self.new).format(k=k),
                           c=self.rng.choice(("0.6", "0.3", "s")), **names)
        self.lines += [indent + line for line in text.split("\n")]

    def statement(self, indent: str, k: str, depth: int = 0) -> None:
        chance, choice = self.rng.random(), self.rng.choice
        if depth < 2 and chance < 0.2:
            self.lines.append(indent + choice((f"if x[{k} % 4] > 0.5:", f"if x[{k} % 4] > 0.3:", "if s > 0.4:")))
            for _ in range(self.rng.randint(1, 2)):
                self.statement(indent + "    ", k, depth + 1)
        elif self.plain:
            self.add(indent, choice(PLAIN), k)
        elif chance < 0.55:
            self.add(indent, choice(LISTS), k)
        elif chance < 0.75:
            self.lines.append(f"{indent}for u in {choice(('ps', 'qs'))}:")
            for _ in range(self.rng.randint(1, 2)):
                self.add(indent + "    ", choice(CHANGES), k, p="u")
        elif chance < 0.85:
            ps = choice(("ps", "qs"))
            self.lines += [f"{indent}for j, u in enumerate({ps}):", f"{indent}    for v in {ps}[j + 1:]:"]
            self.add(indent + "        ", choice(PAIRS), k, p="u", q="v")
        else:
            self.lines.append(f"{indent}if len(ps) > 1 and qs:")
            self.lines.append(f"{indent}    p, q = {choice(('ps[0], qs[-1]', 'ps[-1], ps[0]', 'qs[0], ps[1]'))}")
            for text in (choice(PAIRS), choice(CHANGES), choice(PAIRS)):
                self.add(indent + "    ", text, k, p=choice("pq"), q=choice("pq"))


def program(seed: int) -> str:
    """The text of a file with a kernel `f(x, n)`."""
    rng = Random(seed)
    writer = Objects(rng, seed % 2 == 1)
    writer.lines += ["s = 0.3", "ps, qs = [], []", "box = Box()", "for k in range(n):", "    if x[k % 4] > 0.3:"]
    writer.add("        ", "ps.append({new})", "k")
    for _ in range(rng.randint(2, 4)):
        writer.statement("    ", "k")
    for _ in range(rng.randint(1, 3)):
        writer.statement("", "n")
    writer.lines += ["for k, p in enumerate(ps):", "    s += (k + 1) * p.a * (p.b + 1) + p.n * p.a"]
    writer.lines += [] if seed % 2 else ["    s += p.pos[0] * p.pos[1]"]
    writer.lines += ["for q in qs:", "    s += q.a - q.b", "return s + x[0] * len(ps) + box.total()"]
    return CLASSES + "\n\ndef f(x, n):\n" + "".join(f"    {line}\n" for line in writer.lines)
