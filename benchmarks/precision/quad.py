"""Numbers of 113 bits, and what is exact between them, doubles and mpmath."""
from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

try:
    import mpmath
    from numpy_quaddtype import QuadPrecDType, QuadPrecision
except ImportError as missing:
    raise ImportError('references of 113 bits need numpy-quaddtype and mpmath: pip install "s2sad[peers]"') from missing

QUAD = QuadPrecDType()
DIGITS = 50


class NoReference(Exception):
    """The derivative cannot be computed with 113 bits here: what it needs is named."""


class Namespace:
    """A module of functions on quads; what it does not have raises NoReference."""

    def __init__(self, name: str, found: Mapping[str, Any] | None = None) -> None:
        self.__dict__["_name"] = name
        self.__dict__["_lazy"] = {}
        self.update(found or {})

    def update(self, found: Mapping[str, Any]) -> None:
        self.__dict__.update(found)

    def lazily(self, name: str, made: Callable[[], Any]) -> None:
        self._lazy[name] = made

    def __getattr__(self, name: str) -> Any:
        if name not in self._lazy:
            raise NoReference(f"{self._name}.{name}")
        self.__dict__[name] = found = self._lazy[name]()
        return found


class Complex:
    """A complex array: its real and its imaginary part, which are arrays or numbers of 113 bits."""
    __array_ufunc__ = None      # arrays of reals leave arithmetic with it to it
    dtype = np.dtype(np.complex128)     # what stands for it where a dtype is asked

    def __init__(self, real: Any, imag: Any) -> None:
        self.real, self.imag = real, imag
        self.shape, self.ndim, self.size = np.shape(real), np.ndim(real), np.size(real)

    def __getitem__(self, place: Any) -> Complex:
        return Complex(self.real[place], self.imag[place])

    def __setitem__(self, place: Any, value: Any) -> None:
        value = _complex(value)
        self.real[place], self.imag[place] = value.real, value.imag

    def __neg__(self) -> Complex:
        return Complex(-self.real, -self.imag)

    def __add__(self, other: Any) -> Complex:
        other = _complex(other)
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: Any) -> Complex:
        return self + -_complex(other)

    def __rsub__(self, other: Any) -> Complex:
        return -self + other

    def __mul__(self, other: Any) -> Complex:
        other = _complex(other)
        return Complex(self.real * other.real - self.imag * other.imag, self.real * other.imag + self.imag * other.real)

    def __truediv__(self, other: Any) -> Complex:
        other = _complex(other)
        size = other.real * other.real + other.imag * other.imag
        top = self * Complex(other.real, -other.imag)
        return Complex(top.real / size, top.imag / size)

    def __rtruediv__(self, other: Any) -> Complex:
        return _complex(other) / self

    __radd__, __rmul__ = __add__, __mul__


def _complex(value: Any) -> Complex:
    return value if isinstance(value, Complex) else Complex(as_quad(value), 0 * as_quad(value))


def as_quad(value: Any) -> Any:
    """A number or an array with 113 bits; integers that are exact, bools too."""
    if isinstance(value, (QuadPrecision, Complex)):
        return value
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "c":
            raise NoReference("complex numbers")
        return value if value.dtype == QUAD else value.astype(QUAD)
    if isinstance(value, (complex, np.complexfloating)):
        raise NoReference("complex numbers")
    if isinstance(value, (bool, np.bool_)):
        return QuadPrecision(int(value))
    if isinstance(value, (int, float, np.integer, np.floating)):
        return QuadPrecision(int(value) if isinstance(value, np.integer) else value)
    if isinstance(value, str):
        return QuadPrecision(value)
    if isinstance(value, (tuple, list)):
        return np.array([as_quad(v) for v in value], QUAD)
    raise NoReference(f"a value of type {type(value).__name__}")


def is_whole(value: Any) -> bool:
    """Whether a value is of integers or bools, which stay what they are."""
    return isinstance(value, (bool, int, np.integer, np.bool_)) or (
        isinstance(value, np.ndarray) and value.dtype != QUAD and value.dtype.kind in "iub")


def divide(a: Any, b: Any) -> Any:
    """`a / b`."""
    return as_quad(a) / as_quad(b)


def power(a: Any, b: Any) -> Any:
    """`a ** b`; of quads to an integer power by mpmath, whose products are rounded once."""
    if is_whole(a) and is_whole(b) and np.all(np.asarray(b) >= 0):
        return a ** b
    a, b = np.asarray(as_quad(a)), np.asarray(as_quad(b))
    return by_mpmath(_power)(a, b)


def _power(a: Any, b: Any) -> Any:
    if mpmath.isnan(b) or mpmath.isinf(b) or mpmath.isinf(a) or mpmath.isnan(a):
        return mpmath.mpf(float(np.float64(float(a)) ** np.float64(float(b))))
    if a == 0:
        return mpmath.mpf(math.inf if b < 0 else 1 if b == 0 else 0)
    if a < 0 and b != mpmath.floor(b):
        return mpmath.nan
    return mpmath.power(a, b)


# -- by mpmath ------------------------------------------------------------------------------------------------------
def to_mpmath(value: Any) -> Any:
    """The same number; a quad is the sum of three doubles."""
    total = mpmath.mpf(0)
    for _ in range(3):
        part = float(value)
        if not math.isfinite(part):
            return mpmath.mpf(part)
        total += part
        value = value - QuadPrecision(part)
    return total


def from_mpmath(value: Any) -> Any:
    if isinstance(value, mpmath.mpc):
        return QuadPrecision(math.nan)
    if mpmath.isnan(value) or mpmath.isinf(value):
        return QuadPrecision(float(value))
    return QuadPrecision(mpmath.nstr(value, 40, strip_zeros=False, min_fixed=1, max_fixed=0))


def by_mpmath(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of numbers for quads and arrays of quads."""
    def called(*given: Any) -> Any:
        arrays = np.broadcast_arrays(*(np.asarray(as_quad(g)) for g in given))
        made = np.empty(arrays[0].shape, QUAD)
        with mpmath.workdps(DIGITS), np.errstate(all="ignore"):
            for place in np.ndindex(made.shape):
                made[place] = from_mpmath(function(*(to_mpmath(a[place]) for a in arrays)))
        return made[()]
    return called
