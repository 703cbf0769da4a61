"""dialect: the functions of a derivative's module in what their engine has.

    NumPy       `unraised`: math.sqrt(x) -> np.sqrt(x), 1.0 / n -> 1.0 / np.float64(n)
    Numba       math.cbrt(x) -> np.cbrt(x), math.isqrt(n) -> isqrt(n) of s2sad.runtime: what Numba lacks

Functions of any form go in, and come out in the same.
"""
from __future__ import annotations

from collections.abc import Callable

from s2sad import rules, tree
from s2sad.emit.numpy_scalars import numpy_scalars
from s2sad.infer.types import Type
from s2sad.rules.transforms import TRANSFORMS
from s2sad.tree import AST, BinOp, Call, Div, FunctionDef, Name, attribute, call, call_name, const, copy, name, rebuild
from s2sad.units import Units

_LACKING = {
    "math.fmod": "numpy.fmod", "math.cbrt": "numpy.cbrt", "numpy.fix": "numpy.trunc",
    "numpy.heaviside": "runtime.heaviside", "scipy.special.erf": "math.erf", "scipy.special.erfc": "math.erfc",
    "scipy.special.digamma": "runtime.digamma",
    **{f"scipy.special.{n}": f"runtime.{n}" for n in (
        "expit", "logit", "xlogy", "xlog1py", "gammaln", "entr", "rel_entr", "kl_div")},
    **{f"runtime.{n}": f"runtime.{n}_in_loops" for n in ("sparse_product", "sparse_left_product", "sparse_gain")},
    **{f"math.{n}": f"runtime.{n}" for n in ("remainder", "isqrt", "lcm", "comb", "perm", "factorial")}}

_TRANSFORMS = {f: f"runtime.{f.rpartition('.')[2]}" for f in TRANSFORMS}


def in_dialect(functions: list[FunctionDef], units: Units) -> list[FunctionDef]:
    """The functions, callees first, for the units' engine."""
    if units.engine == "numba":
        return list(map(for_numba, functions))
    return numpy_scalars([rebuild(f, _products_of_stacks) for f in functions], types_of(units), units.program.constants)


def _products_of_stacks(node: AST) -> AST | None:
    """NumPy's own functions of stacks of matrices, and the method in place of a function that takes no keywords."""
    if call_name(node) == "runtime.stacked_transpose":
        return call("numpy.swapaxes", rebuild(node.args[0], _products_of_stacks), const(-2), const(-1))
    if call_name(node) == "runtime.stacked_matmul":
        return call("numpy.matmul", *(rebuild(a, _products_of_stacks) for a in node.args))
    return _conversion(node, _products_of_stacks)


def _conversion(node: AST, change: Callable[[AST], AST | None]) -> AST | None:
    """`x.astype(dtype)`."""
    if call_name(node) != "numpy.astype" or not isinstance(node, Call) or not len(node.args) == len(node.keywords) == 1:
        return None
    made, dtype = rebuild(node.args[0], change), copy(node.keywords[0].value)
    dtype = name("numpy.bool_") if isinstance(dtype, Name) and dtype.id == "builtins.bool" else dtype
    return _at(Call(attribute(made, "astype"), [dtype], []), node)


def types_of(units: Units) -> dict[str, dict[str, Type]]:
    """The types of names, by function."""
    types = {f.name: d.types for d in units.derived.values() for f in d.functions}
    return types | {title: {**u.typing.table, **dict(zip((p.id for p in u.lowered.args.args), u.types))}
                    for title, u in units.titled.items()}


def for_numba(function: FunctionDef) -> FunctionDef:
    """The function without what Numba lacks.

    >>> root = tree.function("root", ["x"], [tree.Return(call("math.cbrt", tree.name("x")))])
    >>> tree.dump(for_numba(root).body[0].value)
    "Call(Name('numpy.cbrt'), [Name('x')], [])"
    """
    made = tree.function(function.name, [p.id for p in function.args.args], rebuild(function.body, _change))
    return tree.at(made, function) if getattr(function, "lineno", None) else made


def _arguments(node: Call) -> list[AST]:
    return [rebuild(a, _change) for a in node.args]


def _change(node: AST) -> AST | None:
    name = call_name(node)
    if not isinstance(node, Call) or name is None:
        return None
    if name in _LACKING:
        args = _arguments(node)
        if name == "math.perm" and len(args) == 1:
            return _at(call("runtime.factorial", *args), node)
        return _at(call(_LACKING[name], *args), node)
    if name in _TRANSFORMS and (rule := rules.find_array(name)) is not None:
        operands = rule.arguments(node)
        return _at(call(_TRANSFORMS[name], *(rebuild(operands[o], _change) for o in (*rule.operands, *rule.options))),
                   node)
    if name == "math.log" and len(node.args) == 2:
        x, base = _arguments(node)
        return _at(BinOp(call(name, x), Div(), call(name, base)), node)
    if name == "numpy.clip" and len(node.args) == 3:
        x, low, high = _arguments(node)
        return _at(call("numpy.minimum", call("numpy.maximum", x, low), high), node)
    if name == "numpy.astype":
        return _conversion(node, _change)
    if name == "numpy.ndim" and len(node.args) == 1:
        return _at(call("builtins.len", call("numpy.shape", *_arguments(node))), node)
    if name == "math.isclose":
        operands = {k.arg: rebuild(k.value, _change) for k in node.keywords}
        tolerances = operands.get("rel_tol", const(1e-9)), operands.get("abs_tol", const(0.0))
        return _at(call("runtime.isclose", *_arguments(node), *tolerances), node)
    return None


def _at(new: AST, old: AST) -> AST:
    return tree.at(new, old) if getattr(old, "lineno", None) else new
