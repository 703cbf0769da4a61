"""Expressions of FPTaylor (A. Solovyev et al., FM 2015): its tests and those it takes from Real2Float."""
from __future__ import annotations

import math

from benchmarks.precision.fpbench.domains import within


@within((0.0, 999.0))
def intro_example(t):
    return t / (t + 1.0)


@within((1.001, 2.0), (1.001, 2.0))
def sec4_example(x, y):
    t = x * y
    return (t - 1.0) / (t * t - 1.0)


@within(*[(1.0, 2.0)] * 3)
def test01_sum3(x0, x1, x2):
    p0 = (x0 + x1) - x2
    p1 = (x1 + x2) - x0
    p2 = (x2 + x0) - x1
    return (p0 + p1) + p2


@within((0.0, 1.0), (-1.0, -0.1))
def test03_nonlin2(x, y):
    return (x + y) / (x - y)


@within(*[(-1.0, 1.0)] * 3, *[(0.00001, 1.0)] * 6)
def test04_dqmom9(m0, m1, m2, w0, w1, w2, a0, a1, a2):
    v2 = (w2 * (0.0 - m2)) * (-3.0 * ((a2 / w2) * (a2 / w2)))
    v1 = (w1 * (0.0 - m1)) * (-3.0 * ((a1 / w1) * (a1 / w1)))
    v0 = (w0 * (0.0 - m0)) * (-3.0 * ((a0 / w0) * (a0 / w0)))
    return v0 + (v1 + v2)


@within((1.00001, 2.0))
def test05_nonlin1(x):
    return (x - 1.0) / (x * x - 1.0)


@within((0.1, 0.5))
def carbon_gas(v):
    return (3.5e7 + 0.401 * (1000.0 / v) * (1000.0 / v)) * (v - 1000.0 * 42.7e-6) - 1.3806503e-23 * 1000.0 * 300.0


@within(*[(0.0, 6.0)] * 2, (1.0, 5.0), *[(0.0, 6.0)] * 2, (0.0, 10.0))
def floudas1(x1, x2, x3, x4, x5, x6):
    return ((((-25.0 * ((x1 - 2.0) * (x1 - 2.0)) - (x2 - 2.0) * (x2 - 2.0)) - (x3 - 1.0) * (x3 - 1.0))
             - (x4 - 4.0) * (x4 - 4.0)) - (x5 - 1.0) * (x5 - 1.0)) - (x6 - 4.0) * (x6 - 4.0)


@within((0.0, 2.0), (0.0, 3.0))
def floudas3(x1, x2):
    return (-12.0 * x1 - 7.0 * x2) + x2 * x2


@within(*[(0.0, 1.0)] * 3)
def hartman3(x1, x2, x3):
    e1 = 3.0 * (x1 - 0.3689) ** 2 + 10.0 * (x2 - 0.117) ** 2 + 30.0 * (x3 - 0.2673) ** 2
    e2 = 0.1 * (x1 - 0.4699) ** 2 + 10.0 * (x2 - 0.4387) ** 2 + 35.0 * (x3 - 0.747) ** 2
    e3 = 3.0 * (x1 - 0.1091) ** 2 + 10.0 * (x2 - 0.8732) ** 2 + 30.0 * (x3 - 0.5547) ** 2
    e4 = 0.1 * (x1 - 0.03815) ** 2 + 10.0 * (x2 - 0.5743) ** 2 + 35.0 * (x3 - 0.8828) ** 2
    return -(1.0 * math.exp(-e1) + 1.2 * math.exp(-e2) + 3.0 * math.exp(-e3) + 3.2 * math.exp(-e4))


@within(*[(4.0, 6.36)] * 6)
def kepler0(x1, x2, x3, x4, x5, x6):
    return ((x2 * x5 + x3 * x6) - x2 * x3) - x5 * x6 + x1 * (((((-x1 + x2) + x3) - x4) + x5) + x6)


@within(*[(4.0, 6.36)] * 4)
def kepler1(x1, x2, x3, x4):
    return ((((((x1 * x4) * (((-x1 + x2) + x3) - x4) + x2 * (((x1 - x2) + x3) + x4))
               + x3 * (((x1 + x2) - x3) + x4)) - (x2 * x3) * x4) - x1 * x3) - x1 * x2) - x4


@within(*[(4.0, 6.36)] * 6)
def kepler2(x1, x2, x3, x4, x5, x6):
    return ((((((x1 * x4) * (((((-x1 + x2) + x3) - x4) + x5) + x6)
                + (x2 * x5) * (((((x1 - x2) + x3) + x4) - x5) + x6))
               + (x3 * x6) * (((((x1 + x2) - x3) + x4) + x5) - x6)) - (x2 * x3) * x4) - (x1 * x3) * x5)
            - (x1 * x2) * x6) - (x4 * x5) * x6


@within((-8.0, 8.0))
def log_exp(x):
    return math.log(1.0 + math.exp(x))


@within((0.1, 0.3))
def predator_prey(x):
    return ((4.0 * x) * x) / (1.0 + (x / 1.11) * (x / 1.11))


@within(*[(-15.0, 15.0)] * 3)
def rigid_body1(x1, x2, x3):
    return ((-(x1 * x2) - (2.0 * x2) * x3) - x1) - x3


@within(*[(-15.0, 15.0)] * 3)
def rigid_body2(x1, x2, x3):
    return (((((2.0 * x1) * x2) * x3 + (3.0 * x3) * x3) - ((x2 * x1) * x2) * x3) + (3.0 * x3) * x3) - x2


@within((-2.0, 2.0))
def sine_order3(z):
    return 0.954929658551372 * z - 0.12900613773279798 * ((z * z) * z)


@within((-1.57079632679, 1.57079632679))
def sine(x):
    return ((x - ((x * x) * x) / 6.0) + ((((x * x) * x) * x) * x) / 120.0) - (
        ((((((x * x) * x) * x) * x) * x) * x) / 5040.0)


@within((-10.0, 10.0), (0.0, 10.0), (-1.570796, 1.570796), (-3.14159265, 3.14159265))
def sphere(x, r, lat, lon):
    return x + (r * math.sin(lat)) * math.cos(lon)


@within((0.0, 1.0))
def square_root(y):
    return (((1.0 + 0.5 * y) - (0.125 * y) * y) + ((0.0625 * y) * y) * y) - (((0.0390625 * y) * y) * y) * y


@within((0.1, 0.3))
def verhulst(x):
    return (4.0 * x) / (1.0 + x / 1.11)


@within(*[(4.0, 3969.0 / 625.0)] * 6)
def delta4(x1, x2, x3, x4, x5, x6):
    return ((((-x2 * x3 - x1 * x4) + x2 * x5) + x3 * x6) - x5 * x6) + x1 * (((((-x1 + x2) + x3) - x4) + x5) + x6)


@within((1.0, 1000.0))
def sqrt_add(x):
    return 1.0 / (math.sqrt(x + 1.0) + math.sqrt(x))


@within((0.01, 0.5))
def exp1x(x):
    return (math.exp(x) - 1.0) / x


@within((0.01, 0.5))
def exp1x_log(x):
    return (math.exp(x) - 1.0) / math.log(math.exp(x))


@within((1.0, 4.0), (1.0, 4.0))
def x_by_xy(x, y):
    return x / (x + y)


@within((0.1, 10.0), (-5.0, 5.0))
def i4(x, y):
    return math.sqrt(x + y * y)


@within((0.1, 10.0), (-5.0, 5.0))
def i6(x, y):
    return math.sin(x * y)


@within((-5.0, 5.0), (-5.0, 5.0))
def himmelblau(x1, x2):
    a = (x1 * x1 + x2) - 11.0
    b = (x1 + x2 * x2) - 7.0
    return a * a + b * b
