"""Functions of numbers that one of the engines lacks, or where `math` raises and a derivative must not."""
from __future__ import annotations

import numpy as np


def remainder(a, b):
    """`math.remainder(a, b)`, exact; nan where that raises.

    >>> float(remainder(5.5, 2.0)), float(remainder(-7.0, 2.0)), float(remainder(0.3, np.inf))
    (-0.5, 1.0, 0.3)
    """
    size = abs(b)
    below = np.fmod(abs(a), size)
    above = size - below
    if below < above:
        near = below
    elif below > above:
        near = -above
    else:  # halfway: to the even multiple
        near = below - 2.0 * np.fmod(0.5 * (abs(a) - below), size)
    return near * np.copysign(1.0, a)


def heaviside(x, half):
    """`numpy.heaviside` of numbers: 0 below 0, 1 above, `half` at 0, nan at nan.

    >>> heaviside(-2.0, 0.5), heaviside(0.0, 0.5), heaviside(3.0, 0.5)
    (0.0, 0.5, 1.0)
    """
    if x == 0.0:
        return 1.0 * half
    return 1.0 if x > 0.0 else 0.0 if x < 0.0 else 1.0 * x


def isqrt(n):
    """`math.isqrt(n)`: the integer part of the square root.

    >>> isqrt(24), isqrt(25), isqrt(2 ** 62 - 1)
    (4, 5, 2147483647)
    """
    if n < 0:
        raise ValueError("isqrt() of a negative number")
    root = int(np.sqrt(n))
    while root > 0 and root > n // root:
        root -= 1
    while root + 1 <= n // (root + 1):
        root += 1
    return root


def lcm(a, b):
    """`math.lcm(a, b)`, the least common multiple.

    >>> lcm(4, -6), lcm(0, 3)
    (12, 0)
    """
    first, second = abs(a), abs(b)
    if first == 0 or second == 0:
        return 0
    x, y = first, second
    while y:
        x, y = y, x % y
    return product(first // x, second)


def factorial(n):
    """`math.factorial(n)`; OverflowError from 21 on, where it does not fit 64 bits.

    >>> factorial(0), factorial(5)
    (1, 120)
    """
    if n < 0:
        raise ValueError("factorial() of a negative number")
    return perm(n, n)


def perm(n, k):
    """`math.perm(n, k)`: ways to choose k of n in order; OverflowError where it does not fit 64 bits.

    >>> perm(5, 2), perm(5, 6)
    (20, 0)
    """
    if n < 0 or k < 0:
        raise ValueError("perm() of a negative number")
    if k > n:
        return 0
    ways = 1
    for factor in range(n - k + 1, n + 1):
        ways = product(ways, factor)
    return ways


def comb(n, k):
    """`math.comb(n, k)`: ways to choose k of n; OverflowError where k times it does not fit 64 bits.

    >>> comb(5, 2), comb(60, 30), comb(5, 6)
    (10, 118264581564861424, 0)
    """
    if n < 0 or k < 0:
        raise ValueError("comb() of a negative number")
    if k > n:
        return 0
    ways = 1
    for chosen in range(1, min(k, n - k) + 1):
        ways = product(ways, n - chosen + 1) // chosen
    return ways


def product(a, b):
    """a * b of integers above 0; OverflowError where it does not fit 64 bits.

    >>> product(6, 7)
    42
    """
    if a > 9223372036854775807 // b:
        raise OverflowError("an integer that does not fit 64 bits")
    return a * b


def whole_product(a, b):
    """a * b of integers; OverflowError where it does not fit 64 bits.

    >>> whole_product(-6, 7), whole_product(0, 7)
    (-42, 0)
    """
    if b != 0 and abs(a) > 9223372036854775807 // abs(b):
        raise OverflowError("an integer that does not fit 64 bits: begin with a float, 1.0, not 1")
    return a * b


def whole_power(a, n):
    """a ** n of integers; ValueError where it is no integer, OverflowError where it does not fit 64 bits.

    >>> whole_power(2, 10), whole_power(-1, 3), whole_power(0, 0)
    (1024, -1, 1)
    """
    if n < 0:
        raise ValueError("an integer to a negative power is no integer: write float(a) ** n")
    if -1 <= a <= 1:
        return 1 if n % 2 == 0 and a != 0 or n == 0 else a
    made = 1
    for _ in range(n):
        made = whole_product(made, a)
    return made


def isclose(a, b, relative, absolute):
    """`math.isclose(a, b, rel_tol=relative, abs_tol=absolute)`.

    >>> isclose(1.0, 1.0 + 1e-10, 1e-9, 0.0), isclose(np.inf, np.inf, 1e-9, 0.0), isclose(np.inf, 1.0, 1e-9, 0.0)
    (True, True, False)
    """
    if a == b:
        return True
    if np.isinf(a) or np.isinf(b):
        return False
    apart = abs(a - b)
    return bool(apart <= abs(relative * b) or apart <= abs(relative * a) or apart <= absolute)
