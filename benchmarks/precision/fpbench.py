"""Expressions of the FPBench suite (fpbench.org; N. Damouche et al., Toward a Standard Benchmark Format and Suite for
Floating-Point Analysis, NSV 2016) that are differentiable and have no loop, with their domains.

From its files: hamming-ch3 (R. W. Hamming, Numerical Methods for Scientists and Engineers, chapter 3), herbie, rosa,
daisy, fptaylor, graphics and Transcendentals. Where a domain has no bound numbers are drawn by their size, 1e-4 to 1e4.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

FREE = (None, None)     # both signs, any size
ABOVE = (0.0, None)


@dataclass(frozen=True)
class Expression:
    """A function of floats, its arguments' ranges, and what must hold of them beside."""
    function: Callable[..., float]
    ranges: tuple[tuple[float | None, float | None], ...]
    holds: Callable[..., Any] = lambda *_: True


LISTED: list[Expression] = []


def _in(*ranges: tuple[float | None, float | None], holds: Callable[..., Any] = lambda *_: True
        ) -> Callable[[Callable[..., float]], Callable[..., float]]:
    def enter(function: Callable[..., float]) -> Callable[..., float]:
        LISTED.append(Expression(function, ranges, holds))
        return function
    return enter


# -- Hamming, chapter 3 ---------------------------------------------------------------------------------------------
@_in(ABOVE)
def example_3_1(x):
    return math.sqrt(x + 1.0) - math.sqrt(x)


@_in(FREE, FREE)
def example_3_3(x, eps):
    return math.sin(x + eps) - math.sin(x)


@_in(FREE)
def example_3_4(x):
    return (1.0 - math.cos(x)) / math.sin(x)


@_in(FREE)
def example_3_5(n):
    return math.atan(n + 1.0) - math.atan(n)


@_in(ABOVE)
def example_3_6(x):
    return 1.0 / math.sqrt(x) - 1.0 / math.sqrt(x + 1.0)


@_in(FREE)
def problem_3_3_1(x):
    return 1.0 / (x + 1.0) - 1.0 / x


@_in(FREE, FREE)
def problem_3_3_2(x, eps):
    return math.tan(x + eps) - math.tan(x)


@_in(FREE)
def problem_3_3_3(x):
    return (1.0 / (x + 1.0) - 2.0 / x) + 1.0 / (x - 1.0)


@_in(ABOVE)
def problem_3_3_4(x):
    return (x + 1.0) ** (1.0 / 3.0) - x ** (1.0 / 3.0)


@_in(FREE, FREE)
def problem_3_3_5(x, eps):
    return math.cos(x + eps) - math.cos(x)


@_in(ABOVE)
def problem_3_3_6(n):
    return math.log(n + 1.0) - math.log(n)


@_in((-700.0, 700.0))
def problem_3_3_7(x):
    return (math.exp(x) - 2.0) + math.exp(-x)


def _real_roots(a, b, c):
    return b * b > 4.0 * (a * c)


@_in(FREE, FREE, FREE, holds=_real_roots)
def p42_positive(a, b, c):
    return (-b + math.sqrt(b * b - 4.0 * (a * c))) / (2.0 * a)


@_in(FREE, FREE, FREE, holds=_real_roots)
def p42_negative(a, b, c):
    return (-b - math.sqrt(b * b - 4.0 * (a * c))) / (2.0 * a)


@_in(FREE, FREE, FREE, holds=lambda a, b, c: b * b > a * c)
def problem_3_2_1_positive(a, b, c):
    return (-b + math.sqrt(b * b - a * c)) / a


@_in(FREE, FREE, FREE, holds=lambda a, b, c: b * b > a * c)
def problem_3_2_1_negative(a, b, c):
    return (-b - math.sqrt(b * b - a * c)) / a


@_in((-0.00017, 700.0))
def example_3_7(x):
    return math.exp(x) - 1.0


@_in((6.8e15, 1e18))
def example_3_8(n):
    return ((n + 1.0) * math.log(n + 1.0) - n * math.log(n)) - 1.0


@_in((-0.026, 0.026))
def example_3_9(x):
    return 1.0 / x - 1.0 / math.tan(x)


@_in((-1.0, 1.0))
def example_3_10(x):
    return math.log(1.0 - x) / math.log(1.0 + x)


@_in(FREE)
def problem_3_4_1(x):
    return (1.0 - math.cos(x)) / (x * x)


@_in((-100.0, 100.0), (-100.0, 100.0), (-1.0, 1.0))
def problem_3_4_2(a, b, eps):
    return (eps * (math.exp((a + b) * eps) - 1.0)) / ((math.exp(a * eps) - 1.0) * (math.exp(b * eps) - 1.0))


@_in((-1.0, 1.0))
def problem_3_4_3(eps):
    return math.log((1.0 - eps) / (1.0 + eps))


@_in((-300.0, 300.0))
def problem_3_4_4(x):
    return math.sqrt((math.exp(2.0 * x) - 1.0) / (math.exp(x) - 1.0))


@_in(FREE)
def problem_3_4_5(x):
    return (x - math.sin(x)) / (x - math.tan(x))


@_in(ABOVE, ABOVE)
def problem_3_4_6(x, n):
    return (x + 1.0) ** (1.0 / n) - x ** (1.0 / n)


@_in((-20.0, 20.0), (-20.0, 20.0))
def section_3_5(a, x):
    return math.exp(a * x) - 1.0


@_in((-300.0, 300.0))
def section_3_11(x):
    return math.exp(x) / (math.exp(x) - 1.0)


# -- Herbie, graphics -----------------------------------------------------------------------------------------------
@_in(FREE, FREE)
def complex_square_root(re, im):
    return 0.5 * math.sqrt(2.0 * (math.sqrt(re * re + im * im) + re))


@_in(FREE, (-300.0, 300.0))
def complex_sine_and_cosine(re, im):
    return (0.5 * math.sin(re)) * (math.exp(-im) - math.exp(im))


@_in((0.0, 10.0), (0.0, 10.0), (-20.0, 20.0), (-20.0, 20.0))
def probabilities_in_a_clustering_algorithm(cp, cn, t, s):
    over = (1.0 / (1.0 + math.exp(-s))) ** cp * (1.0 - 1.0 / (1.0 + math.exp(-s))) ** cn
    return over / ((1.0 / (1.0 + math.exp(-t))) ** cp * (1.0 - 1.0 / (1.0 + math.exp(-t))) ** cn)


@_in(FREE, FREE, FREE, FREE)
def some_eigenvalue_calculation(a, b, c, d):
    return math.sqrt((a + d) ** 2 + (b - c) ** 2) - math.sqrt((a - d) ** 2 + (b + c) ** 2)


# -- Rosa, Daisy ----------------------------------------------------------------------------------------------------
@_in((-5.0, 5.0), (-20.0, 5.0))
def jet_engine(x1, x2):
    t = (3.0 * x1 * x1 + 2.0 * x2) - x1
    t2 = (3.0 * x1 * x1 - 2.0 * x2) - x1
    d = x1 * x1 + 1.0
    s = t / d
    s2 = t2 / d
    return x1 + (((((2.0 * x1 * s * (s - 3.0) + x1 * x1 * (4.0 * s - 6.0)) * d + 3.0 * x1 * x1 * s)
                   + x1 * x1 * x1) + x1) + 3.0 * s2)


@_in((-100.0, 100.0), (20.0, 20000.0), (-30.0, 50.0))
def doppler1(u, v, t):
    t1 = 331.4 + 0.6 * t
    return (-t1 * v) / ((t1 + u) * (t1 + u))


@_in((-125.0, 125.0), (15.0, 25000.0), (-40.0, 60.0))
def doppler2(u, v, t):
    t1 = 331.4 + 0.6 * t
    return (-t1 * v) / ((t1 + u) * (t1 + u))


@_in((-4.5, -0.3), (0.4, 0.9), (3.8, 7.8))
def turbine1(v, w, r):
    return ((3.0 + 2.0 / (r * r)) - (0.125 * (3.0 - 2.0 * v)) * (w * w * r * r) / (1.0 - v)) - 4.5


@_in((1.0, 100.0), (1.0, 100.0))
def polar_radius(x, y):
    return math.sqrt(x * x + y * y)


@_in((1.0, 100.0), (1.0, 100.0))
def polar_angle(x, y):
    return math.atan(y / x) * (180.0 / 3.14159265359)


@_in((1.0, 10.0), (0.0, 360.0))
def cartesian_x(radius, theta):
    return radius * math.cos(theta * (3.14159265359 / 180.0))


@_in((1.0, 10.0), (0.0, 360.0))
def cartesian_y(radius, theta):
    return radius * math.sin(theta * (3.14159265359 / 180.0))


@_in((0.0, 300.0), (1.0, 50.0), (1.0, 100.0), (0.001, 0.004), (1.0, 12.0))
def instantaneous_current(time, resistance, frequency, inductance, voltage):
    reactance = 2.0 * 3.14159265359 * frequency * inductance
    square = resistance * resistance + reactance * reactance
    re = voltage * resistance / square
    im = -(voltage * reactance) / square
    largest = math.sqrt(re * re + im * im)
    return largest * math.cos(2.0 * 3.14159265359 * frequency * time + math.atan(im / re))


@_in(*[(-10.0, 10.0)] * 9)
def matrix_determinant(a, b, c, d, e, f, g, h, i):
    return (((a * e) * i + (b * f) * g) + (c * d) * h) - (((c * e) * g + (b * d) * i) + (a * f) * h)


# -- FPTaylor -------------------------------------------------------------------------------------------------------
@_in((0.0, 999.0))
def intro_example(t):
    return t / (t + 1.0)


@_in((1.001, 2.0), (1.001, 2.0))
def sec4_example(x, y):
    t = x * y
    return (t - 1.0) / (t * t - 1.0)


@_in(*[(1.0, 2.0)] * 3)
def test01_sum3(x0, x1, x2):
    p0 = (x0 + x1) - x2
    p1 = (x1 + x2) - x0
    p2 = (x2 + x0) - x1
    return (p0 + p1) + p2


@_in((0.0, 1.0), (-1.0, -0.1))
def test03_nonlin2(x, y):
    return (x + y) / (x - y)


@_in(*[(-1.0, 1.0)] * 3, *[(0.00001, 1.0)] * 6)
def test04_dqmom9(m0, m1, m2, w0, w1, w2, a0, a1, a2):
    v2 = (w2 * (0.0 - m2)) * (-3.0 * ((a2 / w2) * (a2 / w2)))
    v1 = (w1 * (0.0 - m1)) * (-3.0 * ((a1 / w1) * (a1 / w1)))
    v0 = (w0 * (0.0 - m0)) * (-3.0 * ((a0 / w0) * (a0 / w0)))
    return v0 + (v1 + v2)


@_in((1.00001, 2.0))
def test05_nonlin1(x):
    return (x - 1.0) / (x * x - 1.0)


@_in((0.1, 0.5))
def carbon_gas(v):
    return (3.5e7 + 0.401 * (1000.0 / v) * (1000.0 / v)) * (v - 1000.0 * 42.7e-6) - 1.3806503e-23 * 1000.0 * 300.0


@_in(*[(0.0, 6.0)] * 2, (1.0, 5.0), *[(0.0, 6.0)] * 2, (0.0, 10.0))
def floudas1(x1, x2, x3, x4, x5, x6):
    return ((((-25.0 * ((x1 - 2.0) * (x1 - 2.0)) - (x2 - 2.0) * (x2 - 2.0)) - (x3 - 1.0) * (x3 - 1.0))
             - (x4 - 4.0) * (x4 - 4.0)) - (x5 - 1.0) * (x5 - 1.0)) - (x6 - 4.0) * (x6 - 4.0)


@_in((0.0, 2.0), (0.0, 3.0))
def floudas3(x1, x2):
    return (-12.0 * x1 - 7.0 * x2) + x2 * x2


@_in(*[(0.0, 1.0)] * 3)
def hartman3(x1, x2, x3):
    e1 = 3.0 * (x1 - 0.3689) ** 2 + 10.0 * (x2 - 0.117) ** 2 + 30.0 * (x3 - 0.2673) ** 2
    e2 = 0.1 * (x1 - 0.4699) ** 2 + 10.0 * (x2 - 0.4387) ** 2 + 35.0 * (x3 - 0.747) ** 2
    e3 = 3.0 * (x1 - 0.1091) ** 2 + 10.0 * (x2 - 0.8732) ** 2 + 30.0 * (x3 - 0.5547) ** 2
    e4 = 0.1 * (x1 - 0.03815) ** 2 + 10.0 * (x2 - 0.5743) ** 2 + 35.0 * (x3 - 0.8828) ** 2
    return -(1.0 * math.exp(-e1) + 1.2 * math.exp(-e2) + 3.0 * math.exp(-e3) + 3.2 * math.exp(-e4))


@_in(*[(4.0, 6.36)] * 6)
def kepler0(x1, x2, x3, x4, x5, x6):
    return ((x2 * x5 + x3 * x6) - x2 * x3) - x5 * x6 + x1 * (((((-x1 + x2) + x3) - x4) + x5) + x6)


@_in(*[(4.0, 6.36)] * 4)
def kepler1(x1, x2, x3, x4):
    return ((((((x1 * x4) * (((-x1 + x2) + x3) - x4) + x2 * (((x1 - x2) + x3) + x4))
               + x3 * (((x1 + x2) - x3) + x4)) - (x2 * x3) * x4) - x1 * x3) - x1 * x2) - x4


@_in(*[(4.0, 6.36)] * 6)
def kepler2(x1, x2, x3, x4, x5, x6):
    return ((((((x1 * x4) * (((((-x1 + x2) + x3) - x4) + x5) + x6)
                + (x2 * x5) * (((((x1 - x2) + x3) + x4) - x5) + x6))
               + (x3 * x6) * (((((x1 + x2) - x3) + x4) + x5) - x6)) - (x2 * x3) * x4) - (x1 * x3) * x5)
            - (x1 * x2) * x6) - (x4 * x5) * x6


@_in((-8.0, 8.0))
def log_exp(x):
    return math.log(1.0 + math.exp(x))


@_in((0.1, 0.3))
def predator_prey(x):
    return ((4.0 * x) * x) / (1.0 + (x / 1.11) * (x / 1.11))


@_in(*[(-15.0, 15.0)] * 3)
def rigid_body1(x1, x2, x3):
    return ((-(x1 * x2) - (2.0 * x2) * x3) - x1) - x3


@_in(*[(-15.0, 15.0)] * 3)
def rigid_body2(x1, x2, x3):
    return (((((2.0 * x1) * x2) * x3 + (3.0 * x3) * x3) - ((x2 * x1) * x2) * x3) + (3.0 * x3) * x3) - x2


@_in((-2.0, 2.0))
def sine_order3(z):
    return 0.954929658551372 * z - 0.12900613773279798 * ((z * z) * z)


@_in((-1.57079632679, 1.57079632679))
def sine(x):
    return ((x - ((x * x) * x) / 6.0) + ((((x * x) * x) * x) * x) / 120.0) - (
        ((((((x * x) * x) * x) * x) * x) * x) / 5040.0)


@_in((-10.0, 10.0), (0.0, 10.0), (-1.570796, 1.570796), (-3.14159265, 3.14159265))
def sphere(x, r, lat, lon):
    return x + (r * math.sin(lat)) * math.cos(lon)


@_in((0.0, 1.0))
def square_root(y):
    return (((1.0 + 0.5 * y) - (0.125 * y) * y) + ((0.0625 * y) * y) * y) - (((0.0390625 * y) * y) * y) * y


@_in((0.1, 0.3))
def verhulst(x):
    return (4.0 * x) / (1.0 + x / 1.11)


@_in(*[(4.0, 3969.0 / 625.0)] * 6)
def delta4(x1, x2, x3, x4, x5, x6):
    return ((((-x2 * x3 - x1 * x4) + x2 * x5) + x3 * x6) - x5 * x6) + x1 * (((((-x1 + x2) + x3) - x4) + x5) + x6)


@_in((1.0, 1000.0))
def sqrt_add(x):
    return 1.0 / (math.sqrt(x + 1.0) + math.sqrt(x))


@_in((0.01, 0.5))
def exp1x(x):
    return (math.exp(x) - 1.0) / x


@_in((0.01, 0.5))
def exp1x_log(x):
    return (math.exp(x) - 1.0) / math.log(math.exp(x))


@_in((1.0, 4.0), (1.0, 4.0))
def x_by_xy(x, y):
    return x / (x + y)


@_in((0.1, 10.0), (-5.0, 5.0))
def i4(x, y):
    return math.sqrt(x + y * y)


@_in((0.1, 10.0), (-5.0, 5.0))
def i6(x, y):
    return math.sin(x * y)


@_in((-5.0, 5.0), (-5.0, 5.0))
def himmelblau(x1, x2):
    a = (x1 * x1 + x2) - 11.0
    b = (x1 + x2 * x2) - 7.0
    return a * a + b * b


# -- Transcendentals ------------------------------------------------------------------------------------------------
@_in((-2.0, 2.0), (-5.0, 5.0))
def pendulum1(t, w):
    k1w = (-9.80665 / 2.0) * math.sin(t)
    k2t = w + (0.01 / 2.0) * k1w
    return t + 0.01 * k2t


@_in((-2.0, 2.0), (-5.0, 5.0))
def pendulum2(t, w):
    k2w = (-9.80665 / 2.0) * math.sin(t + (0.01 / 2.0) * w)
    return w + 0.01 * k2w


@_in((-1.57079632679, 1.57079632679))
def analysis1(x):
    x1 = math.sin(x)
    x2 = math.cos(x)
    return ((x1 * x1) * x2) * x2


@_in((-1.1, 0.9))
def analysis2(x):
    x1 = 1.0 / math.cos(x)
    x2 = math.tan(x)
    return (x1 * x1) / (4.0 + x2 * x2)
