"""Complex arrays of 113 bits, each a pair of arrays of quads, and the functions of `numpy` and `numpy.fft` on them.

A transform is the sum that defines it, with sines and cosines by mpmath: for short arrays.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from benchmarks.precision.linalg import matmul
from benchmarks.precision.quad import QUAD, Complex, NoReference, as_quad, by_mpmath, mpmath

BY_PARTS = """copy array moveaxis swapaxes transpose reshape ravel roll flip zeros_like empty_like sum take expand_dims
    squeeze broadcast_to""".split()


def numpy_functions(of_reals: Mapping[str, Any]) -> dict[str, Any]:
    """Functions of `numpy` that take complex arrays, too; of others `of_reals` has them."""
    return {
        **{name: _by_parts(of_reals[name]) for name in BY_PARTS},
        **{name: _made(of_reals[name]) for name in ("empty", "zeros")},
        **{name: _or(of_reals[name], lambda x: np.sqrt(x.real * x.real + x.imag * x.imag)) for name in (
            "abs", "absolute")},
        **{name: _or(of_reals[name], lambda x: Complex(x.real, -x.imag)) for name in ("conj", "conjugate")},
        "real": _or(as_quad, lambda x: x.real), "imag": _or(lambda x: 0 * as_quad(x), lambda x: x.imag),
        "complex128": np.complex128}


def _or(of_real: Callable[..., Any], of_complex: Callable[..., Any]) -> Callable[..., Any]:
    def called(x: Any, *given: Any, **options: Any) -> Any:
        return (of_complex if isinstance(x, Complex) else of_real)(x, *given, **options)
    return called


def _by_parts(function: Callable[..., Any]) -> Callable[..., Any]:
    return _or(function, lambda x, *given, **options: Complex(
        function(x.real, *given, **options), function(x.imag, *given, **options)))


def _made(function: Callable[..., Any]) -> Callable[..., Any]:
    def called(shape: Any, dtype: Any = None, order: str = "C") -> Any:
        if dtype in (complex, np.complex128):
            return Complex(function(shape), function(shape))
        return function(shape, dtype, order)
    return called


# -- transforms -----------------------------------------------------------------------------------------------------
@by_mpmath
def _cosine(turn: Any) -> Any:
    return mpmath.cospi(2 * turn)


@by_mpmath
def _sine(turn: Any) -> Any:
    return mpmath.sinpi(2 * turn)


def _roots(n: int, sign: int) -> Complex:
    """exp(2 pi i sign j k / n) for all j and k."""
    turns = np.arange(n)[:, None] * np.arange(n) % n
    turns = as_quad(turns) / as_quad(n)
    return Complex(_cosine(turns), sign * _sine(turns))


def _rows(x: Any, n: int | None, axis: int) -> Complex:
    """The axis as the last one, with n elements: the first ones, or zeros behind."""
    parts = [np.moveaxis(p, axis, -1) for p in ((x.real, x.imag) if isinstance(x, Complex) else (x, 0 * as_quad(x)))]
    n = parts[0].shape[-1] if n is None else n
    made, known = np.zeros((2, *parts[0].shape[:-1], n), QUAD), min(n, parts[0].shape[-1])
    made[0, ..., :known], made[1, ..., :known] = (p[..., :known] for p in parts)
    return Complex(*made)


def _scale(n: int, norm: str | None, inverse: bool) -> Any:
    if norm not in (None, "backward", "ortho", "forward"):
        raise NoReference(f"norm={norm!r}")
    if norm == "ortho":
        return np.sqrt(as_quad(n))
    return as_quad(n if (norm == "forward") != inverse else 1)


def _transform(x: Any, n: int | None, axis: int, norm: str | None, inverse: bool) -> Complex:
    rows = _rows(x, n, axis)
    n = rows.shape[-1]
    roots, scale = _roots(n, 1 if inverse else -1), _scale(n, norm, inverse)
    left, right = rows.real.reshape(-1, n), rows.imag.reshape(-1, n)
    real = matmul(left, roots.real) - matmul(right, roots.imag)
    imag = matmul(left, roots.imag) + matmul(right, roots.real)
    return Complex(*(np.moveaxis((part / scale).reshape(rows.shape), -1, axis) for part in (real, imag)))


def fft(x: Any, n: int | None = None, axis: int = -1, norm: str | None = None) -> Complex:
    """`numpy.fft.fft`."""
    return _transform(x, n, axis, norm, False)


def ifft(x: Any, n: int | None = None, axis: int = -1, norm: str | None = None) -> Complex:
    """`numpy.fft.ifft`."""
    return _transform(x, n, axis, norm, True)


def rfft(x: Any, n: int | None = None, axis: int = -1, norm: str | None = None) -> Complex:
    """`numpy.fft.rfft`."""
    whole = fft(x, n, axis, norm)
    half = np.arange(whole.shape[axis] // 2 + 1)
    return Complex(np.take(whole.real, half, axis), np.take(whole.imag, half, axis))


def irfft(x: Complex, n: int | None = None, axis: int = -1, norm: str | None = None) -> Any:
    """`numpy.fft.irfft`."""
    n = 2 * (x.shape[axis] - 1) if n is None else n
    half = _rows(x, n // 2 + 1, axis)
    rest = slice((n - 1) // 2, 0, -1)
    whole = Complex(np.concatenate((half.real, half.real[..., rest]), -1),
                    np.concatenate((half.imag, -half.imag[..., rest]), -1))
    return np.moveaxis(ifft(whole, n, -1, norm).real, -1, axis)


TRANSFORMS = {"fft": fft, "ifft": ifft, "rfft": rfft, "irfft": irfft}
