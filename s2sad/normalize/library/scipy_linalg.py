"""scipy_linalg: functions of `scipy.linalg` that are NumPy's, or made of these, with other options.

    def f(a: "float64[:, :]", b: "float64[:]"):     def f(a, b):
        return np.sum(scipy.linalg.solve(a, b))         return np.sum(np.linalg.solve(a, b))

Requires structured form. Establishes that a function of `scipy.linalg` that NumPy has is NumPy's. A symmetric matrix is
its triangle that SciPy reads. Options that are unknown here are left, to be refused: other drivers of `eigh`, and
the upper triangle, give vectors of other signs than NumPy's.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import reduce

from s2sad.passes import Context
from s2sad.tree import (
    AST, Call, Constant, FunctionDef, Starred, at, call, call_name, const, negate, rebuild, tuple_of, with_body,
)

SCIPY = "scipy.linalg."
IGNORED = ("check_finite", "overwrite_a", "overwrite_b", "overwrite_ab")
_PARAMETERS = {"solve": "a b lower overwrite_a overwrite_b check_finite assume_a transposed",
               "qr": "a overwrite_a lwork mode pivoting check_finite", "eigh": "a b", "eigvalsh": "a b",
               "solveh_banded": "ab b overwrite_ab overwrite_b lower check_finite",
               "svd": "a full_matrices compute_uv overwrite_a check_finite lapack_driver"}
_SYMMETRIC = ("sym", "symmetric", "her", "hermitian", "pos", "positive definite")
Options = dict[str, AST]


def scipy_linalg(function: FunctionDef, context: Context) -> FunctionDef:
    """The function with such calls in NumPy's spelling."""
    def change(node: AST) -> AST | None:
        called = call_name(node) or ""
        if not isinstance(node, Call) or not called.startswith(SCIPY):
            return None
        made = _in_numpy(node, called.removeprefix(SCIPY))
        return None if made is None else at(rebuild(made, lambda n: None if n is made else change(n)), node)
    return with_body(function, [rebuild(statement, change) for statement in function.body])


def _in_numpy(node: Call, function: str) -> AST | None:
    if function == "block_diag" and not node.keywords and len(node.args) > 2 and not any(
            isinstance(a, Starred) for a in node.args):
        return reduce(lambda a, b: call(f"{SCIPY}block_diag", a, b), node.args)
    names = _PARAMETERS.get(function, "").split()
    if not names or len(node.args) > len(names):
        return None
    given: Options = {**dict(zip(names, node.args)), **{str(k.arg): k.value for k in node.keywords}}
    if len(given) < len(node.args) + len(node.keywords):
        return None
    options = {k: v for k, v in given.items() if k not in IGNORED and not _is_constant(v, None)}
    made = _SPELLED[function](options) if names[0] in options else None
    return None if options else made     # each takes what it knows


def _is_constant(node: AST, value: object) -> bool:
    return isinstance(node, Constant) and node.value is value


def _pop_constant(options: Options, option: str, default: object) -> object:
    """The constant that an option is; any other expression stays among the options."""
    if option not in options:
        return default
    return options.pop(option).value if isinstance(options[option], Constant) else default


def transposed_matrices(a: AST, transposed: object = True) -> AST:
    """Each matrix of a stack transposed."""
    return call("numpy.swapaxes", a, negate(const(1)), negate(const(2))) if transposed else a


def _solve(options: Options) -> AST | None:
    assumed, lower = _pop_constant(options, "assume_a", "gen"), _pop_constant(options, "lower", False)
    transposed = _pop_constant(options, "transposed", False)
    a, b = options.pop("a"), options.pop("b", None)
    if b is None or assumed not in ("gen", "general", *_SYMMETRIC):
        return None
    if assumed in _SYMMETRIC:
        return call("numpy.linalg.solve", call(f"{SCIPY}mirrored", a, lower=const(bool(lower))), b)
    return call("numpy.linalg.solve", transposed_matrices(a, transposed), b)


def _qr(options: Options) -> AST | None:
    mode, pivoting = _pop_constant(options, "mode", "full"), _pop_constant(options, "pivoting", False)
    a = options.pop("a")
    if pivoting or mode not in ("full", "economic", "r"):
        return None
    if mode == "r":
        return tuple_of(call(f"{SCIPY}qr.triangular", a))       # of a stack of matrices SciPy gives no tuple
    return call("numpy.linalg.qr", a, mode=const("reduced" if mode == "economic" else "complete"))


def _eigh(options: Options) -> AST | None:
    """NumPy reads the lower triangle; the values are the same whatever the driver is, vectors have other signs."""
    alone, driver = _pop_constant(options, "eigvals_only", False), _pop_constant(options, "driver", None)
    lower = _pop_constant(options, "lower", True)
    a = transposed_matrices(options.pop("a"), not lower)
    if alone:
        return call("numpy.linalg.eigvalsh", a)
    return call("numpy.linalg.eigh", a) if driver == "evd" and lower else None


def _eigvalsh(options: Options) -> AST | None:
    _pop_constant(options, "driver", None)
    lower = _pop_constant(options, "lower", True)
    return call("numpy.linalg.eigvalsh", transposed_matrices(options.pop("a"), not lower))


def _solveh_banded(options: Options) -> AST | None:
    lower = _pop_constant(options, "lower", False)
    a, b = options.pop("ab"), options.pop("b", None)
    return None if b is None else call(f"{SCIPY}solveh_banded", a, b, lower=const(bool(lower)))


def _svd(options: Options) -> AST | None:
    driver, vectors = _pop_constant(options, "lapack_driver", "gesdd"), _pop_constant(options, "compute_uv", True)
    complete = _pop_constant(options, "full_matrices", True)
    a = options.pop("a")
    if not vectors:
        return call("runtime.singular_values", a)
    return call("numpy.linalg.svd", a, full_matrices=const(bool(complete))) if driver == "gesdd" else None


_SPELLED: dict[str, Callable[[Options], AST | None]] = {
    "solve": _solve, "qr": _qr, "eigh": _eigh, "eigvalsh": _eigvalsh, "solveh_banded": _solveh_banded,
    "svd": _svd}
