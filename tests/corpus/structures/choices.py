"""Slots that hold one of several things, and only the run knows which: None or a number, one of two objects, a text."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


class Particle:
    def __init__(self, v, m=1.0):
        self.v, self.m, self.n = v, m, 0


class Sphere:
    def __init__(self, center, radius, color):
        self.center, self.radius, self.color = np.asarray(center, float), radius, color

    def intersect(self, origin, direction):
        away = origin - self.center
        b = np.dot(away, direction)
        c = np.dot(away, away) - self.radius ** 2
        if b * b - c < 0:
            return None
        t = -b - np.sqrt(b * b - c)
        return t if t > 1e-6 else None


class Scene:
    def __init__(self, spheres):
        self.spheres, self.light = spheres, np.array([1.0, 1.0, -1.0])

    def trace(self, origin, direction):
        best, hit = np.inf, None
        for s in self.spheres:
            t = s.intersect(origin, direction)
            if t is not None and t < best:
                best = t
                hit = s
        if hit is None:
            return 0.1
        p = origin + best * direction
        n = (p - hit.center) / hit.radius
        away = self.light - p
        return hit.color * max(np.dot(n, away / np.linalg.norm(away)), 0.0)


def ray_tracer(x):
    scene = Scene([Sphere([0, 0, 3 + x[0]], 1.0 + x[1], x[2]), Sphere([0.5, 0.2, 2.0], 0.5, 2 * x[2])])
    total = 0.0
    for px in np.linspace(-1, 1, 4):
        for py in np.linspace(-1, 1, 3):
            d = np.array([px, py, 2.0])
            total += scene.trace(np.zeros(3), d / np.linalg.norm(d))
    return total


def root(x, a, b):
    fa, fb = a * a - x[0], b * b - x[0]
    if fa * fb > 0:
        return None
    for _ in range(30):
        m = 0.5 * (a + b)
        fm = m * m - x[0]
        if fa * fm <= 0:
            b = m
        else:
            a, fa = m, fm
    return m - fm / (2 * m)


def a_root_that_may_not_be(x):
    r = root(x, 0.0, 2.0)
    if r is None:
        return 0.0
    return r * x[1]


def asked_in_a_test(x):
    if root(x, 0.0, 2.0) is not None:
        return x[1] ** 2
    return x[2]


def the_best_of_some(x):
    best = None
    for i in range(x.shape[0]):
        d = x[i] ** 2
        if d > 0.1 and (best is None or d < best):
            best = d
    if best is None:
        return 0.0
    return best * x[0]


def a_place_or_none(x):
    target = None
    best = 0.0
    for i in range(x.shape[0]):
        for j in range(2):
            d = x[i] * (j + 1)
            if d > best:
                best, target = d, (i, j)
    if target is None:
        return 0.0
    i, j = target
    return x[i] ** 2 * (j + 1)


def the_one_before(x):
    prev = None
    s = 0.0
    for i in range(x.shape[0]):
        if x[i] > 0.4:
            if prev is not None:
                s += (x[i] - prev) ** 2
            prev = x[i]
    return s


def an_array_or_none(x):
    u = x * 2
    src = None
    if x[0] > 0.5:
        src = np.sin(x)
    for _ in range(3):
        if src is not None:
            u = u + 0.1 * src
        u = u * 0.9
    return np.sum(u)


def one_of_two_objects(x):
    a, b = Particle(x[0], 1.0), Particle(x[1], 2.0)
    s = 0.0
    for i in range(6):
        m = a if np.sin(i * x[2]) > 0.3 else b
        s += m.v * m.m * i
    return s


def one_of_two_lists(x):
    left, right = [0.0], [0.0]
    for i in range(5):
        side = left if np.sin(x[0] * i) > 0 else right
        side[0] += x[1] * i
    return left[0] * right[0] ** 2


def given_on_to_another_name(x):
    hit = None
    if x[0] > 0.5:
        hit = Particle(x[1])
    t = hit
    hit = None
    s = 0.0
    if t is not None:
        s += t.v ** 2
    if hit is not None:
        s += 100.0
    return s


def the_largest_is_changed(x):
    ps = [Particle(x[0]), Particle(x[1]), Particle(x[2])]
    for i in range(x.shape[0] * 2):
        k = None
        for p in ps:
            if k is None or p.v > k.v:
                k = p
        k.v = k.v * 0.6 + 0.01 * i
        k.n += 1
    return ps[0].v + 2 * ps[1].v ** 2 + 3 * ps[2].v ** 3 + ps[0].n


def a_machine_of_states(x):
    state = "a"
    s = 0.0
    T = x[0]
    for _ in range(x.shape[0] * 5):
        if state == "a":
            s += T * x[1]
            T *= 1.13
            if T > 1.07:
                state = "b"
        elif state == "b":
            s += T ** 2
            T *= 0.83
            if T < 0.71:
                state = "c"
        else:
            s -= x[2] * T
            T *= 1.31
            if T > 0.97:
                state = "a"
    return s


def an_object_of_an_earlier_round(x):
    best = None
    for i in range(x.shape[0] * 2):
        q = np.array([x[i % 3], i * 0.3])
        d = q[0] * np.cos(q[1])
        if best is None or d < best.v:
            best = Particle(d, q)
        best.m[0] *= 1.1
    return best.v * best.m[0] + best.m[1]


def advanced(y, h, x):
    if y > 2.0:
        return None
    return y + h * x[0] * y, h * x[1]


def a_tuple_or_none(x):
    y = 0.5
    tot = 0.0
    for _ in range(40):
        res = advanced(y, 0.1, x)
        if res is None:
            break
        y, e = res
        tot += e
    return y * tot + x[2]


def until_nothing_changes(x):
    prev = None
    y = 1.0
    while prev is None or abs(y - prev) > 1e-12:
        prev = y
        y = 0.5 * (y + x[0] / y)
    return y * prev


def objects_that_change_places(x):
    a, b = Particle(x[0], 2.0), Particle(x[1], 3.0)
    for _ in range(x.shape[0] * 2):
        if a.v > b.v:
            a, b = b, a
        a.v += 0.23 * x[2] * a.m
        b.v *= 0.97
    return a.v * a.m + b.v ** 2


def in_a_dict(x):
    d = {"best": None, "n": 0}
    for v in x:
        if v > 0.4:
            if d["best"] is None or v < d["best"]:
                d["best"] = v
                d["n"] += 1
    return d["best"] ** 2 * d["n"] if d["best"] is not None else 0.0


def found_or_else(x):
    found = None
    for i in range(x.shape[0]):
        if x[i] < 0.6:
            found = x[i] * x[0]
            break
    else:
        found = 7.0
    return found * x[2]


def summed(x, cb=None):
    s = 0.0
    for v in x:
        s += v
        if cb:
            s += cb(v)
    return s


def a_function_or_none(x):
    cb = None
    if x[0] > 0.5:
        cb = lambda v: v ** 3  # noqa: E731
    return summed(x, cb) + summed(x)


def or_another_one(x):
    hit = Particle(x[1]) if x[0] > 0.5 else None
    w = hit.v if hit else 0.0
    other = hit or Particle(x[2])
    return w * other.v


def arrays_that_are_chosen(x):
    a = np.zeros(3)
    b = np.ones(3)
    r = None
    for i in range(3):
        r = a if np.sin(x[i] * 9) > 0 else b
        r[i] += x[i] ** 2
    return np.sum(a) * np.sum(b) + np.sum(r)


def an_object_of_one_round_kept(x):
    last = None
    s = 0.0
    for i in range(x.shape[0]):
        cur = Particle(x[i])
        if last is not None and x[i] > 0.4:
            s += last.v * cur.v
        if x[i] > 0.45:
            last = cur
            cur.v *= 2.0
    return s + (last.v if last is not None else 0.0)


def an_array_that_goes_on_changing(x):
    u = x * 1.0
    prev = None
    s = 0.0
    for i in range(x.shape[0]):
        if prev is not None and x[i] > 0.2:
            s += prev[0] * x[i]
        if x[i] > 0.4:
            prev = u
        u[0] *= 1.5
    return s


def a_list_that_grows(x):
    a, b = [x[0], x[1]], [x[2]]
    c = a if x[0] > 0.5 else b
    c.append(x[1] * 2)
    return sum(c) + len(a) * x[2] + sum(b) ** 2


def two_that_go_together(x):
    best = None
    where = None
    for i in range(x.shape[0]):
        if x[i] < 0.6:
            best = x[i]
            where = i
    if where is not None and best is not None:
        return best * (where + 1)
    return 0.0


def none_again(x):
    best = None
    s = 0.0
    for i in range(x.shape[0] * 3):
        d = np.sin(x[i % 3] * (i + 1))
        if best is None:
            best = d
        else:
            s += best * d
            if d < 0.4:
                best = None
    return s


def read_where_it_is_replaced(x):
    best, s = None, 0.0
    for i in range(x.shape[0] * 2):
        d = np.sin(x[i % 3] * (i + 1))
        old = best
        if d > 0.3:
            best = d
        if old is not None and best is not None:
            s += (best - old) ** 2 + old * x[0]
    return s


def exchanged(p, q, x):
    if x[0] > 0.5:
        p, q = q, p
    p.v = p.v * x[1] + q.v
    return q.v


def changed_by_a_helper(x):
    a, b = Particle(x[0] * x[2]), Particle(2.0 * x[1])
    return a.v * b.v + exchanged(a, b, x) * a.v + b.v ** 2 + exchanged(b, a, x - 0.4)


class Finder:
    def __init__(self):
        self.place = None

    def find(self, x):
        for k, v in enumerate(x):
            if v > 0.4:
                self.place = k


def places_that_are_looked_for(x):
    """x[None] has an axis more; where nothing was found these raise."""
    best, place = -np.inf, None
    for k, v in enumerate(x):
        if np.sin(3.0 * v) > best:
            best, place = np.sin(3.0 * v), k
    finder = Finder()
    finder.find(x)
    rows = np.outer(x, x[::-1])
    rows[finder.place, 1] *= x[place]
    rows[0, place] += rows[place, finder.place]
    return best * x[place] + rows[finder.place] @ x + rows[0] @ x


EVERY = (
    places_that_are_looked_for,
    two_that_go_together, none_again, changed_by_a_helper, ray_tracer, a_root_that_may_not_be, asked_in_a_test,
    the_best_of_some, a_place_or_none,
    the_one_before, read_where_it_is_replaced,
    an_array_or_none, one_of_two_objects, one_of_two_lists, given_on_to_another_name, the_largest_is_changed,
    a_machine_of_states, an_object_of_an_earlier_round, a_tuple_or_none, until_nothing_changes,
    objects_that_change_places, in_a_dict, found_or_else, a_function_or_none, or_another_one,
    arrays_that_are_chosen, an_object_of_one_round_kept)


def cases():
    for kernel in EVERY:
        yield Case(kernel, (np.array([0.8, 0.5, 0.3]),), "x")
    for kernel, said in (
            (an_array_that_goes_on_changing, "S201 at `u[0] *= 1.5`: an array is written that another name may stand "
             "for here, as it did before a loop or branch bound it anew: bind the name to a copy before the loop or "
             "branch: u = u.copy(); where names swap in a branch, swap what their arrays hold"),
            (a_list_that_grows, "S201 at `c.append(x[1] * 2)`: append to 'c', which is not bound once, to a list: "
             "bind it once, as [] or as a list of what it starts with")):
        yield Case(kernel, (np.array([0.8, 0.5, 0.3]),), "x", refused=said)
