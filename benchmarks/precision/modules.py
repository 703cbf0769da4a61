"""What stands for `numpy`, `math` and `scipy` in a text of 113 bits: numpy-quaddtype's arrays, and nothing else.

A name that is not here has no reference (`NoReference`): there is no way back to doubles. What numpy-quaddtype lacks is
written out or asked of mpmath, and no result of any function here may be an array of doubles.
"""
from __future__ import annotations

import builtins
import math
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from benchmarks.precision import complexes, linalg
from benchmarks.precision.quad import (
    DIGITS, QUAD, Namespace, NoReference, QuadPrecDType, QuadPrecision, as_quad, by_mpmath, divide, from_mpmath,
    is_whole, mpmath, power,
)


class _Dtype:
    """What `numpy.float64` is: a dtype and a conversion."""
    dtype = QUAD

    def __call__(self, value: Any = 0.0) -> Any:
        return as_quad(value)


def _checked(name: str, found: Any) -> Any:
    """The result, unless it is of doubles."""
    for value in found if isinstance(found, (tuple, list)) else (found,):
        if isinstance(value, (float, np.floating)) and not isinstance(value, QuadPrecision) or (
                isinstance(value, np.ndarray) and value.dtype != QUAD and value.dtype.kind not in "iub"):
            raise NoReference(f"{name}, which gives doubles")
    return found


# -- numpy ----------------------------------------------------------------------------------------------------------
class _Ufunc:
    """An elementwise function with its methods; `whole` where integers stay integers."""

    def __init__(self, name: str, whole: bool, function: Callable[..., Any] | None = None) -> None:
        self.name, self.whole, self.function = name, whole, function or getattr(np, name)

    def __call__(self, *given: Any, out: Any = None, where: Any = None) -> Any:
        if where is not None:
            raise NoReference(f"where= of numpy.{self.name}")
        if not (self.whole and all(map(is_whole, given))):
            given = tuple(map(as_quad, given))
        with np.errstate(all="ignore"):
            found = _checked(self.name, self.function(*given))
        if out is None:
            return found
        out[...] = found
        return out

    def __getattr__(self, method: str) -> Any:
        if method not in ("at", "reduce", "accumulate", "outer"):
            raise NoReference(f"numpy.{self.name}.{method}")
        return lambda *a, **k: _checked(self.name, getattr(self.function, method)(*a, **k))


def _plain(name: str) -> Callable[..., Any]:
    """A function of NumPy's that does not care what the elements are."""
    def called(*given: Any, **options: Any) -> Any:
        options = {k: _dtype(v) if k == "dtype" else v for k, v in options.items()}
        return _checked(name, getattr(np, name)(*given, **options))
    return called


def _dtype(asked: Any) -> Any:
    """The dtype for a dtype that is asked for: floats have 113 bits."""
    if asked is None or asked is builtins.float or asked is as_quad or isinstance(asked, (_Dtype, QuadPrecDType)):
        return QUAD
    found = np.dtype(asked)
    if found.kind == "c":
        raise NoReference("complex numbers")
    return QUAD if found.kind == "f" else found


def array(value: Any, dtype: Any = None, copy: Any = True, **options: Any) -> Any:
    """`numpy.array`."""
    made = np.array(value, copy=True) if copy else np.asarray(value)
    if dtype is not None:
        return made.astype(_dtype(dtype))
    return as_quad(made) if made.dtype.kind == "f" and made.dtype != QUAD else _checked("array", made)


def _made(name: str) -> Callable[..., Any]:
    return lambda shape, dtype=None, order="C": getattr(np, name)(shape, _dtype(dtype))


def _made_like(name: str) -> Callable[..., Any]:
    def called(like: Any, dtype: Any = None, shape: Any = None) -> Any:
        found = np.asarray(like).dtype if dtype is None else _dtype(dtype)
        return getattr(np, name)(np.shape(like) if shape is None else shape, QUAD if found.kind == "f" else found)
    return called


def _full(shape: Any, value: Any, dtype: Any = None) -> Any:
    made = np.empty(shape, _dtype(dtype) if dtype is not None or not is_whole(value) else np.asarray(value).dtype)
    made[...] = value
    return made


def _arange(*bounds: Any) -> Any:
    if all(map(is_whole, bounds)):
        return np.arange(*bounds)
    start, stop, step = (0.0, *bounds, 1.0) if len(bounds) == 1 else (*bounds, 1.0)[:3]
    return as_quad(start) + as_quad(np.arange(len(np.arange(*map(float, (start, stop, step)))))) * as_quad(step)


def _linspace(start: Any, stop: Any, num: int = 50, endpoint: bool = True) -> Any:
    count = num - 1 if endpoint else num
    return as_quad(start) + (as_quad(stop) - as_quad(start)) * as_quad(np.arange(num)) / as_quad(max(count, 1))


def _where(condition: Any, *sides: Any) -> Any:
    if not all(map(is_whole, sides)):
        sides = tuple(map(as_quad, sides))
    return np.where(condition, *sides)[()] if sides else np.where(condition)


def _dot(a: Any, b: Any) -> Any:
    a, b = np.asarray(a), np.asarray(b)
    if a.ndim == 0 or b.ndim == 0:
        return a * b
    return linalg.matmul(a, b)


def _mean(x: Any, axis: Any = None, keepdims: bool = False, dtype: Any = None) -> Any:
    """`numpy.mean`, whose own division is by a double."""
    x = as_quad(np.asarray(x))
    total = _sum("sum")(x, axis=axis, keepdims=keepdims)
    return total / as_quad(x.size // max(np.size(total), 1))


def _var(x: Any, axis: Any = None, keepdims: bool = False, ddof: int = 0) -> Any:
    x = as_quad(np.asarray(x))
    apart = x - _mean(x, axis, True)
    total = _sum("sum")(apart * apart, axis=axis, keepdims=keepdims)
    return total / as_quad(x.size // max(np.size(total), 1) - ddof)


def _median(x: Any, axis: Any = None, keepdims: bool = False) -> Any:
    rows = np.ravel(x) if axis is None else np.moveaxis(x, axis, -1)
    rows, n = np.sort(rows, axis=-1), rows.shape[-1]
    found = (rows[..., (n - 1) // 2] + rows[..., n // 2]) / as_quad(2)
    return np.expand_dims(found, axis) if keepdims and axis is not None else found


def _logsumexp(x: Any, axis: Any = None, keepdims: bool = False) -> Any:
    top = np.max(x, axis=axis, keepdims=True)
    total = np.log(_sum("sum")(np.exp(x - top), axis=axis, keepdims=keepdims))
    return total + (top if keepdims else np.reshape(top, np.shape(total)))


def _sum(name: str) -> Callable[..., Any]:
    def called(x: Any, axis: Any = None, keepdims: bool = False, **options: Any) -> Any:
        if options.keys() - {"dtype"}:
            raise NoReference(f"options of numpy.{name}")
        x = x if isinstance(x, np.ndarray) else array(x)
        if name in ("sum", "prod") and not is_whole(x):     # numpy-quaddtype's have no identity
            return getattr(np, name)(x, axis=axis, keepdims=keepdims, initial=as_quad(float(name == "prod")))
        return _checked(name, getattr(np, name)(x, axis=axis, keepdims=keepdims))
    return called


def _einsum(subscripts: str, *operands: Any, **options: Any) -> Any:
    """By Python's own sums: the one of numpy-quaddtype gives zeros."""
    found = np.einsum(subscripts, *(np.asarray(as_quad(o)).astype(object) for o in operands))
    return np.asarray(found).astype(QUAD)[()] if isinstance(found, np.ndarray) else as_quad(found)


def _clip(x: Any, low: Any, high: Any) -> Any:
    return np.minimum(np.maximum(as_quad(x), as_quad(low)), as_quad(high))


def _bincount(x: Any, weights: Any = None, minlength: int = 0) -> Any:
    counts = np.bincount(x, minlength=minlength)
    if weights is None:
        return counts
    made = np.zeros(counts.size, QUAD)
    np.add.at(made, x, as_quad(weights))
    return made


def _interp(x: Any, xp: Any, fp: Any) -> Any:
    x, xp, fp = map(as_quad, (x, xp, fp))
    k = np.clip(np.searchsorted(xp, x, side="right") - 1, 0, xp.size - 2)
    inner = fp[k] + (fp[k + 1] - fp[k]) / (xp[k + 1] - xp[k]) * (x - xp[k])
    return np.where(x < xp[0], fp[0], np.where(x > xp[-1], fp[-1], inner))[()]


def _norm(x: Any, ord: Any = None, axis: Any = None, keepdims: bool = False) -> Any:
    if ord not in (None, 2, "fro") or (ord == 2 and np.ndim(x) != 1 and axis is None):
        raise NoReference(f"numpy.linalg.norm with ord={ord!r}")
    return np.sqrt(np.sum(as_quad(x) ** 2, axis=axis, keepdims=keepdims))


def _sinc(x: Any) -> Any:
    angle = CONSTANTS_BY_NAME["pi"] * as_quad(x)
    return np.where(angle == 0, as_quad(1.0), np.sin(angle) / np.where(angle == 0, as_quad(1.0), angle))[()]


with mpmath.workdps(DIGITS):
    CONSTANTS_BY_NAME = {name: from_mpmath(+value) for name, value in {
        "pi": mpmath.pi, "ln2": mpmath.ln2, "1 / ln2": 1 / mpmath.ln2, "1 / ln10": 1 / mpmath.ln10,
        "degree": mpmath.degree, "1 / degree": 1 / mpmath.degree, "2 / sqrt(pi)": 2 / mpmath.sqrt(mpmath.pi),
        "sqrt(1 / 2)": mpmath.sqrt(mpmath.mpf(1) / 2)}.items()}
# by the double that a rule spells
CONSTANTS = {float(value): value for value in CONSTANTS_BY_NAME.values()}

_FLOATS = """exp exp2 expm1 log log2 log10 log1p sin cos tan arcsin arccos arctan asin acos atan sinh cosh tanh arcsinh
    arccosh arctanh asinh acosh atanh sqrt cbrt hypot arctan2 atan2 logaddexp logaddexp2 reciprocal divide true_divide
    copysign fmod heaviside fabs rint floor ceil trunc deg2rad rad2deg radians degrees""".split()
_SAME = """add subtract multiply negative positive absolute abs square maximum minimum fmax fmin sign mod remainder
    floor_divide conjugate conj""".split()
_PLAIN = """roll flip flipud fliplr transpose moveaxis reshape ravel broadcast_to concatenate stack hstack vstack
    column_stack expand_dims squeeze swapaxes tile repeat diag diagonal tril triu copy take take_along_axis
    put_along_axis argmax argmin argsort sort nonzero flatnonzero any all isnan isfinite isinf isclose shape size ndim
    outer trace cumsum cumprod diff unravel_index ix_ meshgrid searchsorted array_equal count_nonzero logical_and
    logical_or logical_not logical_xor signbit bitwise_and bitwise_or invert less less_equal greater greater_equal equal
    not_equal unique pad append delete insert indices tri fill_diagonal triu_indices tril_indices diag_indices kron
    atleast_1d atleast_2d broadcast_shapes ndindex split""".split()
_NUMPY: dict[str, Any] = {
    **{name: _Ufunc(name, False) for name in _FLOATS}, **{name: _Ufunc(name, True) for name in _SAME},
    **{name: _plain(name) for name in _PLAIN},
    **{name: _sum(name) for name in ("sum", "prod", "max", "min", "amax", "amin")},
    "mean": _mean, "var": _var, "median": _median, "std": lambda *a, **k: np.sqrt(_var(*a, **k)),
    **{name: _made(name) for name in ("empty", "zeros", "ones")},
    **{f"{name}_like": _made_like(name) for name in ("empty", "zeros", "ones")},
    "full": _full, "full_like": lambda like, value: _full(np.shape(like), value, np.asarray(like).dtype),
    "array": array, "asarray": lambda value, dtype=None: array(value, dtype, copy=False),
    "ascontiguousarray": np.ascontiguousarray, "arange": _arange, "linspace": _linspace, "where": _where,
    "eye": lambda n, m=None, k=0: as_quad(np.eye(n, m, k)), "identity": lambda n: as_quad(np.eye(n)),
    "matmul": linalg.matmul, "dot": _dot, "inner": lambda a, b: _dot(a, np.asarray(b).T),
    "vdot": lambda a, b: linalg.matmul(np.ravel(a), np.ravel(b)),
    "einsum": _einsum, "tensordot": lambda a, b, axes=2: _checked("tensordot", as_quad(
        np.tensordot(a.astype(object), b.astype(object), axes).astype(QUAD))),
    "power": power, "pow": power, "float_power": power, "clip": _clip, "bincount": _bincount, "interp": _interp,
    "sinc": _sinc, "result_type": lambda *given: QUAD, "float64": _Dtype(), "float32": _Dtype(),
    "errstate": np.errstate,
    "finfo": lambda dtype: SimpleNamespace(eps=as_quad(2.0 ** -112), tiny=as_quad(2.0 ** -16382)),
    "pi": as_quad(math.pi), "e": as_quad(math.e), "inf": as_quad(math.inf), "nan": as_quad(math.nan),
    **{name: getattr(np, name) for name in ("int64", "int32", "bool_", "intp", "newaxis", "s_", "ndarray", "integer")},
}

# -- math and scipy -------------------------------------------------------------------------------------------------
_MATH = {
    **{name: _NUMPY[other] for name, other in {
        **{n: n for n in "exp exp2 expm1 log2 log10 log1p sin cos tan sinh cosh tanh sqrt cbrt hypot fabs fmod "
           "copysign radians degrees asin acos atan atan2 asinh acosh atanh isnan isinf isfinite pi e inf nan".split()},
        "pow": "power", "fsum": "sum", "prod": "prod"}.items()},
    "log": lambda x, *base: divide(np.log(as_quad(x)), np.log(as_quad(base[0]))) if base else np.log(as_quad(x)),
    "floor": math.floor, "ceil": math.ceil, "trunc": math.trunc, "gcd": math.gcd, "isqrt": math.isqrt,
    "comb": math.comb, "factorial": math.factorial, "tau": as_quad(math.tau),
    "hypot": lambda *x: np.sqrt(sum(as_quad(a) * as_quad(a) for a in x)),
    "gamma": by_mpmath(mpmath.gamma), "lgamma": by_mpmath(lambda x: mpmath.log(abs(mpmath.gamma(x)))),
    "erf": by_mpmath(mpmath.erf), "erfc": by_mpmath(mpmath.erfc),
}


def _zero_times(log: Callable[[Any], Any]) -> Callable[[Any, Any], Any]:
    return lambda a, b: mpmath.mpf(0) if a == 0 and not mpmath.isnan(b) else a * log(b)


_SPECIAL = {
    "erf": _MATH["erf"], "erfc": _MATH["erfc"], "gammaln": _MATH["lgamma"], "gamma": _MATH["gamma"],
    "digamma": by_mpmath(mpmath.digamma), "psi": by_mpmath(mpmath.digamma),
    "expit": lambda x: divide(1, 1 + np.exp(-as_quad(x))),
    "logit": by_mpmath(lambda x: mpmath.log(x / (1 - x)) if 0 < x < 1 else mpmath.nan),
    "xlogy": by_mpmath(_zero_times(mpmath.log)), "xlog1py": by_mpmath(_zero_times(lambda b: mpmath.log(1 + b))),
    "logsumexp": _logsumexp,
    "entr": by_mpmath(lambda x: -x * mpmath.log(x) if x > 0 else mpmath.mpf(0) if x == 0 else mpmath.ninf),
    "rel_entr": by_mpmath(lambda a, b: a * mpmath.log(a / b) if a > 0 and b > 0 else mpmath.mpf(0)),
    "kl_div": by_mpmath(lambda a, b: a * mpmath.log(a / b) - a + b if a > 0 and b > 0 else b),
}


def replaced_in_runtime(found: Mapping[str, Any]) -> dict[str, Any]:
    """Of the functions of the runtime those that stop at 53 bits, with 113."""
    better = {**_SPECIAL, **linalg.RUNTIME}
    return {n: better[n] for n in found if n in better}


def _modules() -> dict[str, Any]:
    parts = {"linalg": Namespace("numpy.linalg", {**linalg.LINALG, "norm": _norm}),
             "fft": Namespace("numpy.fft", complexes.TRANSFORMS)}
    numpy_ = Namespace("numpy", {**_NUMPY, **complexes.numpy_functions(_NUMPY), **parts})
    special, same = Namespace("scipy.special", _SPECIAL), ("solve", "inv", "det", "svdvals", "pinv")
    scipy = SimpleNamespace(special=special, linalg=Namespace("scipy.linalg", {
        "expm": linalg.exponential, **{n: linalg.LINALG[n] for n in same}, "norm": _norm}))
    return {"numpy": numpy_, "math": Namespace("math", _MATH), "scipy": scipy, "scipy.special": special,
            "numpy.linalg": numpy_.linalg, "scipy.linalg": scipy.linalg}


MODULES = _modules()
