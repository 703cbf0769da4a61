"""Expressions that tools bound the errors of: Herbie, Rosa, Daisy, and what else they were tried on."""
from __future__ import annotations

import math

from benchmarks.precision.fpbench.domains import FREE, within


# -- Herbie, graphics --------------------------------------------------------------------------------------------------
@within(FREE, FREE)
def complex_square_root(re, im):
    return 0.5 * math.sqrt(2.0 * (math.sqrt(re * re + im * im) + re))


@within(FREE, (-300.0, 300.0))
def complex_sine_and_cosine(re, im):
    return (0.5 * math.sin(re)) * (math.exp(-im) - math.exp(im))


@within((0.0, 10.0), (0.0, 10.0), (-20.0, 20.0), (-20.0, 20.0))
def probabilities_in_a_clustering_algorithm(cp, cn, t, s):
    over = (1.0 / (1.0 + math.exp(-s))) ** cp * (1.0 - 1.0 / (1.0 + math.exp(-s))) ** cn
    return over / ((1.0 / (1.0 + math.exp(-t))) ** cp * (1.0 - 1.0 / (1.0 + math.exp(-t))) ** cn)


@within(FREE, FREE, FREE, FREE)
def some_eigenvalue_calculation(a, b, c, d):
    return math.sqrt((a + d) ** 2 + (b - c) ** 2) - math.sqrt((a - d) ** 2 + (b + c) ** 2)


# -- Rosa, Daisy -------------------------------------------------------------------------------------------------------
@within((-5.0, 5.0), (-20.0, 5.0))
def jet_engine(x1, x2):
    t = (3.0 * x1 * x1 + 2.0 * x2) - x1
    t2 = (3.0 * x1 * x1 - 2.0 * x2) - x1
    d = x1 * x1 + 1.0
    s = t / d
    s2 = t2 / d
    return x1 + (((((2.0 * x1 * s * (s - 3.0) + x1 * x1 * (4.0 * s - 6.0)) * d + 3.0 * x1 * x1 * s)
                   + x1 * x1 * x1) + x1) + 3.0 * s2)


@within((-100.0, 100.0), (20.0, 20000.0), (-30.0, 50.0))
def doppler1(u, v, t):
    t1 = 331.4 + 0.6 * t
    return (-t1 * v) / ((t1 + u) * (t1 + u))


@within((-125.0, 125.0), (15.0, 25000.0), (-40.0, 60.0))
def doppler2(u, v, t):
    t1 = 331.4 + 0.6 * t
    return (-t1 * v) / ((t1 + u) * (t1 + u))


@within((-4.5, -0.3), (0.4, 0.9), (3.8, 7.8))
def turbine1(v, w, r):
    return ((3.0 + 2.0 / (r * r)) - (0.125 * (3.0 - 2.0 * v)) * (w * w * r * r) / (1.0 - v)) - 4.5


@within((1.0, 100.0), (1.0, 100.0))
def polar_radius(x, y):
    return math.sqrt(x * x + y * y)


@within((1.0, 100.0), (1.0, 100.0))
def polar_angle(x, y):
    return math.atan(y / x) * (180.0 / 3.14159265359)


@within((1.0, 10.0), (0.0, 360.0))
def cartesian_x(radius, theta):
    return radius * math.cos(theta * (3.14159265359 / 180.0))


@within((1.0, 10.0), (0.0, 360.0))
def cartesian_y(radius, theta):
    return radius * math.sin(theta * (3.14159265359 / 180.0))


@within((0.0, 300.0), (1.0, 50.0), (1.0, 100.0), (0.001, 0.004), (1.0, 12.0))
def instantaneous_current(time, resistance, frequency, inductance, voltage):
    reactance = 2.0 * 3.14159265359 * frequency * inductance
    square = resistance * resistance + reactance * reactance
    re = voltage * resistance / square
    im = -(voltage * reactance) / square
    largest = math.sqrt(re * re + im * im)
    return largest * math.cos(2.0 * 3.14159265359 * frequency * time + math.atan(im / re))


@within(*[(-10.0, 10.0)] * 9)
def matrix_determinant(a, b, c, d, e, f, g, h, i):
    return (((a * e) * i + (b * f) * g) + (c * d) * h) - (((c * e) * g + (b * d) * i) + (a * f) * h)


# -- Transcendentals ---------------------------------------------------------------------------------------------------
@within((-2.0, 2.0), (-5.0, 5.0))
def pendulum1(t, w):
    k1w = (-9.80665 / 2.0) * math.sin(t)
    k2t = w + (0.01 / 2.0) * k1w
    return t + 0.01 * k2t


@within((-2.0, 2.0), (-5.0, 5.0))
def pendulum2(t, w):
    k2w = (-9.80665 / 2.0) * math.sin(t + (0.01 / 2.0) * w)
    return w + 0.01 * k2w


@within((-1.57079632679, 1.57079632679))
def analysis1(x):
    x1 = math.sin(x)
    x2 = math.cos(x)
    return ((x1 * x1) * x2) * x2


@within((-1.1, 0.9))
def analysis2(x):
    x1 = 1.0 / math.cos(x)
    x2 = math.tan(x)
    return (x1 * x1) / (4.0 + x2 * x2)
