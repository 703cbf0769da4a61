"""Functions that return arrays: helpers, kernels, functions inside functions."""
from __future__ import annotations

import numpy as np

from tests.harness import array_functions
from tests.corpus import Case
from tests.harness.seeds import generator

GRAVITY = 2.0
RNG = generator(3)
N = 6
U, V, M = RNG.random(N) + 0.1, RNG.random(N) + 0.5, RNG.random((4, N))
Y = np.zeros(N)


# -- helpers --------------------------------------------------------------------------------------------------------

def laplacian(u, dx=0.5):
    out = np.zeros_like(u)
    for i in range(1, u.size - 1):
        out[i] = (u[i - 1] - 2.0 * u[i] + u[i + 1]) / dx ** 2
    return out


def products(u, v):
    a = u * v
    return a, u[1:] - u[:-1], np.sum(a)


def rhs(u, p):
    return p[0] * laplacian(u) - u ** 3


def middle(u):
    return u[1:-1]


def filled(u, x):
    u[0] = x
    return u


def limited(u, c):
    if c > 0.3:
        return u
    if c > 0.2:
        return u * c
    out = np.zeros_like(u)
    for i in range(u.size):
        out[i] = u[i] ** 2
    return out


def first_above(u, level):
    for k in range(u.size):
        for j in range(2):
            if u[k] + j > level:
                return u * u[k]
    return u * 2.0


def helpers(du, u, v, p):
    out = 2.0
    lap = laplacian(u, dx=p[1])
    a, b, s = products(lap, v)
    du[:] = a * s + out * rhs(u + 0.1 * a, p)
    du[1:] += b
    m = middle(du)
    m *= array_functions.scaled(v, out)[1:-1]
    w = v.copy()
    x = filled(w, p[0])
    x[1] = w[0] * u[2]
    du += w * limited(u, p[1]) * limited(u, 0.25) + limited(limited(v, 0.1), p[0])


def swapped(u, v):
    return v, u


def in_expressions(y, u, v, n):
    a, b = swapped(u, v)
    a, b = swapped(a, b)
    for k in range(n):
        if np.sum(laplacian(a)) > -100.0 and laplacian(b)[1] != 0.0:
            y += laplacian(a, 1.0 + k) @ laplacian(v) * first_above(b, 0.3 + k)


# -- names bound anew -----------------------------------------------------------------------------------------------

def stepped(u, dt):
    v = u.copy()
    for i in range(1, u.size - 1):
        v[i] = u[i] + dt * (u[i - 1] - 2.0 * u[i] + u[i + 1])
    return v


# -- kernels that return arrays --------------------------------------------------------------------------------------

def scaled_products(u, c):
    out = np.zeros_like(u)
    for i in range(1, u.size):
        out[i] = c * u[i] * u[i - 1]
    return out


def several(u, c):
    a = stepped(u, c)
    s = np.sum(a * u)
    return a, s, u[1:] - c, 3, a, u


def iterated(x, n):
    for _ in range(n):
        r = x ** 2 - 2.0
        if np.sum(r * r) < 1e-3:
            return x
        x = x - r / (2.0 * x)
    return x


def searched(u, c):
    if c > 0.0:
        if c > 1.0:
            return first_above(u, c - 1.0)
        u = u + c
    else:
        u = u - c
    return u ** 2


def part_of_written(u):
    u[0] = u[1] * u[2]
    return u[1:], u


def written_and_new(u, w):
    u *= 2.0
    w[:] = u ** 2
    return u * w, w


def inner_tuple(u, c):
    return (u * c, (np.sum(u), c)), u + c


def tuples(u, c):
    (a, (s, d)), b = inner_tuple(u, c)
    p, q = inner_tuple(b, c)[0]
    if c > 0.0:
        return ((a * s, b), d), u[1], (3, 4), a + p * q[0]
    return ((a, b * 2.0), s), u[2], (4, 5), p


def dot(u, v):                          # NumPy has one, too
    return np.dot(u, v) * u


def constant(u, c):
    return np.ones(3) * 2.0, c


# -- functions inside functions, functions given to functions ---------------------------------------------------------

def rk2(f, u, p, dt):
    k = f(u, p)
    return u + dt * f(u + 0.5 * dt * k, p)


def decay(u, p):
    return -p * u ** 2


def twice(f, x):
    return composed(f, f, x)


def composed(f, g, x):
    return f(g(x))


def closures(u, a):
    n = u.size

    def slope(v):
        out = np.zeros_like(v)
        for i in range(1, n):
            out[i] = a * v[i] * v[i - 1] + GRAVITY
        return out

    def put(i, x):
        w[i] = combine(x) * a ** power(i)

    def power(i, base=2.0):
        return base + i
    w = np.zeros(3)
    combine = lambda x: a + x * u[0]  # noqa: E731
    k = slope(u + 0.1 * slope(u))
    put(0, u[1])
    a = a * 2.0
    put(2, u[0])
    return k, w, combine(3.0), twice(combine, u[1]), composed(np.sin, lambda x: x * a, u[0])


def time_stepper(u, p, dt, n):
    for _ in range(n):
        u = rk2(decay, u, p, dt)
        u = rk2(u=u, f=lambda v, q: q * v, p=p, dt=dt)
    return u


def found_in_a_loop(u, n):
    for k in range(n):
        if u[k] > 0.5:
            return np.ones(k + 2) * u[k]
    return u


def turn(axis, a):
    c, s = np.cos(a), np.sin(a)
    if axis == "x":
        return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])
    if axis == "z":
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    raise ValueError("no such axis")


def turned(a, n):
    m = np.eye(3)
    for k in range(n):
        m = turn("x", a * k) @ m
        m = turn("z", a) @ m
    return np.sum(m[0] * np.array([1.0, 2.0, 3.0]))


# -- products of matrices -------------------------------------------------------------------------------------------

def mixed(q, v, mask):
    w = np.exp(q @ q.T + mask)
    for i in range(w.shape[0]):
        w[i] = w[i] / np.sum(w[i])
    return w @ v


def mixed_row(q, v):
    w = np.sin(q)
    for i in range(w.shape[0]):
        w[i] = w[i] * (i + 1)
    return w[0] @ v


def of_products(m, c):
    mask = (1 - np.tri(m.shape[0], dtype=m.dtype)) * -1e10
    first = mixed(m, m[:, :2], mask) + mixed(c * m, m[:, 1:3], mask)
    rows = mixed_row(m, m.T) * mixed_row(m * m, m.T)
    return np.sum(first[:, 0] * first[:, 1]) + np.sum(rows)


def unread_type(q, k, v, mask):
    return np.exp(q @ k.T + mask) @ v


def requested_dtype(m):
    mask = (1 - np.tri(m.shape[0], dtype=m.dtype)) * -1e10
    return np.sum(unread_type(m, m, m[:, 1:], mask) ** 2) + np.sum(unread_type(m, 0.5 * m, m[:, :2], mask))


def cases():
    # helpers
    yield Case(helpers, (Y, U, V, np.array([0.35, 0.7])), ("u", "v", "p"), ("du",))
    yield Case(in_expressions, (Y, U, V, 2), ("u", "v"), ("y",))
    # kernels
    yield Case(scaled_products, (U, 0.3), ("u", "c"))
    yield Case(several, (U, 0.3), ("u", "c"))
    for n in (2, 9):
        yield Case(iterated, (U + 1.0, n), ("x",))
    for c in (0.3, 1.5, 9.0, -0.4):
        yield Case(searched, (U, c), ("u", "c"))
    for of in (("return",), ("u", "return")):
        yield Case(part_of_written, (U,), ("u",), of)
    for of in (("u", "w", "return"), ("return",)):
        yield Case(written_and_new, (U, V), ("u", "w"), of)
    for c in (0.3, -0.3):
        yield Case(tuples, (U, c), ("u", "c"))
    yield Case(constant, (U, 0.3), ("c",))
    yield Case(dot, (U, V), ("u", "v"))
    # functions inside functions, functions given to functions
    yield Case(closures, (U, 0.3), ("u", "a"))
    yield Case(time_stepper, (U, 0.3, 0.1, 2), ("u", "p", "dt"))
    # a branch is decided by what is given
    yield Case(turned, (0.7, 3), ("a",))
    # a size that a loop makes cannot be returned from inside it
    yield Case(found_in_a_loop, (U, 3), "u", of=None, refused=(
            "S201 at `return np.ones(k + 2) * u[k]`: an array of a size that a loop makes is returned from inside "
            "it: bind it to a name, break, and return it after"))
    # products of matrices
    yield Case(of_products, (M, 0.3), ("m", "c"))
    yield Case(requested_dtype, (M,), ("m",))
    yield Case(requested_dtype, (M.astype("float32"),), ("m",))
