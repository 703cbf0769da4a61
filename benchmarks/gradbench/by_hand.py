"""The evals in C++, derivatives by hand: compiled where there is a compiler, called as the tool's functions are.

`calls` gives, for an eval and the arguments of its functions, what computes the same; what they return has the form of
what the tool's functions return.
"""
from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

OPTIONS = ("-O3", "-march=native", "-std=c++17", "-shared", "-fPIC")
Calls = tuple[Callable[[], Any] | None, Callable[[], Any]]


@cache
def library() -> ctypes.CDLL | None:
    """The compiled library; None without a compiler."""
    compiler = shutil.which("g++")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "by_hand.so"
        sources = sorted(map(str, (Path(__file__).parent / "cpp").glob("*.cpp")))
        subprocess.run([compiler, *OPTIONS, "-o", str(target), *sources], check=True)
        return ctypes.CDLL(str(target))


def calls(module: str, arguments: tuple[Any, ...]) -> Calls:
    """The primal, where the eval has one, and the derivative."""
    return _BY_EVAL[module](*arguments)


def _function(name: str, *arguments: Any, returns: bool = False) -> Callable[[], Any]:
    """A call of a function of the library: arrays go as pointers, which are held."""
    found = library()
    assert found is not None
    called = found[name]
    called.restype = ctypes.c_double if returns else None
    given = [a.ctypes.data_as(ctypes.c_void_p) if isinstance(a, np.ndarray) else ctypes.c_int(a)
             if isinstance(a, (int, np.integer)) else ctypes.c_double(a) if isinstance(a, float) else a
             for a in arguments]

    def call() -> Any:
        assert arguments
        return called(*given)
    return call


def _with(result: Any, call: Callable[[], Any]) -> Callable[[], Any]:
    """The call, which gives what it writes."""
    def called() -> Any:
        call()
        return result
    return called


def _det(a: np.ndarray) -> Calls:
    out = np.empty(a.shape)
    return _function("det_primal", len(a), a, returns=True), _with((out,), _function("det_gradient", len(a), a, out))


def _llsq(x: np.ndarray, n: int) -> Calls:
    out = np.empty(x.size)
    return (_function("llsq_primal", x.size, x, n, returns=True),
            _with((out,), _function("llsq_gradient", x.size, x, n, out)))


def _lse(x: np.ndarray) -> Calls:
    out = np.empty(x.size)
    return _function("lse_primal", x.size, x, returns=True), _with((out,), _function("lse_gradient", x.size, x, out))


def _ode(x: np.ndarray, s: int) -> Calls:
    y, out = np.empty(x.size), np.empty(x.size)
    return (_with(y, _function("ode_primal", x.size, x, s, y)),
            _with((out,), _function("ode_gradient", x.size, x, s, out)))


def _kmeans(points: np.ndarray, centroids: np.ndarray) -> Calls:
    sizes, out = (len(points), *centroids.shape), np.empty(centroids.shape)
    return (_function("kmeans_cost", *sizes, points, centroids, returns=True),
            _with(out, _function("kmeans_dir", *sizes, points, centroids, out)))


def _gmm(*given: Any) -> Calls:
    alpha, mu, q, below, x, gamma, m, _ = given
    arguments = (x.shape[1], alpha.size, len(x), alpha, mu, q, below, x, gamma, m)
    parts = [np.empty(part.size) for part in (alpha, mu, q, below)]
    out = np.empty(sum(part.size for part in parts))
    ends = np.cumsum([part.size for part in parts])[:-1]
    split = tuple(part.reshape(like.shape) for part, like in zip(np.split(out, ends), (alpha, mu, q, below)))
    return (_function("gmm_objective", *arguments, returns=True),
            _with(split, _function("gmm_jacobian", *arguments, out)))


def _lstm(main: np.ndarray, extra: np.ndarray, state: np.ndarray, sequence: np.ndarray) -> Calls:
    arguments = (len(main) // 2, *sequence.shape, main, extra, state, sequence)
    out = np.empty(main.size + extra.size)
    parts = out[:main.size].reshape(main.shape), out[main.size:].reshape(extra.shape)
    return (_function("lstm_objective", *arguments, returns=True),
            _with(parts, _function("lstm_jacobian", *arguments, out)))


def _ba(*given: np.ndarray) -> Calls:
    cameras, points, weights, features, _, _ = given
    p = weights.size
    arguments = (len(cameras), len(points), p, cameras, points, weights, features)
    errors, starts = (np.empty((p, 2)), np.empty(p)), np.empty(3 * p + 1, dtype=np.int64)
    columns, values = np.empty(31 * p, dtype=np.int64), np.empty(31 * p)
    return (_with(errors, _function("ba_objective", *arguments, *errors)),
            _with((starts, columns, values), _function("ba_jacobian", *arguments, starts, columns, values)))


class _Hand(ctypes.Structure):
    _fields_ = [*((name, ctypes.c_int) for name in ("bones", "vertices", "count", "mirrored")),
                *((name, ctypes.c_void_p) for name in (
                    "parents", "relatives", "inverses", "positions", "weights", "triangles", "correspondences",
                    "points", "theta", "us"))]


def _ht(*given: Any) -> Calls:
    theta, *rest = given
    us = rest.pop(0) if len(given) > 9 else None
    parents, relatives, inverses, positions, weights, *rest = rest
    triangles = rest.pop(0) if us is not None else None
    mirrored, correspondences, points = rest
    arrays = parents, relatives, inverses, positions, weights, triangles, correspondences, points, theta, us
    hand = _Hand(len(parents), len(positions), len(points), int(mirrored),
                 *(None if a is None else a.ctypes.data for a in arrays))
    out, columns = np.empty(points.size), np.empty((points.size, 26 if us is None else 28))
    return (_with(out, _function("ht_objective", ctypes.byref(hand), out)),
            _with(columns, _function("ht_jacobian", ctypes.byref(hand), columns)))


def _particle(w: float) -> Calls:
    return None, _function("particle_control", w, returns=True)


def _saddle(start: np.ndarray) -> Calls:
    out = np.empty(4)
    return None, _with(out, _function("saddle_point", start, out))


_BY_EVAL: dict[str, Callable[..., Calls]] = {
    "ba": _ba, "det": _det, "gmm": _gmm, "ht": _ht, "kmeans": _kmeans, "llsq": _llsq, "lse": _lse, "lstm": _lstm,
    "ode": _ode, "particle": _particle, "saddle": _saddle}
