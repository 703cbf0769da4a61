"""Powers whose base or exponent is complex; a real base is a number above 0."""
from __future__ import annotations

import numpy as np

from tests.corpus import Case


def of_arrays(z, w, x, p):
    a = z ** w
    return np.sum(a.real * np.arange(1.0, 4.0)) + np.sum(np.abs(a) ** 2) + np.sum(
        (z[:, None] ** w[None, ::-1]).imag) + (np.sum((z[:0] ** w[:0]).real))


def of_real_exponents(z, w, x, p):
    return np.sum((z ** x).imag * np.arange(1.0, 4.0)) + np.sum(np.abs(np.power(z, x)) ** 2) + np.sum((w ** p).real) + (
        np.sum((z ** 2).imag) + np.sum((z ** -1.5).real) + np.sum((z ** 0).real) + pow(z[0], p).imag)


def of_real_bases(z, w, x, p):
    return np.sum((2.0 ** z).real) + np.sum((np.e ** w).imag) + ((x[1] + 0j) ** z[0]).real + np.sum(
        ((x + 0j) ** w).imag) + ((-2.0 + 0j) ** z[1]).imag


def of_numbers(z, w, x, p):
    s = 0.0
    for i in range(3):
        b = z[i]
        s += (b ** w[i]).real + (w[0] ** b).imag + (b ** p).real + abs(b ** (1 + 2j)) + (w[1] ** p).imag
    return s


def in_place(z, w, x, p):
    z **= w
    z[0] **= 2.5
    w[1:] **= p
    return np.sum(z.real ** 2) + np.sum(w.imag)


def of_zero(z, w, x, p):
    n = z - z
    return (n[0] ** (1 + 0j)).real + (n[1] ** (3 + 0j)).imag + np.sum((n ** 2.0).real) + np.sum((n ** (w * 0 + 2)).imag)


def of_what_may_be_negative(z, w, x, p):
    return (x[0] ** z[0]).real


def cases():
    z, w = np.array([1 + 0.5j, -0.7 - 0.3j, 0.2 + 1.1j]), np.array([0.3 + 0.2j, 1.5, -0.7 - 0.1j])
    given = z, w, np.array([2.0, -0.5, 1.5]), 2.5
    for kernel in (of_arrays, of_real_exponents, of_real_bases, of_numbers, in_place):
        yield Case(kernel, given, ("z", "w", "x", "p"))
    yield Case(of_zero, given, ("z",))
    yield Case(of_what_may_be_negative, given, ("z",), refused=(
        "S301 at `x[0] ** z[0]`: no derivative rule for a complex power of a number that may be negative: "
        "write (a + 0j) ** b"))
