"""Complex numbers: derivatives with the inner product Re(conj(a) b)."""
from __future__ import annotations

import cmath
from cmath import exp as complex_exp
from dataclasses import dataclass

import numpy as np

from tests.corpus import Case
from tests.harness.seeds import generator

ROTATION = 0.6 + 0.8j
PHASES = np.exp(1j * np.linspace(0.0, 1.0, 4))


def arithmetic(out, z, w, x, s):
    """Whole arrays: every operator, scalars of both kinds, constants of the module."""
    y = z * w + 1j * x - ROTATION * s
    y /= 2.0 + z * np.conj(w)
    y += PHASES * x ** 2
    out[:] = y ** 3 - (1.0 - 2j) / z
    return np.sum((y * y.conj()).real) + np.mean(y.imag ** 2)


def functions(z, x):
    """Every elementwise function that holds for complex numbers."""
    a = np.exp(0.3 * z) + np.sin(z) * np.cos(z) + np.tan(0.3 * z)
    b = np.sqrt(z) + np.log(z) + np.log1p(z) + np.expm1(z) - np.log10(z) * np.log2(z)
    c = np.sinh(0.2 * z) + np.cosh(0.2 * z) * np.tanh(z) + np.square(z) + np.reciprocal(z)
    d = np.arcsin(z) + np.arccos(0.5 * z) + np.arctan(z) + np.arcsinh(z) + np.arctanh(z) + np.arccosh(z)
    e = np.abs(a) + np.angle(b) * np.real(c) + np.imag(d) + np.abs(-d.conj())
    return np.sum(e * x) + np.sum(np.where(x > 0.7, a * b, c + d)).real


def elements(z, c, x):
    """Complex numbers, element by element."""
    out = np.empty_like(z)
    total = 0j
    for i in range(z.size):
        v = 0.1 * z[i]
        for _ in range(3):
            v = v * v + c
        if abs(v) > 0.2 and v.real > -5.0:
            v = v / abs(v) + complex(x[i], 2.0)
        out[i] = v * np.exp(1j * x[i])
        total += out[i] * np.conj(z[i])
    z[:] = out
    return total, abs(total)


def transfer(w, k, m, c):
    """The response of a damped oscillator; nothing that is given is complex."""
    gain = np.zeros(w.size)
    for i in range(w.size):
        h = 1.0 / (k - m * w[i] ** 2 + 1j * c * w[i])
        gain[i] = abs(h) ** 2 + np.angle(h) + h.imag
    return np.sum(gain * w)


def of_cmath(k, c, x):
    """Functions of Python's for complex numbers, of real and of complex ones: what they give is complex."""
    root = cmath.sqrt(c * c - 4.0 * k)
    total = 0j
    for i in range(x.size):
        step = complex_exp(-1j * x[i]) * cmath.asin(0.3 * x[i]) + cmath.sinh(c * x[i])
        total += step * cmath.rect(x[i], k) / cmath.log10(complex(x[i], 1.0))
    r, angle = cmath.polar(total + cmath.log(root) * cmath.atan(root))
    return r + 2.0 * angle + cmath.phase(root) * cmath.pi + cmath.cos(total).real


def on_one_side(w):
    return (np.sum(np.arcsin(w).imag) + 2.0 * np.sum(np.arccos(w).imag) + 3.0 * np.sum(np.arccosh(w).real)
            + 4.0 * np.sum(np.arctanh(w).real) + 5.0 * np.sum(np.sqrt(w).imag) + np.sum((w ** 0.7).imag)
            + 6.0 * np.sum(np.arcsinh(1j * w).real) + 7.0 * np.sum(np.log(w).real))


def on_branch_cuts(x):
    """The sign of a zero is the side of the cut that a number lies on."""
    z = x + 1.5 + 0j
    s = on_one_side(z) - 0.3 * on_one_side(np.conj(z)) + x[0] * on_one_side(-z) + x[1] * on_one_side(np.conj(-z))
    return s + abs(z[2] - 0.5)


def products(m, z, w, x):
    """Products, sums along axes, functions that move elements."""
    y = m @ z + np.dot(m, x) - np.roll(z, 1) * np.vdot(z, w)
    k = np.outer(y, x) + m.T * np.conj(m)
    t = np.sum(k, axis=0) + np.mean(k * 1j, axis=1) + np.concatenate((z[:2], y[2:])) * np.diag(k)
    return t @ np.flip(w) + np.inner(z, w) + np.trace(k)


def views(z, n):
    """Stores into parts, in a loop over time."""
    work = np.zeros((n, z.size), dtype=np.complex128)
    for t in range(n):
        row = work[t]
        row[1:-1] = z[:-2] + 2j * z[2:]
        row[0] = z[-1] ** 2
        z[::2] *= 0.5 + 0.1j
        z[1] += np.sum(row)
        work[t, -1] = z[t].real
    return work


def mixed(z, x):
    """Floats that meet complex numbers, and back."""
    a = x.astype(complex)
    a[1:] += z[1:]
    b = np.full(x.size, 1j) * x + np.array([1.0, 2j, 0.5, 1.0])
    x *= np.abs(a)
    x[0] = (a[0] * b[1]).imag
    return np.sum(a * b * x)


def helper(z, scale):
    return scale * z * abs(z)


def called(z, x):
    """Calls of kernels with complex arguments and results."""
    total = 0.0 + 0j
    for i in range(z.size):
        total += helper(z[i], x[i]) - helper(x[i] * 1j, 2.0)
    return total


def schroedinger(psi, v, w, dt, dx, steps):
    """Crank-Nicolson's explicit cousin: psi is written in place."""
    lap = np.zeros_like(psi)
    for _ in range(steps):
        lap[1:-1] = (psi[2:] - 2.0 * psi[1:-1] + psi[:-2]) / dx ** 2
        psi += dt * 1j * (0.5 * lap - v * psi)
    return np.sum(np.abs(psi) ** 2 * w)


def helmholtz(f, c, omega):
    """A linear system with a complex matrix."""
    n = f.size
    a = np.zeros((n, n), dtype=complex)
    for i in range(n):
        a[i, i] = 2.0 - (omega / c[i]) ** 2 + 0.1j * omega
        if i > 0:
            a[i, i - 1] = -1.0
            a[i - 1, i] = -1.0
    u = np.linalg.solve(a, f)
    return np.sum(np.abs(u) ** 2)


def arranged(z, w, m, x):
    """Functions that are written out in others, elements picked by places and by masks, stacks of matrices."""
    places = np.array([0, 2, 2])
    a = np.stack((z, w)) + np.vstack((w, 1j * x)) * np.hstack((z[:2], w[2:]))
    b = np.cumsum(z) * np.expand_dims(w, 0)[0] + np.einsum("ij,j->i", m, w)
    c = np.swapaxes(m, 0, 1) @ np.diag(z) + np.linalg.inv(m) * np.tensordot(m, z, axes=1)
    w[1:3] = [z[0], 2.0 + x[1]]
    w[places] = z[places] ** 2
    c[np.abs(m) > 0.9] *= 2.0 - 1j
    picked = m[x > 0.8]
    stacked = m.reshape(2, 2, 4) @ m.reshape(2, 4, 2)
    return (np.sum(np.diff(a * b, axis=1)) + np.vdot(c, m) + np.sum(picked ** 2) + np.sum(np.diagonal(c) * w) +
            np.sum(stacked[0] * stacked[1]) + np.mean(m.reshape(-1) * np.ravel(c)))


def shared_part(z):
    part = z.real
    part[0] = 3.0
    return np.sum(z * z).real


def owned(z):
    return abs(z)


def owned_adjoint(z, result_bar):
    return result_bar


def quotients(z, w, s):
    """Each divides by zero where w and s are."""
    total = 0.0
    for i in range(z.size):
        total += (z[i] / w[i]).real + (1.0 / (s + 1j * w[i].imag)).real + (z[i] / s).imag + (1j * s / w[i]).real
    return total


@dataclass
class Oscillator:
    z: np.ndarray
    c: complex
    k: float


def driven(o, n):
    """A field that is assigned, and an array, both complex."""
    for i in range(n):
        o.c = o.c * o.k + o.z[i]
        o.z[i] *= 1j
    return abs(o.c) ** 2 + np.sum(o.z.imag)


RNG = generator(7)
Z, W = (RNG.normal(size=4) + 1j * RNG.normal(size=4) for _ in range(2))
X = RNG.uniform(0.5, 1.5, 4)
M = RNG.normal(size=(4, 4)) + 1j * RNG.normal(size=(4, 4))


def cases():
    yield Case(arithmetic, (np.zeros(4, complex), Z, W, X, 0.3 - 0.2j), ("z", "w", "x", "s"), ("out", "return"))
    yield Case(functions, (Z, X), ("z", "x"))
    yield Case(elements, (Z, 0.1 + 0.2j, X), ("z", "c", "x"), ("z", "return"))
    yield Case(transfer, (X, 2.0, 0.3, 0.1), ("w", "k", "m", "c"))
    yield Case(of_cmath, (1.3, 0.4, X), ("k", "c", "x"))
    yield Case(on_branch_cuts, (np.array([0.2, 0.7, 1.9]),), "x")
    yield Case(products, (M, Z, W, X), ("m", "z", "w", "x"))
    yield Case(views, (Z, 3), ("z",), ("z", "return"))
    yield Case(mixed, (Z, X), ("z", "x"), ("x", "return"))
    yield Case(called, (Z, X), ("z", "x"))
    yield Case(schroedinger, (Z, X, X[::-1].copy(), 0.1, 0.5, 3), ("psi", "v", "w", "dt"), ("psi", "return"))
    yield Case(arranged, (Z, W, M, X), ("z", "w", "m", "x"), ("w", "return"))
    yield Case(helmholtz, (Z, X, 0.7), ("f", "c", "omega"))
    # a written part that NumPy shares
    yield Case(shared_part, (Z,), refused=(
            "S201 at `part[0] = 3.0`: an array is written that NumPy shares with another one, which is a view of it "
            "by a function: write into the array itself, or take a copy: np.copy(...)"))
