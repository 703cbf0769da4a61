"""R. W. Hamming, Numerical Methods for Scientists and Engineers, 1987, chapter 3 (the file hamming-ch3)."""
from __future__ import annotations

import math

from benchmarks.precision.fpbench.domains import ABOVE, FREE, within


@within(ABOVE)
def example_3_1(x):
    return math.sqrt(x + 1.0) - math.sqrt(x)


@within(FREE, FREE)
def example_3_3(x, eps):
    return math.sin(x + eps) - math.sin(x)


@within(FREE)
def example_3_4(x):
    return (1.0 - math.cos(x)) / math.sin(x)


@within(FREE)
def example_3_5(n):
    return math.atan(n + 1.0) - math.atan(n)


@within(ABOVE)
def example_3_6(x):
    return 1.0 / math.sqrt(x) - 1.0 / math.sqrt(x + 1.0)


@within(FREE)
def problem_3_3_1(x):
    return 1.0 / (x + 1.0) - 1.0 / x


@within(FREE, FREE)
def problem_3_3_2(x, eps):
    return math.tan(x + eps) - math.tan(x)


@within(FREE)
def problem_3_3_3(x):
    return (1.0 / (x + 1.0) - 2.0 / x) + 1.0 / (x - 1.0)


@within(ABOVE)
def problem_3_3_4(x):
    return (x + 1.0) ** (1.0 / 3.0) - x ** (1.0 / 3.0)


@within(FREE, FREE)
def problem_3_3_5(x, eps):
    return math.cos(x + eps) - math.cos(x)


@within(ABOVE)
def problem_3_3_6(n):
    return math.log(n + 1.0) - math.log(n)


@within((-700.0, 700.0))
def problem_3_3_7(x):
    return (math.exp(x) - 2.0) + math.exp(-x)


def _real_roots(a, b, c):
    return b * b > 4.0 * (a * c)


@within(FREE, FREE, FREE, holds=_real_roots)
def p42_positive(a, b, c):
    return (-b + math.sqrt(b * b - 4.0 * (a * c))) / (2.0 * a)


@within(FREE, FREE, FREE, holds=_real_roots)
def p42_negative(a, b, c):
    return (-b - math.sqrt(b * b - 4.0 * (a * c))) / (2.0 * a)


@within(FREE, FREE, FREE, holds=lambda a, b, c: b * b > a * c)
def problem_3_2_1_positive(a, b, c):
    return (-b + math.sqrt(b * b - a * c)) / a


@within(FREE, FREE, FREE, holds=lambda a, b, c: b * b > a * c)
def problem_3_2_1_negative(a, b, c):
    return (-b - math.sqrt(b * b - a * c)) / a


@within((-0.00017, 700.0))
def example_3_7(x):
    return math.exp(x) - 1.0


@within((6.8e15, 1e18))
def example_3_8(n):
    return ((n + 1.0) * math.log(n + 1.0) - n * math.log(n)) - 1.0


@within((-0.026, 0.026))
def example_3_9(x):
    return 1.0 / x - 1.0 / math.tan(x)


@within((-1.0, 1.0))
def example_3_10(x):
    return math.log(1.0 - x) / math.log(1.0 + x)


@within(FREE)
def problem_3_4_1(x):
    return (1.0 - math.cos(x)) / (x * x)


@within((-100.0, 100.0), (-100.0, 100.0), (-1.0, 1.0))
def problem_3_4_2(a, b, eps):
    return (eps * (math.exp((a + b) * eps) - 1.0)) / ((math.exp(a * eps) - 1.0) * (math.exp(b * eps) - 1.0))


@within((-1.0, 1.0))
def problem_3_4_3(eps):
    return math.log((1.0 - eps) / (1.0 + eps))


@within((-300.0, 300.0))
def problem_3_4_4(x):
    return math.sqrt((math.exp(2.0 * x) - 1.0) / (math.exp(x) - 1.0))


@within(FREE)
def problem_3_4_5(x):
    return (x - math.sin(x)) / (x - math.tan(x))


@within(ABOVE, ABOVE)
def problem_3_4_6(x, n):
    return (x + 1.0) ** (1.0 / n) - x ** (1.0 / n)


@within((-20.0, 20.0), (-20.0, 20.0))
def section_3_5(a, x):
    return math.exp(a * x) - 1.0


@within((-300.0, 300.0))
def section_3_11(x):
    return math.exp(x) / (math.exp(x) - 1.0)
